#include <pintle/solver/block_solver.h>

#include <pintle/solver/row_velocities.h>

#include <cmath>

namespace pintle {
inline namespace PINTLE_PRECISION {

void BlockSolver::measure(const std::vector<Vector6d>& velocities) {
  measureAtStart(m_island, *m_of.component, own(velocities), m_work.u);
}

void BlockSolver::begin(Sweep sweep, std::vector<Vector6d>& velocities) {
  measure(velocities);
  m_set.choose();
  if (sweep != Sweep::all_at_once) {
    std::fill(m_work.y.begin(), m_work.y.end(), 0.);
    m_swept = sweep == Sweep::one_by_one ? &m_set.all() : &m_set.bounded();
    m_set.release(*m_swept);
  }
  if (sweep == Sweep::one_by_one) return;
  factorise();
  respond(m_work.y, velocities);
}

double BlockSolver::sweep(std::vector<Vector6d>& velocities) {
  const double change = m_swept != nullptr ? sweepRows(velocities) : 0;
  if (!m_has_factor) return change;
  const Pass pass = solve(velocities);
  m_changes = pass.changes_set;
  return std::fmax(change, pass.error / m_island.dt);
}

// All rows at once, with one factor. Which of them act is found before the first pass over contacts. A later pass that would change
// that is undone, and rows with bounds go on as contacts do (Passes::settle).
BlockSolver::Pass BlockSolver::solve(std::vector<Vector6d>& velocities) {
  const bool among_passes = !m_alone && m_passes > 0;
  bool changes = false;
  if (mayChangeSet() && !among_passes) {
    std::vector<double>&x = m_work.x, &y = m_work.y;
    m_work.y_before_choice = y;
    m_set.measureBounded(own(velocities));
    m_is_unsettled =
        !m_alone && m_set.factors() >= m_options.max_set_factors && m_set.wouldChange();
    if (m_is_unsettled) return {infinity, true};
    changes = m_set.chooseAgain(m_alone && m_set.factors() >= m_options.max_set_factors);
    if (y != m_work.y_before_choice) {  // those that came to a bound
      for (size_t k = 0; k < y.size(); ++k) x[k] = y[k] - m_work.y_before_choice[k];
      respond(x, velocities);
    }
    if (changes) factorise();
  }
  const double error = m_has_factor ? solveOnce(velocities) : 0;
  if (mayChangeSet() && among_passes) {
    m_set.measureBounded(own(velocities));
    m_is_unsettled = m_set.wouldChange();
  }
  return {error, changes};
}

// Returns what was left before, m or rad.
double BlockSolver::solveOnce(std::vector<Vector6d>& velocities) {
  std::vector<double>&x = m_work.x, &y = m_work.y;
  const double error = m_set.findResidual(own(velocities));
  if (error <= m_options.newton_tolerance) return error;
  m_of.K->solve(x.data());
  respond(x, velocities);
  for (size_t k = 0; k < y.size(); ++k) y[k] += x[k];
  return error;
}

void BlockSolver::finish(std::vector<Vector6d>& velocities, const std::vector<ContactRow>& bounds) {
  if (m_alone)
    while (m_has_factor && solve(velocities).changes_set) continue;
  for (double last = infinity; m_has_factor;) {
    const double error = solveOnce(velocities);
    if (!(error > m_options.newton_tolerance && error < last / 2)) break;
    last = error;
  }
  // A factor that rounding has spoilt leads elsewhere.
  if (m_has_factor && !(m_set.findResidual(own(velocities)) <=
                        std::fmax(m_options.contact_tolerance, m_options.newton_tolerance)))
    m_solvable = false;
  takeBounds(bounds);
  const auto first = velocities.begin() + m_of.component->first_body;
  m_work.v.assign(first, first + m_of.component->bodies);
  measure(velocities);
  m_set.keepImpulses();
}

// What the parts of its law have of its impulse.
void BlockSolver::addBounds(std::vector<ContactRow>& to, std::vector<Vector6d>& velocities) {
  std::fill(m_work.x.begin(), m_work.x.end(), 0.);
  m_set.measureBounded(own(velocities));
  m_is_unsettled = false;
  m_has_bounds = true;
  m_first_bound = to.size();
  for (const ActiveSet::Place& of : m_set.bounded()) {
    const IslandRow& row = *of.row;
    double& y = m_work.y[of.at];
    const double impulse = y * row.by_root_K;
    const AxisLaw::Parts parts =
        row.law.split(m_work.pieces[of.r].velocityAt(m_work.u[of.r], impulse), impulse);
    double sum = 0;
    for (int i = 0; i < row.law.parts(); ++i) sum += parts[size_t(i)];
    m_work.x[of.at] = sum * row.root_K - y;
    y = sum * row.root_K;
    const IslandJoint& joint = m_island.joints[size_t(m_of.component->first_joint + of.joint)];
    const double moved = m_island.velocityOfUnmoved(joint, row.J);
    ContactRow bound;
    bound.body = joint.body;
    bound.J = row.J;
    for (int i = 0; i < row.law.parts(); ++i) {
      const LawPart& part = row.law.part(i);
      bound.target = part.target - moved;
      bound.softness = part.softness > 0 ? part.softness : m_work.of_loop[size_t(of.joint)] * row.K;
      bound.lower = part.lower;
      bound.upper = part.upper;
      bound.impulse = parts[size_t(i)];
      to.push_back(bound);
    }
  }
  respond(m_work.x, velocities);
  m_set.release(m_set.bounded());
  m_solvable = m_has_factor = m_set.factorise(m_options.max_set_factors + 1);
}

void BlockSolver::takeBounds(const std::vector<ContactRow>& from) {
  if (!m_has_bounds) return;
  m_work.parts.resize(m_work.pieces.size());
  size_t next = m_first_bound;
  for (const ActiveSet::Place& of : m_set.bounded()) {
    AxisLaw::Parts& parts = m_work.parts[of.r];
    double impulse = 0;
    for (int i = 0; i < of.row->law.parts(); ++i)
      impulse += parts[size_t(i)] = from[next++].impulse;
    m_work.y[of.at] = impulse * of.row->root_K;
    m_work.pieces[of.r].impulse = impulse;
  }
}

double BlockSolver::sweepRows(std::vector<Vector6d>& velocities) {
  double largest = 0;
  for (const ActiveSet::Place& of : *m_swept) {
    const IslandRow& row = *of.row;
    const IslandJoint& joint = m_island.joints[size_t(m_of.component->first_joint + of.joint)];
    const auto v = [&](int side) -> const Vector6d& {
      return m_island.velocity(joint.body[size_t(side)], velocities.data());
    };
    double& y = m_work.y[of.at];
    const double lambda = y * row.by_root_K, free = row.J.along(v(0), v(1)) - row.K * lambda,
                 next = row.law.meet(free, row.K).impulseAt(free, row.K), change = next - lambda;
    if (change == 0) continue;
    y = next * row.root_K;
    m_work.pieces[of.r].impulse = next;
    for (int side = 0; side < 2; ++side) {
      const int body = joint.body[size_t(side)];
      if (body < 0) continue;
      const InverseInertia& by = m_of.K->bodies()[size_t(body - m_of.component->first_body)];
      velocities[size_t(body)] += change * by.answer(row.J.L(side), row.J.A(side));
    }
    largest = std::fmax(largest, std::abs(row.K * change));
  }
  return largest;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

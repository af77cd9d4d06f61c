#include <pintle/solver/model/row_velocities.h>
#include <pintle/solver/model/stops.h>
#include <pintle/solver/solve/block_solver.h>
#include <pintle/solver/system/active_set.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

double sumOf(const AxisLaw::Parts& parts) {
  return std::accumulate(parts.begin(), parts.end(), 0.);
}

}  // namespace

void BlockSolver::measure(const std::vector<Vector6d>& velocities) {
  measureAtStart(m_island, *m_of.component, own(velocities), m_work.u);
}

void BlockSolver::factorise() {
  ++m_factors;
  m_solvable = m_has_factor = factoriseRows(m_island, *m_of.component, m_options, m_work, *m_of.K);
  aimRows(m_island, *m_of.component, *m_of.K, m_work);
}

template <class Are>
void BlockSolver::addLimitsThat(const Are& are, std::vector<ContactRow>& to) {
  std::vector<ActiveSet::Place>& limits = m_work.limits;
  limits.erase(std::remove_if(limits.begin(), limits.end(),
                              [&](const ActiveSet::Place& of) {
                                if (!are(of)) return false;
                                goOnAsContact(of, to);
                                return true;
                              }),
               limits.end());
}

void BlockSolver::begin(Sweep sweep, std::vector<Vector6d>& velocities,
                        std::vector<ContactRow>& bounds) {
  m_work.limits.clear();
  m_work.pressing.clear();
  m_work.held.clear();
  m_work.as_contacts.clear();
  if (sweep == Sweep::one_by_one) {
    std::fill(m_work.y.begin(), m_work.y.end(), 0.);
    m_swept = &m_set.all();
    m_set.release(*m_swept);
    return;
  }
  respond(m_work.y, velocities);
  measure(velocities);
  changeImpulses(velocities, [&] {
    m_set.choose(m_set.bounded());
    m_set.takeLimits();
    takePressing();
    for (const ActiveSet::Place& of : m_set.bounded()) goOnAsContact(of, bounds);
    m_set.release(m_set.bounded());
    for (const ActiveSet::Place& of : m_work.limits)
      m_work.y[of.at] = sumOf(partsOf(of)) * of.row->root_K;
    m_set.release(m_work.limits);
    addLimitsThat([&](const ActiveSet::Place& of) { return m_work.y[of.at] != 0; }, bounds);
  });
  factorise();
}

void BlockSolver::takePressing() {
  const auto presses = [&](const ActiveSet::Place& of) {
    const LawPiece& piece = m_work.pieces[of.r];
    return piece.acts && !(rebounds(of.row->law, piece.target) &&
                           std::abs(piece.target) * m_island.dt > m_options.newton_tolerance);
  };
  m_work.pressing.clear();
  takeIf(presses, m_work.limits, m_work.pressing);
}

bool BlockSolver::pulls(const ActiveSet::Place& of) const {
  const double y = m_work.y[of.at];
  const LawPart* const stop = pressedStop(of.row->law, y);
  return (stop == nullptr || stop->target != m_work.pieces[of.r].target) &&
         std::abs(y) * of.row->root_K * m_island.dt > m_options.newton_tolerance;
}

bool BlockSolver::releaseLimits(std::vector<ContactRow>& to, std::vector<Vector6d>& velocities) {
  std::vector<ActiveSet::Place>& those = m_work.held;  // none is, before the end
  those.clear();
  takeIf([&](const ActiveSet::Place& of) { return pulls(of); }, m_work.pressing, those);
  if (those.empty()) return false;
  changeImpulses(velocities, [&] {
    for (const ActiveSet::Place& of : those) {
      m_work.y[of.at] = 0;
      goOnAsContact(of, to);
    }
    m_set.release(those);
  });
  factorise();
  return true;
}

void BlockSolver::addTo(DualFunction& of) const {
  for (size_t r = 0; r < m_work.scales.size(); ++r) {
    if (!m_work.pieces[r].acts) continue;
    const size_t at = m_work.scales[r].at;
    of.add(m_work.y[at], m_work.aim[at], m_work.softness[r]);
  }
}

void BlockSolver::scaleImpulses(double fraction) {
  for (double& y : m_work.y) y *= fraction;
}

// Bodies answer to what `change` does to the impulses.
template <class Change>
void BlockSolver::changeImpulses(std::vector<Vector6d>& velocities, const Change& change) {
  std::vector<double>&x = m_work.x, &y = m_work.y;
  x = y;
  change();
  if (x == y) return;
  for (size_t k = 0; k < y.size(); ++k) x[k] = y[k] - x[k];
  respond(x, velocities);
}

// What the parts of its law have of its impulse.
AxisLaw::Parts BlockSolver::partsOf(const ActiveSet::Place& of) const {
  const double impulse = m_work.y[of.at] * of.row->by_root_K;
  return of.row->law.split(m_work.pieces[of.r].velocityAt(m_work.u[of.r], impulse), impulse);
}

double BlockSolver::sweep(std::vector<Vector6d>& velocities) {
  const double change = m_swept != nullptr ? sweepRows(velocities) : 0;
  if (!m_has_factor) return change;
  return std::fmax(change, solveOnce(velocities, m_options.newton_tolerance) / m_island.dt);
}

// A set of active rows is the right one where it leads to velocities at which just these are active: so each one is solved for. All
// rows that come to another piece of their laws take a step there at once, while these steps become fewer, or else that one whose impulse
// changes most, while as many factors are left as there are steps to be taken. Each takes one: so it has a budget. Returns whether a set is found.
bool BlockSolver::findWhichAct(const std::vector<ActiveSet::Place>& rows,
                               std::vector<Vector6d>& velocities) {
  m_set.measure(rows, own(velocities));
  bool any = false;
  changeImpulses(velocities, [&] { any = m_set.choose(rows); });
  if (any) factorise();
  if (!m_has_factor) return false;
  // The tolerance that passes leave would make bodies at rest quiver. (Among contacts they leave more.)
  solveOnce(velocities, m_is_alone ? 0 : m_options.newton_tolerance);
  int fewest = std::numeric_limits<int>::max();
  for (int left = m_options.max_factors / 2;; --left) {
    m_set.measure(rows, own(velocities));
    const int changes = m_set.countSteps(rows);
    if (changes == 0) return true;
    const bool all = changes < fewest;
    if (left <= 0 || (!all && changes > left)) return false;
    fewest = std::min(fewest, changes);
    changeImpulses(velocities, [&] { all ? m_set.changeAll(rows) : m_set.changeMost(rows); });
    factorise();
    if (!m_has_factor) return false;
    solveOnce(velocities, 0);
  }
}

// Returns what was left before, m or rad.
double BlockSolver::solveOnce(std::vector<Vector6d>& velocities, double tolerance) {
  std::vector<double>&x = m_work.x, &y = m_work.y;
  const double error = findResidual(m_island.dt, *m_of.K, own(velocities), m_work);
  if (error <= tolerance) return error;
  m_of.K->solve(x.data());
  respond(x, velocities);
  for (size_t k = 0; k < y.size(); ++k) y[k] += x[k];
  return error;
}

bool BlockSolver::finish(std::vector<Vector6d>& velocities, const std::vector<ContactRow>& bounds,
                         bool is_alone) {
  m_is_alone = is_alone;
  takeBounds(bounds);
  const int factors = m_factors;
  bool is_found = false;
  if (m_has_factor) {
    const std::vector<Workspace::AsContact>& all = m_work.as_contacts;
    const bool are_limits = std::all_of(all.begin(), all.end(), [](const Workspace::AsContact& as) {
      return isLimit(as.of.row->law);
    });
    m_is_met = m_is_alone && !are_limits && hold(false, velocities);
    is_found = m_is_met || hold(true, velocities);
    m_is_met = m_is_met || (is_found && m_is_alone && are_limits);
  }
  m_solvable = m_has_factor || m_swept != nullptr;  // rows one by one would be met less still
  const auto first = velocities.begin() + m_of.component->first_body;
  m_work.v.assign(first, first + m_of.component->bodies);
  measure(velocities);
  if (is_found) splitHeld();
  if (m_swept != nullptr)  // whatever their impulses have come to, poses close them
    for (const ActiveSet::Place& of : *m_swept)
      if (of.row->law.isEquality()) m_work.pieces[of.r] = of.row->law.meet(0, of.row->K);
  unscaleImpulses(m_work);
  return m_has_factor && m_factors > factors;
}

// Returns whether rows that act are met: a factor that rounding has spoilt leads elsewhere.
bool BlockSolver::solveToTheEnd(std::vector<Vector6d>& velocities) {
  if (!m_has_factor) return false;
  for (double last = infinity;;) {
    const double error = solveOnce(velocities, m_options.newton_tolerance);
    if (error <= m_options.newton_tolerance) return true;
    if (!(error < last / 2)) break;
    last = error;
  }
  return findResidual(m_island.dt, *m_of.K, own(velocities), m_work) <=
         std::fmax(m_options.contact_tolerance, m_options.newton_tolerance);
}

// Rows of the passes that press are rows of the factor in the end, so that they hold as joints do: all, or limits alone. Which of them do so
// is found while the others stay as they are. Where that is not found they go back to what passes have found of them. Returns whether these and
// equalities are met.
bool BlockSolver::hold(bool limits_alone, std::vector<Vector6d>& velocities) {
  std::vector<ActiveSet::Place>& rows = m_work.held;
  rows = m_work.limits;
  rows.insert(rows.end(), m_work.pressing.begin(), m_work.pressing.end());
  for (const Workspace::AsContact& as : m_work.as_contacts)
    if (!limits_alone || isLimit(as.of.row->law)) rows.push_back(as.of);
  if ((rows.empty() || findWhichAct(rows, velocities)) && solveToTheEnd(velocities)) return true;
  if (rows.empty()) return false;
  changeImpulses(velocities, [&] {
    for (const ActiveSet::Place& of : rows)
      m_work.y[of.at] = sumOf(m_work.parts[of.r]) * of.row->root_K;
    m_set.release(rows);
  });
  factorise();
  solveToTheEnd(velocities);
  return false;
}

void BlockSolver::goOnAsContact(const ActiveSet::Place& of, std::vector<ContactRow>& to) {
  const IslandRow& row = *of.row;
  const AxisLaw::Parts parts = partsOf(of);
  m_work.y[of.at] = sumOf(parts) * row.root_K;
  m_work.as_contacts.push_back({of, to.size()});
  const IslandJoint& joint = m_island.joints[size_t(m_of.component->first_joint + of.joint)];
  const double moved = m_island.velocityOfUnmoved(joint, row.J);
  ContactRow bound;
  bound.is_limit = isLimit(row.law);
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

bool BlockSolver::isReached(const ActiveSet::Place& of) const {
  const LawPiece piece = of.row->law.meet(m_work.u[of.r], of.row->K);
  return piece.acts || piece.impulse != 0;
}

bool BlockSolver::addLimits(std::vector<ContactRow>& to, std::vector<Vector6d>& velocities) {
  const size_t before = m_work.as_contacts.size();
  m_set.measure(m_work.limits, own(velocities));
  addLimitsThat([this](const ActiveSet::Place& of) { return isReached(of); }, to);
  return m_work.as_contacts.size() != before;
}

// What passes have found of the parts of their laws.
void BlockSolver::takeBounds(const std::vector<ContactRow>& from) {
  if (m_work.as_contacts.empty() && m_work.limits.empty() && m_work.pressing.empty()) return;
  m_work.parts.assign(m_work.pieces.size(), {});
  for (const ActiveSet::Place& of : m_work.pressing)
    if (!pulls(of)) m_work.parts[of.r] = partsOf(of);
  for (const Workspace::AsContact& as : m_work.as_contacts) {
    AxisLaw::Parts& parts = m_work.parts[as.of.r];
    for (int i = 0; i < as.of.row->law.parts(); ++i)
      parts[size_t(i)] = from[as.first + size_t(i)].impulse;
    const double impulse = sumOf(parts);
    m_work.y[as.of.at] = impulse * as.of.row->root_K;
    m_work.pieces[as.of.r].impulse = impulse;
  }
}

void BlockSolver::splitHeld() {
  if (m_work.parts.empty()) return;
  for (const ActiveSet::Place& of : m_work.held) m_work.parts[of.r] = partsOf(of);
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

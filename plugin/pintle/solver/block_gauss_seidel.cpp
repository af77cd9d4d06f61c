#include <pintle/solver/block_gauss_seidel.h>

#include <pintle/solver/active_set.h>
#include <pintle/solver/load_stiffness.h>
#include <pintle/solver/row_velocities.h>

#include <cmath>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// Bodies that swing faster than a step resolves resist it (load_stiffness.h): (M + S) v = M v*. That takes energy, too.
void addStiffness(const Island& island, const JointBlock& of, std::vector<Vector6d>& velocities) {
  stiffen(island, *of.component, *of.work, *of.K);
  for (int i = 0; i < of.component->bodies; ++i) {
    Vector6d& v = velocities[size_t(of.component->first_body + i)];
    v.tail<3>() -=
        of.K->bodies()[size_t(i)].angular * (of.work->stiffness[size_t(i)] * v.tail<3>());
  }
}

/// The joints of a component.
class BlockSolver {
 public:
  BlockSolver(const Island& island, const JointBlock& of, const SolverOptions& options)
      : m_island(island),
        m_of(of),
        m_options(options),
        m_work(*of.work),
        m_set(island, *of.component, options, *of.K, *of.work) {}

  /// `velocities`: of all bodies of the island, without impulses of joints, and then with those that it begins with.
  void begin(Sweep sweep, std::vector<Vector6d>& velocities);
  /// One pass over its rows. Returns the largest change of those that are solved one by one, m/s or rad/s.
  double sweep(std::vector<Vector6d>& velocities);
  /// To the last digits: those that are solved at once.
  void finish(std::vector<Vector6d>& velocities);
  /// Whether rows are solved one by one.
  bool isSwept() const { return m_swept != nullptr; }
  /// Whether there is a factor where one is needed.
  bool isSolvable() const { return m_solvable; }
  int factors() const { return m_set.factors(); }
  /// Whether the last pass did.
  bool changesSet() const { return m_changes; }
  /// Of conjugate gradients: its impulses before a pass, and by so much of the last direction on.
  void beginPass() { m_work.y_before_pass = m_work.y; }
  void goOn(double part) {
    std::vector<double>&y = m_work.y, &direction = m_work.y_direction;
    for (size_t k = 0; k < y.size(); ++k) {
      const double last = part * direction[k];
      direction[k] = y[k] - m_work.y_before_pass[k] + last;
      y[k] += last;
    }
  }

 private:
  struct Pass {
    double error;      ///< m or rad, before it
    bool changes_set;  ///< of rows that act
  };
  Pass solve(std::vector<Vector6d>& velocities);
  double sweepRows(std::vector<Vector6d>& velocities);
  void respond(const std::vector<double>& y, std::vector<Vector6d>& velocities) const {
    m_of.K->addResponse(y.data(), velocities.data() + m_of.component->first_body);
  }
  void measure(const std::vector<Vector6d>& velocities) {
    measureAtStart(m_island, *m_of.component, velocities.data() + m_of.component->first_body,
                   m_work.u);
  }

  const Island& m_island;
  const JointBlock& m_of;
  const SolverOptions& m_options;
  Workspace& m_work;
  ActiveSet m_set;
  const std::vector<ActiveSet::Place>* m_swept = nullptr;  ///< rows that are solved one by one
  bool m_has_factor = false, m_solvable = true, m_changes = false;
};

void BlockSolver::begin(Sweep sweep, std::vector<Vector6d>& velocities) {
  m_work.y_direction.assign(m_work.y.size(), 0.);
  measure(velocities);
  m_set.choose();
  if (sweep != Sweep::all_at_once) {
    std::fill(m_work.y.begin(), m_work.y.end(), 0.);
    m_swept = sweep == Sweep::one_by_one ? &m_set.all() : &m_set.bounded();
    m_set.release(*m_swept);
  }
  if (sweep == Sweep::one_by_one) {
    m_set.setRows();
    return;
  }
  m_solvable = m_has_factor = m_set.factorise(m_options.max_set_factors);
  respond(m_work.y, velocities);
}

double BlockSolver::sweep(std::vector<Vector6d>& velocities) {
  const double change = m_swept != nullptr ? sweepRows(velocities) : 0;
  m_changes = m_has_factor && solve(velocities).changes_set;
  return change;
}

// All rows at once, with one factor.
BlockSolver::Pass BlockSolver::solve(std::vector<Vector6d>& velocities) {
  std::vector<double>&x = m_work.x, &y = m_work.y;
  measure(velocities);
  bool changes = false;
  if (m_swept == nullptr && !m_set.bounded().empty()) {
    m_work.y_before_choice = y;
    changes = m_set.chooseAgain();
    if (changes) m_solvable = m_has_factor = m_set.factorise(m_options.max_set_factors);
    if (y != m_work.y_before_choice) {  // those that came to a bound
      for (size_t k = 0; k < y.size(); ++k) x[k] = y[k] - m_work.y_before_choice[k];
      respond(x, velocities);
      measure(velocities);
    }
  }
  std::fill(x.begin(), x.end(), 0.);  // of bodies that are unknowns, too
  const double error = m_set.findResidual();
  if (error <= m_options.newton_tolerance || !m_has_factor) return {error, changes};
  m_of.K->solve(x.data());
  respond(x, velocities);
  for (size_t k = 0; k < y.size(); ++k) y[k] += x[k];
  return {error, changes};
}

void BlockSolver::finish(std::vector<Vector6d>& velocities) {
  for (double last = infinity; m_has_factor;) {
    const Pass pass = solve(velocities);
    if (!pass.changes_set && !(pass.error > m_options.newton_tolerance && pass.error < last / 2))
      break;
    last = pass.changes_set ? infinity : pass.error;
  }
  const auto first = velocities.begin() + m_of.component->first_body;
  m_work.v.assign(first, first + m_of.component->bodies);
  measure(velocities);
  m_set.keepImpulses();
}

double BlockSolver::sweepRows(std::vector<Vector6d>& velocities) {
  double largest = 0;
  for (const ActiveSet::Place& of : *m_swept) {
    const IslandRow& row = *of.row;
    const IslandJoint& joint = m_island.joints[size_t(m_of.component->first_joint + of.joint)];
    const auto v = [&](int side) -> const Vector6d& {
      const int body = joint.body[size_t(side)];
      return body < 0 ? m_island.unmovedBody(body).v : velocities[size_t(body)];
    };
    double& y = m_work.y[of.at];
    const double lambda = y / row.root_K, free = row.J.along(v(0), v(1)) - row.K * lambda,
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

// What impulses of contacts do.
void findAnswers(const Island& island, const std::vector<JointBlock>& of,
                 std::vector<ContactRow>& contacts) {
  std::vector<const InverseInertia*> inertia(island.bodies.size(), nullptr);
  for (const JointBlock& part : of)
    for (int i = 0; i < part.component->bodies; ++i)
      inertia[size_t(part.component->first_body + i)] = &part.K->bodies()[size_t(i)];
  for (ContactRow& row : contacts) {
    row.K = 0;
    for (int side = 0; side < 2; ++side) {
      const int body = row.body[size_t(side)];
      if (body < 0) continue;
      const InverseInertia* const by = inertia[size_t(body)];  // null: it has no joints
      Vector6d& answer = row.answer[size_t(side)];
      answer = by != nullptr ? by->answer(row.J.L(side), row.J.A(side))
                             : island.bodies[size_t(body)].answer(row.J.L(side), row.J.A(side));
      row.K += row.J.L(side).dot(answer.head<3>()) + row.J.A(side).dot(answer.tail<3>());
    }
  }
}

// One pass. Returns the largest change, m/s.
double sweepContacts(std::vector<ContactRow>& contacts, std::vector<Vector6d>& velocities) {
  double largest = 0;
  for (ContactRow& row : contacts) {
    if (!(row.K > 0)) continue;
    boundFriction(contacts, row);
    const double next = row.meet(row.velocity(velocities)), change = next - row.impulse;
    if (change == 0) continue;
    row.impulse = next;
    row.push(change, velocities);
    largest = std::fmax(largest, std::abs(row.K * change));
  }
  return largest;
}

// What a pass has changed leads on: nonsmooth nonlinear conjugate gradients (Silcowitz, Niebe and Erleben 2010). Joints hold along
// any sum of such changes.
class Gradients {
 public:
  Gradients(std::vector<ContactRow>& contacts, std::vector<Vector6d>& velocities)
      : m_velocities(velocities), m_direction(velocities.size(), Vector6d::Zero()) {
    for (ContactRow& row : contacts) row.direction = 0;
  }

  void beginPass(const std::vector<ContactRow>& contacts, std::vector<BlockSolver>& blocks) {
    m_start = m_velocities;
    m_impulses.clear();
    for (const ContactRow& row : contacts) m_impulses.push_back(row.impulse);
    for (BlockSolver& block : blocks) block.beginPass();
  }
  /// Goes on by as much of the last direction as makes the new one conjugate to it; of `anew`, by none.
  void goOn(std::vector<ContactRow>& contacts, std::vector<BlockSolver>& blocks, bool anew) {
    double length2 = 0;
    for (size_t r = 0; r < contacts.size(); ++r) {
      const double change = contacts[r].impulse - m_impulses[r];
      length2 += contacts[r].K * change * change;
    }
    const double part = anew || !(length2 < m_length2) ? 0 : length2 / m_length2;
    m_length2 = length2;
    for (size_t i = 0; i < m_velocities.size(); ++i) {
      const Vector6d last = part * m_direction[i];
      m_direction[i] = m_velocities[i] - m_start[i] + last;
      m_velocities[i] += last;
    }
    for (size_t r = 0; r < contacts.size(); ++r) {
      ContactRow& row = contacts[r];
      const double last = part * row.direction;
      row.direction = row.impulse - m_impulses[r] + last;
      row.impulse += last;
    }
    for (BlockSolver& block : blocks) block.goOn(part);
  }

 private:
  std::vector<Vector6d>& m_velocities;
  std::vector<Vector6d> m_start, m_direction;
  std::vector<double> m_impulses;
  double m_length2 = 0;
};

}  // namespace

SolveReport solveInVelocity(const Island& island, std::vector<JointBlock>& of,
                            std::vector<ContactRow>& contacts, const SolverOptions& options,
                            Sweep sweep, int most, std::vector<Vector6d>& velocities) {
  SolveReport report;
  velocities.clear();
  for (const IslandBody& body : island.bodies) velocities.push_back(body.v_free);
  for (const JointBlock& part : of) addStiffness(island, part, velocities);
  findAnswers(island, of, contacts);
  for (ContactRow& row : contacts)
    if (sweep == Sweep::all_at_once)
      row.push(row.impulse, velocities);
    else
      row.impulse = 0;
  std::vector<BlockSolver> blocks;
  blocks.reserve(of.size());
  bool is_swept = !contacts.empty(), is_solvable = true;
  for (const JointBlock& part : of) {
    blocks.emplace_back(island, part, options);
    blocks.back().begin(sweep, velocities);
  }
  Gradients gradients(contacts, velocities);
  for (bool go_on = true; go_on;) {
    gradients.beginPass(contacts, blocks);
    double largest = sweepContacts(contacts, velocities);
    bool changes_set = false;
    for (BlockSolver& block : blocks) {
      largest = std::fmax(largest, block.sweep(velocities));
      changes_set = changes_set || block.changesSet();
      is_swept = is_swept || block.isSwept();
      is_solvable = is_solvable && block.isSolvable();
    }
    ++report.steps;
    report.error = largest * island.dt;
    // What contacts see in the first pass is not yet what joints do.
    report.converged = !is_swept || (report.steps > 1 && report.error <= options.contact_tolerance);
    go_on = is_swept && is_solvable && !report.converged && report.steps < most;
    // They may gain: where that is to be mended, each pass takes energy.
    if (go_on && sweep == Sweep::all_at_once) gradients.goOn(contacts, blocks, changes_set);
  }
  for (BlockSolver& block : blocks) {
    block.finish(velocities);
    report.factors += block.factors();
    report.is_solvable = report.is_solvable && block.isSolvable();
  }
  return report;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

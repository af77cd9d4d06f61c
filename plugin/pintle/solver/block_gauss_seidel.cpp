#include <pintle/solver/block_gauss_seidel.h>

#include <pintle/solver/load_stiffness.h>

#include <cmath>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// Bodies that swing faster than a step resolves resist it (load_stiffness.h): (M + S) v = M v*. That takes energy, too.
void addStiffness(const Island& island, const BlockOfJoints& of,
                  std::vector<Vector6d>& velocities) {
  stiffen(island, *of.component, *of.work, *of.K);
  for (int i = 0; i < of.component->bodies; ++i) {
    Vector6d& v = velocities[size_t(of.component->first_body + i)];
    v.tail<3>() -=
        of.K->bodies()[size_t(i)].angular * (of.work->stiffness[size_t(i)] * v.tail<3>());
  }
}

// A row that moves its bodies by less of its own is held by joints, but for rounding.
constexpr double least_part_free = 1e-9;

// Where it is known what an impulse does to each body.
void findSources(const std::vector<BlockOfJoints>& of, Span<const int> bodies,
                 std::vector<PassMemory::Source>& source) {
  for (const int i : bodies) source[size_t(i)] = {nullptr, nullptr};
  for (const BlockOfJoints& part : of)
    for (int i = 0; i < part.component->bodies; ++i)
      source[size_t(part.component->first_body + i)] = {&part.K->bodies()[size_t(i)], nullptr};
}

// What an impulse does to a body without its joints.
Vector6d answerAlone(const Island& island, const std::vector<PassMemory::Source>& source, int body,
                     const Vector3d& along, const Vector3d& about) {
  const InverseInertia* const by = source[size_t(body)].alone;
  return by != nullptr ? by->answer(along, about)
                       : island.bodies[size_t(body)].answer(along, about);
}

// What impulses of contacts do to bodies without joints.
void findAnswersAlone(const Island& island, const std::vector<PassMemory::Source>& source,
                      Span<ContactRow> contacts) {
  for (ContactRow& row : contacts) {
    row.K_alone = 0;
    for (int side = 0; side < 2; ++side) {
      const int body = row.body[size_t(side)];
      if (body < 0) continue;
      Vector6d& answer = row.answer[size_t(side)];
      answer = answerAlone(island, source, body, row.J.L(side), row.J.A(side));
      row.K_alone += row.J.along(side, answer);
    }
    row.K = row.K_alone;
  }
}

// The same where the joints of their components hold.
void findAnswersWithJoints(const std::vector<PassMemory::Source>& source,
                           Span<ContactRow> contacts) {
  for (ContactRow& row : contacts) {
    row.K = 0;
    for (int side = 0; side < 2; ++side) {
      const int body = row.body[size_t(side)];
      if (body < 0) continue;
      Vector6d& answer = row.answer[size_t(side)];
      if (const JointMatrix::Matrix6d* const by = source[size_t(body)].with_joints)
        answer = by->leftCols<3>() * row.J.L(side) + by->rightCols<3>() * row.J.A(side);
      row.K += row.J.along(side, answer);
    }
    if (!(row.K > least_part_free * row.K_alone)) row.K = 0;
  }
}

// What a sweep over contacts changes.
struct Changes {
  std::vector<Vector6d>* impulses = nullptr;  ///< of each body, N s and N m s; null: nobody asks
  double largest = 0;                         ///< m/s
  /// The dual function (block_gauss_seidel.h) along it, but for the velocities.
  double slope = 0, bend = 0;
};

void sweepContacts(Span<ContactRow> contacts, std::vector<Vector6d>& velocities, Changes& done) {
  for (ContactRow& row : contacts) {
    row.before = row.impulse;
    if (!(row.K > 0)) continue;
    boundFriction(contacts, row);
    const double next = row.meet(row.velocity(velocities)), by = next - row.impulse;
    if (by == 0) continue;
    row.impulse = next;
    row.push(by, velocities);
    if (done.impulses != nullptr) row.load(by, *done.impulses);
    done.largest = std::fmax(done.largest, std::abs(row.K * by));
    done.slope += by * (row.softness * row.before - row.target);
    done.bend += by * row.softness * by;
  }
}

class Passes {
 public:
  Passes(const Island& island, std::vector<BlockOfJoints>& of, Span<const int> bodies,
         Span<ContactRow> contacts, const SolverOptions& options, Sweep sweep,
         std::vector<Vector6d>& velocities, PassMemory& memory)
      : m_island(island),
        m_of(of),
        m_bodies(bodies),
        m_contacts(contacts),
        m_velocities(velocities),
        m_sweep(sweep),
        m_memory(memory) {
    memory.prepare(island.bodies.size());
    for (const int i : bodies) velocities[size_t(i)] = island.bodies[size_t(i)].v_free;
    for (const BlockOfJoints& part : of) addStiffness(island, part, velocities);
    if (sweep != Sweep::all_at_once)
      for (ContactRow& row : contacts) row.impulse = 0;
    memory.bounds.clear();
    findSources(of, bodies, memory.sources);
    findAnswersAlone(island, memory.sources, contacts);
    for (ContactRow& row : contacts) row.push(row.impulse, velocities);
    blocks().clear();
    blocks().reserve(of.size());
    for (const BlockOfJoints& part : of) {
      blocks().emplace_back(island, part, options, contacts.empty());
      blocks().back().begin(sweep, velocities);
    }
    if (sweep != Sweep::all_at_once || contacts.empty() || !isSolvable()) return;
    for (BlockSolver& block : blocks()) block.settle(velocities);
    for (const int i : bodies) memory.touched[size_t(i)] = false;
    touch(contacts, memory.touched);
    for (size_t i = 0; i < of.size(); ++i)
      if (!blocks()[i].isUnsettled()) findAnswersOf(of[i]);
    settle();
  }
  bool isSolvable() const {
    for (const BlockSolver& block : blocks())
      if (!block.isSolvable()) return false;
    return true;
  }
  bool isSwept() const {
    for (const BlockSolver& block : blocks())
      if (block.isSwept()) return true;
    return !m_contacts.empty();
  }
  bool changesSet() const {
    for (const BlockSolver& block : blocks())
      if (block.changesSet()) return true;
    return false;
  }
  double pass() {
    if (m_sweep == Sweep::all_at_once && !m_contacts.empty()) return passAtOnce();
    Changes done;
    sweepContacts(m_contacts, m_velocities, done);
    return std::fmax(done.largest, sweepBlocks());
  }
  void finish() {
    for (BlockSolver& block : blocks()) block.finish(m_velocities, m_memory.bounds);
  }

 private:
  std::vector<BlockSolver>& blocks() { return m_memory.blocks; }
  const std::vector<BlockSolver>& blocks() const { return m_memory.blocks; }
  double sweepBlocks() {
    double largest = 0;
    for (BlockSolver& block : blocks()) largest = std::fmax(largest, block.sweep(m_velocities));
    return largest;
  }
  bool isUnsettled() const {
    for (const BlockSolver& block : blocks())
      if (block.isUnsettled()) return true;
    return false;
  }
  // Where contacts keep changing which rows act, those with bounds go on as contacts do.
  void settle() {
    for (size_t i = 0; i < blocks().size(); ++i) {
      if (!blocks()[i].isUnsettled()) continue;
      blocks()[i].addBounds(m_memory.bounds, m_velocities);
      blocks()[i].sweep(m_velocities);
      touch(m_memory.bounds, m_memory.touched);
      findAnswersOf(m_of[i]);
    }
    findAnswersAlone(m_island, m_memory.sources, m_memory.bounds);
    for (const Span<ContactRow>& rows : {m_contacts, Span<ContactRow>(m_memory.bounds)})
      findAnswersWithJoints(m_memory.sources, rows);
  }
  void findAnswersOf(BlockOfJoints& part) {
    const auto first = m_memory.touched.begin() + part.component->first_body;
    part.work->touched.assign(first, first + part.component->bodies);
    part.K->findAnswers(part.work->touched, part.work->answers);
    for (int i = 0; i < part.component->bodies; ++i)
      m_memory.sources[size_t(part.component->first_body + i)].with_joints =
          &part.work->answers[size_t(i)];
  }
  template <class Visit>
  void forEachRow(const Visit& visit) {
    for (ContactRow& row : m_contacts) visit(row);
    for (ContactRow& row : m_memory.bounds) visit(row);
  }
  double passAtOnce();

  const Island& m_island;
  std::vector<BlockOfJoints>& m_of;
  const Span<const int> m_bodies;
  const Span<ContactRow> m_contacts;
  std::vector<Vector6d>& m_velocities;
  const Sweep m_sweep;
  PassMemory& m_memory;
};

// Contacts see what joints do to their own bodies. What they do to others is found after them, by the joints: from what contacts have
// changed, by one A^-1 for each body, and not for each row.
double Passes::passAtOnce() {
  std::vector<Vector6d>&start = m_memory.start, &impulses = m_memory.changes;
  for (const int i : m_bodies) {
    start[size_t(i)] = m_velocities[size_t(i)];
    impulses[size_t(i)].setZero();
  }
  for (BlockSolver& block : blocks()) block.beginPass();
  Changes done = {&impulses};
  sweepContacts(m_contacts, m_velocities, done);
  sweepContacts(m_memory.bounds, m_velocities, done);
  for (const int body : m_bodies) {
    const auto i = size_t(body);
    if (!m_memory.touched[i]) continue;
    m_velocities[i] = start[i] + answerAlone(m_island, m_memory.sources, body,
                                             impulses[i].head<3>(), impulses[i].tail<3>());
  }
  sweepBlocks();
  if (isUnsettled()) {
    for (const int i : m_bodies) m_velocities[size_t(i)] = start[size_t(i)];
    forEachRow([](ContactRow& row) { row.impulse = row.before; });
    for (BlockSolver& block : blocks()) block.goBack(0);
    settle();
    return passAtOnce();
  }
  for (const int body : m_bodies) {
    const auto i = size_t(body);
    if (!m_memory.touched[i]) continue;
    done.slope += impulses[i].dot(start[i]);
    done.bend += impulses[i].dot(m_velocities[i] - start[i]);
  }
  if (!(done.slope < 0) || !(done.bend > -done.slope)) return done.largest;
  const double part = -done.slope / done.bend;
  for (const int body : m_bodies) {
    const auto i = size_t(body);
    m_velocities[i] = start[i] + part * (m_velocities[i] - start[i]);
  }
  forEachRow(
      [&](ContactRow& row) { row.impulse = row.before + part * (row.impulse - row.before); });
  for (BlockSolver& block : blocks()) block.goBack(part);
  return part * done.largest;
}

}  // namespace

bool stopRebounds(Island& island, const Component& component) {
  bool any = false;
  for (int c = component.first_joint; c < component.first_joint + component.joints; ++c) {
    const IslandJoint& joint = island.joints[size_t(c)];
    for (int i = 0; i < joint.rows; ++i)
      any = island.rows[size_t(joint.first_row + i)].law.stopRebound() || any;
  }
  return any;
}

SolveReport solveInVelocity(const Island& island, std::vector<BlockOfJoints>& of,
                            Span<const int> bodies, Span<ContactRow> contacts,
                            const SolverOptions& options, Sweep sweep, int most,
                            std::vector<Vector6d>& velocities, PassMemory& memory) {
  SolveReport report;
  Passes passes(island, of, bodies, contacts, options, sweep, velocities, memory);
  report.is_solvable = passes.isSolvable();
  for (bool go_on = report.is_solvable; go_on;) {
    report.error = passes.pass() * island.dt;
    ++report.steps;
    report.converged =
        !passes.isSwept() || (!passes.changesSet() && report.error <= options.contact_tolerance);
    report.is_solvable = report.is_solvable && passes.isSolvable();
    go_on = passes.isSwept() && report.is_solvable && !report.converged && report.steps < most;
  }
  passes.finish();
  report.is_solvable = report.is_solvable && passes.isSolvable();
  return report;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

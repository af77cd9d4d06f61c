#include <pintle/solver/block_gauss_seidel.h>

#include <pintle/solver/active_set.h>
#include <pintle/solver/load_stiffness.h>
#include <pintle/solver/row_velocities.h>

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

}  // namespace

/// The joints of a component.
class BlockSolver {
 public:
  /// `alone`: no contacts change what its impulses lead to.
  BlockSolver(const Island& island, const BlockOfJoints& of, const SolverOptions& options,
              bool alone)
      : m_alone(alone),
        m_island(island),
        m_of(of),
        m_options(options),
        m_work(*of.work),
        m_set(island, *of.component, options, *of.K, *of.work) {}

  /// `velocities`: of all bodies of the island, without impulses of joints, and then with those that it begins with.
  void begin(Sweep sweep, std::vector<Vector6d>& velocities);
  /// One pass over its rows. Returns the largest change of one, m/s or rad/s.
  double sweep(std::vector<Vector6d>& velocities);
  /// To the last digits: those that are solved at once. `bounds`: where those are that are solved as contacts are.
  void finish(std::vector<Vector6d>& velocities, std::vector<ContactRow>& bounds);
  /// Whether rows are solved one by one.
  bool isSwept() const { return m_swept != nullptr; }
  /// Its rows with bounds go on as contacts do: each part of their laws is added to them.
  void addBounds(std::vector<ContactRow>& to, std::vector<Vector6d>& velocities);
  /// Finds which rows act, while contacts have the impulses with which they begin.
  void settle(std::vector<Vector6d>& velocities) {
    do sweep(velocities);
    while (m_changes && m_solvable && !m_is_unsettled);
  }
  /// Whether contacts change which of its rows act.
  bool isUnsettled() const { return m_is_unsettled; }
  /// Whether there is a factor where one is needed.
  bool isSolvable() const { return m_solvable; }
  int factors() const { return m_set.factors(); }
  /// Whether the last pass did.
  bool changesSet() const { return m_changes; }
  /// Its impulses before a pass, and back to a part of the way from there.
  void beginPass() {
    ++m_passes;
    m_work.y_before_pass = m_work.y;
  }
  void goBack(double part) {
    std::vector<double>& y = m_work.y;
    for (size_t k = 0; k < y.size(); ++k)
      y[k] = m_work.y_before_pass[k] + part * (y[k] - m_work.y_before_pass[k]);
  }

 private:
  void takeBounds(const std::vector<ContactRow>& from);
  struct Pass {
    double error;      ///< m or rad, before it
    bool changes_set;  ///< of rows that act
  };
  Pass solve(std::vector<Vector6d>& velocities);
  double sweepRows(std::vector<Vector6d>& velocities);
  void respond(const std::vector<double>& y, std::vector<Vector6d>& velocities) const {
    m_of.K->addResponse(y.data(), velocities.data() + m_of.component->first_body);
  }
  // One row at a time: each may come to a piece and leave it.
  void factorise() {
    const int each_twice = m_alone ? 2 * int(m_set.bounded().size()) : 0;
    m_solvable = m_has_factor = m_set.factorise(m_options.max_set_factors + each_twice);
  }
  const Vector6d* own(const std::vector<Vector6d>& velocities) const {
    return velocities.data() + m_of.component->first_body;
  }
  void measure(const std::vector<Vector6d>& velocities) {
    measureAtStart(m_island, *m_of.component, own(velocities), m_work.u);
  }

  const bool m_alone;
  const Island& m_island;
  const BlockOfJoints& m_of;
  const SolverOptions& m_options;
  Workspace& m_work;
  ActiveSet m_set;
  const std::vector<ActiveSet::Place>* m_swept = nullptr;  ///< rows that are solved one by one
  bool m_has_factor = false, m_solvable = true, m_changes = false;
  bool m_is_unsettled = false, m_has_bounds = false;
  size_t m_first_bound = 0;  ///< where those of its rows begin
  int m_passes = 0;
};

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

// All rows at once, with one factor.
BlockSolver::Pass BlockSolver::solve(std::vector<Vector6d>& velocities) {
  std::vector<double>&x = m_work.x, &y = m_work.y;
  bool changes = false;
  if (m_swept == nullptr && !m_has_bounds && !m_set.bounded().empty()) {
    m_work.y_before_choice = y;
    m_set.measureBounded(own(velocities));
    m_is_unsettled = !m_alone && (m_passes > 0 || m_set.factors() >= m_options.max_set_factors) &&
                     m_set.wouldChange();
    if (m_is_unsettled) return {infinity, true};
    changes = m_set.chooseAgain(m_alone && m_set.factors() >= m_options.max_set_factors);
    if (y != m_work.y_before_choice) {  // those that came to a bound
      for (size_t k = 0; k < y.size(); ++k) x[k] = y[k] - m_work.y_before_choice[k];
      respond(x, velocities);
    }
    if (changes) factorise();
  }
  const double error = m_set.findResidual(own(velocities));
  if (error <= m_options.newton_tolerance || !m_has_factor) return {error, changes};
  m_of.K->solve(x.data());
  respond(x, velocities);
  for (size_t k = 0; k < y.size(); ++k) y[k] += x[k];
  return {error, changes};
}

void BlockSolver::finish(std::vector<Vector6d>& velocities, std::vector<ContactRow>& bounds) {
  for (double last = infinity; m_has_factor;) {
    const Pass pass = solve(velocities);
    if (m_is_unsettled) addBounds(bounds, velocities);
    if (!pass.changes_set && !(pass.error > m_options.newton_tolerance && pass.error < last / 2))
      break;
    last = pass.changes_set ? infinity : pass.error;
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
  m_is_unsettled = false;
  m_has_bounds = true;
  m_first_bound = to.size();
  for (const ActiveSet::Place& of : m_set.bounded()) {
    const IslandRow& row = *of.row;
    double& y = m_work.y[of.at];
    const double impulse = y * row.by_root_K;
    double parts[AxisLaw::max_parts], sum = 0, moved = 0;
    row.law.split(m_work.pieces[of.r].velocityAt(m_work.u[of.r], impulse), impulse, parts);
    for (int i = 0; i < row.law.parts(); ++i) sum += parts[i];
    m_work.x[of.at] = sum * row.root_K - y;
    y = sum * row.root_K;
    ContactRow bound;
    bound.body = m_island.joints[size_t(m_of.component->first_joint + of.joint)].body;
    bound.J = row.J;
    for (int side = 0; side < 2; ++side)
      if (const int body = bound.body[size_t(side)]; body < 0)
        moved += row.J.along(side, m_island.unmovedBody(body).v);
    for (int i = 0; i < row.law.parts(); ++i) {
      const LawPart& part = row.law.part(i);
      if (!std::isfinite(part.target)) continue;  // a stop that is not there
      bound.target = part.target - moved;
      bound.softness = part.softness > 0 ? part.softness : m_work.of_loop[size_t(of.joint)] * row.K;
      bound.lower = part.lower;
      bound.upper = part.upper;
      bound.impulse = bound.before = parts[i];
      to.push_back(bound);
    }
  }
  respond(m_work.x, velocities);
  m_set.release(m_set.bounded());
  m_solvable = m_has_factor = m_set.factorise(m_options.max_set_factors + 1);
}

void BlockSolver::takeBounds(const std::vector<ContactRow>& from) {
  if (!m_has_bounds) return;
  size_t next = m_first_bound;
  for (const ActiveSet::Place& of : m_set.bounded()) {
    double impulse = 0;
    for (int i = 0; i < of.row->law.parts(); ++i)
      if (std::isfinite(of.row->law.part(i).target)) impulse += from[next++].impulse;
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
      const int body = joint.body[size_t(side)];
      return body < 0 ? m_island.unmovedBody(body).v : velocities[size_t(body)];
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

PassMemory::PassMemory() = default;
PassMemory::~PassMemory() = default;
void PassMemory::reserve(size_t bodies, size_t components, size_t rows) {
  pintle::reserve(bodies, sources, touched, start);
  pintle::reserve(rows, bounds);
  pintle::reserve(components, blocks);
}
size_t PassMemory::bytes() const { return bytesOf(sources, touched, start, bounds, blocks); }

namespace {

// A row that moves its bodies by less of its own is held by joints, but for rounding.
constexpr double least_part_free = 1e-9;

// What impulses of contacts do. `with_joints`: of components whose joints hold.
void findAnswers(const Island& island, const std::vector<BlockOfJoints>& of,
                 std::vector<ContactRow>& contacts, bool with_joints,
                 std::vector<PassMemory::Source>& source) {
  using Source = PassMemory::Source;
  source.assign(island.bodies.size(), {nullptr, nullptr});
  for (const BlockOfJoints& part : of)
    for (int i = 0; i < part.component->bodies; ++i) {
      Source& to = source[size_t(part.component->first_body + i)];
      to.alone = &part.K->bodies()[size_t(i)];
      if (with_joints) to.with_joints = &part.work->answers[size_t(i)];
    }
  for (ContactRow& row : contacts) {
    double alone = 0;
    row.K = 0;
    for (int side = 0; side < 2; ++side) {
      const int body = row.body[size_t(side)];
      if (body < 0) continue;
      const Source& by = source[size_t(body)];
      const Vector3d &L = row.J.L(side), &A = row.J.A(side);
      Vector6d& answer = row.answer[size_t(side)];
      answer =
          by.alone != nullptr ? by.alone->answer(L, A) : island.bodies[size_t(body)].answer(L, A);
      Vector6d& with = row.with_joints[size_t(side)];
      with = by.with_joints != nullptr
                 ? Vector6d(by.with_joints->leftCols<3>() * L + by.with_joints->rightCols<3>() * A)
                 : answer;
      alone += row.J.along(side, answer);
      row.K += row.J.along(side, with);
    }
    if (!(row.K > least_part_free * alone)) row.K = 0;
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
    row.push(change, row.with_joints, velocities);
    largest = std::fmax(largest, std::abs(row.K * change));
  }
  return largest;
}

class Passes {
 public:
  Passes(const Island& island, std::vector<BlockOfJoints>& of, std::vector<ContactRow>& contacts,
         const SolverOptions& options, Sweep sweep, std::vector<Vector6d>& velocities,
         PassMemory& memory)
      : m_island(island),
        m_of(of),
        m_contacts(contacts),
        m_velocities(velocities),
        m_sweep(sweep),
        m_memory(memory) {
    velocities.clear();
    for (const IslandBody& body : island.bodies) velocities.push_back(body.v_free);
    for (const BlockOfJoints& part : of) addStiffness(island, part, velocities);
    if (sweep != Sweep::all_at_once)
      for (ContactRow& row : contacts) row.impulse = 0;
    memory.bounds.clear();
    findAnswers(island, of, contacts, false, memory.sources);
    for (ContactRow& row : contacts) row.push(row.impulse, velocities);
    blocks().clear();
    blocks().reserve(of.size());
    for (const BlockOfJoints& part : of) {
      blocks().emplace_back(island, part, options, contacts.empty());
      blocks().back().begin(sweep, velocities);
    }
    if (sweep != Sweep::all_at_once || contacts.empty() || !isSolvable()) return;
    for (BlockSolver& block : blocks()) block.settle(velocities);
    findTouched(contacts, island.bodies.size(), memory.touched);
    for (size_t i = 0; i < of.size(); ++i)
      if (!blocks()[i].isUnsettled()) findAnswersWithJoints(of[i]);
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
    const double largest = sweepContacts(m_contacts, m_velocities);
    return std::fmax(largest, sweepBlocks());
  }
  int finish() {
    int factors = 0;
    for (BlockSolver& block : blocks()) {
      block.finish(m_velocities, m_memory.bounds);
      factors += block.factors();
    }
    return factors;
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
      findAnswersWithJoints(m_of[i]);
    }
    for (std::vector<ContactRow>* rows : {&m_contacts, &m_memory.bounds})
      findAnswers(m_island, m_of, *rows, true, m_memory.sources);
    measure();
  }
  void findAnswersWithJoints(BlockOfJoints& part) {
    const auto first = m_memory.touched.begin() + part.component->first_body;
    part.work->touched.assign(first, first + part.component->bodies);
    part.K->findAnswers(part.work->touched, part.work->answers);
  }
  template <class Visit>
  void forEachRow(const Visit& visit) {
    for (ContactRow& row : m_contacts) visit(row);
    for (ContactRow& row : m_memory.bounds) visit(row);
  }
  void measure() {
    forEachRow([&](ContactRow& row) { row.speed = row.velocity(m_velocities); });
  }
  double passAtOnce();

  const Island& m_island;
  std::vector<BlockOfJoints>& m_of;
  std::vector<ContactRow>& m_contacts;
  std::vector<Vector6d>& m_velocities;
  const Sweep m_sweep;
  PassMemory& m_memory;
};

// Contacts see what joints do to their own bodies. What they do to others is found after them, by the joints.
double Passes::passAtOnce() {
  std::vector<Vector6d>& start = m_memory.start;
  start = m_velocities;
  forEachRow([](ContactRow& row) { row.before = row.impulse; });
  for (BlockSolver& block : blocks()) block.beginPass();
  const double largest = std::fmax(sweepContacts(m_contacts, m_velocities),
                                   sweepContacts(m_memory.bounds, m_velocities));
  m_velocities = start;
  forEachRow([&](ContactRow& row) { row.push(row.impulse - row.before, m_velocities); });
  sweepBlocks();
  if (isUnsettled()) {
    m_velocities = start;
    forEachRow([](ContactRow& row) { row.impulse = row.before; });
    for (BlockSolver& block : blocks()) block.goBack(0);
    settle();
    return passAtOnce();
  }
  double slope = 0, bend = 0;
  forEachRow([&](ContactRow& row) {
    const double by = row.impulse - row.before, next = row.velocity(m_velocities);
    slope += by * (row.speed + row.softness * row.before - row.target);
    bend += by * (next - row.speed + row.softness * by);
    row.speed = next;
  });
  if (!(slope < 0) || !(bend > -slope)) return largest;
  const double part = -slope / bend;
  for (size_t i = 0; i < start.size(); ++i)
    m_velocities[i] = start[i] + part * (m_velocities[i] - start[i]);
  forEachRow([&](ContactRow& row) {
    row.impulse = row.before + part * (row.impulse - row.before);
    row.speed = row.velocity(m_velocities);
  });
  for (BlockSolver& block : blocks()) block.goBack(part);
  return part * largest;
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
                            std::vector<ContactRow>& contacts, const SolverOptions& options,
                            Sweep sweep, int most, std::vector<Vector6d>& velocities,
                            PassMemory& memory) {
  SolveReport report;
  Passes passes(island, of, contacts, options, sweep, velocities, memory);
  report.is_solvable = passes.isSolvable();
  for (bool go_on = true; go_on;) {
    report.error = passes.pass() * island.dt;
    ++report.steps;
    report.converged =
        !passes.isSwept() || (!passes.changesSet() && report.error <= options.contact_tolerance);
    report.is_solvable = report.is_solvable && passes.isSolvable();
    go_on = passes.isSwept() && report.is_solvable && !report.converged && report.steps < most;
  }
  report.factors = passes.finish();
  report.is_solvable = report.is_solvable && passes.isSolvable();
  return report;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

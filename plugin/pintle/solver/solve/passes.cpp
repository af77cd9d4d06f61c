#include <pintle/solver/constants.h>
#include <pintle/solver/model/stops.h>
#include <pintle/solver/solve/passes.h>
#include <pintle/solver/system/load_stiffness.h>

#include <algorithm>
#include <cmath>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// Bodies that swing faster than a step resolves resist it (load_stiffness.h): (M + S) v = M v*. That takes energy, too.
void addStiffness(const Island& island, const BlockOfJoints& of,
                  std::vector<Vector6d>& velocities) {
  stiffen(island, *of.component, *of.work, *of.K);
  if (of.work->is_resolved) return;
  for (int i = 0; i < of.component->bodies; ++i) {
    Vector6d& v = velocities[size_t(of.component->first_body + i)];
    v.tail<3>() -=
        of.K->bodies()[size_t(i)].angular * (of.work->stiffness[size_t(i)] * v.tail<3>());
  }
}

// One pass with velocities that joints have no part in.
double sweepContacts(Span<ContactRow> contacts, std::vector<Vector6d>& velocities) {
  double largest = 0;
  for (ContactRow& row : contacts) {
    if (!(row.K > 0)) continue;
    boundFriction(contacts, row);
    const double next = row.meet(row.velocity(velocities)), by = next - row.impulse;
    row.impulse = next;
    row.push(by, velocities);
    largest = std::fmax(largest, std::abs(row.K * by));
  }
  return largest;
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
        m_options(options),
        m_sweep(sweep),
        m_memory(memory) {
    for (const int i : bodies) velocities[size_t(i)] = island.bodies[size_t(i)].v_free;
    for (const BlockOfJoints& part : of) addStiffness(island, part, velocities);
    memory.base.resize(velocities.size());
    for (const int i : bodies) memory.base[size_t(i)] = velocities[size_t(i)];
    memory.bounds.clear();
    blocks().clear();
    blocks().reserve(of.size());
    for (const BlockOfJoints& part : of) memory.response.addJoints(*part.component, *part.K);
    for (ContactRow& row : contacts) {
      memory.response.begin(island, row);
      if (sweep == Sweep::one_by_one) row.impulse = 0;
      row.before = 0;
      row.push(velocities);
    }
    for (const BlockOfJoints& part : of) {
      blocks().emplace_back(island, part, options);
      blocks().back().begin(sweep, velocities, memory.bounds);
    }
    if (sweep == Sweep::one_by_one || !isSolvable()) return;
    m_see_joints =
        !contacts.empty() && memory.response.leaveOutLongPaths(contacts, options.longest_path);
    beginBounds(0);
    sweepBlocks();
    if (releaseLimits()) sweepBlocks();
    const bool any = !contacts.empty() || !memory.bounds.empty();
    if (any && scaleWarmStart()) sweepBlocks();
    for (size_t i = 0; i < of.size(); ++i) takeFactor(i);
    addLimits();
    startResponse();
  }
  bool isSolvable() const {
    for (const BlockSolver& block : blocks())
      if (!block.isSolvable()) return false;
    return true;
  }
  double pass(bool is_last) {
    if (m_sweep == Sweep::passes) return passWithFactor(is_last);
    const double largest = sweepBlocks();
    return std::fmax(largest, sweepContacts(m_contacts, m_velocities));
  }
  void finish() {
    if (m_sweep == Sweep::passes) forEachRow([&](ContactRow& row) { row.push(m_velocities); });
    for (size_t i = 0; i < blocks().size(); ++i)
      if (blocks()[i].finish(m_velocities, m_memory.bounds, m_contacts.empty()) &&
          m_sweep == Sweep::passes)
        takeFactor(i);
  }
  bool isMet() const {
    for (const BlockSolver& block : blocks())
      if (!block.isMet()) return false;
    return true;
  }

 private:
  std::vector<BlockSolver>& blocks() { return m_memory.blocks; }
  const std::vector<BlockSolver>& blocks() const { return m_memory.blocks; }
  double sweepBlocks() {
    double largest = 0;
    for (BlockSolver& block : blocks()) largest = std::fmax(largest, block.sweep(m_velocities));
    return largest;
  }
  bool hasLimits() const {
    for (const BlockSolver& block : blocks())
      if (block.hasLimits()) return true;
    return false;
  }
  bool hasPressingLimits() const {
    for (const BlockSolver& block : blocks())
      if (block.hasPressingLimits()) return true;
    return false;
  }
  // Paths through the factor of a block are not worth their time without contacts: which rows act is found by factors in the end.
  void takeFactor(size_t of) {
    if (!m_contacts.empty() && blocks()[of].isSolvable())
      m_memory.response.takeFactor(m_of[of].component->first_body, *m_of[of].K);
  }
  void beginBounds(size_t from) {
    for (size_t k = from; k < m_memory.bounds.size(); ++k) {
      ContactRow& row = m_memory.bounds[k];
      m_memory.response.begin(m_island, row);
      row.before = row.impulse;
    }
  }
  bool addLimits() {
    bool any = false;
    const size_t first = m_memory.bounds.size();
    for (BlockSolver& block : blocks())
      any = (block.hasLimits() && block.addLimits(m_memory.bounds, m_velocities)) || any;
    beginBounds(first);
    return any;
  }
  bool scaleWarmStart();
  bool hasNews();
  bool releaseLimits();
  void startResponse() {
    for (const int i : m_bodies) m_memory.response.setVelocity(i, m_velocities[size_t(i)]);
    for (const BlockOfJoints& part : m_of)
      m_memory.response.rest(part.component->first_body, *part.K);
  }
  template <class Visit>
  void forEachRow(const Visit& visit) {
    for (ContactRow& row : m_memory.bounds) visit(row);
    for (ContactRow& row : m_contacts) visit(row);
  }
  double passWithFactor(bool is_last);

  const Island& m_island;
  std::vector<BlockOfJoints>& m_of;
  const Span<const int> m_bodies;
  const Span<ContactRow> m_contacts;
  std::vector<Vector6d>& m_velocities;
  const SolverOptions& m_options;
  const Sweep m_sweep;
  PassMemory& m_memory;
  int m_passes = 0, m_next_look = 1;
  /// Contacts see all joints. Else these are solved after each pass.
  bool m_see_joints = true;
};

// From none on, passes never raise the dual function. From the impulses of the last step they do not where these are no worse than none;
// else the fraction of them is taken that is best. Where twice as much would still be too little, as of a motor that presses on a wall, it
// is doubled, up to the bounds of drives. Returns whether it is not just all.
bool Passes::scaleWarmStart() {
  DualFunction of;
  for (const int i : m_bodies) {
    const Vector6d &base = m_memory.base[size_t(i)], change = m_velocities[size_t(i)] - base;
    const IslandBody& body = m_island.bodies[size_t(i)];
    of.slope += body.product(change, base);
    of.curvature += body.product(change, change);
  }
  for (const BlockOfJoints& part : m_of) {
    if (part.work->is_resolved) continue;
    for (int i = 0; i < part.component->bodies; ++i) {
      const auto b = size_t(part.component->first_body + i);
      const Vector3d base = m_memory.base[b].tail<3>(), change = m_velocities[b].tail<3>() - base,
                     stiff = part.work->stiffness[size_t(i)] * change;
      of.slope += stiff.dot(base);
      of.curvature += stiff.dot(change);
    }
  }
  for (const BlockSolver& block : blocks()) block.addTo(of);
  forEachRow(
      [&](const ContactRow& row) { of.add(row.impulse, row.target - row.recovery, row.softness); });
  double most = max_warm_start;
  for (const ContactRow& row : m_memory.bounds) most = std::fmin(most, row.timesToBound());
  const double fraction = of.fraction(most);
  if (fraction == 1) return false;
  for (const int i : m_bodies) {
    const Vector6d& base = m_memory.base[size_t(i)];
    Vector6d& v = m_velocities[size_t(i)];
    v = base + fraction * (v - base);
  }
  for (BlockSolver& block : blocks()) block.scaleImpulses(fraction);
  forEachRow([&](ContactRow& row) { row.before = row.impulse *= fraction; });
  return true;
}

// Motors, friction and limits of joints come first, and contacts last: where they contradict each other, contacts win. Equalities are
// solved when the passes are over, and before after 1, 2, 4, ... of them, only to see which limits are reached.
double Passes::passWithFactor(bool is_last) {
  ++m_passes;
  for (;;) {
    ContactResponse& response = m_memory.response;
    // Twice: motors of a chain are coupled more strongly than contacts, and they are few.
    const double of_bounds =
                     std::fmax(response.sweep(m_memory.bounds), response.sweep(m_memory.bounds)),
                 of_contacts = response.sweep(m_contacts),
                 largest = std::fmax(of_contacts, of_bounds);
    const bool is_converged = largest * m_island.dt <= m_options.contact_tolerance;
    if (m_see_joints && !is_last && !is_converged && m_passes < m_next_look) return largest;
    if (m_passes >= m_next_look) m_next_look *= 2;
    if ((m_see_joints && !hasLimits() && !hasPressingLimits()) || !hasNews()) return largest;
    if (!is_last) return infinity;
  }
}

bool Passes::hasNews() {
  forEachRow([&](ContactRow& row) { row.push(m_velocities); });
  sweepBlocks();
  const bool any = addLimits(), is_released = releaseLimits();
  if (is_released) {
    sweepBlocks();
    if (scaleWarmStart()) sweepBlocks();
  }
  startResponse();
  return any || is_released;
}

// Those that pull.
bool Passes::releaseLimits() {
  bool any = false;
  for (size_t i = 0; i < blocks().size(); ++i) {
    const size_t first = m_memory.bounds.size();
    if (!blocks()[i].releaseLimits(m_memory.bounds, m_velocities)) continue;
    any = true;
    beginBounds(first);
    takeFactor(i);
  }
  if (any) forEachRow([&](ContactRow& row) { m_memory.response.forgetOld(m_island, row); });
  return any;
}

}  // namespace

bool stopRebounds(Island& island, const Component& component) {
  bool any = false;
  for (int c = component.first_joint; c < component.first_joint + component.joints; ++c) {
    const IslandJoint& joint = island.joints[size_t(c)];
    for (int i = 0; i < joint.rows; ++i)
      any = stopRebounds(island.rows[size_t(joint.first_row + i)].law) || any;
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
    report.error = passes.pass(report.steps + 1 >= most) * island.dt;
    ++report.steps;
    report.converged = report.error <= options.contact_tolerance;
    report.is_solvable = report.is_solvable && passes.isSolvable();
    go_on = report.is_solvable && !report.converged && report.steps < most;
  }
  if (!report.is_solvable) return report;
  passes.finish();
  report.is_solvable = passes.isSolvable();
  report.converged = report.converged || passes.isMet();
  return report;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

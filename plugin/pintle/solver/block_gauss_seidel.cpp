#include <pintle/solver/block_gauss_seidel.h>

#include <pintle/solver/load_stiffness.h>
#include <pintle/solver/stops.h>

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
    if (!isAtOnce(sweep))
      for (ContactRow& row : contacts) row.impulse = 0;
    memory.bounds.clear();
    if (!contacts.empty()) {
      for (const BlockOfJoints& part : of)
        memory.response.addJoints(part.component->first_body, *part.K);
      m_see_joints = memory.response.leaveOutLongPaths(contacts, options.longest_path);
    }
    for (ContactRow& row : contacts) {
      row.K = memory.response.findAnswers(island, row);
      row.before = 0;
      row.parts = 0;
      row.push(velocities);
    }
    blocks().clear();
    blocks().reserve(of.size());
    for (const BlockOfJoints& part : of) {
      blocks().emplace_back(island, part, options, contacts.empty());
      blocks().back().begin(sweep, velocities);
    }
    if (contacts.empty() || !isSolvable()) return;
    if (isAtOnce(sweep)) {
      for (size_t i = 0; i < of.size(); ++i) {
        blocks()[i].sweep(velocities);
        if (!blocks()[i].isUnsettled()) takeFactor(i);
      }
      settle();
      addLimits();
    }
    startResponse();
    if (sweep == Sweep::all_at_once_from_less) beginWithLess();
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
  double pass(bool is_last) {
    if (isAtOnce(m_sweep) && !m_contacts.empty()) return passAtOnce(is_last);
    const double largest = sweepContacts(m_contacts, m_velocities);
    return std::fmax(largest, sweepBlocks());
  }
  void finish() {
    if (isAtOnce(m_sweep)) forEachRow([&](ContactRow& row) { row.push(m_velocities); });
    for (size_t i = 0; i < blocks().size(); ++i)
      if (blocks()[i].finish(m_velocities, m_memory.bounds) && !m_contacts.empty()) takeFactor(i);
  }

 private:
  std::vector<BlockSolver>& blocks() { return m_memory.blocks; }
  const std::vector<BlockSolver>& blocks() const { return m_memory.blocks; }
  double sweepBlocks() {
    double largest = 0;
    for (BlockSolver& block : blocks()) largest = std::fmax(largest, block.sweep(m_velocities));
    return largest;
  }
  bool mayChangeSet() const {
    for (const BlockSolver& block : blocks())
      if (block.mayChangeSet() || block.hasLimits()) return true;
    return false;
  }
  // Of a block with a factor.
  void takeFactor(size_t of) {
    if (blocks()[of].isSolvable())
      m_memory.response.takeFactor(m_of[of].component->first_body, *m_of[of].K);
  }
  // Where contacts change which rows act, those with bounds go on as contacts do. Returns whether any do.
  bool settle() {
    bool any = false;
    for (size_t i = 0; i < blocks().size(); ++i) {
      if (!blocks()[i].isUnsettled()) continue;
      any = true;
      const size_t first = m_memory.bounds.size();
      blocks()[i].addBounds(m_memory.bounds, m_velocities);
      blocks()[i].sweep(m_velocities);
      beginBounds(first);
      takeFactor(i);
    }
    if (any) forEachRow([&](ContactRow& row) { m_memory.response.forgetOld(row); });
    return any;
  }
  void beginBounds(size_t from) {
    for (size_t k = from; k < m_memory.bounds.size(); ++k) {
      ContactRow& row = m_memory.bounds[k];
      m_memory.response.findAnswers(m_island, row);
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
  // The dual function (block_gauss_seidel.h) is a parabola in the part with which the contacts begin.
  void beginWithLess() {
    ContactResponse& response = m_memory.response;
    const auto slopeAt = [&](double part) {
      return response.slope(m_contacts, part) + response.slope(m_memory.bounds, part);
    };
    const auto push = [&](double part) {
      response.push(m_contacts, part);
      response.push(m_memory.bounds, part);
    };
    const double at_all = slopeAt(1);
    if (!(at_all > 0)) return;
    push(-1);
    const double at_none = slopeAt(0), part = at_none < 0 ? at_none / (at_none - at_all) : 0;
    push(part);
    forEachRow([&](ContactRow& row) { row.impulse *= part; });
  }
  bool hasNews();
  void startResponse() {
    for (const int i : m_bodies) m_memory.response.setVelocity(i, m_velocities[size_t(i)]);
    for (const BlockOfJoints& part : m_of)
      m_memory.response.rest(part.component->first_body, *part.K);
  }
  template <class Visit>
  void forEachRow(const Visit& visit) {
    for (ContactRow& row : m_contacts) visit(row);
    for (ContactRow& row : m_memory.bounds) visit(row);
  }
  double passAtOnce(bool is_last);

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

// Contacts see each other through the joints. These are solved when the passes are over, and before after 1, 2, 4, ... of them, only
// to see which limits are met, and whether rows with bounds still act as they did.
double Passes::passAtOnce(bool is_last) {
  ++m_passes;
  for (;;) {
    ContactResponse& response = m_memory.response;
    const double of_contacts = response.sweep(m_contacts),
                 of_bounds = response.sweep(m_memory.bounds),
                 largest = std::fmax(of_contacts, of_bounds);
    const bool is_converged = largest * m_island.dt <= m_options.contact_tolerance;
    if (m_see_joints && !is_last && !is_converged && m_passes < m_next_look) return largest;
    if (m_passes >= m_next_look) m_next_look *= 2;
    if ((m_see_joints && !mayChangeSet()) || !hasNews()) return largest;
    if (!is_last) return infinity;
  }
}

bool Passes::hasNews() {
  forEachRow([&](ContactRow& row) { row.push(m_velocities); });
  sweepBlocks();
  const bool settles = settle(), meets = addLimits();
  startResponse();
  return settles || meets;
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
    report.converged = !passes.isSwept() || report.error <= options.contact_tolerance;
    report.is_solvable = report.is_solvable && passes.isSolvable();
    go_on = passes.isSwept() && report.is_solvable && !report.converged && report.steps < most;
  }
  passes.finish();
  report.is_solvable = report.is_solvable && passes.isSolvable();
  return report;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

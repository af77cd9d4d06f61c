#include <pintle/solver/solve/chord.h>

#include <pintle/solver/constants.h>
#include <pintle/solver/model/row_velocities.h>
#include <pintle/solver/solve/pose_changes.h>
#include <pintle/solver/system/active_set.h>
#include <pintle/solver/system/load_stiffness.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// Velocities without impulses of joints: M (v - v*) + S (v - v_0) = 0, S the stiffness.
void findBase(const Island& island, const Component& component, JointMatrix& K,
              const Workspace& work, std::vector<Vector6d>& to) {
  to.clear();
  for (int i = 0; i < component.bodies; ++i) {
    const IslandBody& body = island.bodies[size_t(component.first_body + i)];
    Vector6d base = body.v_free;
    if (!work.is_resolved)
      base.tail<3>() -= K.bodies()[size_t(i)].angular *
                        (work.stiffness[size_t(i)] * (body.v_free - body.v0).tail<3>());
    to.push_back(base);
  }
}

class Chord {
 public:
  Chord(const Island& island, const Component& component, const SolverOptions& options,
        double energy_by_forces, JointMatrix& K, Workspace& work, ChordMemory& memory)
      : m_island(island),
        m_component(component),
        m_options(options),
        m_energy_by_forces(energy_by_forces),
        m_K(K),
        m_work(work),
        m_memory(memory),
        m_set(island, component, options, K, work) {}

  SolveReport run();

 private:
  void findWhatForeseenMisses();
  bool isForeseen();
  void measureEnd() {
    moveBodies(m_island, m_component, m_work.v.data(), m_work.moved);
    measureAtEnd(m_island, m_component, m_work.moved, m_work.u);
  }
  void findVelocities() {
    m_work.v = m_memory.base;
    m_K.addResponse(m_work.y.data(), m_work.v.data());
  }
  int countSteps();
  int end();
  void meetClosely();

  const Island& m_island;
  const Component& m_component;
  const SolverOptions& m_options;
  const double m_energy_by_forces;
  JointMatrix& m_K;
  Workspace& m_work;
  ChordMemory& m_memory;
  ActiveSet m_set;
  SolveReport m_report;
};

// At the velocities that are foreseen rows bend as they will. From there to those of the impulses they are taken to be straight.
void Chord::findWhatForeseenMisses() {
  std::vector<Vector6d>& change = m_memory.change;
  change = m_memory.base;
  m_K.addResponse(m_work.y.data(), change.data());
  for (size_t i = 0; i < change.size(); ++i) change[i] -= m_work.v[i];
  findResidual(m_island.dt, m_work);
  m_K.subtractVelocities(change.data(), m_work.x.data());
}

// Whether impulses lead to what is foreseen, but for rounding, and rows are met there.
bool Chord::isForeseen() {
  const double most2 =
      2 * m_energy_by_forces * rounding_of_velocities * rounding_of_velocities;  // twice, J
  double missed2 = 0, left = 0, work = 0;
  for (const Workspace::Scale& of : m_work.scales) {
    const double x = m_work.x[of.at];
    missed2 += x * x;
    work += std::abs(x * m_work.y[of.at]);
    if (!(missed2 <= most2 && work <= rounding_of_work * m_energy_by_forces)) return false;
    left = larger(left, of.root_K * x);
  }
  m_report.error = left * m_island.dt;
  if (m_report.error > m_options.newton_tolerance) return false;
  const IslandBody* const bodies = &m_island.bodies[size_t(m_component.first_body)];
  missed2 = 0;
  for (size_t i = 0; i < m_work.v.size(); ++i)
    missed2 += bodies[i].product(m_memory.change[i], m_memory.change[i]);
  return missed2 <= most2;
}

// Returns how many steps rows are from the pieces of their laws to which they would come.
int Chord::countSteps() {
  const int changes = m_set.countSteps(m_set.bounded());
  m_report.error = findResidual(m_island.dt, m_work);
  m_report.converged = changes == 0 && m_report.error <= m_options.newton_tolerance;
  return changes;
}

// Finds and measures the end to which the impulses lead. Returns as countSteps does.
int Chord::end() {
  ++m_report.steps;
  findVelocities();
  measureEnd();
  return countSteps();
}

// The tolerance leaves joints open, always to where their load pulls. Where poses are moved back, that gives back but a part of what it took
// of the motion. In single precision this is most of what a swing loses: so rows are met once more from there. Not where rows are bounded,
// which are met up to the tolerance, nor where joints start open.
void Chord::meetClosely() {
  if (!m_set.bounded().empty() || !startsClosed(m_island, m_component, m_options.pose_tolerance) ||
      !m_memory.broyden.step(m_K, m_work.x, m_work.y))
    return;
  findVelocities();
  measureEnd();
}

SolveReport Chord::run() {
  measureEnd();
  m_set.choose(m_set.bounded());
  setActing(m_island, m_component, m_work, m_K);
  findWhatForeseenMisses();
  // Then nothing is to be solved. But impulses that had to change in the last step do so again: what is at rest would leave it by what
  // rounding allows, and come back by two solves, for ever. So they are solved for once more, and then are right.
  const bool was_missed = std::exchange(m_work.is_missed, !isForeseen());
  if (!was_missed && !m_work.is_missed) {
    for (size_t i = 0; i < m_work.v.size(); ++i) m_work.v[i] += m_memory.change[i];
    m_report.converged = true;
    unscaleImpulses(m_work);
    return m_report;
  }
  Broyden& broyden = m_memory.broyden;
  broyden.begin();
  if (!m_K.factorise(m_options.least_pivot) || !broyden.step(m_K, m_work.x, m_work.y))
    return m_report;
  // Where bodies swing no faster than steps resolve, a way that is not straight leads there, too.
  const bool may_wander = m_work.is_resolved;
  broyden.begin(may_wander);
  int fewest = std::numeric_limits<int>::max();
  for (int changes = end(); !m_report.converged; changes = end()) {
    if (m_report.steps >= m_options.max_iterations) return m_report;
    if (changes > 0) {
      if (changes >= fewest) return m_report;
      fewest = changes;
      m_set.changeAll(m_set.bounded());
      if (!factoriseRows(m_island, m_component, m_options, m_work, m_K)) return m_report;
      findVelocities();
      measureEnd();
      findResidual(m_island.dt, m_work);
      broyden.begin(may_wander);
    }
    if (!broyden.step(m_K, m_work.x, m_work.y)) return m_report;
  }
  if (sizeof(Scalar) == 4) meetClosely();
  unscaleImpulses(m_work);
  return m_report;
}

}  // namespace

SolveReport solveByChord(const Island& island, const Component& component,
                         const SolverOptions& options, double energy_by_forces, JointMatrix& K,
                         Workspace& work, ChordMemory& memory) {
  stiffen(island, component, work, K);
  findBase(island, component, K, work, memory.base);
  return Chord(island, component, options, energy_by_forces, K, work, memory).run();
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

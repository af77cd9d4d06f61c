#include <pintle/solver/exact_joint_solver.h>

#include <pintle/joint_rows.h>
#include <pintle/joints/joint.h>
#include <pintle/solver/end_of_step.h>
#include <pintle/solver/joint_system.h>
#include <pintle/solver_body.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// Rounds of geometric stiffness a step. The joints' force depends on the stiffness, and the stiffness on the force.
// Two rounds converge, unless a load comes suddenly.
constexpr int max_stiffenings = 6;

// Contact passes after which the geometric stiffness is found again: the contacts have then put most of their load
// on the joints.
constexpr int contact_load_iterations = 2;

// Rounds of the active set a step. A row at its bound goes to Bullet's iteration, a row inside its bounds comes back,
// and the island is solved again. After `max_reclaim_rounds` rows only go, so that the set settles; in round
// `max_active_set_rounds` every row with bounds goes.
constexpr int max_reclaim_rounds = 3, max_active_set_rounds = 6;

// Sizes of position errors at the end of a step, m or rad.
struct Tolerances {
  double small;      // one correction leaves next to nothing of it
  double remaining;  // of larger errors no more is left: it adds up to energy over a million steps
  double large;      // the motion may be too violent for a correction
  double open;       // a component with a larger gap after all corrections cannot be held
};
constexpr Tolerances free_tolerances = {1e-5, 1e-6, 1e-4, 2e-3};
// Contacts take energy, and are not solved again with a correction, so more may remain.
constexpr Tolerances contact_tolerances = {1e-2, 1e-2, 1e-2, 1e-2};
const Tolerances& tolerances(bool contacts) {
  return contacts ? contact_tolerances : free_tolerances;
}
bool anyExceeds(const std::vector<double>& errors, double than) {
  return std::any_of(errors.begin(), errors.end(), [than](double e) { return !(e <= than); });
}

// Whether an error above `than` has at least been halved.
bool isConverging(const std::vector<double>& errors, const std::vector<double>& before,
                  double than) {
  for (size_t i = 0; i < errors.size(); ++i)
    if (errors[i] > than && 2 * errors[i] < before[i]) return true;
  return false;
}

// A component may end its step with this multiple of the kinetic energy that it has without impulses, plus the energy
// of a motion at `correction_speed`.
constexpr double max_energy_ratio = 1.1;
constexpr double correction_speed = 3;  // m/s and rad/s

// A centre that ends its step on a circle moves along the chord, and its energy there is (w dt / 2)^2 of itself larger
// than on the circle. End-of-step corrections may add twice that to a component, plus the energy of a motion at
// `chord_speed`. The budget applies to turns above `min_chord_turn`, and does not grow beyond `max_chord_turn`.
constexpr double chord_speed = 1;                             // m/s and rad/s
constexpr double min_chord_turn = 0.4, max_chord_turn = 0.8;  // rad a step

// A component cannot be held at the end of the step if it exceeds that budget, or keeps a gap above this part of the
// way that it moves. It is then slowed towards `min_chord_turn`, by a factor between these, at most
// `max_slowdowns` times.
constexpr double max_gap_per_motion = 0.02;
constexpr double min_speed_factor = 0.5, max_speed_factor = 0.9;
constexpr int max_slowdowns = 4;

// Compensation of the energy that chords give to a component or take from it: the energy of a whipping chain errs by
// 0.4 % instead of 3.7 %. It begins where a body turns by more than `min_compensated_turn`, lasts so long after,
// and ends above `max_chord_turn`.
constexpr double min_compensated_turn = 0.1;  // rad a step
constexpr double compensation_time = 10;      // s
constexpr double max_speed_change = 0.2;      // of the velocities, a step
constexpr double min_energy_error = 1e-4;     // of the energy; a smaller error waits

// A component that gains too much energy closes its gaps as fast as it moves, between these speeds, m/s and rad/s. A
// body that is brought back from far away must not be thrown; one that turns at 1000 rad/s must not get away.
constexpr double min_closing_speed = 20, max_closing_speed = 100;

// A correction by rows of the end is rejected if a body then turns by more than this in the step, where those rows lose
// their meaning, and by more than this multiple of its turn without impulses.
constexpr double max_end_turn = 1;  // rad
constexpr double max_end_turn_ratio = 1.1;

// Corrections beyond the position iterations, while an error exceeds `remaining`. After the first number they go on, up
// to the second, only while they converge: they do not where poses are rounded or rows are dependent.
constexpr int max_extra_iterations = 3, max_converging_iterations = 6;

}  // namespace

// The state of one solve.
struct ExactJointSolver::Island {
  JointSystem joints;
  EndOfStep end;
  std::vector<double> error;         ///< at the end of the step, of each row by block, m/s or rad/s
  std::vector<double> largest;       ///< error of each component, m or rad
  std::vector<double> next_largest;  ///< the same after a correction
  std::vector<JointSystem::Energy> energy;  ///< of each component
  std::vector<double> speeds;  ///< of each component: bound of its closing, m/s and rad/s
  std::vector<double> parts;   ///< of each component: factor on its impulses or velocities
  std::vector<double> gained;  ///< Topology::gained, if the step ends like this
  std::vector<char> rejected;  ///< of each component: its correction is rejected
  std::vector<btTypedConstraint*> in_passes;  ///< the joints that Bullet's passes call
  int stiffenings = 0;                        ///< in this step

  /// So that a later step, the first to need these, does not allocate.
  void reserve(int constraints) {
    in_passes.reserve(size_t(constraints));
    const auto components = size_t(joints.topology().components);
    for (std::vector<double>* of : {&largest, &next_largest, &speeds, &parts, &gained})
      of->reserve(components);
    energy.reserve(components);
    rejected.reserve(components);
    joints.topology().gained.reserve(components);
    joints.topology().chord_energy.reserve(components);
  }
};

ExactJointSolver::ExactJointSolver() : m_island(new Island) {}
ExactJointSolver::~ExactJointSolver() { delete m_island; }

void ExactJointSolver::setPositionIterations(int iterations) {
  if (iterations < 0)
    throw std::invalid_argument("pintle::ExactJointSolver: position iterations = " +
                                std::to_string(iterations) + ": must be >= 0");
  m_position_iterations = iterations;
}

size_t ExactJointSolver::getMemory() const { return m_island->joints.bytes(); }

// As Bullet's own, without preparing rows for its iteration: most never enter it.
void ExactJointSolver::convertJoints(btTypedConstraint** constraints, int numConstraints,
                                     const btContactSolverInfo& infoGlobal) {
  AsJoint as_joint;
  m_tmpConstraintSizesPool.resizeNoInitialize(numConstraints);
  int rows = 0;
  for (int i = 0; i < numConstraints; ++i) {
    btTypedConstraint& constraint = *constraints[i];
    if (Joint* joint = as_joint(&constraint)) joint->m_solved_at_once = true;
    constraint.buildJacobian();
    constraint.internalSetAppliedImpulse(0);
    if (btJointFeedback* feedback = constraint.getJointFeedback()) {
      for (btVector3* of : {&feedback->m_appliedForceBodyA, &feedback->m_appliedTorqueBodyA,
                            &feedback->m_appliedForceBodyB, &feedback->m_appliedTorqueBodyB})
        of->setZero();
    }
    btTypedConstraint::btConstraintInfo1& size = m_tmpConstraintSizesPool[i];
    size.m_numConstraintRows = size.nub = 0;
    if (constraint.isEnabled()) constraint.getInfo1(&size);
    rows += size.m_numConstraintRows;
  }
  m_tmpSolverNonContactConstraintPool.resizeNoInitialize(rows);
  const StepOfRows step = {1 / infoGlobal.m_timeStep, infoGlobal.m_erp, infoGlobal.m_globalCfm,
                           infoGlobal.m_damping, infoGlobal.m_numIterations};
  for (int i = 0, row = 0; i < numConstraints; ++i) {
    btTypedConstraint& constraint = *constraints[i];
    const int count = m_tmpConstraintSizesPool[i].m_numConstraintRows;
    if (count > 0) convertJoint(constraint, step, row, count);
    if (Joint* joint = as_joint(&constraint)) joint->m_solved_at_once = false;
    row += count;
  }
}

void ExactJointSolver::convertJoint(btTypedConstraint& joint, const StepOfRows& step, int first,
                                    int count) {
  const int id_a = getOrInitSolverBody(joint.getRigidBodyA(), 1 / step.fps);
  const int id_b = getOrInitSolverBody(joint.getRigidBodyB(), 1 / step.fps);
  const btSolverBody &a = m_tmpSolverBodyPool[id_a], &b = m_tmpSolverBodyPool[id_b];
  const int own_iterations = joint.getOverrideNumSolverIterations();
  const int iterations = own_iterations > 0 ? own_iterations : step.iterations;
  m_maxOverrideNumSolverIterations = btMax(m_maxOverrideNumSolverIterations, iterations);
  btSolverConstraint* rows = &m_tmpSolverNonContactConstraintPool[first];
  const Scalar damping = askRows(joint, step, rows, count);
  completeTargets(rows, count, joint, damping, a, b);
  const Scalar threshold = joint.getBreakingImpulseThreshold();
  for (int i = 0; i < count; ++i) {
    btSolverConstraint& row = rows[i];
    row.m_solverBodyIdA = id_a;
    row.m_solverBodyIdB = id_b;
    row.m_overrideNumSolverIterations = iterations;
    row.m_originalContactPoint = &joint;
    row.m_upperLimit = btMin(row.m_upperLimit, threshold);
    row.m_lowerLimit = btMax(row.m_lowerLimit, -threshold);
  }
}

btScalar ExactJointSolver::solveGroupCacheFriendlySetup(
    btCollisionObject** bodies, int numBodies, btPersistentManifold** manifoldPtr, int numManifolds,
    btTypedConstraint** constraints, int numConstraints, const btContactSolverInfo& infoGlobal,
    btIDebugDraw* debugDrawer) {
  btContactSolverInfo info = infoGlobal;
  // Contacts need many iterations to find a heavy load on light, jointed bodies. The warm start spreads them over the
  // steps, so it must keep all of the impulse.
  if (numConstraints > 0) info.m_warmstartingFactor = 1;
  return btSequentialImpulseConstraintSolver::solveGroupCacheFriendlySetup(
      bodies, numBodies, manifoldPtr, numManifolds, constraints, numConstraints, info, debugDrawer);
}

bool ExactJointSolver::hasBounds() const { return !m_island->joints.all() || hasContacts(); }

struct ExactJointSolver::Pools : std::array<btConstraintArray*, 4> {};

ExactJointSolver::Pools ExactJointSolver::allRows() {
  return {{&m_tmpSolverNonContactConstraintPool, &m_tmpSolverContactConstraintPool,
           &m_tmpSolverContactFrictionConstraintPool,
           &m_tmpSolverContactRollingFrictionConstraintPool}};
}

void ExactJointSolver::resetVelocities() {
  for (int i = 0; i < m_tmpSolverBodyPool.size(); ++i) {
    m_tmpSolverBodyPool[i].internalGetDeltaLinearVelocity().setZero();
    m_tmpSolverBodyPool[i].internalGetDeltaAngularVelocity().setZero();
  }
}

// Updates the geometric stiffness. Returns whether it has changed and the joints were solved again.
bool ExactJointSolver::stiffen(const btContactSolverInfo& info) {
  JointSystem& joints = m_island->joints;
  if (m_island->stiffenings == max_stiffenings || !joints.stiffen(info.m_timeStep)) return false;
  ++m_island->stiffenings;
  restart();
  return true;
}

// Solves the joints again, with the present inertia of the bodies and the impulses iterated so far.
void ExactJointSolver::restart() {
  JointSystem& joints = m_island->joints;
  resetVelocities();
  for (btConstraintArray* rows : allRows())
    joints.stiffenRows(m_tmpSolverBodyPool, *rows, rows != &m_tmpSolverNonContactConstraintPool);
  joints.begin(m_tmpSolverBodyPool);
}

// Drops the warm start of components that gain energy by it. That happens where limits or contacts ask for a motion
// that the joints cannot make.
void ExactJointSolver::dropGainingWarmStarts() {
  computeEnergies();
  if (!rejectEnergyGains(max_energy_ratio, correction_speed)) return;
  const std::vector<int>& component = m_island->joints.topology().body_component;
  const auto isRejected = [&](int body) {
    const auto i = size_t(body);
    return i < component.size() && component[i] >= 0 && m_island->rejected[size_t(component[i])];
  };
  for (btConstraintArray* rows : allRows())
    for (int i = 0; i < rows->size(); ++i) {
      btSolverConstraint& row = (*rows)[i];
      if (isRejected(row.m_solverBodyIdA) || isRejected(row.m_solverBodyIdB))
        row.m_appliedImpulse = 0;
    }
  restart();
}

// Bullet calls each joint in each pass. A joint of Pintle's needs the call only if rows of its own are iterated.
void ExactJointSolver::findInPasses(btTypedConstraint** constraints, int numConstraints) {
  const btConstraintArray& rows = m_tmpSolverNonContactConstraintPool;
  m_island->in_passes.clear();
  AsJoint as_joint;
  int row = 0;
  for (int i = 0; i < numConstraints; ++i) {
    bool iterated = false;
    for (; row < rows.size() && rows[row].m_originalContactPoint == constraints[i]; ++row)
      iterated = iterated || rows[row].m_overrideNumSolverIterations > 0;
    if (iterated || as_joint(constraints[i]) == nullptr)
      m_island->in_passes.push_back(constraints[i]);
  }
}

void ExactJointSolver::beginReactions() {
  m_island->joints.beginReactions(
      m_tmpSolverBodyPool,
      {&m_tmpSolverContactConstraintPool, &m_tmpSolverContactFrictionConstraintPool,
       &m_tmpSolverContactRollingFrictionConstraintPool},
      m_tmpSolverNonContactConstraintPool);
}

// Finds the errors at the end of the step, and the largest of each component, m or rad.
template <class Vector>
void ExactJointSolver::predictErrors(const btContactSolverInfo& info, Vector& largest) {
  Island& island = *m_island;
  island.joints.write(m_tmpSolverBodyPool);
  island.end.predict(m_tmpSolverBodyPool, info);
  island.end.errors(island.joints, m_tmpSolverNonContactConstraintPool, island.error, largest);
}

void ExactJointSolver::computeEnergies() {
  Island& island = *m_island;
  island.joints.write(m_tmpSolverBodyPool);
  island.joints.energies(m_tmpSolverBodyPool, island.energy);
  island.rejected.resize(island.energy.size());
}

// Rejects components that cannot be held at the end of the step, or only by exceeding the energy budget of chords.
bool ExactJointSolver::rejectUnheld(double dt) {
  Island& island = *m_island;
  island.gained = island.joints.topology().gained;
  std::vector<double>& gained = island.gained;
  gained.resize(island.energy.size(), 0);
  const bool closes = island.joints.maxCorrectionSpeed() > correction_speed;
  const Tolerances& tolerance = tolerances(hasContacts());
  bool any = false;
  for (size_t i = 0; i < island.energy.size(); ++i) {
    const JointSystem::Energy& energy = island.energy[i];
    const double turn = std::min(energy.spin * dt, max_chord_turn);
    const double max_gain = turn * turn / 2 * energy.free + chord_speed * chord_speed * energy.unit;
    // The joints' work neither counts what other rows add, nor is it lessened by what they take.
    const double sum = gained[i] + std::min(energy.work, energy.now - energy.free) / max_gain;
    // A component that starts far apart may turn by being brought together.
    const double max_spin = closes ? energy.spin : std::max(energy.spin, energy.spin_at_end);
    const double moved = dt * std::sqrt(std::max(energy.free, energy.now) / energy.unit);
    const double max_gap = std::clamp(max_gap_per_motion * moved, tolerance.small, tolerance.open);
    // A free component would lose angular momentum if the turn that its own joints give it counted.
    const double spin = island.joints.topology().grounded[i] ? max_spin : energy.spin;
    const bool open = !(spin * dt < min_chord_turn) && !(island.largest[i] < max_gap);
    island.rejected[i] = open || (!(max_spin * dt < min_chord_turn) && !(sum <= 1));
    if (!island.rejected[i]) gained[i] = turn < min_chord_turn ? 0 : std::max(0., sum);
    any = any || island.rejected[i];
  }
  return any;
}

// Rejects components that have gained more energy than joints may give.
bool ExactJointSolver::rejectEnergyGains(double gain, double speed) {
  Island& island = *m_island;
  bool any = false;
  for (size_t i = 0; i < island.energy.size(); ++i) {
    const JointSystem::Energy& energy = island.energy[i];
    island.rejected[i] = !(energy.now <= gain * energy.free + speed * speed * energy.unit);
    any = any || island.rejected[i];
  }
  return any;
}

// Solves rejected components without their end-of-step corrections.
void ExactJointSolver::undoRejected() {
  JointSystem& joints = m_island->joints;
  joints.undoCorrections(m_tmpSolverNonContactConstraintPool, m_island->rejected);
  restart();
  joints.solveLoopTargets();
}

// Scales down the uncorrected velocities of rejected components, further with each call. Returns whether any was.
bool ExactJointSolver::slowRejected(double dt) {
  Island& island = *m_island;
  bool any = false;
  for (size_t i = 0; i < island.energy.size(); ++i) {
    const double turn = island.energy[i].spin * dt;
    if (!island.rejected[i] || (turn < min_chord_turn && !island.joints.topology().grounded[i]))
      continue;
    island.parts[i] *= std::clamp(min_chord_turn / turn, min_speed_factor, max_speed_factor);
    any = true;
  }
  if (!any) return false;
  for (size_t i = 0; i < island.energy.size(); ++i) island.rejected[i] = island.parts[i] < 1;
  undoRejected();
  island.joints.scaleVelocities(m_tmpSolverBodyPool, island.parts);
  island.joints.solve();
  return true;
}

// Rigid joints do no work, but a step that ends on the joints moves along chords. It gives energy while a body comes to
// turn faster, and takes energy while it slows down, and the two do not cancel. Energy that was given is taken back;
// energy that was taken is returned, as far as this function took it.
void ExactJointSolver::compensateChordEnergy(const btContactSolverInfo& info) {
  Island& island = *m_island;
  JointSystem& joints = island.joints;
  std::vector<Topology::ChordEnergy>& chord_energy = joints.topology().chord_energy;
  chord_energy.resize(size_t(joints.topology().components));
  const double dt = double(info.m_timeStep);
  double& left = joints.topology().compensation_left;
  const double turn = joints.spin() * dt;
  left = turn > min_compensated_turn ? compensation_time : left - dt;
  if (hasBounds() || m_position_iterations == 0 || !(left > 0) || !(turn < max_chord_turn)) {
    left = 0;
    std::fill(chord_energy.begin(), chord_energy.end(), Topology::ChordEnergy());
    return;
  }
  computeEnergies();
  island.parts.assign(chord_energy.size(), 1);
  bool any = false;
  for (size_t i = 0; i < chord_energy.size(); ++i) {
    const JointSystem::Energy& energy = island.energy[i];
    Topology::ChordEnergy& chord = chord_energy[i];
    const bool holds = island.largest[i] < free_tolerances.large && energy.is_rigid;
    if (!holds || !joints.topology().grounded[i]) {
      chord = Topology::ChordEnergy();
      continue;
    }
    chord.given += energy.given;
    const double excess = std::max(chord.given, -chord.taken);
    if (!(std::abs(excess) > min_energy_error * energy.now)) continue;
    island.parts[i] = std::clamp(std::sqrt(std::max(0., 1 - excess / energy.now)),
                                 1 - max_speed_change, 1 + max_speed_change);
    chord.given -= energy.given;
    chord.taken += energy.given;
    any = true;
  }
  if (!any) return;
  joints.scaleVelocities(m_tmpSolverBodyPool, island.parts);
  joints.solve();
  iteratePositions(info);
  computeEnergies();
  for (size_t i = 0; i < chord_energy.size(); ++i) {
    if (island.parts[i] == 1) continue;
    Topology::ChordEnergy& chord = chord_energy[i];
    chord.given += island.energy[i].given;
    chord.taken = std::max(0., chord.taken - island.energy[i].given);
  }
}

// A body that turns further in a step than Bullet turns it leaves its joints far open, and closing them by force would
// add energy without end. A component that gains too much closes at a bounded speed. If other rows drive it beyond
// that, all of its impulses are scaled down.
void ExactJointSolver::limitEnergyGain(const btContactSolverInfo& info) {
  Island& island = *m_island;
  JointSystem& joints = island.joints;
  const double dt = double(info.m_timeStep);
  computeEnergies();
  island.parts.assign(island.energy.size(), 1);
  bool any_rejected = rejectUnheld(dt);
  for (int i = 0; any_rejected && i < max_slowdowns && slowRejected(dt); ++i) {
    iteratePositions(info);
    computeEnergies();
    any_rejected = rejectUnheld(dt);
  }
  if (any_rejected) {
    undoRejected();
    computeEnergies();
  }
  joints.topology().gained = island.gained;
  if (!rejectEnergyGains(max_energy_ratio, correction_speed)) return;
  // The contacts' impulses were found with the present stiffness, so that stays.
  if (hasContacts()) {
    undoRejected();
    computeEnergies();
    if (!rejectEnergyGains(max_energy_ratio, correction_speed)) return;
  }
  island.speeds.resize(island.energy.size());
  for (size_t i = 0; i < island.energy.size(); ++i) {
    const double speed = std::sqrt(island.energy[i].free / island.energy[i].unit);
    island.speeds[i] = std::clamp(speed, min_closing_speed, max_closing_speed);
  }
  joints.limitCorrectionSpeed(island.rejected, island.speeds);
  restart();
  joints.solveLoopTargets();
  computeEnergies();
  if (!rejectEnergyGains(1, max_closing_speed)) return;
  island.parts.assign(island.energy.size(), 1);
  for (size_t i = 0; i < island.energy.size(); ++i) {
    if (!island.rejected[i]) continue;
    // The energy at a factor f on the impulses: added f^2 + 2 half f + free
    const JointSystem::Energy& energy = island.energy[i];
    const double half = (energy.now - energy.added - energy.free) / 2;
    const double more = max_closing_speed * max_closing_speed * energy.unit;
    const double f = more / (half + std::sqrt(half * half + energy.added * more));
    island.parts[i] = f < 1 ? f : 0;
  }
  joints.scaleImpulses(island.parts);
}

// Newton's iteration for the positions at the end of the step: first by the rows of the start, then by those of the
// end. Impulses act along the rows of the start either way, and so conserve momentum. Returns whether an error was so
// large that the correction may have added energy.
bool ExactJointSolver::iteratePositions(const btContactSolverInfo& info) {
  Island& island = *m_island;
  JointSystem& joints = island.joints;
  island.largest.assign(size_t(joints.topology().components), 0.);
  if (m_position_iterations == 0) return false;
  island.end.begin(joints.blocks().size(), m_tmpSolverBodyPool);
  predictErrors(info, island.largest);
  const Tolerances& tolerance = tolerances(hasContacts());
  const bool any_large = anyExceeds(island.largest, tolerance.large);
  bool may_be_at_end = true;
  for (int i = 1;; ++i) {
    const bool last = i >= m_position_iterations, far = anyExceeds(island.largest, tolerance.small);
    if (far || !last) joints.saveState();
    const bool at_end = may_be_at_end && i > 1 &&
                        (anyExceeds(island.largest, tolerance.large) ||
                         island.end.largestTurned() > tolerance.small);
    if (at_end) {
      island.end.addEndRows(joints, m_tmpSolverNonContactConstraintPool, m_tmpSolverBodyPool);
      joints.correctAtEnd(island.error);
    } else {
      island.end.clearTurned(island.error);
      joints.correct(island.error);
    }
    if (!far && last) return any_large;
    // Line search: a component whose correction is rejected goes half of the way, then none of it.
    bool any_rejected = false;
    for (const double part : {0.5, 0.}) {
      predictErrors(info, island.next_largest);
      any_rejected = rejectGrowingErrors(tolerance.large);
      if (at_end && rejectLargeTurns(double(info.m_timeStep))) any_rejected = true;
      if (!any_rejected) break;
      joints.restoreState(part, island.rejected);
    }
    const int extra = i - m_position_iterations;
    const bool more =
        extra < max_extra_iterations
            ? anyExceeds(island.next_largest, tolerance.remaining)
            : extra < max_converging_iterations &&
                  isConverging(island.next_largest, island.largest, tolerance.remaining);
    if (!any_rejected) {
      island.largest.swap(island.next_largest);
      if (last && !more) return any_large;
      continue;
    }
    // The other kind of rows may still do better.
    if (last && (!may_be_at_end || extra >= max_extra_iterations)) return any_large;
    may_be_at_end = !at_end;
    predictErrors(info, island.largest);
  }
}

bool ExactJointSolver::rejectGrowingErrors(double large) {
  Island& island = *m_island;
  bool any = false;
  island.rejected.resize(island.largest.size());
  for (size_t i = 0; i < island.largest.size(); ++i) {
    // Written so that NaN is rejected.
    island.rejected[i] =
        !(island.next_largest[i] <= large) && !(island.next_largest[i] < island.largest[i]);
    any = any || island.rejected[i];
  }
  return any;
}

// Also rejects components in which impulses turn a body further than rows of its end are good for.
bool ExactJointSolver::rejectLargeTurns(double dt) {
  Island& island = *m_island;
  const std::vector<int>& component = island.joints.topology().body_component;
  bool any = false;
  for (size_t i = 0; i < component.size(); ++i) {
    if (component[i] < 0) continue;
    const btSolverBody& body = m_tmpSolverBodyPool[int(i)];
    const double turn = dt * double(angularVelocity(body).length());
    const btVector3 before = body.m_angularVelocity + body.m_externalTorqueImpulse;
    if (turn < std::max(max_end_turn, max_end_turn_ratio * dt * double(before.length()))) continue;
    island.rejected[size_t(component[i])] = any = true;
  }
  return any;
}

// Solves an island with the present active set. Returns the number of passes.
template <class Pass>
int ExactJointSolver::solveIsland(const btContactSolverInfo& info, bool again, const Pass& pass) {
  JointSystem& joints = m_island->joints;
  const int iterations =
      hasBounds() ? btMax(info.m_numIterations, m_maxOverrideNumSolverIterations) : 0;
  // The impulses of the last step predict the geometric stiffness. Contacts load the joints anew, so it is found again
  // after them.
  m_island->stiffenings = 0;
  const bool foreseen = stiffen(info);
  if (!foreseen) {
    joints.factorise();
    if (again)
      restart();
    else
      joints.begin(m_tmpSolverBodyPool);
  }
  while (!(foreseen && iterations > 0) && stiffen(info) && joints.hasUnresolved()) {
  }
  if (iterations > 0) dropGainingWarmStarts();
  joints.solveLoopTargets();

  // Each iteration is a pass of Bullet's over the rows with bounds, then an exact solution of the joints, as far as
  // those rows depend on it.
  int used = 0;
  m_leastSquaresResidual = 0;
  if (iterations > 0) {
    joints.write(m_tmpSolverBodyPool);
    beginReactions();
  }
  for (bool last = iterations == 0; !last;) {
    m_leastSquaresResidual = pass(used++);
    last = used == iterations || m_leastSquaresResidual <= info.m_leastSquaresResidualThreshold;
    if (last || used == contact_load_iterations)
      joints.endReactions(m_tmpSolverBodyPool, m_tmpSolverNonContactConstraintPool);
    if (used == contact_load_iterations) {
      if (stiffen(info)) joints.solveLoopTargets();
      joints.write(m_tmpSolverBodyPool);
      if (!last) beginReactions();
    } else if (!last) {
      joints.react(m_tmpSolverBodyPool);
    }
  }
  joints.rememberPointImpulses();
  joints.restoreMomentum(m_tmpSolverBodyPool);
  if (iterations > 0 || joints.bounded())
    m_complementarity_residual = std::sqrt(m_leastSquaresResidual);

  const bool any_large = iteratePositions(info);
  compensateChordEnergy(info);
  if (any_large || joints.maxCorrectionSpeed() > correction_speed)
    limitEnergyGain(info);
  else
    std::fill(joints.topology().gained.begin(), joints.topology().gained.end(), 0.);
  return used;
}

btScalar ExactJointSolver::solveGroupCacheFriendlyIterations(
    btCollisionObject** bodies, int numBodies, btPersistentManifold** manifoldPtr, int numManifolds,
    btTypedConstraint** constraints, int numConstraints, const btContactSolverInfo& infoGlobal,
    btIDebugDraw* debugDrawer) {
  JointSystem& joints = m_island->joints;
  const auto solve_by_bullet = [&] {
    return btSequentialImpulseConstraintSolver::solveGroupCacheFriendlyIterations(
        bodies, numBodies, manifoldPtr, numManifolds, constraints, numConstraints, infoGlobal,
        debugDrawer);
  };
  btConstraintArray& rows = m_tmpSolverNonContactConstraintPool;
  // Among contacts limits are iterated, too: both change each other, and some change in every step.
  const bool limits = !hasContacts();
  const auto gather = [&] {
    return joints.gather(m_tmpSolverBodyPool, rows, limits, infoGlobal.m_numIterations);
  };
  if (!gather()) return solve_by_bullet();
  m_island->reserve(numConstraints);

  solveGroupCacheFriendlySplitImpulseIterations(bodies, numBodies, manifoldPtr, numManifolds,
                                                constraints, numConstraints, infoGlobal,
                                                debugDrawer);
  const auto pass = [&](int iteration) {
    if (iteration == 0) findInPasses(constraints, numConstraints);
    std::vector<btTypedConstraint*>& in_passes = m_island->in_passes;
    return solveSingleIteration(iteration, bodies, numBodies, manifoldPtr, numManifolds,
                                in_passes.data(), int(in_passes.size()), infoGlobal, debugDrawer);
  };
  int used = solveIsland(infoGlobal, joints.loaded(), pass);
  for (int round = 1; joints.finite(); ++round) {
    joints.write(m_tmpSolverBodyPool);
    const bool taken = limits && round <= max_reclaim_rounds &&
                       joints.reclaimUnsaturated(m_tmpSolverBodyPool, rows, infoGlobal.m_timeStep);
    if (!joints.releaseSaturated(rows, round == max_active_set_rounds) && !taken) break;
    gather();
    used = solveIsland(infoGlobal, true, pass);
  }
  if (!joints.finite()) {
    // Overflow has spread to rows and contacts, too. Nothing acts in this step.
    joints.releaseAll(rows, infoGlobal.m_numIterations);
    resetVelocities();
    for (btConstraintArray* pool : allRows())
      for (int i = 0; i < pool->size(); ++i) (*pool)[i].m_appliedImpulse = 0;
    return 0;
  }
  joints.writeImpulses(rows);
  joints.rememberIteratedImpulses(rows);
  joints.reclaimUnsaturated(m_tmpSolverBodyPool, rows, infoGlobal.m_timeStep);
  joints.report(m_tmpSolverBodyPool, rows, infoGlobal.m_timeStep);
  ++m_analyticsData.m_numSolverCalls;
  m_analyticsData.m_numIterationsUsed = used;
  m_analyticsData.m_islandId = numBodies > 0 ? bodies[0]->getCompanionId() : -2;
  m_analyticsData.m_numBodies = numBodies;
  m_analyticsData.m_numContactManifolds = numManifolds;
  m_analyticsData.m_remainingLeastSquaresResidual = m_leastSquaresResidual;
  return 0;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

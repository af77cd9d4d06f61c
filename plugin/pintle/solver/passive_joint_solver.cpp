#include <pintle/solver/passive_joint_solver.h>

#include <pintle/solver/balance.h>
#include <pintle/solver/block_gauss_seidel.h>
#include <pintle/solver/chord.h>
#include <pintle/solver/component_memory.h>
#include <pintle/solver/island_builder.h>
#include <pintle/solver/joint_access.h>
#include <pintle/solver/joint_report.h>
#include <pintle/solver/load_stiffness.h>
#include <pintle/solver/pose_correction.h>
#include <pintle/solver/softness.h>

#include <algorithm>
#include <unordered_map>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

void move(btRigidBody& body, const PoseChange& by) {
  const Eigen::Quaterniond q(turnBy(by.tail<3>()));
  btTransform to = body.getWorldTransform();
  to.setOrigin(to.getOrigin() + btVector3(Scalar(by[0]), Scalar(by[1]), Scalar(by[2])));
  to.setRotation(
      (btQuaternion(Scalar(q.x()), Scalar(q.y()), Scalar(q.z()), Scalar(q.w())) * to.getRotation())
          .normalized());
  body.setWorldTransform(to);
}

}  // namespace

struct PassiveJointSolver::State {
  SolverOptions options;
  StepReport report;
  Island island;
  IslandBuilder builder{island, options};
  std::vector<Component> components;
  std::unordered_map<const btTypedConstraint*, std::unique_ptr<ComponentMemory>> memory;
  std::vector<PoseChange> pose_changes;
  std::vector<Vector6d> velocities;  ///< with which bodies end the step
  std::vector<ContactRow> contacts;
  int sweeps = 0;  ///< of contacts

  ComponentMemory& begin(const Component& component);
  bool solveByChord(const Component& component);
  void solveAlone(const Component& component);
  void solveInVelocity(const std::vector<const Component*>& those, std::vector<ContactRow>& rows);
  double gainInVelocity(const std::vector<const Component*>& those,
                        const std::vector<ContactRow>& rows);
  void finish(const Component& component, ComponentMemory& kept);
  std::vector<char> findTouched() const;
  void count(const SolveReport& done, int components);
  std::unique_ptr<ComponentMemory>& slotOf(const Component& component) {
    return memory[island.joints[size_t(component.first_joint)].constraint];
  }
  ComponentMemory& memoryOf(const Component& component) { return *slotOf(component); }
  void solveAll();
};

// Where a solve begins, with what its joints bore in the last steps.
ComponentMemory& PassiveJointSolver::State::begin(const Component& component) {
  ComponentMemory& kept = memoryOf(component);
  kept.begin(island, component);
  findSoftness(island, component, options, kept.in_loop, kept.work);
  findStiffness(island, component, options.stable_swing, kept.work);
  return kept;
}

// The first tier. Returns false where it does not converge, or where its joints would give too much.
bool PassiveJointSolver::State::solveByChord(const Component& component) {
  ComponentMemory& kept = begin(component);
  kept.holds_end = false;
  const SolveReport done = pintle::solveByChord(island, component, options, kept.K, kept.work);
  count(done, 1);
  if (!done.converged) return false;
  kept.tolerance = options.pose_tolerance;
  kept.has_factor = kept.holds_end = true;
  kept.work_done = workOfJoints(island, component, kept.work);
  return (isResolved(kept.work) && isOfArcs(island, component, options, kept)) ||
         kept.ledger.mayGive(kept.work_done, options.ledger_share);
}

// Where the first tier gives too much, the second one may lose more than that: then it is balanced.
void PassiveJointSolver::State::solveAlone(const Component& component) {
  if (solveByChord(component)) return;
  ComponentMemory& kept = memoryOf(component);
  const bool has_end = kept.holds_end && isOfArcs(island, component, options, kept);
  const Workspace::Solution by_chord = has_end ? kept.work.solution() : Workspace::Solution();
  const double given = kept.work_done;
  std::vector<ContactRow> none;
  solveInVelocity({&component}, none);
  if (!has_end || kept.ledger.mayGive(-kept.work_done, options.ledger_share)) return;
  kept.work.take(by_chord);
  kept.work_done = given;
  kept.has_factor = false;
  kept.holds_end = true;
}

// J: what all impulses gave to the velocities that forces lead to. Contacts may give what they aim at: rebounds, and ways out of each
// other.
double PassiveJointSolver::State::gainInVelocity(const std::vector<const Component*>& those,
                                                 const std::vector<ContactRow>& rows) {
  double gain = 0;
  std::vector<char> counted(island.bodies.size(), false);
  for (const Component* of : those) {
    gain += gainOverForces(island, *of, memoryOf(*of).work);
    std::fill_n(counted.begin() + of->first_body, of->bodies, true);
  }
  for (size_t i = 0; !rows.empty() && i < counted.size(); ++i)
    if (!counted[i]) gain += gainOf(island.bodies[i], island.bodies[i].v_free, velocities[i]);
  for (const ContactRow& row : rows) gain -= std::fmax(row.impulse * row.target, 0);
  return gain;
}

// The second tier: one component alone, or those that contacts touch.
void PassiveJointSolver::State::solveInVelocity(const std::vector<const Component*>& those,
                                                std::vector<ContactRow>& rows) {
  report.second_tier += int(those.size());
  std::vector<BlockOfJoints> blocks;
  double largest = 0;
  for (const Component* of : those) {
    ComponentMemory& kept = memoryOf(*of);
    blocks.push_back({of, &kept.K, &kept.work});
    largest += kept.ledger.largest();
  }
  for (const IslandBody& body : island.bodies)
    if (!rows.empty()) largest += gainOf(body, Vector6d::Zero(), body.v_free);
  SolveReport done;
  const auto solve = [&](Sweep sweep) {
    const int most = rows.empty() ? options.max_sweeps : sweeps;
    done = pintle::solveInVelocity(island, blocks, rows, options, sweep, most, velocities);
    count(done, int(those.size()));
  };
  // Again, where bodies swing fast, and under another load than was foreseen.
  const auto attempt = [&](Sweep sweep) {
    for (const Component* of : those) begin(*of);
    solve(sweep);
    bool again = false;
    for (const Component* of : those)
      again = foreseeLoad(island, *of, options.stable_swing, memoryOf(*of).work) || again;
    if (again) solve(sweep);
    return done.is_solvable && gainInVelocity(those, rows) <= options.ledger_share * largest;
  };
  // Stops that many bodies meet at once may give back more than they took (Kane 1984): then they give back nothing.
  const auto attemptWithoutRebounds = [&](Sweep sweep) {
    bool any = false;
    for (const Component* of : those) any = stopRebounds(island, *of) || any;
    return any && attempt(sweep);
  };
  const bool is_passive = attempt(Sweep::all_at_once) || attempt(Sweep::bounds_one_by_one) ||
                          attemptWithoutRebounds(Sweep::bounds_one_by_one);
  if (!is_passive) {
    ++report.one_by_one;
    attempt(Sweep::one_by_one);
  }
  if (!done.converged) report.not_converged += int(those.size());
  for (const Component* of : those) {
    ComponentMemory& kept = memoryOf(*of);
    kept.has_factor = is_passive;
    kept.tolerance = done.converged ? options.pose_tolerance : options.loose_pose_tolerance;
    kept.holds_end = false;
    kept.work_done = rows.empty() ? workOfJoints(island, *of, kept.work)
                                  : workAmongContacts(island, *of, kept.work);
  }
}

void PassiveJointSolver::State::finish(const Component& component, ComponentMemory& kept) {
  Workspace& work = kept.work;
  double sum = 0;
  for (const Vector6d& v : work.v) sum += v.sum();
  if (!std::isfinite(sum)) {  // overflow: nothing acts in this step
    kept.forget();
    kept.begin(island, component);
    return;
  }
  PoseChange* const changes = pose_changes.data() + component.first_body;
  if (!kept.holds_end || isOpen(island, component))
    correctPoses(island, component, options, kept.tolerance, work, kept.K, kept.has_factor,
                 changes);
  kept.work_done += workOfPoses(island, component, changes);
  kept.work_done += balance(island, component, options, kept, changes);
  kept.ledger.book(kept.work_done, options.ledger_share);
  kept.keep(island, component);
  pintle::report(island, component, work);
}

// `of`: so many components, solved together.
void PassiveJointSolver::State::count(const SolveReport& done, int of) {
  report.steps += done.steps * of;
  report.factors += done.factors;
  report.error = std::max(report.error, done.error);
}

// Of each component: whether a contact is on one of its bodies.
std::vector<char> PassiveJointSolver::State::findTouched() const {
  std::vector<char> body(island.bodies.size(), false), touched;
  for (const ContactRow& row : contacts)
    for (const int i : row.body)
      if (i >= 0) body[size_t(i)] = true;
  for (const Component& component : components) {
    const auto first = body.begin() + component.first_body, last = first + component.bodies;
    touched.push_back(std::find(first, last, true) != last);
  }
  return touched;
}

// A joint breaks at what it bears when all else is solved, and the step is then solved without it.
void PassiveJointSolver::State::solveAll() {
  const std::vector<char> touched = findTouched();
  std::vector<const Component*> among_contacts;
  for (size_t c = 0; c < components.size(); ++c) {
    const Component& component = components[c];
    remember(island, component, slotOf(component));
    ComponentMemory& kept = memoryOf(component);
    kept.stretchSprings(island, component);
    kept.ledger.begin(island, component, options.ledger_share);
    if (touched[c]) among_contacts.push_back(&component);
  }
  const auto breaks = [&](const Component& component) {
    return breakOverloaded(island, component, memoryOf(component).work);
  };
  for (size_t c = 0; c < components.size(); ++c) {
    if (touched[c]) continue;
    do {
      solveAlone(components[c]);
    } while (breaks(components[c]));
  }
  for (bool again = !contacts.empty(); again;) {
    solveInVelocity(among_contacts, contacts);
    again = false;
    for (const Component* of : among_contacts) again = breaks(*of) || again;
  }
  if (contacts.empty()) {  // who has no joint with rows is free
    velocities.clear();
    for (const IslandBody& body : island.bodies) velocities.push_back(body.v_free);
  }
  for (const Component& component : components) {
    ComponentMemory& kept = memoryOf(component);
    finish(component, kept);
    std::copy(kept.work.v.begin(), kept.work.v.end(), velocities.begin() + component.first_body);
  }
}

PassiveJointSolver::PassiveJointSolver() : m_state(new State) {}
PassiveJointSolver::~PassiveJointSolver() = default;
SolverOptions& PassiveJointSolver::options() { return m_state->options; }
const StepReport& PassiveJointSolver::lastStep() const { return m_state->report; }
int PassiveJointSolver::getNumRemembered() const { return int(m_state->memory.size()); }

// Once a step of the world. What no island has used in the last one is forgotten: its joints sleep, or are gone.
void PassiveJointSolver::prepareSolve(int, int) {
  m_state->report = {};
  auto& memory = m_state->memory;
  for (auto of = memory.begin(); of != memory.end();) {
    const bool is_used = of->second != nullptr && of->second->is_used;
    if (is_used) of->second->is_used = false;
    of = is_used ? std::next(of) : memory.erase(of);
  }
}

void PassiveJointSolver::convertJoints(btTypedConstraint** constraints, int numConstraints,
                                       const btContactSolverInfo& info) {
  m_tmpConstraintSizesPool.resizeNoInitialize(0);
  m_tmpSolverNonContactConstraintPool.resizeNoInitialize(0);
  State& state = *m_state;
  state.builder.begin(info);
  for (int i = 0; i < numConstraints; ++i) {
    btTypedConstraint& constraint = *constraints[i];
    constraint.buildJacobian();
    constraint.internalSetAppliedImpulse(0);
    if (btJointFeedback* feedback = constraint.getJointFeedback())
      for (btVector3* of : {&feedback->m_appliedForceBodyA, &feedback->m_appliedTorqueBodyA,
                            &feedback->m_appliedForceBodyB, &feedback->m_appliedTorqueBodyB})
        of->setZero();
    if (!constraint.isEnabled()) continue;
    const int a = getOrInitSolverBody(constraint.getRigidBodyA(), info.m_timeStep),
              b = getOrInitSolverBody(constraint.getRigidBodyB(), info.m_timeStep);
    state.builder.add(constraint, m_tmpSolverBodyPool, a, b);
  }
  state.builder.finish(state.components);
}

void PassiveJointSolver::addContacts(btConstraintArray& pool, bool are_friction) {
  State& state = *m_state;
  const Vector6d zero = Vector6d::Zero();
  for (int i = 0; i < pool.size(); ++i) {
    btSolverConstraint& from = pool[i];
    ContactRow row;
    // Bullet's target of a contact has the velocities of bodies that their owner moves.
    const auto bodyOf = [&](int number) {
      return std::max(state.builder.body(m_tmpSolverBodyPool, number),
                      Island::unmoved(Island::at_rest));
    };
    row.body = {bodyOf(from.m_solverBodyIdA), bodyOf(from.m_solverBodyIdB)};
    row.J = {inDouble(from.m_contactNormal1), inDouble(from.m_relpos1CrossNormal),
             inDouble(from.m_contactNormal2), inDouble(from.m_relpos2CrossNormal)};
    // Bullet has both multiplied by its own 1 / K.
    const double inverse_K = double(from.m_jacDiagABInv);
    const auto free = [&](int body) {
      return body < 0 ? zero : state.island.bodies[size_t(body)].v_free;
    };
    row.target = inverse_K > 0 ? double(from.m_rhs) / inverse_K +
                                     row.J.along(free(row.body[0]), free(row.body[1]))
                               : 0;
    row.softness = inverse_K > 0 ? double(from.m_cfm) / inverse_K : 0;
    row.lower = double(from.m_lowerLimit);
    row.upper = double(from.m_upperLimit);
    row.normal = are_friction ? from.m_frictionIndex : -1;
    row.friction = double(from.m_friction);
    row.impulse = double(from.m_appliedImpulse);
    row.from = &from;
    state.contacts.push_back(row);
  }
}

// Contacts need many passes to find a heavy load on light, jointed bodies. The warm start spreads them over the steps, so it must keep
// all of the impulse.
btScalar PassiveJointSolver::solveGroupCacheFriendlySetup(
    btCollisionObject** bodies, int numBodies, btPersistentManifold** manifolds, int numManifolds,
    btTypedConstraint** constraints, int numConstraints, const btContactSolverInfo& info,
    btIDebugDraw* drawer) {
  btContactSolverInfo with_all = info;
  if (numConstraints > 0) with_all.m_warmstartingFactor = 1;
  return btSequentialImpulseConstraintSolver::solveGroupCacheFriendlySetup(
      bodies, numBodies, manifolds, numManifolds, constraints, numConstraints, with_all, drawer);
}

btScalar PassiveJointSolver::solveGroupCacheFriendlyIterations(
    btCollisionObject** bodies, int numBodies, btPersistentManifold** manifolds, int numManifolds,
    btTypedConstraint** constraints, int numConstraints, const btContactSolverInfo& info,
    btIDebugDraw* drawer) {
  State& state = *m_state;
  state.pose_changes.clear();
  if (state.components.empty())
    return btSequentialImpulseConstraintSolver::solveGroupCacheFriendlyIterations(
        bodies, numBodies, manifolds, numManifolds, constraints, numConstraints, info, drawer);
  solveGroupCacheFriendlySplitImpulseIterations(bodies, numBodies, manifolds, numManifolds,
                                                constraints, numConstraints, info, drawer);
  for (IslandBody& of : state.island.bodies) {
    const btSolverBody& from = m_tmpSolverBodyPool[of.solver_body];
    of.push << inDouble(from.m_pushVelocity),
        double(info.m_splitImpulseTurnErp) * inDouble(from.m_turnVelocity);
  }
  state.contacts.clear();
  addContacts(m_tmpSolverContactConstraintPool, false);
  addContacts(m_tmpSolverContactFrictionConstraintPool, true);
  addContacts(m_tmpSolverContactRollingFrictionConstraintPool, true);
  state.pose_changes.assign(state.island.bodies.size(), PoseChange::Zero());
  state.sweeps = info.m_numIterations;
  state.report.components += int(state.components.size());
  state.solveAll();
  for (size_t i = 0; i < state.island.bodies.size(); ++i) {
    const IslandBody& body = state.island.bodies[i];
    btSolverBody& to = m_tmpSolverBodyPool[body.solver_body];
    const Vector6d change = state.velocities[i] - body.v_free;
    to.m_deltaLinearVelocity = btVector3(Scalar(change[0]), Scalar(change[1]), Scalar(change[2]));
    to.m_deltaAngularVelocity = btVector3(Scalar(change[3]), Scalar(change[4]), Scalar(change[5]));
  }
  for (const ContactRow& row : state.contacts) row.from->m_appliedImpulse = Scalar(row.impulse);
  return 0;
}

btScalar PassiveJointSolver::solveGroupCacheFriendlyFinish(btCollisionObject** bodies,
                                                           int numBodies,
                                                           const btContactSolverInfo& info) {
  const btScalar result =
      btSequentialImpulseConstraintSolver::solveGroupCacheFriendlyFinish(bodies, numBodies, info);
  State& state = *m_state;
  for (size_t i = 0; i < state.pose_changes.size(); ++i)
    if (!state.pose_changes[i].isZero(0))
      move(*const_cast<btRigidBody*>(state.island.bodies[i].body), state.pose_changes[i]);
  return result;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

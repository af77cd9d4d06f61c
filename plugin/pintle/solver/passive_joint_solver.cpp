#include <pintle/solver/passive_joint_solver.h>

#include <pintle/solver/chord.h>
#include <pintle/solver/component_memory.h>
#include <pintle/solver/contacts.h>
#include <pintle/solver/island_builder.h>
#include <pintle/solver/joint_access.h>
#include <pintle/solver/joint_report.h>
#include <pintle/solver/pose_correction.h>
#include <pintle/solver/relaxation.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <unordered_map>

namespace pintle {
inline namespace PINTLE_PRECISION {
struct PassiveJointSolver::State {
  SolverOptions options;
  StepReport report;
  Island island;
  IslandBuilder builder{island};
  std::vector<Component> components;
  std::unordered_map<const btTypedConstraint*, std::unique_ptr<ComponentMemory>> memory;
  std::vector<PoseChange> pose_changes;
  std::vector<Vector6d> velocities;  ///< with which bodies end the step
  std::vector<ContactRow> contacts;

  void solve(const Component& component);
  bool stopRebounds(const Component& component);
  void finish(const Component& component, ComponentMemory& kept);
  void beginVelocities();
  std::vector<char> findTouched() const;
  void count(const NewtonReport& done, int components);
  std::unique_ptr<ComponentMemory>& slotOf(const Component& component) {
    return memory[island.joints[size_t(component.first_joint)].constraint];
  }
  ComponentMemory& memoryOf(const Component& component) { return *slotOf(component); }
  void solveAmongContacts(const std::vector<char>& touched);
  void relax(std::vector<ContactPart>& parts, std::vector<ContactRow>& rows);
  void solveAll();
};

void PassiveJointSolver::State::solve(const Component& component) {
  ComponentMemory& kept = memoryOf(component);
  Workspace& work = kept.work;
  work.external.clear();
  const auto begin = [&] { kept.begin(island, component); };
  const auto attempt = [&](double horizon) {
    work.now.horizon = horizon;
    const NewtonReport done = Newton(island, component, options, kept.fronts, work).run();
    count(done, 1);
    return done.converged;
  };
  begin();
  kept.findStiffness(island, component, options.stable_swing);
  const NewtonReport chord = solveByChord(island, component, options, kept.fronts, kept.K, work);
  count(chord, 1);
  kept.is_K_of_start = chord.converged;
  if (chord.converged) {
    kept.work_done = workOfJoints(island, component, work.now);
    if (kept.ledger.mayGive(kept.work_done, options.ledger_share)) return;
  }
  ++report.second_tier;
  kept.is_K_of_start = false;
  const auto solveByGradient = [&] {
    begin();
    if (attempt(island.dt)) return true;
    // In velocity alone, which is a linear problem: at the end of the step they are open.
    ++report.not_converged;
    begin();
    return attempt(0);
  };
  const auto gains = [&] {
    return kept.ledger.isMuch(gainOverForces(island, component, work.now), options.ledger_share);
  };
  bool found = solveByGradient();
  // Stops that many bodies meet at once may give back more than they took (Kane 1984): then they give back nothing.
  if (found && gains() && stopRebounds(component)) found = solveByGradient();
  if (!found || gains()) {
    std::vector<ContactPart> alone = {{&component, &kept.fronts, &work}};
    std::vector<ContactRow> no_contacts;
    relax(alone, no_contacts);
  }
  kept.work_done = workOfJoints(island, component, work.now);
}

void PassiveJointSolver::State::finish(const Component& component, ComponentMemory& kept) {
  Workspace& work = kept.work;
  double sum = 0;
  for (const BodyAtEnd& body : work.now.bodies) sum += body.v.sum();
  if (!std::isfinite(sum)) {  // overflow: nothing acts in this step
    kept.forget();
    kept.begin(island, component);
    return;
  }
  kept.ledger.book(kept.work_done, options.ledger_share);
  kept.keep(island, component);
  pintle::report(island, component, work.now);
  correctPoses(island, component, options, work, kept.K, kept.is_K_of_start, pose_changes);
}

bool PassiveJointSolver::State::stopRebounds(const Component& component) {
  bool any = false;
  for (int c = component.first_joint; c < component.first_joint + component.joints; ++c) {
    const IslandJoint& joint = island.joints[size_t(c)];
    for (int i = 0; i < joint.rows; ++i)
      any = island.rows[size_t(joint.first_row + i)].law.stopRebound() || any;
  }
  return any;
}

// Contacts take energy, and so does the discrete gradient: it alone acts among them.
void PassiveJointSolver::State::solveAmongContacts(const std::vector<char>& touched) {
  std::vector<ContactPart> parts;
  double peak = 0;
  std::vector<char> in_parts(island.bodies.size(), false);
  for (size_t c = 0; c < components.size(); ++c) {
    if (!touched[c]) continue;
    ComponentMemory& kept = memoryOf(components[c]);
    kept.begin(island, components[c]);
    kept.work_done = 0;
    kept.is_K_of_start = false;
    peak += kept.ledger.largest();
    parts.push_back({&components[c], &kept.fronts, &kept.work});
    std::fill_n(in_parts.begin() + components[c].first_body, components[c].bodies, true);
  }
  for (size_t i = 0; i < island.bodies.size(); ++i)
    if (!in_parts[i]) peak += gainOf(island.bodies[i], Vector6d::Zero(), island.bodies[i].v_free);
  const auto attempt = [&] {
    beginVelocities();
    const NewtonReport done =
        pintle::solveAmongContacts(island, parts, contacts, options, velocities);
    count(done, int(parts.size()));
    report.second_tier += int(parts.size());
    return done.converged;
  };
  // Contacts may give what they aim at: rebounds, and ways out of each other.
  const auto gains = [&] {
    double gain = 0;
    for (ContactPart& part : parts) gain += gainOverForces(island, *part.component, part.work->now);
    for (size_t i = 0; i < island.bodies.size(); ++i)
      if (!in_parts[i]) gain += gainOf(island.bodies[i], island.bodies[i].v_free, velocities[i]);
    for (const ContactRow& row : contacts) gain -= std::fmax(row.impulse * row.target, 0);
    return !(gain <= options.ledger_share * peak);
  };
  bool converged = attempt();
  if (converged && gains()) {
    bool any = false;
    for (ContactPart& part : parts) any = stopRebounds(*part.component) || any;
    if (any) {
      for (ContactPart& part : parts) memoryOf(*part.component).begin(island, *part.component);
      converged = attempt();
    }
  }
  if (!converged) report.not_converged += int(parts.size());
  if (gains()) relax(parts, contacts);
}

// Parts and contacts from the velocities that forces lead to.
void PassiveJointSolver::State::relax(std::vector<ContactPart>& parts,
                                      std::vector<ContactRow>& rows) {
  ++report.relaxed;
  beginVelocities();
  pintle::relax(island, parts, rows, options.max_contact_sweeps, velocities);
}

void PassiveJointSolver::State::beginVelocities() {
  velocities.clear();
  for (const IslandBody& body : island.bodies) velocities.push_back(body.v_free);
}

// `of`: so many components, solved together.
void PassiveJointSolver::State::count(const NewtonReport& done, int of) {
  report.newton_steps += done.steps * of;
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
  beginVelocities();
  const std::vector<char> touched = findTouched();
  for (const Component& component : components) {
    remember(island, component, slotOf(component));
    ComponentMemory& kept = memoryOf(component);
    kept.stretchSprings(island, component);
    kept.ledger.begin(island, component, options.ledger_share);
  }
  const auto breaks = [&](size_t c) {
    return breakOverloaded(island, components[c], memoryOf(components[c]).work.now);
  };
  for (size_t c = 0; c < components.size(); ++c) {
    if (touched[c]) continue;
    do solve(components[c]);
    while (breaks(c));
  }
  for (bool again = !contacts.empty(); again;) {
    solveAmongContacts(touched);
    again = false;
    for (size_t c = 0; c < components.size(); ++c) again = (touched[c] && breaks(c)) || again;
  }
  for (const Component& component : components) {
    ComponentMemory& kept = memoryOf(component);
    finish(component, kept);
    for (int i = 0; i < component.bodies; ++i)
      velocities[size_t(component.first_body + i)] = kept.work.now.bodies[size_t(i)].v;
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
  state.contacts.clear();
  addContacts(m_tmpSolverContactConstraintPool, false);
  addContacts(m_tmpSolverContactFrictionConstraintPool, true);
  addContacts(m_tmpSolverContactRollingFrictionConstraintPool, true);
  state.pose_changes.assign(state.island.bodies.size(), PoseChange::Zero());
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
  for (size_t i = 0; i < state.pose_changes.size(); ++i) {
    const Vector6d& change = state.pose_changes[i];
    if (change.isZero()) continue;
    auto* const body = const_cast<btRigidBody*>(state.island.bodies[i].body);
    const Turn turn(change.tail<3>(), 1);
    const Eigen::Quaterniond q(turn.rotation());
    btTransform to = body->getWorldTransform();
    to.setOrigin(to.getOrigin() +
                 btVector3(Scalar(change[0]), Scalar(change[1]), Scalar(change[2])));
    to.setRotation((btQuaternion(Scalar(q.x()), Scalar(q.y()), Scalar(q.z()), Scalar(q.w())) *
                    to.getRotation())
                       .normalized());
    body->setWorldTransform(to);
  }
  return result;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

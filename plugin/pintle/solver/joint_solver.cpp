#include <pintle/solver/joint_solver.h>

#include <pintle/solver/bullet/joint_access.h>
#include <pintle/solver/bullet/joint_report.h>
#include <pintle/solver/cache/world_memory.h>
#include <pintle/solver/linalg/memory.h>
#include <pintle/solver/solve/step.h>
#include <pintle/upgrade/memory_of_worlds.h>

#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>

#include <algorithm>
#include <vector>

namespace pintle {
inline namespace PINTLE_PRECISION {

template <class BulletSolver>
JointSolver<BulletSolver>::JointSolver()
    : m_islands(new IslandStep), m_memory(new MemoryOfWorlds<WorldMemory>) {}
template <class BulletSolver>
JointSolver<BulletSolver>::~JointSolver() = default;
template <class BulletSolver>
void JointSolver<BulletSolver>::setOptions(const SolverOptions& options) {
  check(options);
  m_islands->setOptions(options);
}
template <class BulletSolver>
const SolverOptions& JointSolver<BulletSolver>::options() const {
  return m_islands->options();
}
template <class BulletSolver>
std::string JointSolver<BulletSolver>::whyIgnored(const btTypedConstraint& constraint) const {
  return (*m_memory)->upgradedJoints().whyIgnored(constraint);
}
template <class BulletSolver>
StepReport JointSolver<BulletSolver>::lastStep() const {
  return (*m_memory)->report();
}
template <class BulletSolver>
int JointSolver<BulletSolver>::getNumRemembered() const {
  return (*m_memory)->size();
}
template <class BulletSolver>
size_t JointSolver<BulletSolver>::getMemory() const {
  return (*m_memory)->bytes() + m_islands->bytes() + bytesOf(m_touched, m_upgraded);
}

template <class BulletSolver>
void JointSolver<BulletSolver>::prepareSolve(int, int) {
  (*m_memory)->beginStep();
}

template <class BulletSolver>
void JointSolver<BulletSolver>::shareMemoryOf(const JointSolver& other) {
  m_memory->share(*other.m_memory);
}

namespace {

// Islands in which something touches something move as Bullet moves them. `touched`: room for their numbers.
void touch(Span<btCollisionObject*> bodies, Span<btPersistentManifold*> manifolds, double dt,
           WorldMemory& memory, std::vector<int>& touched) {
  touched.clear();
  for (const btPersistentManifold* manifold : manifolds)
    if (manifold->getNumContacts() > 0)
      for (const btCollisionObject* body : {manifold->getBody0(), manifold->getBody1()})
        if (!body->isStaticOrKinematicObject()) touched.push_back(body->getIslandTag());
  std::sort(touched.begin(), touched.end());
  for (btCollisionObject* object : bodies) {
    btRigidBody* const body = btRigidBody::upcast(object);
    if (body == nullptr || body->isStaticOrKinematicObject() ||
        !std::binary_search(touched.begin(), touched.end(), body->getIslandTag()))
      continue;
    MotionsOfBody& motions = memory.motionsOf(*body);
    motions.is_touched = true;
    Vector6d v;
    v << inDouble(body->getLinearVelocity()), inDouble(body->getAngularVelocity());
    if (motions.lastOf(*body, v, dt).gravity == MotionOfBody::Gravity::in_halves) {
      const Vector3d back = v.head<3>() - motions.last.second_half;
      body->setLinearVelocity(btVector3(Scalar(back[0]), Scalar(back[1]), Scalar(back[2])));
    }
    motions.last = {};
  }
}

}  // namespace

template <class BulletSolver>
void JointSolver<BulletSolver>::enter(const btDispatcher* world, btCollisionObject** bodies,
                                      int numBodies, btPersistentManifold** manifolds,
                                      int numManifolds, btTypedConstraint** constraints,
                                      int numConstraints, const btContactSolverInfo& info) {
  if (world != nullptr) m_memory->enter(*world);
  if (options().second_order)
    touch({bodies, size_t(numBodies)}, {manifolds, size_t(numManifolds)}, double(info.m_timeStep),
          **m_memory, m_touched);
  m_upgraded.assign(size_t(numConstraints), nullptr);
  if (m_upgrades) (*m_memory)->upgradedJoints().find(constraints, numConstraints, m_upgraded);
}

template <class BulletSolver>
void JointSolver<BulletSolver>::leave() {
  for (UpgradedJoint* of : m_upgraded)
    if (of != nullptr) of->markSolved();
}

template <class BulletSolver>
btScalar JointSolver<BulletSolver>::solveGroup(btCollisionObject** bodies, int numBodies,
                                               btPersistentManifold** manifolds, int numManifolds,
                                               btTypedConstraint** constraints, int numConstraints,
                                               const btContactSolverInfo& info,
                                               btIDebugDraw* drawer, btDispatcher* dispatcher) {
  enter(dispatcher, bodies, numBodies, manifolds, numManifolds, constraints, numConstraints, info);
  const btScalar result =
      BulletSolver::solveGroup(bodies, numBodies, manifolds, numManifolds, constraints,
                               numConstraints, info, drawer, dispatcher);
  leave();
  return result;
}

namespace {

// Of a joint and its rows: what most have.
constexpr size_t joint_bytes = 2 * sizeof(Joint), rows_bytes = 4 * sizeof(Row);

// What a joint knows the places of.
void prefetchOf(btTypedConstraint& joint) {
  prefetch<sizeof(btRigidBody)>(&joint.getRigidBodyA());
  prefetch<sizeof(btRigidBody)>(&joint.getRigidBodyB());
  if (const Joint* const ours = JointAccess::ours(joint))
    prefetch<rows_bytes>(&JointAccess::firstRow(*ours));
}

}  // namespace

template <class BulletSolver>
void JointSolver<BulletSolver>::convertJoints(btTypedConstraint** constraints, int numConstraints,
                                              const btContactSolverInfo& info) {
  this->m_tmpConstraintSizesPool.resizeNoInitialize(0);
  this->m_tmpSolverNonContactConstraintPool.resizeNoInitialize(0);
  m_islands->begin(info);
  StepReport ignored;
  for (int i = 0; i < numConstraints; ++i) {
    btTypedConstraint& constraint = *constraints[i];
    // Memory takes about as long as one joint does; and a joint must be there to know its bodies.
    if (i + 4 < numConstraints) prefetch<joint_bytes>(constraints[i + 4]);
    if (i + 2 < numConstraints) prefetchOf(*constraints[i + 2]);
    UpgradedJoint* const upgraded = m_upgraded[size_t(i)];
    (upgraded != nullptr ? *upgraded : constraint).buildJacobian();
    clearImpulses(constraint);
    if (!constraint.isEnabled()) continue;
    if (upgraded != nullptr)
      ignored.ignored_settings += JointAccess::ignoredSettings(upgraded->joint());
    const int a = this->getOrInitSolverBody(constraint.getRigidBodyA(), info.m_timeStep),
              b = this->getOrInitSolverBody(constraint.getRigidBodyB(), info.m_timeStep);
    m_islands->addJoint(constraint, upgraded != nullptr ? &upgraded->joint() : nullptr,
                        this->m_tmpSolverBodyPool, a, b);
  }
  if (ignored.ignored_settings > 0) (*m_memory)->add(ignored);
  m_has_joints = m_islands->endJoints();
}

// Contacts need many passes to find a heavy load on light, jointed bodies. The warm start spreads them over the steps, so it must keep
// all of the impulse.
template <class BulletSolver>
btScalar JointSolver<BulletSolver>::solveGroupCacheFriendlySetup(
    btCollisionObject** bodies, int numBodies, btPersistentManifold** manifolds, int numManifolds,
    btTypedConstraint** constraints, int numConstraints, const btContactSolverInfo& info,
    btIDebugDraw* drawer) {
  btContactSolverInfo with_all = info;
  if (numConstraints > 0) with_all.m_warmstartingFactor = 1;
  return BulletSolver::solveGroupCacheFriendlySetup(bodies, numBodies, manifolds, numManifolds,
                                                    constraints, numConstraints, with_all, drawer);
}

template <class BulletSolver>
btScalar JointSolver<BulletSolver>::solveGroupCacheFriendlyIterations(
    btCollisionObject** bodies, int numBodies, btPersistentManifold** manifolds, int numManifolds,
    btTypedConstraint** constraints, int numConstraints, const btContactSolverInfo& info,
    btIDebugDraw* drawer) {
  if (!m_has_joints)
    return BulletSolver::solveGroupCacheFriendlyIterations(
        bodies, numBodies, manifolds, numManifolds, constraints, numConstraints, info, drawer);
  SolverBodies& of = this->m_tmpSolverBodyPool;
  m_islands->addContacts(this->m_tmpSolverContactConstraintPool, of, false);
  m_islands->addContacts(this->m_tmpSolverContactFrictionConstraintPool, of, true);
  m_islands->addContacts(this->m_tmpSolverContactRollingFrictionConstraintPool, of, true);
  m_islands->solve(info, of, passOverOthers(info), **m_memory);
  return 0;
}

template <class BulletSolver>
btScalar JointSolver<BulletSolver>::solveGroupCacheFriendlyFinish(btCollisionObject** bodies,
                                                                  int numBodies,
                                                                  const btContactSolverInfo& info) {
  if (options().second_order && !hasOthers())
    m_islands->moveFreely(this->m_tmpSolverBodyPool, **m_memory);
  const btScalar result = BulletSolver::solveGroupCacheFriendlyFinish(bodies, numBodies, info);
  m_islands->movePoses();
  return result;
}

template class JointSolver<btSequentialImpulseConstraintSolver>;
template class JointSolver<btMultiBodyConstraintSolver>;

}  // namespace PINTLE_PRECISION
}  // namespace pintle

// All that is public of the exact solvers.
#include <pintle/joints/ball_joint.h>
#include <pintle/solver/exact_joint_solver.h>
#include <pintle/solver/exact_joint_solver_pool.h>
#include <pintle/solver/exact_multi_body_joint_solver.h>
#include <pintle/solver/step_log.h>

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>
#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>

#include <sstream>

namespace {

// A pendulum falls for a second.
template <class Solver, class World>
bool holds_on() {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  Solver solver;
  pintle::SolverOptions options = solver.options();
  options.max_iterations = 20;
  solver.setOptions(options);
  World world(&dispatcher, &broadphase, &solver, &configuration);
  if (!pintle::usesExactSolver(world) || !pintle::whyNotExact(world).empty()) return false;

  btBoxShape shape(btVector3(btScalar(0.5), btScalar(0.1), btScalar(0.1)));
  btVector3 inertia;
  shape.calculateLocalInertia(1, inertia);
  btRigidBody body(1, nullptr, &shape, inertia);
  body.setActivationState(DISABLE_DEACTIVATION);
  world.addRigidBody(&body);
  pintle::BallJoint joint(body, btVector3(btScalar(0.5), 0, 0));
  world.addConstraint(&joint, true);
  std::ostringstream text;
  pintle::StepLog log(world, text);
  for (int step = 0; step < 60; ++step) {
    world.stepSimulation(btScalar(1) / 60, 0);
    log.write();
  }
  const btVector3 pivot = body.getCenterOfMassTransform()(joint.getPivotInA());
  const pintle::StepReport report = pintle::lastStep(world);
  world.removeConstraint(&joint);
  world.removeRigidBody(&body);
  return (pivot - joint.getPivotInB()).length() < btScalar(1e-5) && report.components == 1 &&
         solver.getNumRemembered() == 1 && solver.getMemory() > 0 && text.str().size() > 60;
}

}  // namespace

bool can_solve_exactly() {
  return holds_on<pintle::ExactJointSolver, btDiscreteDynamicsWorld>() &&
         holds_on<pintle::ExactMultiBodyJointSolver, btMultiBodyDynamicsWorld>();
}

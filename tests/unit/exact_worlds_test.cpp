// The exact solver in all kinds of Bullet's worlds: of multibodies, of many threads, and where Bullet ignores it.
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/solver/exact_joint_solver.h>
#include <pintle/solver/exact_joint_solver_pool.h>
#include <pintle/solver/exact_multi_body_joint_solver.h>

#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorldMt.h>
#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointLimitConstraint.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointMotor.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>
#include <BulletDynamics/Featherstone/btMultiBodyPoint2Point.h>
#include <btBulletDynamicsCommon.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cstring>
#include <functional>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "bodies.h"
#include "cables.h"
#include "physics_support.h"
#include "support.h"

namespace exact_worlds {
namespace {

using physics::rounding;
using support::scalar;
using support::vec;

constexpr double dt = 1. / 60;
constexpr double held = 2e-9;  // m: of three rows, each to 1e-9

struct Bullet {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
};

/// Rigid bodies and their joints, in any world.
class Bodies : public support::Bodies {
 public:
  using support::Bodies::Bodies;

  /// Links of 0.5 m and 1 kg, along x from `start`, where a ball holds the first one. Returns the last one.
  btRigidBody& addChain(int links, const btVector3& start, double load = 1) {
    btRigidBody* last = &add(0, vec(0.1, 0.1, 0.1), start);
    for (int i = 0; i < links; ++i) {
      btRigidBody& link =
          add(i == links - 1 ? load : 1, vec(0.25, 0.05, 0.05), start + vec(0.5 * i + 0.25, 0, 0));
      join(std::make_unique<pintle::BallJoint>(*last, link, vec(i > 0 ? 0.25 : 0, 0, 0),
                                               vec(-0.25, 0, 0)));
      last = &link;
    }
    return *last;
  }
  std::vector<btScalar> state() const {
    std::vector<btScalar> all;
    for (const auto& body : bodies)
      for (const btVector3& of :
           {body->getCenterOfMassPosition(), body->getLinearVelocity(), body->getAngularVelocity(),
            body->getCenterOfMassTransform().getBasis()[0]})
        all.insert(all.end(), {of.x(), of.y(), of.z()});
    return all;
  }
};

/// An arm of two links of 1 m and 2 kg that turn about z, on a base that is fixed at x; its links collide.
class Arm {
 public:
  Arm(btMultiBodyDynamicsWorld& world, const btVector3& x)
      : tree(2, 0, btVector3(0, 0, 0), true, false), m_world(world), m_shape(vec(0.5, 0.1, 0.1)) {
    btVector3 inertia;
    m_shape.calculateLocalInertia(2, inertia);
    const btQuaternion none = btQuaternion::getIdentity();
    for (int i = 0; i < 2; ++i)
      tree.setupRevolute(i, 2, inertia, i - 1, none, vec(0, 0, 1), vec(i > 0 ? 0.5 : 0, 0, 0),
                         vec(0.5, 0, 0), true);
    tree.setBasePos(x);
    tree.finalizeMultiDof();
    tree.setLinearDamping(0);
    tree.setAngularDamping(0);
    tree.setCanSleep(false);
    world.addMultiBody(&tree);
    for (int i = 0; i < 2; ++i) {
      m_colliders.push_back(std::make_unique<btMultiBodyLinkCollider>(&tree, i));
      m_colliders.back()->setCollisionShape(&m_shape);
      m_colliders.back()->setActivationState(DISABLE_DEACTIVATION);
      tree.getLink(i).m_collider = m_colliders.back().get();
      world.addCollisionObject(m_colliders.back().get(), 2, -1 ^ 2);
    }
    btAlignedObjectArray<btQuaternion> turns;
    btAlignedObjectArray<btVector3> origins;
    tree.forwardKinematics(turns, origins);
    tree.updateCollisionObjectWorldTransforms(turns, origins);
  }
  ~Arm() {
    for (const auto& row : m_rows) m_world.removeMultiBodyConstraint(row.get());
    for (const auto& collider : m_colliders) m_world.removeCollisionObject(collider.get());
    m_world.removeMultiBody(&tree);
  }
  Arm(const Arm&) = delete;
  Arm& operator=(const Arm&) = delete;

  void constrain(std::unique_ptr<btMultiBodyConstraint> row) {
    m_world.addMultiBodyConstraint(row.get());
    m_rows.push_back(std::move(row));
  }
  std::vector<btScalar> state() const {
    return {tree.getJointPos(0), tree.getJointPos(1), tree.getJointVel(0), tree.getJointVel(1)};
  }

  btMultiBody tree;

 private:
  btMultiBodyDynamicsWorld& m_world;
  btBoxShape m_shape;
  std::vector<std::unique_ptr<btMultiBodyLinkCollider>> m_colliders;
  std::vector<std::unique_ptr<btMultiBodyConstraint>> m_rows;
};

template <class Solver>
struct MultiBodyWorld : Bullet {
  Solver solver;
  btMultiBodyDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
};

TEST(ExactMultiBodySolver, HoldsChainsBesideAnArm) {
  MultiBodyWorld<pintle::ExactMultiBodyJointSolver> of;
  Bodies bodies(of.world);
  bodies.addChain(10, vec(0, 5, 0));
  bodies.addChain(5, vec(0, -5, 0), 100);
  Arm arm(of.world, vec(0, 0, 0));
  arm.constrain(std::make_unique<btMultiBodyJointMotor>(&arm.tree, 0, 2, 5));
  for (int i = 0; i < 300; ++i) {
    of.world.stepSimulation(scalar(dt), 0, scalar(dt));
    ASSERT_LE(bodies.largestGap(), rounding(1e-4, held)) << i;
  }
  EXPECT_NEAR(double(arm.tree.getJointVel(0)), 2, 1e-2) << "it turns";
  EXPECT_EQ(of.solver.lastStep().components, 2);
}

/// m: how far the hinge is open.
double gapOf(const pintle::QuaternionHinge& hinge) {
  return double(
      (hinge.getRigidBodyA().getCenterOfMassTransform() * hinge.getFrameOffsetA().getOrigin() -
       hinge.getRigidBodyB().getCenterOfMassTransform() * hinge.getFrameOffsetB().getOrigin())
          .length());
}

TEST(ExactMultiBodySolver, AnArmPushesADoorThatHolds) {
  MultiBodyWorld<pintle::ExactMultiBodyJointSolver> of;
  Bodies bodies(of.world);
  btRigidBody& wall = bodies.add(0, vec(0.1, 0.1, 0.1), vec(1, 1, 0));
  btRigidBody& door = bodies.add(20, vec(0.6, 0.05, 1), vec(1.65, 1, 0), true);
  door.setFriction(scalar(0.5));
  auto made = std::make_unique<pintle::QuaternionHinge>(wall, door, vec(0, 0, 0), vec(-0.65, 0, 0),
                                                        vec(0, 0, 1), vec(0, 0, 1));
  pintle::QuaternionHinge& hinge = *made;
  bodies.join(std::move(made));
  Arm arm(of.world, vec(0, 0.5, 0));
  arm.constrain(std::make_unique<btMultiBodyJointMotor>(&arm.tree, 0, 1, 5));
  arm.constrain(std::make_unique<btMultiBodyJointMotor>(&arm.tree, 1, 0, 5));
  double turned = 0;
  for (int i = 0; i < 120; ++i) {
    of.world.stepSimulation(scalar(dt), 0, scalar(dt));
    ASSERT_LE(gapOf(hinge), rounding(1e-5, held)) << i;
    turned = std::max(turned, std::abs(double(hinge.getHingeAngle())));
  }
  EXPECT_GT(turned, 0.3);
  EXPECT_LT(double(door.getAngularVelocity().length()), 10);
}

TEST(ExactMultiBodySolver, AChainHangsOnAnArm) {
  MultiBodyWorld<pintle::ExactMultiBodyJointSolver> of;
  Bodies bodies(of.world);
  btRigidBody* last = nullptr;
  std::vector<btRigidBody*> links;
  for (int i = 0; i < 5; ++i) {
    btRigidBody& link = bodies.add(1, vec(0.05, 0.05, 0.25), vec(2, 0, -0.25 - 0.5 * i));
    if (last != nullptr)
      bodies.join(
          std::make_unique<pintle::BallJoint>(*last, link, vec(0, 0, -0.25), vec(0, 0, 0.25)));
    last = &link;
    links.push_back(&link);
  }
  Arm arm(of.world, vec(0, 0, 0));
  arm.constrain(std::make_unique<btMultiBodyPoint2Point>(&arm.tree, 1, links[0], vec(0.5, 0, 0),
                                                         vec(0, 0, 0.25)));
  arm.constrain(std::make_unique<btMultiBodyJointMotor>(&arm.tree, 0, 1, 10));
  arm.constrain(std::make_unique<btMultiBodyJointMotor>(&arm.tree, 1, 0, 10));
  for (int i = 0; i < 300; ++i) {
    of.world.stepSimulation(scalar(dt), 0, scalar(dt));
    ASSERT_LE(bodies.largestGap(), rounding(1e-4, held)) << i;
    const btVector3 tip = arm.tree.localPosToWorld(1, vec(0.5, 0, 0)),
                    top = links[0]->getCenterOfMassTransform() * vec(0, 0, 0.25);
    ASSERT_LE(double((tip - top).length()), 0.05) << i;
  }
}

/// The states of an arm that meets its limit, of one that pushes a box, and of a free box on the ground.
template <class Solver>
std::vector<btScalar> playArms(bool with_chain) {
  MultiBodyWorld<Solver> of;
  of.world.getSolverInfo().m_minimumSolverBatchSize = 1;
  Bodies bodies(of.world);
  bodies.add(0, vec(20, 20, 1), vec(0, 0, -1.5), true);
  bodies.add(1, vec(0.3, 0.3, 0.3), vec(1.5, 1, -0.2), true);
  bodies.add(1, vec(0.3, 0.3, 0.3), vec(8, 8, 0), true);
  Arm arm(of.world, vec(0, 0, 0)), other(of.world, vec(-5, 0, 0));
  arm.constrain(std::make_unique<btMultiBodyJointMotor>(&arm.tree, 0, 2, 5));
  other.tree.setJointVel(1, 3);
  other.constrain(
      std::make_unique<btMultiBodyJointLimitConstraint>(&other.tree, 1, scalar(-1), scalar(1)));
  std::unique_ptr<Bodies> beside;
  if (with_chain) {
    beside = std::make_unique<Bodies>(of.world);
    beside->addChain(3, vec(0, 20, 5));
  }
  std::vector<btScalar> all;
  for (int i = 0; i < 120; ++i) {
    of.world.stepSimulation(scalar(dt), 0, scalar(dt));
    for (const auto& state : {arm.state(), other.state(), bodies.state()})
      all.insert(all.end(), state.begin(), state.end());
  }
  return all;
}

TEST(ExactMultiBodySolver, MultibodiesMoveAsOnBulletsSolver) {
  const std::vector<btScalar> stock = playArms<btMultiBodyConstraintSolver>(false);
  EXPECT_TRUE(stock == playArms<pintle::ExactMultiBodyJointSolver>(false));
  EXPECT_TRUE(stock == playArms<pintle::ExactMultiBodyJointSolver>(true)) << "beside a chain";
}

/// A pool of which each island of each step gets another solver.
class Rotating : public btConstraintSolverPoolMt {
 public:
  explicit Rotating(const std::vector<btConstraintSolver*>& solvers)
      : btConstraintSolverPoolMt(const_cast<btConstraintSolver**>(solvers.data()),
                                 int(solvers.size())),
        m_solvers(solvers),
        m_mutexes(solvers.size()) {}

  btScalar solveGroup(btCollisionObject** bodies, int numBodies, btPersistentManifold** manifolds,
                      int numManifolds, btTypedConstraint** constraints, int numConstraints,
                      const btContactSolverInfo& info, btIDebugDraw* drawer,
                      btDispatcher* dispatcher) override {
    const size_t i = m_next++ % m_solvers.size();
    const std::lock_guard<std::mutex> lock(m_mutexes[i]);
    return m_solvers[i]->solveGroup(bodies, numBodies, manifolds, numManifolds, constraints,
                                    numConstraints, info, drawer, dispatcher);
  }

 private:
  std::vector<btConstraintSolver*> m_solvers;
  std::vector<std::mutex> m_mutexes;
  std::atomic<size_t> m_next{0};
};

using Islands = btSimulationIslandManagerMt;

/// Bullet of distributions is built without threads: these are the test's.
void solveOnThreads(btAlignedObjectArray<Islands::Island*>* islands,
                    const Islands::SolverParams& params) {
  std::vector<std::thread> threads;
  for (int i = 0; i < islands->size(); ++i)
    threads.emplace_back(
        [=] { Islands::solveIsland(params.m_solverPool, *(*islands)[i], params); });
  for (std::thread& thread : threads) thread.join();
}

std::vector<btConstraintSolver*> solvers(int count) {
  std::vector<btConstraintSolver*> all;
  for (int i = 0; i < count; ++i) all.push_back(new pintle::ExactJointSolver);
  return all;
}

struct MtWorld : Bullet {
  explicit MtWorld(std::unique_ptr<btConstraintSolverPoolMt> solvers)
      : pool(std::move(solvers)),
        world(&dispatcher, &broadphase, pool.get(), nullptr, &configuration) {
    islands().setMinimumSolverBatchSize(1);
  }
  Islands& islands() { return *static_cast<Islands*>(world.getSimulationIslandManager()); }

  std::unique_ptr<btConstraintSolverPoolMt> pool;
  btDiscreteDynamicsWorldMt world;
};

std::unique_ptr<btConstraintSolverPoolMt> rotating(int count) {
  return std::make_unique<Rotating>(solvers(count));
}

/// Chains of 40 links: fewer bodies, and Bullet solves several islands at once. One lies on the ground.
std::vector<btScalar> playChains(std::unique_ptr<btConstraintSolverPoolMt> pool, bool on_threads) {
  MtWorld of(std::move(pool));
  if (on_threads) of.islands().setIslandDispatchFunction(solveOnThreads);
  Bodies bodies(of.world);
  for (int i = 0; i < 4; ++i) bodies.addChain(40, vec(0, 3 * i, 0), i == 3 ? 1000 : 1);
  bodies.add(0, vec(50, 1, 1), vec(0, -10, -1), true);
  btRigidBody* last = nullptr;
  for (int i = 0; i < 40; ++i) {
    btRigidBody& link = bodies.add(1, vec(0.2, 0.2, 0.2), vec(0.5 * i, -10, 0.3), true);
    if (last != nullptr)
      bodies.join(
          std::make_unique<pintle::BallJoint>(*last, link, vec(0.25, 0, 0), vec(-0.25, 0, 0)));
    last = &link;
  }
  std::vector<btScalar> all;
  for (int i = 0; i < 60; ++i) {
    of.world.stepSimulation(scalar(dt), 0, scalar(dt));
    EXPECT_LE(bodies.largestGap(), rounding(2e-3, 1e-7)) << i;
    const std::vector<btScalar> state = bodies.state();
    all.insert(all.end(), state.begin(), state.end());
  }
  return all;
}

TEST(ExactSolverMt, WhicheverSolverSolvesAnIsland) {
  const auto one =
      playChains(std::make_unique<btConstraintSolverPoolMt>(solvers(1).data(), 1), false);
  EXPECT_TRUE(one == playChains(rotating(3), false)) << "any";
  EXPECT_TRUE(one == playChains(rotating(400), false)) << "a fresh one";
  EXPECT_TRUE(one == playChains(rotating(8), true)) << "on threads";
}

/// As threads may come to them.
void solveInReverse(btAlignedObjectArray<Islands::Island*>* islands,
                    const Islands::SolverParams& params) {
  for (int i = islands->size(); i-- > 0;)
    Islands::solveIsland(params.m_solverPool, *(*islands)[i], params);
}

/// Three chains, of which the joints of one are off for a step, and for two.
std::vector<btScalar> playWithBreaks(bool in_reverse) {
  MtWorld of(std::make_unique<pintle::ExactJointSolverPool>(2));
  if (in_reverse) of.islands().setIslandDispatchFunction(solveInReverse);
  Bodies bodies(of.world);
  for (int i = 0; i < 3; ++i) bodies.addChain(40, vec(0, 3 * i, 0));
  std::vector<btScalar> all;
  for (int i = 0; i < 60; ++i) {
    const bool is_off = i == 20 || i == 30 || i == 31;
    for (int k = 0; k < 40; ++k) bodies.joints[size_t(k)]->setEnabled(!is_off);
    of.world.stepSimulation(scalar(dt), 0, scalar(dt));
    EXPECT_EQ(pintle::lastStep(of.world).components, is_off ? 2 : 3) << i;
    const std::vector<btScalar> state = bodies.state();
    all.insert(all.end(), state.begin(), state.end());
  }
  return all;
}

TEST(ExactSolverMt, APoolKnowsWhenAStepBegins) {
  EXPECT_TRUE(playWithBreaks(false) == playWithBreaks(true));
}

TEST(ExactSolverMt, APoolTakesOptions) {
  pintle::ExactJointSolverPool pool(2);
  pintle::SolverOptions options;
  options.max_iterations = 7;
  pool.setOptions(options);
  EXPECT_EQ(pool.options().max_iterations, 7);
  options.max_iterations = 0;
  EXPECT_THROW(pool.setOptions(options), std::invalid_argument);
  EXPECT_EQ(pool.options().max_iterations, 7);
  for (const int count : {0, -1}) {
    try {
      pintle::ExactJointSolverPool none(count);
      ADD_FAILURE() << count;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find("count = " + std::to_string(count)),
                std::string::npos);
    }
  }
}

struct Cable {
  double gap = 0, gain = 0, peak = 0;  ///< m; J: the most above the start, and the largest kinetic
  std::vector<btScalar> end;
};
Cable playCable(btDiscreteDynamicsWorld& world) {
  Bodies bodies(world);
  support::addCable<pintle::BallJoint>(bodies, 10, 0.02);
  Cable cable;
  const double start = bodies.energy(dt);
  for (int i = 0; i < 300; ++i) {
    world.stepSimulation(scalar(dt), 0, scalar(dt));
    cable.gap = std::max(cable.gap, bodies.largestGap());
    cable.gain = std::max(cable.gain, bodies.energy(dt) - start);
    cable.peak = std::max(cable.peak, bodies.kinetic());
  }
  cable.end = bodies.state();
  return cable;
}

TEST(ExactSolverMt, HoldsACableAsInAPlainWorld) {
  Bullet of;
  pintle::ExactJointSolver solver;
  btDiscreteDynamicsWorld plain(&of.dispatcher, &of.broadphase, &solver, &of.configuration);
  const Cable there = playCable(plain);
  MtWorld mt(rotating(4));
  const Cable here = playCable(mt.world);
  EXPECT_LE(here.gap, rounding(2e-5, 1e-8));
  EXPECT_LE(here.gain, rounding(0.02, 0.01) * here.peak);
  double apart = 0;  // in the end, m, m/s and rad/s: Bullet's worlds sort their joints differently
  for (size_t i = 0; i < here.end.size(); ++i)
    apart = std::max(apart, std::abs(double(here.end[i] - there.end[i])));
  EXPECT_LE(apart, rounding(1e-2, 1e-6));
}

// Solvers of a pool share what they keep, and forget what is gone.
TEST(ExactSolverMt, ForgetsWhatIsGone) {
  const std::vector<btConstraintSolver*> all = solvers(3);
  MtWorld of(std::make_unique<Rotating>(all));
  auto& any = *static_cast<pintle::ExactJointSolver*>(all[1]);
  Bodies bodies(of.world);
  for (int i = 0; i < 3; ++i) bodies.addChain(40, vec(0, 3 * i, 0));
  const auto step = [&] {
    for (int i = 0; i < 4; ++i) of.world.stepSimulation(scalar(dt), 0, scalar(dt));
  };
  step();
  EXPECT_EQ(any.getNumRemembered(), 3);
  EXPECT_EQ(any.lastStep().components, 3) << "of all solvers";
  for (int i = 0; i < 40; ++i) {
    of.world.removeConstraint(bodies.joints.back().get());
    bodies.joints.pop_back();
  }
  step();
  EXPECT_EQ(any.getNumRemembered(), 2);
  EXPECT_EQ(any.lastStep().components, 2);
}

TEST(UsesExactSolver, PlainWorlds) {
  Bullet of;
  btSequentialImpulseConstraintSolver stock;
  pintle::ExactJointSolver exact;
  pintle::ExactMultiBodyJointSolver multi_body;
  btDiscreteDynamicsWorld world(&of.dispatcher, &of.broadphase, &stock, &of.configuration);
  EXPECT_FALSE(pintle::usesExactSolver(world));
  EXPECT_NE(pintle::whyNotExact(world).find("is not a pintle::ExactJointSolver"),
            std::string::npos);
  world.setConstraintSolver(&exact);
  EXPECT_TRUE(pintle::usesExactSolver(world));
  EXPECT_EQ(pintle::whyNotExact(world), "");
  world.setConstraintSolver(&multi_body);
  EXPECT_TRUE(pintle::usesExactSolver(world));
}

TEST(UsesExactSolver, WorldsOfMultibodies) {
  Bullet of;
  btMultiBodyConstraintSolver stock;
  pintle::ExactJointSolver exact;
  pintle::ExactMultiBodyJointSolver multi_body;
  btMultiBodyDynamicsWorld world(&of.dispatcher, &of.broadphase, &stock, &of.configuration);
  EXPECT_FALSE(pintle::usesExactSolver(world));
  for (btConstraintSolver* ignored :
       {static_cast<btConstraintSolver*>(&exact), static_cast<btConstraintSolver*>(&multi_body)}) {
    world.setConstraintSolver(ignored);
    EXPECT_FALSE(pintle::usesExactSolver(world));
    EXPECT_NE(pintle::whyNotExact(world).find("setMultiBodyConstraintSolver()"), std::string::npos);
  }
  world.setMultiBodyConstraintSolver(&multi_body);
  EXPECT_TRUE(pintle::usesExactSolver(world));
}

TEST(UsesExactSolver, PoolsOfSolvers) {
  EXPECT_TRUE(pintle::usesExactSolver(MtWorld(rotating(3)).world));
  const auto because = [](const std::vector<btConstraintSolver*>& of) {
    return pintle::whyNotExact(MtWorld(std::make_unique<Rotating>(of)).world);
  };
  EXPECT_EQ(because(solvers(2)), "");
  std::vector<btConstraintSolver*> mixed = solvers(2);
  mixed.push_back(new btSequentialImpulseConstraintSolver);
  EXPECT_NE(because(mixed).find("btConstraintSolverPoolMt"), std::string::npos);

  Bullet of;
  btSequentialImpulseConstraintSolver large;
  const auto pool = rotating(1);
  btDiscreteDynamicsWorldMt world(&of.dispatcher, &of.broadphase, pool.get(), &large,
                                  &of.configuration);
  EXPECT_NE(pintle::whyNotExact(world).find("constraintSolverMt"), std::string::npos);
}

}  // namespace
}  // namespace exact_worlds

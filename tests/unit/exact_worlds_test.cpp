// The exact solver in all kinds of Bullet's worlds: of multibodies, of many threads, and where Bullet ignores it.
#include <pintle/solver/exact_joint_solver.h>
#include <pintle/solver/exact_joint_solver_pool.h>
#include <pintle/solver/exact_multi_body_joint_solver.h>

#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorldMt.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cstring>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "cables.h"
#include "exact_worlds.h"
#include "physics_support.h"
#include "support.h"

namespace exact_worlds {
namespace {

using physics::rounding;
using support::scalar;

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
template <class Ball = pintle::BallJoint>
std::vector<btScalar> playChains(std::unique_ptr<btConstraintSolverPoolMt> pool, bool on_threads) {
  MtWorld of(std::move(pool));
  if (on_threads) of.islands().setIslandDispatchFunction(solveOnThreads);
  Bodies bodies(of.world);
  for (int i = 0; i < 4; ++i) bodies.addChain<Ball>(40, vec(0, 3 * i, 0), i == 3 ? 1000 : 1);
  bodies.add(0, vec(50, 1, 1), vec(0, -10, -1), true);
  btRigidBody* last = nullptr;
  for (int i = 0; i < 40; ++i) {
    btRigidBody& link = bodies.add(1, vec(0.2, 0.2, 0.2), vec(0.5 * i, -10, 0.3), true);
    if (last != nullptr)
      bodies.join(std::make_unique<Ball>(*last, link, vec(0.25, 0, 0), vec(-0.25, 0, 0)));
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

TEST(ExactSolverMt, WhicheverSolverUpgradesStockJoints) {
  using Stock = btPoint2PointConstraint;
  const auto pool = [] { return std::make_unique<pintle::ExactJointSolverPool>(4); };
  const auto ours = playChains(pool(), false);
  EXPECT_TRUE(ours == playChains<Stock>(pool(), false));
  EXPECT_TRUE(ours == playChains<Stock>(rotating(400), false)) << "a fresh one";
  EXPECT_TRUE(ours == playChains<Stock>(rotating(8), true)) << "on threads of Bullet's pool";
}

TEST(ExactSolverMt, APoolUpgradesUnlessTold) {
  pintle::ExactJointSolverPool pool(2);
  EXPECT_TRUE(pool.getUpgradesBulletJoints());
  pool.setUpgradesBulletJoints(false);
  EXPECT_FALSE(pool.getUpgradesBulletJoints());
  btRigidBody a(1, nullptr, nullptr), b(1, nullptr, nullptr);
  const btPoint2PointConstraint ball(a, b, vec(0, 0, support::nan_value), vec(0, 0, 0));
  EXPECT_NE(pool.whyIgnored(ball).find("pivotA"), std::string::npos);
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
  EXPECT_LE(here.gain, rounding(0.02, 0.0101) * here.peak);  // and rounding
  double apart = 0;  // in the end, m, m/s and rad/s: Bullet's worlds sort their joints differently
  for (size_t i = 0; i < here.end.size(); ++i)
    apart = std::max(apart, std::abs(double(here.end[i] - there.end[i])));
  EXPECT_LE(apart, rounding(1e-2, 1e-3));  // it snaps, by which rounding grows
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

// Bodies in a world of the exact solver, with books of its energy.
#pragma once

#include <pintle/solver/exact_joint_solver.h>

#include <btBulletDynamicsCommon.h>

#include <algorithm>

#include "bodies.h"
#include "support.h"

namespace support {

struct ExactWorld {
  // Stock joints are solved by the rows that they write themselves: upgraded_joints_test.cpp has the others.
  ExactWorld() {
    world.getSolverInfo().m_minimumSolverBatchSize = 1;
    solver.setUpgradesBulletJoints(false);
  }

  pintle::ExactJointSolver solver;
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
};

/// Bodies in a world of their own, with books of its energy.
class Books : public ExactWorld, public Bodies {
 public:
  explicit Books(double hz) : Bodies(ExactWorld::world), m_dt(1 / hz) {}

  double energy() const { return Bodies::energy(m_dt); }
  void begin() {
    m_start = m_last = energy();
    peak = kinetic();
  }
  void step() {
    world.stepSimulation(scalar(m_dt), 0, scalar(m_dt));
    const double now = energy();
    gain = std::max(gain, now - m_start);
    gains += std::max(0., now - m_last);
    m_last = now;
    peak = std::max(peak, kinetic());
  }

  double gain = 0;   ///< J: the most above the start
  double gains = 0;  ///< J: the sum of all gains of a step
  double peak = 0;   ///< J: the largest kinetic energy

 private:
  double m_dt, m_start = 0, m_last = 0;
};

}  // namespace support

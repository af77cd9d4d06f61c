// What the ledger books as the work of a joint: of one body on one row, of which no step needs to be played.
#include <pintle/solver/energy/energy_ledger.h>

#include <gtest/gtest.h>

namespace exact_energy_ledger_test {

using pintle::AxisLaw;
using pintle::Vector3d;
using pintle::Vector6d;

constexpr double mass = 2;  // kg

class OneRow : public testing::Test {
 protected:
  OneRow() {
    m_island.dt = 0.01;
    m_island.unmoved_bodies.emplace_back(Vector6d::Zero(), m_island.dt);
    m_island.bodies.resize(1);
    m_island.bodies.front().mass = mass;
    m_island.bodies.front().inertia.setIdentity();
    m_row.has_position = false;
    m_row.index = 0;
    m_row.J = {-Vector3d::UnitX(), Vector3d::Zero(), Vector3d::UnitX(), Vector3d::Zero()};
    m_row.setK(1 / mass);
    m_row.law = AxisLaw(m_island.giveExtras(m_row).parts);
  }

  // J: booked of an impulse along the row that changes the velocity along it, m/s, without forces.
  double work(double from, double to) {
    pintle::IslandJoint joint = {};
    joint.body = {pintle::Island::unmoved(pintle::Island::at_rest), 0};
    joint.add(m_row);
    m_island.rows = {m_row};
    m_island.joints = {joint};
    pintle::IslandBody& body = m_island.bodies.front();
    body.v0.setZero();
    body.v0[0] = from;
    body.v_free = body.v0;
    body.by_forces.setZero();
    body.gyroscopic_work = 0;
    pintle::Workspace end;
    end.v = {body.v0};
    end.v.front()[0] = to;
    end.u = {to};
    end.lambda = {mass * (to - from)};
    end.pieces = {{false, 0, 0, end.lambda.front()}};
    end.parts = {{end.lambda.front()}};
    const pintle::Component component{0, 1, 0, 1, 1};
    const double of_all = workOfJoints(m_island, component, end);
    EXPECT_NEAR(workAmongContacts(m_island, component, end), of_all, 1e-12);
    m_over_forces = gainOverForces(m_island, component, end);
    return of_all;
  }

  pintle::Island m_island;
  pintle::IslandRow m_row;
  double m_over_forces = 0;  // J: of the last one, as what may not be
};

TEST_F(OneRow, AMotorMayGive) {
  m_row.law.add({1, 0, -10, 10, true});
  EXPECT_NEAR(work(0, 1), 0, 1e-12);
  EXPECT_LE(m_over_forces, 0);
  EXPECT_NEAR(work(1, 0), 0, 1e-12);
}

// Along directions of the start friction may come to push, where they turn in the step. Then that is what the joint gives.
TEST_F(OneRow, FrictionTakesAlone) {
  m_row.law.add({0, 0, -10, 10, true});
  EXPECT_NEAR(work(1, 0), 0, 1e-12);
  EXPECT_NEAR(work(0, 1), 1, 1e-12);
}

// So whatever bodies gain to which friction is held is a solve that is not sound.
TEST_F(OneRow, FrictionGivesNothingToWhereForcesLead) {
  m_row.law.add({0, 0, -10, 10, true});
  for (const double to : {0.5, 1., 2.}) {
    work(1, to);
    EXPECT_NEAR(m_over_forces, to * to - 1, 1e-12) << to;
  }
}

// What a stop takes in one step and gives back in the next one is in sum nothing: else each rebound would leave credit for the next one.
TEST_F(OneRow, AStopKeepsWhatItGivesBack) {
  m_row.law.add({0, 0, 0, AxisLaw::unbounded, false, false, pintle::Axis::limit});
  EXPECT_NEAR(work(-1, 0), -1, 1e-12);
  m_row.extras->keeps_for_rebound = true;
  EXPECT_NEAR(work(-1, 0), 0, 1e-12);
  m_row.extras->keeps_for_rebound = false;
  m_row.extras->rebound_energy = 1;
  EXPECT_NEAR(work(0, 1), 0, 1e-12);
  EXPECT_NEAR(work(0, 0.5), -0.75, 1e-12);
  EXPECT_NEAR(work(0, 2), 3, 1e-12);
}

}  // namespace exact_energy_ledger_test

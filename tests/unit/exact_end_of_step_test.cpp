// How the end of a step changes with the velocities in it, by which ExactJointSolver corrects these.
#include <pintle/solver_body.h>

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace {

using Vector = Eigen::Vector3d;

constexpr double time_step = 1. / 60;
double rounding(double in_single, double in_double) {
  return sizeof(btScalar) == sizeof(double) ? in_double : in_single;
}

btSolverBody bodyThatTurns(const Vector& w) {
  btSolverBody body;
  body.m_linearVelocity = body.m_externalForceImpulse = body.m_externalTorqueImpulse =
      btVector3(0, 0, 0);
  body.internalGetDeltaLinearVelocity().setZero();
  body.internalGetDeltaAngularVelocity().setZero();
  body.m_angularVelocity = btVector3(btScalar(w.x()), btScalar(w.y()), btScalar(w.z()));
  return body;
}

// Where Bullet turns to in a step, in double.
Eigen::Quaterniond turned(const Vector& w) {
  const double most = double(ANGULAR_MOTION_THRESHOLD);
  const double rate = std::min(w.norm(), most / time_step);
  const Vector v = w * std::sin(rate * time_step / 2) / rate;
  return Eigen::Quaterniond(std::cos(rate * time_step / 2), v.x(), v.y(), v.z()).normalized();
}

// By up to and beyond what Bullet turns a body by.
class EndOfStep : public testing::TestWithParam<double> {
 protected:
  const Vector w = GetParam() / time_step * Vector(0.48, -0.6, 0.64);
};

TEST_P(EndOfStep, IsWhereBulletTurnsTo) {
  btTransform end;
  pintle::endOfStep(btTransform::getIdentity(), bodyThatTurns(w), btScalar(time_step), end);
  const btQuaternion q = end.getRotation();
  const Eigen::Quaterniond is(double(q.w()), double(q.x()), double(q.y()), double(q.z()));
  EXPECT_LT(is.angularDistance(turned(w)), rounding(1e-3, 1e-7));
}

// By central differences: a small change of the velocity, and the turn between the ends to which it leads.
TEST_P(EndOfStep, RowsAreThoseOfTheVelocity) {
  constexpr double small = 1e-4;
  for (const Vector& A : {Vector(1, 0, 0), Vector(0, 1, 0), Vector(0.6, 0, -0.8)}) {
    const Vector row = pintle::byVelocity(bodyThatTurns(w), btScalar(time_step), A);
    for (int k = 0; k < 3; ++k) {
      const Vector change = small * Vector::Unit(k);
      const Eigen::Quaterniond between = turned(w + change) * turned(w - change).conjugate();
      EXPECT_NEAR(row[k], A.dot(2 * between.vec()) / (2 * small * time_step), rounding(1e-5, 1e-8))
          << A.transpose() << ", " << k;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Turns, EndOfStep,
                         testing::Values(1e-9, 1e-3, 0.1, 0.5, 0.78, 0.8, 1.2, 5));

}  // namespace

// Steps of second order, against equations of motion that are solved by Runge and Kutta's method of order 4, and what interrupts them.
#include <pintle/joints/ball_joint.h>
#include <pintle/solver/model/free_rotor.h>
#include <pintle/solver/solver_options.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <btBulletDynamicsCommon.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "books.h"
#include "physics_support.h"
#include "support.h"

namespace exact_second_order_test {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::VectorXd;
using physics::rounding;
using pintle::inDouble;
using support::Books;
using support::gravity;
using support::scalar;
using support::vec;

constexpr int samples = 20;  ///< a second
using Points = std::vector<Vector3d>;

class World : public Books {
 public:
  explicit World(double hz, bool second_order = true) : Books(hz) {
    pintle::SolverOptions options;
    options.second_order = second_order;
    solver.setOptions(options);
  }
  btRigidBody& addBody(const Vector3d& inertia, const btTransform& pose) {
    btRigidBody& body = add(1, vec(0.5, 0.05, 0.05), pose);
    body.setMassProps(1, vec(inertia[0], inertia[1], inertia[2]));
    body.setDamping(0, 0);
    body.updateInertiaTensor();
    return body;
  }
};

// m: a point of each body that is on none of its axes.
Points pointsOf(const World& world) {
  Points points;
  for (const auto& body : world.bodies)
    points.push_back(inDouble(body->getCenterOfMassTransform() * vec(0.5, 0.3, 0.2)));
  return points;
}
Vector3d pointOf(const Vector3d& center, const Matrix3d& R) {
  return center + R * Vector3d(0.5, 0.3, 0.2);
}

struct Motion {
  std::function<void(World&)> build;
  double seconds;
  std::vector<Points> wanted;  ///< at each sample
};

template <class State, class Slope>
State stepOf(const State& at, double dt, const Slope& slope) {
  const State a = slope(at), b = slope(State(at + dt / 2 * a)), c = slope(State(at + dt / 2 * b)),
              d = slope(State(at + dt * c));
  return at + dt / 6 * (a + 2 * b + 2 * c + d);
}
constexpr int steps_of_sample = 500;

constexpr double across = 1. / 12;  ///< kg m^2: of a rod

// Rods of 1 m and 1 kg, one at the end of the other, which fall in a plane from the horizontal: of their angles below it,
//   sum_j (m_ij cos(a_i - a_j) a_j'' + m_ij sin(a_i - a_j) a_j'^2) + I a_i'' = g c_i cos a_i
Motion rods(int n, double seconds) {
  Motion motion{[n](World& world) {
                  btRigidBody* last = nullptr;
                  for (int i = 0; i < n; ++i) {
                    btRigidBody& rod =
                        world.addBody({0.001, across, across},
                                      btTransform(btQuaternion::getIdentity(), vec(i + 0.5, 0, 0)));
                    if (last == nullptr)
                      world.join(std::make_unique<pintle::BallJoint>(rod, vec(-0.5, 0, 0)));
                    else
                      world.join(std::make_unique<pintle::BallJoint>(*last, rod, vec(0.5, 0, 0),
                                                                     vec(-0.5, 0, 0)));
                    last = &rod;
                  }
                },
                seconds,
                {}};
  // Rod k < i is a whole lever of the centre of rod i, and rod i half of one.
  const auto lever = [](int body, int rod) { return body > rod ? 1. : body == rod ? 0.5 : 0.; };
  MatrixXd m = MatrixXd::Zero(n, n);
  VectorXd c = VectorXd::Zero(n);
  for (int body = 0; body < n; ++body)
    for (int i = 0; i < n; ++i) {
      c[i] += lever(body, i);
      for (int j = 0; j < n; ++j) m(i, j) += lever(body, i) * lever(body, j);
    }
  const auto slope = [&](const VectorXd& at) {
    MatrixXd M = across * MatrixXd::Identity(n, n);
    VectorXd f(n), to(2 * n);
    for (int i = 0; i < n; ++i) {
      f[i] = gravity * c[i] * std::cos(at[i]);
      for (int j = 0; j < n; ++j) {
        M(i, j) += m(i, j) * std::cos(at[i] - at[j]);
        f[i] -= m(i, j) * std::sin(at[i] - at[j]) * at[n + j] * at[n + j];
      }
    }
    to << at.tail(n), M.ldlt().solve(f);
    return to;
  };
  VectorXd at = VectorXd::Zero(2 * n);
  for (int sample = 0; sample < int(seconds * samples); ++sample) {
    for (int k = 0; k < steps_of_sample; ++k)
      at = stepOf(at, 1. / samples / steps_of_sample, slope);
    Points points;
    Vector3d end = Vector3d::Zero();
    for (int i = 0; i < n; ++i) {
      const Matrix3d R = Eigen::AngleAxisd(at[i], Vector3d::UnitY()).matrix();
      const Vector3d along = R.col(0);
      points.push_back(pointOf(end + along / 2, R));
      end += along;
    }
    motion.wanted.push_back(points);
  }
  return motion;
}

// A body that turns about a point, `arm` below its centre, by Euler's equations.
Motion rotor(const Vector3d& inertia, double arm, double tilt, const Vector3d& w, double seconds) {
  const Quaterniond start(Eigen::AngleAxisd(tilt, Vector3d::UnitY()));
  Motion motion{[=](World& world) {
                  if (arm == 0) world.world.setGravity(vec(0, 0, 0));
                  const btQuaternion q(scalar(start.x()), scalar(start.y()), scalar(start.z()),
                                       scalar(start.w()));
                  btRigidBody& body =
                      world.addBody(inertia, btTransform(q, quatRotate(q, vec(0, 0, arm))));
                  const Vector3d of = start * w;
                  body.setAngularVelocity(vec(of[0], of[1], of[2]));
                  if (arm > 0)
                    world.join(std::make_unique<pintle::BallJoint>(body, vec(0, 0, -arm)));
                },
                seconds,
                {}};
  const Vector3d about = inertia + arm * arm * Vector3d(1, 1, 0);
  using State = Eigen::Matrix<double, 7, 1>;  // w in the body, and q
  const auto slope = [&](const State& at) {
    const Vector3d rate = at.head<3>();
    const Quaterniond q(at[3], at[4], at[5], at[6]);
    const Vector3d pull = q.conjugate() * Vector3d(0, 0, -gravity);
    const Vector3d torque =
        Vector3d(0, 0, arm).cross(pull) - rate.cross(Vector3d(about.cwiseProduct(rate)));
    const Quaterniond turn = q * Quaterniond(0, rate[0] / 2, rate[1] / 2, rate[2] / 2);
    State to;
    to << torque.cwiseQuotient(about), turn.w(), turn.x(), turn.y(), turn.z();
    return to;
  };
  State at;
  at << w, start.w(), start.x(), start.y(), start.z();
  for (int sample = 0; sample < int(seconds * samples); ++sample) {
    for (int k = 0; k < 4 * steps_of_sample; ++k) {
      at = stepOf(at, 0.25 / samples / steps_of_sample, slope);
      at.tail<4>().normalize();
    }
    const Matrix3d R = Quaterniond(at[3], at[4], at[5], at[6]).matrix();
    motion.wanted.push_back({pointOf(arm * R.col(2), R)});
  }
  return motion;
}

// m: the mean over bodies and samples.
double meanError(const Motion& motion, double hz) {
  World world(hz);
  motion.build(world);
  double sum = 0;
  int count = 0;
  for (int step = 1; step <= int(std::lround(motion.seconds * hz)); ++step) {
    world.step();
    if (step * samples % int(hz) != 0) continue;
    const Points &points = pointsOf(world),
                 &wanted = motion.wanted[size_t(step * samples / int(hz) - 1)];
    for (size_t i = 0; i < points.size(); ++i, ++count) sum += (points[i] - wanted[i]).norm();
  }
  return sum / count;
}

// By least squares, of the errors' logarithms.
double orderOf(const Motion& motion) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const double hz : {120., 240., 480., 1000.}) {
    const double u = std::log(hz), v = std::log(meanError(motion, hz));
    n += 1, x += u, y += v, xx += u * u, xy += u * v;
  }
  return -(n * xy - x * y) / (n * xx - x * x);
}

void expectSecondOrder(const Motion& motion, double most) {
  // (Floats round the turn of each step.)
  EXPECT_LT(meanError(motion, 240), most + rounding(1e-3, 0));
  if (support::is_double) {
    EXPECT_GT(orderOf(motion), 1.9);
  }
}

// (Without the option they err by 7e-3, 8e-3 and 1e-2 m.)
TEST(SecondOrder, RodsFallAsTheirEquationsSay) {
  expectSecondOrder(rods(1, 5), 3e-4);
  expectSecondOrder(rods(2, 2), 3e-4);
  expectSecondOrder(rods(4, 1.5), 3e-4);
}

TEST(SecondOrder, AHeavyTopTurnsAsEulersEquationsSay) {
  expectSecondOrder(rotor({0.02, 0.02, 0.03}, 0.5, 0.3, {0, 0, 60}, 5), 5e-3);
}

// About the axis of the middle inertia, from which it turns over.
TEST(SecondOrder, AFreeBodyTumblesAsEulersEquationsSay) {
  expectSecondOrder(rotor({0.02, 0.05, 0.06}, 0, 0, {0.05, 6, 0.016}, 5), 2e-5);
}

TEST(SecondOrder, AFreeRotorKeepsItsAngularMomentum) {
  World world(60);
  world.world.setGravity(vec(0, 0, 0));
  btRigidBody& body = world.addBody({0.02, 0.05, 0.06}, btTransform::getIdentity());
  body.setAngularVelocity(vec(3, 6, 1));
  const auto momentum = [&] {
    return inDouble(body.getInvInertiaTensorWorld().inverse() * body.getAngularVelocity());
  };
  const Vector3d start = momentum();
  for (int i = 0; i < 600; ++i) world.step();
  EXPECT_LT((momentum() - start).norm(), rounding(1e-4, 1e-12));
}

// Whose flags are 0 keeps its angular velocity, as in Bullet.
TEST(SecondOrder, WithoutGyroscopicFlagsABodyKeepsItsAngularVelocity) {
  World world(60);
  btRigidBody& body = world.addBody({0.02, 0.05, 0.06}, btTransform::getIdentity());
  body.setFlags(0);
  const btVector3 w = vec(3, 6, 1);
  body.setAngularVelocity(w);
  for (int i = 0; i < 60; ++i) world.step();
  EXPECT_LT(double((body.getAngularVelocity() - w).length()), rounding(1e-5, 1e-12));
}

TEST(SecondOrder, FreeFallIsExactAtAnyStep) {
  support::Random random(1);
  World world(60);
  btRigidBody& body = world.add(1, vec(0.1, 0.1, 0.1), vec(0, 0, 0));
  body.setLinearVelocity(vec(1, 2, 3));
  double time = 0;
  for (int i = 0; i < 100; ++i) {
    const double dt = random.uniform(1e-3, 0.05);
    world.world.stepSimulation(scalar(dt), 0, scalar(dt));
    time += double(scalar(dt));
    const Vector3d wanted(time, 2 * time, 3 * time - gravity * time * time / 2);
    ASSERT_LT((inDouble(body.getCenterOfMassPosition()) - wanted).norm(), rounding(2e-5, 1e-12))
        << i;
    ASSERT_LT(std::abs(double(body.getLinearVelocity().z()) - 3 + gravity * time),
              rounding(1e-5, 1e-12));
  }
}

// Forces that users add are known at the start of a step alone. So they act before bodies move, as in Bullet: springs keep their energy, here at
// 20 rad/s and 60 Hz, drag of c dt / m = 1.5 slows, and a force for one step gives its impulse.
TEST(SecondOrder, ForcesOfUsersActAsInBullet) {
  World world(60);
  world.world.setGravity(vec(0, 0, 0));
  btRigidBody& body = world.add(1, vec(0.1, 0.1, 0.1), vec(1, 0, 0));
  constexpr double stiffness = 400;
  const auto energy = [&] {
    return world.kinetic() + stiffness / 2 * double(body.getCenterOfMassPosition().length2());
  };
  const double start = energy();
  for (int i = 0; i < 600; ++i) {
    body.applyCentralForce(scalar(-stiffness) * body.getCenterOfMassPosition());
    world.step();
    ASSERT_LT(energy(), 1.5 * start) << i;
    ASSERT_GT(energy(), 0.5 * start) << i;
  }
  body.setLinearVelocity(vec(10, 0, 0));
  for (int i = 0; i < 60; ++i) {
    body.applyCentralForce(scalar(-90) * body.getLinearVelocity());
    world.step();
  }
  EXPECT_LT(double(body.getLinearVelocity().length()), 1e-6);
  body.setLinearVelocity(vec(0, 0, 0));
  body.applyCentralForce(vec(60, 0, 0));
  for (int i = 0; i < 3; ++i) {
    world.step();
    EXPECT_NEAR(double(body.getLinearVelocity().x()), 1, rounding(1e-6, 1e-12)) << i;
  }
}

// Gravity that changes, and velocities and masses that users set, leave nothing of the second half of the last step.
TEST(SecondOrder, WhatUsersSetIsWhatBodiesHave) {
  World world(60);
  btRigidBody& body = world.add(1, vec(0.1, 0.1, 0.1), vec(0, 0, 0));
  for (int i = 0; i < 10; ++i) world.step();
  body.setGravity(vec(0, 0, 0));
  body.setLinearVelocity(vec(0, 0, 0));
  for (int i = 0; i < 10; ++i) world.step();
  EXPECT_EQ(body.getLinearVelocity(), vec(0, 0, 0));
  // A planet, about which a body goes once a second: 20 times.
  const double w = 2 * physics::pi;
  body.setCenterOfMassTransform(btTransform(btQuaternion::getIdentity(), vec(1, 0, 0)));
  body.setLinearVelocity(vec(0, w, 0));
  for (int i = 0; i < 20 * 60; ++i) {
    const btVector3 x = body.getCenterOfMassPosition();
    body.setGravity(scalar(-w * w / std::pow(double(x.length()), 3)) * x);
    world.step();
    ASSERT_NEAR(double(body.getCenterOfMassPosition().length()), 1, 0.02) << i;
  }
}

struct Bounces {
  double gains = 0;   ///< m: the sum of what a bounce leads higher than the one before
  double energy = 0;  ///< J: the sum of what is left in the end
};
Bounces bouncesOf(double restitution, bool second_order) {
  Bounces of;
  for (int k = 0; k < 50; ++k) {
    World world(60, second_order);
    world.add(0, vec(5, 5, 0.5), vec(0, 0, -0.5), true).setRestitution(1);
    double top = 1 + 0.037 * k, highest = 0;  // m: of the last bounce, and since then
    btRigidBody& ball = world.add(1, std::make_unique<btSphereShape>(scalar(0.2)),
                                  btTransform(btQuaternion::getIdentity(), vec(0, 0, top)), true);
    ball.setRestitution(scalar(restitution));
    bool rose = false;
    for (int i = 0; i < 1200; ++i) {
      world.step();
      const bool rises = double(ball.getLinearVelocity().z()) > 0;
      if (rose && !rises) {
        of.gains += std::max(0., highest - top - 1e-3);
        top = highest;
        highest = 0;
      }
      rose = rises;
      highest = std::max(highest, double(ball.getCenterOfMassPosition().z()));
    }
    of.energy += world.kinetic() + gravity * double(ball.getCenterOfMassPosition().z());
  }
  return of;
}

// Balls that fall on the ground from 50 heights. Bullet's contacts give a bounce of 0.9 energy now and then, by how deep it comes: no more of it
// than without the option. (Without half a step of forces where they come and go it is four times as much.)
TEST(SecondOrder, WhatBouncesGainsNoMoreThanOnBulletsSteps) {
  for (const double restitution : {0., 0.5, 0.9}) {
    SCOPED_TRACE(restitution);
    const Bounces first = bouncesOf(restitution, false), second = bouncesOf(restitution, true);
    EXPECT_LE(second.gains, 1.2 * first.gains);
    EXPECT_LE(second.energy, 1.1 * first.energy);
  }
}

// Three links of 1 kg with 10 t at their end, let go from a tilt. No step of 60 Hz resolves how links swing under that load, which is known after the
// first step alone: solved in halves, that one throws them (25 rad/s).
TEST(SecondOrder, LightLinksUnderAHeavyLoadAreNotThrown) {
  World world(60);
  btRigidBody* last = &world.add(0, vec(0.1, 0.1, 0.1), vec(0, 0, 0));
  const btVector3 along = vec(0.3, 0, -1).normalized();
  const btQuaternion turn = shortestArcQuat(vec(1, 0, 0), along);
  btVector3 pivot = vec(0, 0, 0);
  for (const double half : {0.1, 0.1, 0.1, 0.3}) {
    btRigidBody& link = world.add(half > 0.2 ? 1e4 : 1, vec(half, half / 5, half / 5),
                                  btTransform(turn, pivot + along * scalar(half)));
    const btVector3 in_last = last->getCenterOfMassTransform().inverse() * pivot;
    world.join(std::make_unique<pintle::BallJoint>(*last, link, in_last, vec(-half, 0, 0)));
    pivot += along * scalar(2 * half);
    last = &link;
  }
  for (int i = 0; i < 60; ++i) {
    world.step();
    for (const auto& body : world.bodies)
      ASSERT_LT(double(body->getAngularVelocity().length()), 4) << i;
  }
}

// Without forces in a step, as a user may clear them, it moves by its velocity.
TEST(SecondOrder, WhatIsNotPulledDoesNotRise) {
  World world(60);
  btRigidBody& body = world.add(1, vec(0.1, 0.1, 0.1), vec(0, 0, 0));
  world.world.setInternalTickCallback([](btDynamicsWorld* of, btScalar) { of->clearForces(); },
                                      nullptr, true);
  for (int i = 0; i < 60; ++i) world.step();
  EXPECT_NEAR(double(body.getCenterOfMassPosition().z()), 0, 1e-12);
}

// Neither leaves a trace of what was before.
TEST(SecondOrder, WhatIsTeleportedOrWokenGoesOnFromThere) {
  World world(60);
  btRigidBody& body = world.add(1, vec(0.1, 0.1, 0.1), vec(0, 0, 0));
  const auto fallFrom = [&](double z) {
    for (int i = 1; i <= 30; ++i) {
      world.step();
      ASSERT_NEAR(double(body.getCenterOfMassPosition().z()),
                  z - gravity * (i / 60.) * (i / 60.) / 2, rounding(1e-5, 1e-12));
    }
  };
  fallFrom(0);
  body.setCenterOfMassTransform(btTransform(btQuaternion::getIdentity(), vec(0, 0, 7)));
  body.setLinearVelocity(vec(0, 0, 0));
  fallFrom(7);
  body.forceActivationState(ISLAND_SLEEPING);
  const double z = double(body.getCenterOfMassPosition().z());
  for (int i = 0; i < 10; ++i) world.step();
  EXPECT_NEAR(double(body.getCenterOfMassPosition().z()), z, 1e-12);
  body.forceActivationState(DISABLE_DEACTIVATION);
  body.setLinearVelocity(vec(0, 0, 0));
  fallFrom(z);
}

}  // namespace
}  // namespace exact_second_order_test

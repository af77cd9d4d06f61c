// What a gear holds: coordinates of joints, over any number of revolutions, on Bullet's solver and on the exact one. Angles are
// measured by the bodies' poses.
#include <gtest/gtest.h>
#include <pintle/joints/gear_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/slider_joint.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <vector>

#include "kinetic_energy.h"
#include "solver_of_tests.h"
#include "support.h"

namespace gear_joint_test {
namespace {

using pintle::GearCoordinate;
using pintle::GearJoint;
using pintle::QuaternionHinge;
using pintle::SliderJoint;
using scenes::pi;
using support::is_double;
using support::nan_value;
using support::refusal;
using support::scalar;
using support::vec;

constexpr double dt = 1. / 60;

// rad: how a body has turned about an axis of the world, revolutions counted, in double.
class Turns {
 public:
  Turns(const btRigidBody& body, const btVector3& axis) : m_body(body), m_axis(axis) {
    btPlaneSpace1(axis, m_x, m_y);
    m_in_body = body.getCenterOfMassTransform().getBasis().transpose() * m_x;
  }
  double operator()() {
    const btVector3 v = m_body.getCenterOfMassTransform().getBasis() * m_in_body;
    const double now = std::atan2(dot(v, m_axis.cross(m_x)), dot(v, m_x));
    m_angle += std::remainder(now - m_angle, 2 * pi);
    return m_angle;
  }

 private:
  static double dot(const btVector3& a, const btVector3& b) {
    return double(a.x()) * double(b.x()) + double(a.y()) * double(b.y()) +
           double(a.z()) * double(b.z());
  }
  const btRigidBody& m_body;
  btVector3 m_axis, m_x, m_y, m_in_body;
  double m_angle = 0;
};

const btVector3 z_axis = vec(0, 0, 1);

// Wheels about vertical axes on one frame, side by side.
struct Shop {
  scenes::World world;
  btRigidBody& frame;
  std::vector<btRigidBody*> wheels;
  std::vector<QuaternionHinge*> hinges;
  std::deque<Turns> turns;

  explicit Shop(double frame_mass = 0, int iterations = 10)
      : world(0, iterations),
        frame(world.add_box(frame_mass, vec(2, 2, 0.1), scenes::pose_at(vec(0, 0, 0)))) {}
  // kg m^2 about its axis.
  QuaternionHinge& addWheel(double inertia = 1) {
    const btVector3 x = vec(double(wheels.size()), 0, 0.5);
    btRigidBody& wheel = world.add_box(1, vec(0.4, 0.4, 0.1), scenes::pose_at(x));
    wheel.setMassProps(1, vec(inertia, inertia, inertia));
    wheel.updateInertiaTensor();
    wheels.push_back(&wheel);
    hinges.push_back(&world.join<QuaternionHinge>(frame, wheel, scenes::pose_at(x), true));
    turns.emplace_back(wheel, z_axis);
    return *hinges.back();
  }
  GearJoint& gear(int i, int j, double ratio) {
    return world.add_joint<GearJoint>(*hinges[size_t(i)], *hinges[size_t(j)], scalar(ratio));
  }
  double angle(int i) { return turns[size_t(i)](); }
  double speed(int i) { return double(wheels[size_t(i)]->getAngularVelocity().z()); }
  void spin(int i, double speed) { wheels[size_t(i)]->setAngularVelocity(vec(0, 0, speed)); }
  void step(int steps = 1) {
    for (int i = 0; i < steps; ++i) {
      world.step(dt);
      for (Turns& of : turns) of();
    }
  }
  double kinetic() const {
    double sum = 0;
    for (const btRigidBody* body : wheels)
      sum += support::kineticEnergy(*body, body->getCenterOfMassTransform().getBasis());
    return sum;
  }
};

// rad: what poses of single precision round, of an angle and its multiple.
double rounding(double ratio) { return (1 + std::abs(ratio)) * (is_double ? 1e-9 : 2e-6); }

TEST(Explore, Torque) {
  for (const double ratio : {2.5, -1. / 3, pi}) {
    Shop shop;
    shop.addWheel(1);
    shop.addWheel(2);
    GearJoint& gear = shop.gear(0, 1, ratio);
    double worst = 0, off = 0;
    for (int i = 0; i < 600; ++i) {
      shop.wheels[0]->applyTorque(vec(0, 0, i < 300 ? 3 : -1));
      shop.step();
      worst = std::max(worst, std::abs(shop.angle(0) + ratio * shop.angle(1)));
      off = std::max(off, std::abs(shop.speed(0) + ratio * shop.speed(1)));
    }
    std::printf("ratio %g: worst %g rad, %g rad/s, angle %g, error %g; KE %g\n", ratio, worst, off, shop.angle(0), double(gear.getError()), shop.kinetic());
  }
}

TEST(Explore, Long) {
  for (const double ratio : {2.5, pi}) {
    Shop shop;
    for (int i = 0; i < 5; ++i) shop.addWheel(1 + i);
    for (int i = 0; i < 4; ++i) shop.gear(i, i + 1, i % 2 ? ratio : -1/ratio);
    shop.spin(0, 30);
    double worst = 0;
    const double before = shop.kinetic();
    for (int i = 0; i < 6000; ++i) {
      shop.step();
      if (i > 100)
      for (int k = 0; k < 4; ++k)
        worst = std::max(worst, std::abs(shop.angle(k) + (k % 2 ? ratio : -1/ratio) * shop.angle(k + 1)));
    }
    std::printf("chain %g: worst %g, angles %g %g, KE %g\n", ratio, worst, shop.angle(0), shop.angle(4), shop.kinetic()/before);
  }
}

}  // namespace
}  // namespace gear_joint_test

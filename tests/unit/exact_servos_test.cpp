// Servos are solved with all else, in the step in which something happens.
#include <pintle/joints/quaternion_hinge.h>

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "books.h"
#include "physics_support.h"
#include "support.h"

namespace exact_servos_test {
namespace {

using physics::rounding;
using support::Books;
using support::scalar;
using support::vec;

constexpr double dt = 1. / 60, length = 0.3;  // s, m
constexpr int count = 6;
/// So stiff that it gives by nothing: it is that of two links, and they bear six.
constexpr double stiff = 1e5;  // Hz

/// A level arm of six links on servos, without gravity. All of its bodies are at rest, until its last one is struck.
struct Arm {
  explicit Arm(double max_torque) : books(1 / dt) {
    books.world.setGravity(vec(0, 0, 0));
    btRigidBody* last = &books.add(0, vec(0.15, 0.05, 0.05), vec(0, 0, 0));
    for (int i = 1; i <= count; ++i) {
      btRigidBody& link = books.add(2, vec(0.15, 0.05, 0.05), vec(length * i, 0, 0));
      const btVector3 end = vec(length / 2, 0, 0), y = vec(0, 1, 0);
      auto hinge = std::make_unique<pintle::QuaternionHinge>(*last, link, end, -end, y, y);
      hinge->setMotorServo(0, scalar(stiff), 1, scalar(max_torque));
      hinges.push_back(hinge.get());
      books.join(std::move(hinge));
      last = &link;
    }
    for (int i = 0; i < 10; ++i) books.step();
  }
  btRigidBody& tip() { return *books.bodies.back(); }
  /// N m s: of a servo in the last step.
  double impulse(int i) const { return std::abs(double(hinges[size_t(i)]->getMotorImpulse())); }

  Books books;
  std::vector<pintle::QuaternionHinge*> hinges;
};

// Each bears the blow on its lever, in that step, and no body moves. On Bullet's solver it arrives step by step.
TEST(ExactServos, BearABlowInItsStep) {
  constexpr double blow = 3;  // N s
  Arm arm(support::infinite);
  for (int i = 0; i < count; ++i) EXPECT_LE(arm.impulse(i), 1e-9);
  arm.tip().applyCentralImpulse(vec(0, 0, -blow));
  arm.books.step();
  for (int i = 0; i < count; ++i) {
    const double lever = length * (count - i - 0.5);
    EXPECT_NEAR(arm.impulse(i), blow * lever, 1e-3 * blow * lever) << i;
  }
  for (const auto& body : arm.books.bodies) {
    EXPECT_LE(double(body->getLinearVelocity().length()), 1e-3);
    EXPECT_LE(double(body->getAngularVelocity().length()), 1e-3);
  }
  arm.books.step();
  for (int i = 0; i < count; ++i) EXPECT_LE(arm.impulse(i), 1e-3 * blow * length) << i;
}

// What is too much for one it takes as far as it can, in that step, too, and the rest moves the arm.
TEST(ExactServos, GiveAllThatTheyHaveInTheStepOfABlow) {
  constexpr double torque = 5, blow = 3, lever = length / 2;  // N m, N s, m
  Books books(1 / dt);
  books.world.setGravity(vec(0, 0, 0));
  btRigidBody& arm = books.add(2, vec(lever, 0.05, 0.05), vec(lever, 0, 0));
  auto made = std::make_unique<pintle::QuaternionHinge>(arm, vec(-lever, 0, 0), vec(0, 1, 0));
  pintle::QuaternionHinge& hinge = *made;
  books.join(std::move(made));
  hinge.setMotorServo(0, scalar(stiff), 1, scalar(torque));
  books.step();
  EXPECT_EQ(hinge.getMotorImpulse(), 0);
  arm.applyCentralImpulse(vec(0, 0, -blow));
  books.step();
  EXPECT_NEAR(std::abs(double(hinge.getMotorImpulse())), torque * dt, rounding(1e-7, 1e-12));
  const double inertia = 1 / double(arm.getInvInertiaDiagLocal().y()) + 2 * lever * lever;
  const double speed = (blow * lever - torque * dt) / inertia, turn = speed * dt;
  // Its centre goes along the chord.
  EXPECT_NEAR(std::abs(double(arm.getAngularVelocity().y())), speed, turn * turn * speed);
}

// A target that is moved is met in the step, by all bodies that hang on it.
TEST(ExactServos, MeetANewTargetInItsStep) {
  constexpr double turn = 0.01;  // rad
  Arm arm(support::infinite);
  arm.hinges[0]->setMotorServo(scalar(turn), scalar(stiff), 1, support::infinite);
  arm.books.step();
  EXPECT_NEAR(double(arm.hinges[0]->getHingeAngle()), turn, 1e-3 * turn);
  for (int i = 1; i < count; ++i)
    EXPECT_NEAR(double(arm.hinges[size_t(i)]->getHingeAngle()), 0, 1e-3 * turn) << i;
  const btVector3 tip = arm.tip().getCenterOfMassPosition();
  EXPECT_NEAR(std::abs(double(tip.z())), turn * length * (count - 0.5), 1e-2 * turn);
}

}  // namespace
}  // namespace exact_servos_test

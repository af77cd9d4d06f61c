// Shared by the physics tests: two bodies on a hinge about the world's z axis, and their true
// angle, counted body by body from the poses. What a joint says of itself is not evidence.
#pragma once

#include <gtest/gtest.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/solver/solver_options.h>
#include <scenes/world.h>

#include <cmath>
#include <limits>
#include <ostream>
#include <string>
#include <tuple>

#include "solver_of_tests.h"

namespace physics {

using scenes::degrees;
using scenes::pi;
using scenes::radians;

constexpr bool single_precision = sizeof(btScalar) == sizeof(float);

/// A tolerance that only rounding decides.
constexpr double rounding(double in_single, double in_double) {
  return single_precision ? in_single : in_double;
}

inline btVector3 vector(double x, double y, double z) { return scenes::to_bullet({x, y, z}); }

inline btTransform about_z(double angle, const Eigen::Vector3d& origin = {0, 0, 0}) {
  return btTransform(btQuaternion(vector(0, 0, 1), btScalar(angle)), scenes::to_bullet(origin));
}

/// What the hinge connects.
enum class Partner {
  fixed_b,   ///< a moves, b is static
  fixed_a,   ///< b moves, a is static
  free,      ///< both move
  kinematic  ///< a moves, b is turned by its owner
};

inline std::string to_string(Partner partner) {
  switch (partner) {
    case Partner::fixed_b: return "StaticB";
    case Partner::fixed_a: return "StaticA";
    case Partner::free: return "BothFree";
    case Partner::kinematic: return "KinematicB";
  }
  return "";
}

/// An angle in degrees as a part of a test's name.
inline std::string angle_name(double degrees_) {
  std::string text = std::to_string(degrees_);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  for (char& c : text) {
    if (c == '-') c = 'm';
    if (c == '.') c = 'p';
  }
  return text;
}

/// A spring: frequency (Hz), damping ratio, what it connects, steps a second.
using SpringCase = std::tuple<double, double, Partner, double>;
inline auto springCases() {
  return testing::Combine(testing::Values(0.1, 1, 5, 20, 60, 240),
                          testing::Values(0, 0.1, 0.7, 1, 3, 10),
                          testing::Values(Partner::fixed_b, Partner::fixed_a, Partner::free),
                          testing::Values(60., 240.));
}
inline std::string springName(const testing::TestParamInfo<SpringCase>& tested) {
  return angle_name(std::get<0>(tested.param)) + "HzDamped" +
         angle_name(std::get<1>(tested.param)) + to_string(std::get<2>(tested.param)) + "StepRate" +
         angle_name(std::get<3>(tested.param));
}

/// How far a body has turned about z, turns included: exact, for Bullet turns one body by less than
/// half a turn a step whatever its velocity.
class Turned {
 public:
  explicit Turned(const btRigidBody& body) : body_(body), angle_(wrapped()) {}
  void look() { angle_ += std::remainder(wrapped() - angle_, 2 * pi); }
  double angle() const { return angle_; }

 private:
  double wrapped() const {
    const Eigen::Vector3d x = scenes::direction_in_world(body_, {1, 0, 0});
    return std::atan2(x.y(), x.x());
  }

  const btRigidBody& body_;
  double angle_;
};

struct RigSettings {
  Partner partner = Partner::fixed_b;
  bool reference_a = false;  ///< useReferenceFrameA
  double start = 0;          ///< hinge angle, rad, within half a turn
  double offset = 0.3;       ///< m, from the hinge axis to the centre of each body that moves
  bool centred_a = false;    ///< not of a: the inertia of a free pair is then the same at any angle
  double kinematic_speed = 0;  ///< rad/s
  double dt = 1.0 / 60;        ///< s
  int iterations = 10;
};

/// Two boxes of 2 kg on a hinge about z through the origin, without gravity.
template <class Hinge = pintle::QuaternionHinge>
class HingeRig {
 public:
  explicit HingeRig(const RigSettings& settings)
      : settings_(settings),
        sign_(settings.reference_a ? -1 : 1),
        world_(0, settings.iterations),
        a_(add(settings.partner != Partner::fixed_a, arm_a(),
               settings.partner == Partner::fixed_a ? 0 : sign_ * settings.start)),
        b_(add(settings.partner == Partner::fixed_a || settings.partner == Partner::free, arm_b(),
               settings.partner == Partner::fixed_a ? -sign_ * settings.start : 0)),
        hinge_(world_.add_joint<Hinge>(a_, b_, scenes::pose_at(scenes::to_bullet(-arm_a())),
                                       scenes::pose_at(scenes::to_bullet(-arm_b())),
                                       settings.reference_a)),
        turned_a_(a_),
        turned_b_(b_) {
    if (settings.partner == Partner::kinematic) {
      b_.setCollisionFlags(b_.getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
      move_kinematic();
      look();
    }
  }

  Hinge& hinge() { return hinge_; }
  btRigidBody& a() { return a_; }
  btRigidBody& b() { return b_; }
  double dt() const { return settings_.dt; }
  /// +1: the hinge angle is that of a against b.
  double sign() const { return sign_; }

  /// One step; a kinematic body is then moved to where its velocity says that it is.
  void step() {
    world_.step(settings_.dt);
    if (settings_.partner == Partner::kinematic) move_kinematic();
    look();
  }

  /// From the next move on.
  void set_kinematic_speed(double speed) { settings_.kinematic_speed = speed; }

  /// Torque (N m) along the hinge angle, for the next step.
  void push(double torque) {
    a_.applyTorque(vector(0, 0, sign_ * torque));
    b_.applyTorque(vector(0, 0, -sign_ * torque));
  }

  /// Lets the bodies turn about the hinge axis, each at its own speed (rad/s, world).
  void spin(double w_a, double w_b) {
    const auto set = [](btRigidBody& body, double w) {
      body.setAngularVelocity(vector(0, 0, w));
      body.setLinearVelocity(
          scenes::to_bullet(Eigen::Vector3d(0, 0, w).cross(scenes::position(body))));
    };
    if (a_.getInvMass() > 0) set(a_, w_a);
    if (b_.getInvMass() > 0) set(b_, w_b);
  }
  /// The same, by the hinge's own speed: that of the body that moves, or half each.
  void spin(double speed) {
    const double w = sign_ * speed;
    settings_.partner == Partner::free ? spin(w / 2, -w / 2) : spin(w, -w);
  }

  /// Takes the angle after the poses were changed from outside.
  void look() {
    turned_a_.look();
    turned_b_.look();
  }
  /// The true hinge angle, turns included, rad.
  double angle() const {
    // How far its owner has turned a kinematic body is known without looking.
    const bool kinematic = settings_.partner == Partner::kinematic;
    return sign_ * (turned_a_.angle() - (kinematic ? kinematic_angle_ : turned_b_.angle()));
  }
  /// m, between the two anchors.
  double gap() const {
    return (scenes::point_in_world(a_, -arm_a()) - scenes::point_in_world(b_, -arm_b())).norm();
  }
  /// Its speed, rad/s.
  double speed() const {
    return sign_ * double(a_.getAngularVelocity().z() - b_.getAngularVelocity().z());
  }
  /// What a torque along the hinge angle has to speed up, kg m^2: the inertia of the body that
  /// moves about the hinge axis; of a free pair (with centred_a) that of both against each other.
  double inertia() const {
    const double offset2 = settings_.offset * settings_.offset;
    if (settings_.partner != Partner::free) {
      const btRigidBody& body = a_.getInvMass() > 0 ? a_ : b_;
      return double(body.getLocalInertia().z()) + (settings_.centred_a ? 0 : mass * offset2);
    }
    const double own = double(a_.getLocalInertia().z());
    return 1 / (1 / own + 1 / (own + mass / 2 * offset2));
  }

  static constexpr double mass = 2;  // kg

  /// Which part of the way of a step the pull of a spring of w (rad/s) knows: all of it is an implicit Euler step. The exact solver leaves
  /// springs that its steps resolve as they are: dt^2 k J M^-1 J^T below SolverOptions::stable_swing, with bodies that nothing holds.
  double springShare(double w) const {
    if (!onExactSolver()) return 1;
    const double h = settings_.dt, swing = h * h * w * w * inertia() *
                                           double(a_.getInvInertiaTensorWorld()[2][2] +
                                                  b_.getInvInertiaTensorWorld()[2][2]);
    return std::max(0., 1 - pintle::SolverOptions().stable_swing / swing);
  }

 private:
  Eigen::Vector3d arm_a() const {
    return settings_.partner == Partner::fixed_a || settings_.centred_a
               ? Eigen::Vector3d(0, 0, 0)
               : Eigen::Vector3d(settings_.offset, 0, 0);
  }
  Eigen::Vector3d arm_b() const {
    return settings_.partner == Partner::fixed_a ? Eigen::Vector3d(0, settings_.offset, 0)
           : settings_.partner == Partner::free  ? Eigen::Vector3d(0, -settings_.offset, 0)
                                                 : Eigen::Vector3d(0, 0, 0);
  }
  btRigidBody& add(bool moves, const Eigen::Vector3d& arm, double angle) {
    const btTransform turn = about_z(angle);
    return world_.add_box(moves ? mass : 0, vector(0.4, 0.2, 0.1),
                          turn * scenes::pose_at(scenes::to_bullet(arm)));
  }
  void move_kinematic() {
    kinematic_angle_ += settings_.kinematic_speed * settings_.dt;
    b_.setCenterOfMassTransform(about_z(kinematic_angle_));
  }

  RigSettings settings_;
  double sign_;
  scenes::World world_;
  btRigidBody& a_;
  btRigidBody& b_;
  Hinge& hinge_;
  Turned turned_a_, turned_b_;
  double kinematic_angle_ = 0;
};

}  // namespace physics

// An arm on an elbow that keeps it within a wedge: thrown at the limits, and left to hang in the
// corner.
//
// A cube of 1 kg at the end of an arm of 0.3 m turns about a pivot. Its direction may point anywhere
// within half planes at -total/2 and total/2 about the wedge axis, which is z of a frame in the
// world. No stock joint has this limit; the nearest is the six degree of freedom joint with its
// first angle, about z, limited, which is singular where the direction nears the axis.
//
// Thrown: from 24 directions inside at `speed`, without gravity, for 2 s each. Measured:
//   beyond      how far outside it came, rad, by the shortest way back in
//   fastest     its largest angular speed over `speed`: above 1 the limit has thrown it
// Hanging, with air drag, for 10 s, where straight down is 40 degrees off the axis and behind the
// edge: a wedge of less than half a turn holds it in the corner, along the axis; a wider one on a
// side. Measured in the last 2 s:
//   restless    the largest angular speed, rad/s
//   off         how far outside it rests, rad
// Ideal: 0, 1, 0, 0.

#pragma once

#include <BulletDynamics/ConstraintSolver/btGeneric6DofSpring2Constraint.h>

#include <algorithm>
#include <cmath>

#include "directions.h"
#include "world.h"

namespace scenes {

// The direction at psi about z and at `height` from it, rad.
inline Eigen::Vector3d wedge_direction(double psi, double height) {
  return {std::sin(height) * std::cos(psi), std::sin(height) * std::sin(psi), std::cos(height)};
}

struct WedgeSettings {
  double total = radians(60);  // rad
  double speed = 6;            // rad/s
  double dt = 1.0 / 60;        // s
  int iterations = 10;
  SolverFactory make_solver = {};
};

struct WedgeResult {
  double beyond = 0, fastest = 0;
  double restless = 0, off = 0;
  bool finite = true;
  double microseconds_per_step = 0;  // wall-clock: does not repeat
};

// A joint whose x of b keeps within the wedge about z of a.
template <class Joint>
std::unique_ptr<btTypedConstraint> make_wedge(btRigidBody& a, btRigidBody& b,
                                              const btTransform& in_a, const btTransform& in_b,
                                              const Wedge& wedge) {
  if constexpr (std::is_same_v<Joint, btGeneric6DofSpring2Constraint>) {
    auto joint = std::make_unique<Joint>(a, b, in_a, in_b, RO_ZYX);
    joint->setLinearLowerLimit(btVector3(0, 0, 0));
    joint->setLinearUpperLimit(btVector3(0, 0, 0));
    joint->setAngularLowerLimit(btVector3(1, 1, btScalar(wedge.low)));  // x and y are free
    joint->setAngularUpperLimit(btVector3(-1, -1, btScalar(wedge.high)));
    return joint;
  } else {
    auto joint = std::make_unique<Joint>(a, b, in_a, in_b);
    joint->setLimit(btScalar(wedge.low), btScalar(wedge.high));
    return joint;
  }
}

template <class Joint>
class Elbow {
 public:
  // The cube points along `start` in the frame of the wedge, whose world rotation is `frame`.
  Elbow(const WedgeSettings& settings, const Wedge& wedge, double gravity,
        const btQuaternion& frame, const Eigen::Vector3d& start)
      : settings_(settings),
        wedge_(wedge),
        world_(gravity, settings.iterations, settings.make_solver),
        frame_(btTransform(frame)),
        cube_(add_cube(frame * shortestArcQuat(btVector3(1, 0, 0), to_bullet(start)))) {
    btRigidBody& fixed = world_.add_box(
        0, btVector3(btScalar(0.05), btScalar(0.05), btScalar(0.05)), btTransform::getIdentity());
    world_.take_joint(
        make_wedge<Joint>(fixed, cube_, frame_, pose_at(btVector3(btScalar(-arm), 0, 0)), wedge));
  }

  // Turns about the pivot, rad/s.
  void spin(const Eigen::Vector3d& w) {
    cube_.setAngularVelocity(to_bullet(w));
    cube_.setLinearVelocity(to_bullet(w).cross(cube_.getCenterOfMassPosition()));
  }
  void drag(double damping) { cube_.setDamping(btScalar(damping), btScalar(damping)); }
  void step() { world_.step(settings_.dt); }
  double outside() const {
    const btVector3 c = cube_.getCenterOfMassTransform().getBasis().getColumn(0);
    return wedge_.outside(to_eigen(frame_.getBasis().transpose() * c));
  }
  double speed() const { return to_eigen(cube_.getAngularVelocity()).norm(); }
  double microseconds_per_step() const { return world_.microseconds_per_step(); }

 private:
  static constexpr double arm = 0.3;  // m

  btRigidBody& add_cube(const btQuaternion& turn) {
    return world_.add_box(1, btVector3(btScalar(0.05), btScalar(0.05), btScalar(0.05)),
                          btTransform(turn, quatRotate(turn, btVector3(btScalar(arm), 0, 0))));
  }

  WedgeSettings settings_;
  Wedge wedge_;
  World world_;
  btTransform frame_;
  btRigidBody& cube_;
};

template <class Joint>
WedgeResult wedge(const WedgeSettings& settings) {
  const Wedge limit{-settings.total / 2, settings.total / 2};
  WedgeResult result;
  const int steps = int(std::lround(2 / settings.dt));
  for (int n = 0; n < 24; ++n) {
    // Directions and spins that are spread out and repeat: multiples of the golden angle.
    const double turn = 2.39996 * n;
    const double psi = 0.9 * limit.high * std::sin(turn), height = 0.15 + 2.8 * (n + 0.5) / 24;
    Elbow<Joint> elbow(settings, limit, 0, btQuaternion::getIdentity(),
                       wedge_direction(psi, height));
    elbow.spin(settings.speed * wedge_direction(turn, 0.3 + 2.5 * ((7 * n) % 24) / 24.));
    for (int i = 0; i < steps && result.finite; ++i) {
      elbow.step();
      result.finite = std::isfinite(elbow.outside() + elbow.speed());
      result.beyond = std::max(result.beyond, elbow.outside());
      result.fastest = std::max(result.fastest, elbow.speed() / settings.speed);
    }
  }
  // Straight down opposite the middle, 40 degrees off the axis; a little to one side, so that it is
  // known which way a wedge of more than half a turn lets it slide.
  const Eigen::Vector3d down = wedge_direction(pi - 0.1, radians(40));
  Elbow<Joint> elbow(settings, limit, standard_gravity,
                     shortestArcQuat(to_bullet(down), btVector3(0, 0, -1)),
                     wedge_direction(0.2 * limit.high, 0.4));
  elbow.drag(0.9);
  for (int i = 0; i < 5 * steps && result.finite; ++i) {
    elbow.step();
    result.finite = std::isfinite(elbow.outside() + elbow.speed());
    if (i < 4 * steps) continue;
    result.restless = std::max(result.restless, elbow.speed());
    result.off = std::max(result.off, elbow.outside());
  }
  result.microseconds_per_step = elbow.microseconds_per_step();
  return result;
}

}  // namespace scenes

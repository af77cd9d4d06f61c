// A cube whose x axis leans out of the plane in which an angle is measured is pushed round against the
// limit of that angle for a second. The document's row has the gradient of the angle for a cube that
// stands upright; the exact one knows how it leans.
//   beyond      the farthest that the angle of x about the upright axis gets beyond the limit, rad
// Ideal: 0.

#pragma once

#include <algorithm>
#include <cmath>

#include "world.h"

namespace scenes {

struct TiltSettings {
  double tilt = radians(60);  // rad, between x and the plane
  double torque = 0.02;       // N m, about the world's x: along the way that the printed row misses
  double dt = 1.0 / 60;       // s
  double seconds = 1;
};

struct TiltResult {
  double beyond = 0;  // rad
  bool finite = true;
  double microseconds_per_step = 0;  // wall-clock: does not repeat
};

template <class Limit, class Configure = AsConstructed>
TiltResult tilt(const TiltSettings& settings, Configure configure = {}) {
  World world(0);
  const btVector3 half_extents(btScalar(0.1), btScalar(0.1), btScalar(0.1));
  btRigidBody& post = world.add_box(0, half_extents, pose_at({0, 0, 0}));
  const Eigen::Matrix3d lean =
      Eigen::AngleAxisd(-settings.tilt, Eigen::Vector3d::UnitY()).toRotationMatrix();
  btRigidBody& cube =
      world.add_box(1, half_extents, btTransform(matrix_to_bullet(lean), btVector3(0, 0, 0)));
  Limit& limit =
      world.add_joint<Limit>(post, cube, btTransform::getIdentity(), btTransform::getIdentity());
  limit.setLimit(-1, 0);
  configure(limit);

  TiltResult result;
  const int steps = int(std::lround(settings.seconds / settings.dt));
  for (int step = 1; step <= steps; ++step) {
    cube.applyTorque(btVector3(btScalar(-settings.torque), 0, 0));
    world.step(settings.dt);
    const Eigen::Vector3d x = direction_in_world(cube, {1, 0, 0});
    const double angle = std::atan2(x.y(), x.x());
    result.finite = std::isfinite(angle);
    if (!result.finite) break;
    result.beyond = std::max(result.beyond, angle);
  }
  result.microseconds_per_step = world.microseconds_per_step();
  return result;
}

}  // namespace scenes

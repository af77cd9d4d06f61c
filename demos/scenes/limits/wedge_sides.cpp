// A forearm that hangs down is swung round, and slides along the sides of its wedge, which is free along its axis.

#include "../catalog.h"

namespace scenes {

Scene wedge_sides_scene() {
  const double half_length = 0.3;  // m
  Scene scene{"wedge_sides", "forearm that slides along the sides of a wedge"};
  scene.show(Group::limits, "A wedge",
             "A forearm is swung round between two half planes, and slides along them.");
  const Vector3d down(0, 0, -1), axis(0, 1, 0);
  Eigen::Matrix3d frame;
  frame << down, axis.cross(down), axis;
  const Eigen::Quaterniond turn(frame);
  Body forearm = box(2, {half_length, 0.05, 0.05}, half_length * down, turn);
  spin(forearm, {6, -7, 0}, {0, 0, 0});  // rad/s
  const int moving = scene.add(forearm);
  Joint& joint = scene.connect(Kind::wedge, 0, moving, Isometry3d(turn));
  joint.in_b = at({-half_length, 0, 0});
  joint.range = {radians(-35), radians(35)};
  scene.seconds = 4;
  scene.errors = {Error::overshoot, Error::gap};
  scene.compared = Compared::nowhere;
  return scene;
}

}  // namespace scenes

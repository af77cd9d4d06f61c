// A limb is swung round and rides on the rim of its elliptic cone, which hangs down. Going round turns it about
// itself, up to its twist limit.

#include "../catalog.h"

namespace scenes {

Scene cone_rim_scene() {
  const double half_length = 0.3, bend = 0.3;  // m, rad
  Scene scene{"cone_rim", "limb that rides on the rim of an elliptic cone"};
  scene.show(Group::limits, "A cone and a twist",
             "A limb is swung round in its elliptic cone, and rides on the rim. The small arc is "
             "its twist.");
  const Eigen::Quaterniond frame = turn_between(Vector3d::UnitX(), {0, 0, -1});
  const Eigen::Quaterniond turn = frame * Eigen::AngleAxisd(bend, Vector3d::UnitY());
  const Vector3d along = turn * Vector3d::UnitX(), way = frame * Vector3d::UnitY();
  Body limb = box(2, {half_length, 0.04, 0.08}, half_length * along, turn);
  spin(limb, 8 * along.cross(way), {0, 0, 0});  // rad/s
  const int moving = scene.add(limb);
  Joint& joint = scene.connect(Kind::cone_twist, 0, moving, Isometry3d(frame));
  joint.in_b = at({-half_length, 0, 0});
  joint.spans = {0.9, 0.5, 0.4};
  scene.seconds = 4;
  scene.errors = {Error::overshoot, Error::gap};
  scene.compared = Compared::nowhere;
  return scene;
}

}  // namespace scenes

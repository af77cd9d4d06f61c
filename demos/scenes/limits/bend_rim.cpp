// A shaft on a constant velocity joint is swung round at the most that the joint bends. It goes round without
// turning about itself against the other shaft, which stands still.

#include "../catalog.h"

namespace scenes {

Scene bend_rim_scene() {
  const double half_length = 0.3, bend = 0.3;  // m, rad
  Scene scene{"bend_rim", "shaft that rides on the cone of its bend"};
  scene.show(Group::limits, "The bend of a constant velocity joint",
             "A shaft is swung round as far as its joint bends. It does not turn about itself.");
  const Eigen::Quaterniond frame = turn_between(Vector3d::UnitX(), {0, 0, -1});
  const Eigen::Quaterniond turn = frame * Eigen::AngleAxisd(bend, Vector3d::UnitY());
  const Vector3d still = frame * Vector3d::UnitX(), along = turn * Vector3d::UnitX();
  const Vector3d round = along.cross(frame * Vector3d::UnitY());
  Body shaft = box(2, {half_length, 0.04, 0.08}, half_length * along, turn);
  // Across both shafts' bisector, so that there is no twist.
  const Vector3d across = round - round.dot(still) / (1 + std::cos(bend)) * along;
  spin(shaft, 8 * across, {0, 0, 0});  // rad/s
  const int moving = scene.add(shaft);
  Joint& joint = scene.connect(Kind::constant_velocity, 0, moving, Isometry3d(frame));
  joint.in_b = at({-half_length, 0, 0});
  joint.range = {0, radians(45)};
  scene.seconds = 4;
  scene.errors = {Error::overshoot, Error::gap, Error::axis};
  scene.compared = Compared::nowhere;
  return scene;
}

}  // namespace scenes

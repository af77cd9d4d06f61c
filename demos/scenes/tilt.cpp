// A cube whose x axis leans out of the plane in which an angle is measured is pushed round against the
// limit of that angle. The document's row has the gradient of the angle for a cube that stands
// upright; the exact one knows how it leans.

#include "catalog.h"

namespace scenes {

Scene tilt_scene(double tilt) {
  Scene scene{"tilt", "a leaning cube is pushed against the limit of an angle"};
  scene.show(Group::measured, "Tilt", "A leaning cube is pushed against the limit of an angle.");
  scene.gravity = 0;
  Body leaning = box(1, {0.1, 0.1, 0.1}, {0, 0, 0},
                     Eigen::Quaterniond(Eigen::AngleAxisd(-tilt, Vector3d::UnitY())));
  leaning.torque = {-0.02, 0, 0};  // along the way that the printed row misses
  const int cube = scene.add(leaning);
  Joint& limit = scene.connect(Kind::angle, 0, cube, at({0, 0, 0}));
  limit.in_b.setIdentity();
  limit.range = {-1, 0};
  scene.seconds = 1;
  scene.errors = {Error::overshoot};
  scene.compared = Compared::nowhere;
  return scene;
}

}  // namespace scenes

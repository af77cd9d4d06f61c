// A forearm on an elbow falls and is thrown against the sides of its wedge: acute, about level; or
// beyond 180 degrees, about upright, where gravity still ends at a side.

#include "catalog.h"

namespace scenes {

Scene wedge_elbow_scene(double total) {
  const bool acute = total < pi;
  const double arm = 0.3;
  const Vector3d reference = acute ? Vector3d(1, 0, 0) : Vector3d(0, 0, 1);

  Scene scene;
  scene.name = acute ? "wedge_acute" : "wedge_wide";
  scene.title =
      "elbow in a wedge of " + std::to_string(int(std::lround(degrees(total)))) + " degrees";
  Body forearm = box(1, {0.05, 0.05, 0.05}, arm * reference);
  forearm.damping = 0.5;
  spin(forearm, {2, 3, 4}, {0, 0, 0});
  const int moving = scene.add(forearm);
  Isometry3d frame;  // x the reference, z the wedge axis
  frame.setIdentity();
  frame.linear() << reference, reference.cross(Vector3d::UnitY()) * -1, Vector3d::UnitY();
  scene.connect(Kind::wedge, 0, moving, frame).range = {-total / 2, total / 2};
  scene.errors = {Error::overshoot, Error::gap, Error::gained};
  scene.energy_scale = standard_gravity * arm;
  return scene;
}

}  // namespace scenes

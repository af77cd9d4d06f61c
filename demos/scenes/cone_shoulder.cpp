// A limb is thrown against the limits of its shoulder and then hangs in them: the cone is level, so
// that gravity pulls the limb into its edge.

#include "catalog.h"

namespace scenes {

Scene cone_shoulder_scene(const Spans& spans, const Vector3d& throw_spin) {
  const double half_length = 0.3;
  Scene scene{"cone_shoulder", "limb thrown at an elliptic cone and a twist limit"};
  scene.show(Group::measured, "Shoulder",
             "A limb is thrown at its elliptic cone, and hangs in it.");
  Body limb = box(3, {half_length, 0.06, 0.08}, {half_length, 0, 0});
  limb.damping = 0.6;
  spin(limb, throw_spin, {0, 0, 0});
  const int moving = scene.add(limb);
  scene.connect(Kind::cone_twist, 0, moving, at({0, 0, 0})).spans = spans;
  scene.errors = {Error::overshoot, Error::gap};
  return scene;
}

}  // namespace scenes

// A limb is thrown at a flat elliptic cone, without gravity. Its energy can only fall.

#include "../catalog.h"

namespace scenes {

Scene flat_cone_scene() {
  Scene scene = cone_shoulder_scene({0.1, 1.2, 0.3}, {2, 6, -5});
  scene.name = "flat_cone";
  scene.title = "limb thrown at a flat elliptic cone";
  scene.show(
      Group::wrong, "A cone that gives energy",
      "A limb is thrown at an elliptic cone, and nothing else acts on it. Look at its speed.");
  scene.gravity = 0;
  Body& limb = scene.bodies.back();
  limb.damping = 0;
  scene.energy_scale = 0.5 * limb.mass * limb.velocity.squaredNorm() +
                       0.5 * limb.inertia.dot(limb.angular_velocity.cwiseAbs2());
  scene.errors = {Error::gained, Error::overshoot, Error::gap};
  scene.compared = Compared::nowhere;
  scene.mended = {Error::gained, 2, 0.05};
  return scene;
}

}  // namespace scenes

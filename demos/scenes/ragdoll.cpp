// A ragdoll falls on the ground: cone-twist joints in neck, spine, shoulders and hips, hinges with
// limits in elbows and knees, contacts with the ground and between limbs.

#include "catalog.h"

namespace scenes {
namespace {

int limb(Scene& scene, double mass, const Vector3d& half_extents, const Vector3d& position) {
  Body body = box(mass, half_extents, position);
  body.collides = true;
  body.velocity = {1, 0.5, 0};
  return scene.add(body);
}

}  // namespace

Scene ragdoll_scene() {
  Scene scene{"ragdoll", "falls on the ground"};
  scene.bodies[0].half_extents = {20, 20, 1};
  scene.bodies[0].pose = at({0, 0, -1});
  scene.bodies[0].collides = true;

  const double drop = 0.5;  // m, of the feet
  const auto up = [&](double x, double y, double z) { return Vector3d(x, y, z + drop); };
  const auto swing = [&](int parent, int child, const Vector3d& point, const Vector3d& along,
                         const Spans& spans) {
    scene.connect(Kind::cone_twist, parent, child, with_x(point, along)).spans = spans;
  };
  const auto bend = [&](int parent, int child, const Vector3d& point, const Vector3d& axis) {
    scene.connect(Kind::hinge, parent, child, with_z(point, axis)).range = {radians(-5),
                                                                            radians(130)};
  };
  const Vector3d x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  const int pelvis = limb(scene, 12, {0.10, 0.16, 0.08}, up(0, 0, 0.95));
  const int chest = limb(scene, 20, {0.11, 0.18, 0.17}, up(0, 0, 1.23));
  const int head = limb(scene, 5, {0.09, 0.08, 0.12}, up(0, 0, 1.56));
  swing(pelvis, chest, up(0, 0, 1.05), z, {0.4, 0.4, 0.3});
  swing(chest, head, up(0, 0, 1.42), z, {0.6, 0.5, 0.8});
  for (const double side : {-1., 1.}) {
    const int arm = limb(scene, 2.5, {0.045, 0.14, 0.045}, up(0, side * 0.34, 1.34));
    const int forearm = limb(scene, 1.8, {0.04, 0.13, 0.04}, up(0, side * 0.63, 1.34));
    swing(chest, arm, up(0, side * 0.19, 1.34), side * y, {1.2, 1.0, 0.7});
    bend(arm, forearm, up(0, side * 0.49, 1.34), side * z);
    const int thigh = limb(scene, 8, {0.07, 0.07, 0.19}, up(0, side * 0.1, 0.67));
    const int shin = limb(scene, 4, {0.05, 0.05, 0.21}, up(0, side * 0.1, 0.24));
    swing(pelvis, thigh, up(0, side * 0.1, 0.88), -z, {0.6, 1.1, 0.4});
    bend(thigh, shin, up(0, side * 0.1, 0.46), y);
  }
  scene.seconds = 3;
  scene.errors = {Error::gap, Error::overshoot, Error::axis, Error::gained};
  scene.energy_scale = 70 * standard_gravity;
  return scene;
}

}  // namespace scenes

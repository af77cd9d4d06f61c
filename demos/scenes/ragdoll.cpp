// A ragdoll falls on the ground, or down a flight of stairs: cone-twist joints in neck, spine, shoulders and
// hips, hinges with limits in elbows and knees, contacts with the ground and between limbs.

#include "catalog.h"

namespace scenes {
namespace {

using Limb = Body (*)(double mass, const Vector3d& half_extents, const Vector3d& position);

Body box_limb(double mass, const Vector3d& half_extents, const Vector3d& position) {
  return box(mass, half_extents, position);
}

// Round along its longest side.
Body round_limb(double mass, const Vector3d& half, const Vector3d& position) {
  Eigen::Index longest;
  const double length = half.maxCoeff(&longest);
  const double radius = std::sqrt(half.prod() / length);
  if (length < 1.5 * radius) return box(mass, half, position);
  return capsule(mass, radius, length - radius, position,
                 turn_between(Vector3d::UnitZ(), Vector3d::Unit(longest)));
}

// Stands with its feet at a point.
void add_ragdoll(Scene& scene, const Vector3d& feet, const Vector3d& velocity, Limb make_limb) {
  const auto up = [&](double x, double y, double z) { return Vector3d(feet + Vector3d(x, y, z)); };
  const auto limb = [&](double mass, const Vector3d& half_extents, const Vector3d& position) {
    Body body = solid(make_limb(mass, half_extents, position));
    body.velocity = velocity;
    return scene.add(body);
  };
  const auto swing = [&](int parent, int child, const Vector3d& point, const Vector3d& along,
                         const Spans& spans) {
    scene.connect(Kind::cone_twist, parent, child, with_x(point, along)).spans = spans;
  };
  const auto bend = [&](int parent, int child, const Vector3d& point, const Vector3d& axis) {
    scene.connect(Kind::hinge, parent, child, with_z(point, axis)).range = {radians(-5),
                                                                            radians(130)};
  };
  const Vector3d x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  const int pelvis = limb(12, {0.10, 0.16, 0.08}, up(0, 0, 0.95));
  const int chest = limb(20, {0.11, 0.18, 0.17}, up(0, 0, 1.23));
  const int head = limb(5, {0.09, 0.08, 0.12}, up(0, 0, 1.56));
  swing(pelvis, chest, up(0, 0, 1.05), z, {0.4, 0.4, 0.3});
  swing(chest, head, up(0, 0, 1.42), z, {0.6, 0.5, 0.8});
  for (const double side : {-1., 1.}) {
    const int arm = limb(2.5, {0.045, 0.14, 0.045}, up(0, side * 0.34, 1.34));
    const int forearm = limb(1.8, {0.04, 0.13, 0.04}, up(0, side * 0.63, 1.34));
    swing(chest, arm, up(0, side * 0.19, 1.34), side * y, {1.2, 1.0, 0.7});
    bend(arm, forearm, up(0, side * 0.49, 1.34), side * z);
    const int thigh = limb(8, {0.07, 0.07, 0.19}, up(0, side * 0.1, 0.67));
    const int shin = limb(4, {0.05, 0.05, 0.21}, up(0, side * 0.1, 0.24));
    swing(pelvis, thigh, up(0, side * 0.1, 0.88), -z, {0.6, 1.1, 0.4});
    bend(thigh, shin, up(0, side * 0.1, 0.46), y);
  }
}

}  // namespace

Scene ragdoll_scene() {
  Scene scene{"ragdoll", "falls on the ground"};
  scene.show(Group::measured, "Ragdoll", "It falls on the ground.");
  scene.bodies[0].half_extents = {20, 20, 1};
  scene.bodies[0].pose = at({0, 0, -1});
  scene.bodies[0].collides = true;
  add_ragdoll(scene, {0, 0, 0.5}, {1, 0.5, 0}, box_limb);
  scene.seconds = 3;
  scene.errors = {Error::gap, Error::overshoot, Error::axis, Error::gained};
  scene.energy_scale = 70 * standard_gravity;
  return scene;
}

Scene stairs_scene() {
  Scene scene{"stairs", "a ragdoll falls down a flight of stairs"};
  scene.show(Group::known, "Ragdoll on stairs",
             "It falls down nine steps. Do limbs stay in their sockets?");
  const int steps = 9;
  const double tread = 0.34, rise = 0.2;  // m
  scene.bodies[0].half_extents = {20, 20, 1};
  scene.bodies[0].pose = at({0, 0, -1});
  scene.bodies[0].collides = true;
  for (int i = 0; i < steps; ++i) {
    const double top = rise * (steps - i), depth = i == 0 ? 0.7 : tread / 2;
    const double x = i == 0 ? -0.7 + tread / 2 : i * tread;
    scene.add(solid(box(0, {depth, 0.9, top / 2}, {x, 0, top / 2})));
  }
  add_ragdoll(scene, {-0.3, 0, rise * steps + 0.02}, {1.8, 0.15, 0}, round_limb);
  scene.seconds = 5;
  scene.errors = {Error::gap, Error::overshoot, Error::axis};
  scene.energy_scale = 70 * standard_gravity;
  scene.compared = Compared::nowhere;
  return scene;
}

}  // namespace scenes

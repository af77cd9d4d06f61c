// A weight on a rod, that swings, and on a rope that is slack at first: it falls, goes taut, and
// swings. Bullet's own joints have no distance: they make a rod of a stick and a rope of ten, each
// stick 1 % of the weight's mass, with ball joints between. (A stick on its own changes the period
// by -8e-4.)

#include "catalog.h"

#include <algorithm>

namespace scenes {
namespace {

constexpr double length = 1, amplitude = radians(60);

// The weight alone, which is the probe.
Scene weight_scene(bool slack) {
  Scene scene;
  scene.name = slack ? "rope" : "rod";
  scene.title = slack ? "a weight falls until its rope is taut" : "a weight swings on a rod";
  const Vector3d hanging = length * Vector3d(std::sin(amplitude), 0, -std::cos(amplitude));
  const Body weight = box(2, {0.05, 0.05, 0.05}, slack ? Vector3d(0.3, 0, 0) : hanging);
  scene.probe_body = scene.add(weight);
  scene.seconds = 20;
  scene.compared = Compared::nowhere;
  scene.energy_scale =
      weight.mass * standard_gravity * length * (slack ? 1 : 1 - std::cos(amplitude));
  return scene;
}

}  // namespace

Scene rope_scene(bool slack) {
  Scene scene = weight_scene(slack);
  if (slack) {
    scene.show(Group::measured, "Rope", "Slack at first, then it catches a fall.");
  } else {
    scene.show(Group::measured, "Rod", "A weight swings on a rod, from 60 degrees.");
  }
  Joint& joint = scene.connect(Kind::distance, 0, scene.probe_body, at({0, 0, 0}));
  joint.in_b.setIdentity();
  joint.range = {slack ? 0 : length, length};
  scene.errors = {Error::overshoot, slack ? Error::gained : Error::energy};
  return scene;
}

Scene stick_rope_scene(bool slack) {
  Scene scene = weight_scene(slack);
  const Vector3d end = scene.bodies[size_t(scene.probe_body)].pose.translation();
  const int sticks = slack ? 10 : 1;
  const double stick_length = length / sticks;
  // In zigzag from the point to the weight.
  const Vector3d way = end / sticks;
  const double across = stick_length * stick_length - way.squaredNorm();
  const Vector3d side(0, std::sqrt(std::max(0., across)), 0);
  int last = 0;
  for (int i = 0; i < sticks; ++i) {
    const Vector3d from = i * way + (i % 2 == 0 ? Vector3d(0, 0, 0) : side),
                   along = way + (i % 2 == 0 ? 1 : -1) * side;
    const auto turn = turn_between(Vector3d::UnitX(), along);
    const int stick = scene.add(box(0.02, {stick_length / 2, 0.01, 0.01}, from + along / 2, turn));
    scene.connect(Kind::ball, last, stick, at(from));
    last = stick;
  }
  scene.connect(Kind::ball, last, scene.probe_body, at(end));
  return scene;
}

}  // namespace scenes

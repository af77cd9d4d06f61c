// A motor turns a crank at constant speed; a rod between two ball joints drives a piston along its
// slider: a loop of three kinds of joint.
//
// With the crank at w t from the slider's axis the piston is at
//   x(t) = r cos(w t) + sqrt(l^2 - r^2 sin^2(w t)).

#include "catalog.h"

namespace scenes {

Scene slider_crank_scene(double w, double r, double l) {
  const auto bar = [](double length) { return Vector3d(length / 2, 0.03, 0.03); };

  Scene scene{"slider_crank", "motor, crank, rod and piston"};
  scene.show(Group::measured, "Slider crank", "A motor drives a piston.");
  // The crank turns from x to z, that is about -y.
  Body crank_body = box(1, bar(r), {r / 2, 0, 0});
  spin(crank_body, {0, -w, 0}, {0, 0, 0});
  Body rod_body = box(1, bar(l), {r + l / 2, 0, 0});
  spin(rod_body, {0, w * r / l, 0}, {r + l, 0, 0});
  const int crank = scene.add(crank_body), rod = scene.add(rod_body);
  const int piston = scene.add(box(2, {0.1, 0.1, 0.1}, {r + l, 0, 0}));
  scene.connect(Kind::hinge, 0, crank, with_z({0, 0, 0}, {0, -1, 0})).motor = {
      [w](double) { return w; }, 6e4};
  scene.connect(Kind::ball, crank, rod, at({r, 0, 0}));
  scene.connect(Kind::ball, rod, piston, at({r + l, 0, 0}));
  scene.connect(Kind::slider, 0, piston, at({0, 0, 0})).in_b.setIdentity();  // its position is x
  scene.errors = {Error::trajectory, Error::gap};
  scene.probe_body = piston;
  scene.horizon = scene.seconds;
  scene.closed_form = [=](double time) {
    const double across = r * std::sin(w * time);
    return Vector3d(r * std::cos(w * time) + std::sqrt(l * l - across * across), 0, 0);
  };
  return scene;
}

}  // namespace scenes

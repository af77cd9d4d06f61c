// A weight on an upright slider with a spring of 2 Hz and damping ratio 0.05 is struck while the
// spring has no load: x'' + 2 z w x' + w^2 x = -g.

#include "catalog.h"

namespace scenes {

Scene spring_scene() {
  const double frequency = 2, z = 0.05, speed = 1;  // Hz, -, m/s
  Scene scene{"spring", "weight on a spring of 2 Hz"};
  scene.show(Group::measured, "Spring", "A slider on a spring.");
  Body weight = box(2, {0.1, 0.1, 0.1}, {0, 0, 0});
  weight.velocity = {0, 0, speed};
  const int moving = scene.add(weight);
  scene.connect(Kind::slider, 0, moving, with_x({0, 0, 0}, Vector3d::UnitZ())).spring = {frequency,
                                                                                         z};
  scene.errors = {Error::trajectory};
  scene.probe_body = moving;
  scene.horizon = scene.seconds;
  scene.closed_form = [=](double time) {
    const double w = 2 * pi * frequency, damped = w * std::sqrt(1 - z * z);
    const double sag = standard_gravity / (w * w);  // x is measured from the sag
    const double part = (speed + z * w * sag) / damped;
    return Vector3d(
        0, 0,
        std::exp(-z * w * time) * (sag * std::cos(damped * time) + part * std::sin(damped * time)) -
            sag);
  };
  return scene;
}

}  // namespace scenes

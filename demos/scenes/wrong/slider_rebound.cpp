// A slider bounces between its limits, each of which gives back half of the speed. The sign of stock's bounce is
// wrong.

#include "../catalog.h"

namespace scenes {

Scene slider_rebound_scene() {
  const double stop = 0.52, speed = 3, restitution = 0.5;  // m, m/s
  Scene scene{"slider_rebound", "a slider bounces between its limits"};
  scene.show(Group::wrong, "A slider that does not rebound",
             "Each stop is to give back half of the speed. Look at what becomes of it.");
  scene.gravity = 0;
  Body block = box(1, {0.1, 0.1, 0.1}, {0, 0, 0});
  block.velocity = {speed, 0, 0};
  const int moving = scene.add(block);
  Joint& rail = scene.connect(Kind::slider, 0, moving, at({0, 0, 0}));
  rail.range = {-stop, stop};
  rail.restitution = restitution;
  scene.seconds = 4;
  scene.errors = {Error::trajectory, Error::overshoot};
  scene.compared = Compared::nowhere;
  scene.probe_body = moving;
  scene.horizon = scene.seconds;
  scene.closed_form = [=](double time) -> Vector3d {
    double at = 0, velocity = speed;
    for (;;) {
      const double way = stop - at * (velocity > 0 ? 1 : -1), there = way / std::abs(velocity);
      if (time <= there) return {at + velocity * time, 0, 0};
      time -= there;
      at = velocity > 0 ? stop : -stop;
      velocity *= -restitution;
    }
  };
  scene.mended = {Error::trajectory, 0.3, 0.03};
  return scene;
}

}  // namespace scenes

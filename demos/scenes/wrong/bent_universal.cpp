// A universal joint is turned on through 90 degrees, where stock's angles have their pole. A constant torque about
// the second axis is all that acts: angle = torque / inertia t^2 / 2.

#include "../catalog.h"

namespace scenes {

Scene bent_universal_scene() {
  const double arm = 0.5, torque = 0.1;  // m, N m
  Scene scene{"bent_universal", "a universal joint turns on through 90 degrees"};
  scene.show(Group::wrong, "A universal joint at 90 degrees",
             "A box is turned about one axis, faster and faster. Look at it pass 90 degrees, where "
             "stock throws it about.");
  scene.gravity = 0;
  Body bar = box(1, {arm, 0.1, 0.1}, {arm, 0, 0});
  bar.torque = {0, torque, 0};
  const int moving = scene.add(bar);
  scene.connect(Kind::universal, 0, moving, at({0, 0, 0})).range = {-100, 100};  // as good as free
  scene.seconds = 8;
  scene.errors = {Error::trajectory, Error::gap, Error::axis};
  scene.compared = Compared::nowhere;
  scene.probe_body = moving;
  scene.probe = {1 - arm, 0, 0};  // 1 m off the axis: metres are radians
  scene.horizon = scene.seconds;
  const double acceleration = torque / (bar.inertia.y() + bar.mass * arm * arm);
  scene.closed_form = [=](double time) {
    const double angle = acceleration * time * time / 2;
    return Vector3d(std::cos(angle), 0, -std::sin(angle));
  };
  scene.mended = {Error::trajectory, 0.5, 0.05};
  return scene;
}

}  // namespace scenes

// A steering wheel with stops two turns either way: a motor turns it onto one, and back to the
// other one.

#include "catalog.h"

#include <algorithm>

namespace scenes {

Scene steering_scene() {
  const double stop = radians(720), speed = 12, turn_back = 3;  // rad, rad/s, s
  Scene scene{"steering", "stops at +-720 degrees"};
  scene.show(Group::measured, "Steering",
             "A wheel is turned onto its stops, two turns either way.");
  Body wheel = round(box(2, {0.2, 0.2, 0.02}, {0, 0, 0}), 0.23);
  wheel.angular_velocity = {0, 0, speed};
  const int moving = scene.add(wheel);
  Joint& column = scene.connect(Kind::hinge, 0, moving, at({0, 0, 0}));
  column.range = {-stop, stop};
  column.motor = {[=](double time) { return time < turn_back ? speed : -speed; }, 100};
  scene.seconds = 6;
  scene.errors = {Error::trajectory, Error::overshoot};
  scene.probe_body = moving;
  scene.probe = {1, 0, 0};  // 1 m off the axis: metres are radians
  scene.horizon = scene.seconds;
  scene.closed_form = [=](double time) {
    const double angle = time < turn_back ? std::min(stop, speed * time)
                                          : std::max(-stop, stop - speed * (time - turn_back));
    return Vector3d(std::cos(angle), std::sin(angle), 0);
  };
  return scene;
}

}  // namespace scenes

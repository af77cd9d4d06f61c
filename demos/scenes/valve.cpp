// A motor turns a valve's wheel several turns onto its stop, and back onto the other one. A joint
// that wraps its limits to one turn sees 0 to 0, give or take rounding, for whole turns: it locks, or
// it never stops.

#include "bouncing.h"
#include "catalog.h"

namespace scenes {

Scene valve_scene(double turns, double speed) {
  const double stop = 2 * pi * turns, torque = 5;  // rad, N m
  Scene scene{"valve", "a motor turns a wheel onto its stops"};
  scene.show(Group::known, "Valve", "A motor turns the wheel five turns onto its stop, and back.");
  const int wheel = scene.add(round(box(4, {0.3, 0.3, 0.03}, {0, 0, 0}), 0.34));
  const double acceleration = torque / scene.bodies[size_t(wheel)].inertia.z();
  const double one_way = std::round(stop / speed) + 3;  // s
  Joint& spindle = scene.connect(Kind::hinge, 0, wheel, at({0, 0, 0}));
  spindle.range = {0, stop};
  spindle.motor = {[=](double time) { return time < one_way ? speed : -speed; }, torque};
  scene.seconds = 2 * one_way;
  scene.errors = {Error::trajectory, Error::overshoot};
  scene.compared = Compared::nowhere;
  scene.probe_body = wheel;
  scene.probe = {1, 0, 0};  // 1 m off the axis: metres are radians
  scene.horizon = scene.seconds;
  // The motor takes it to its speed with its whole torque, also after each rebound.
  const auto way = [=](double time) {
    const double restitution = 0.3;  // that hinges have
    const double start = speed / acceleration, there = stop / speed + start / 2;
    if (time < start) return acceleration * time * time / 2;
    if (time < there) return speed * (time - start / 2);
    return stop - bouncing(time - there, restitution * speed, acceleration, restitution);
  };
  scene.closed_form = [=](double time) {
    const double angle = time < one_way ? way(time) : stop - way(time - one_way);
    return Vector3d(std::cos(angle), std::sin(angle), 0);
  };
  return scene;
}

}  // namespace scenes

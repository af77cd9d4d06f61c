// A motor turns the first of three wheels that mesh, and a brake pulls at the last one. What an iterated solver
// leaves of the row of a gear of Bullet's in a step is lost for good, for it is one of speeds.

#include "../catalog.h"

namespace scenes {

Scene gear_train_scene() {
  const double ratio = 2, speed = 10, brake = 50;  // rad/s of the first wheel, N m
  Scene scene{"gear_train", "a motor turns three wheels against a brake"};
  scene.show(Group::wrong, "Gears that drift",
             "A motor turns the first of three wheels, and a brake pulls at the last one. Look at "
             "it fall behind: Bullet's gear holds speeds, and what is left of them adds up.");
  scene.gravity = 0;
  double radius = 0.1, at_x = 0, turning = speed;
  for (int i = 0; i < 3; ++i) {
    const double half_side = radius / std::sqrt(2.);
    Body wheel =
        round(box(radius * radius * 1000, {half_side, half_side, 0.03}, {at_x, 0, 0}), radius);
    wheel.angular_velocity = {0, 0, turning};
    const int now = scene.add(wheel), last = now - 1;
    Joint& axle = scene.connect(Kind::hinge, 0, now, at({at_x, 0, 0}));
    if (i == 0) axle.motor = {[speed](double) { return speed; }, 1e4};
    if (i > 0) scene.connect(Kind::gear, last, now, at({at_x, 0, 0})).ratio = ratio;
    at_x += radius * (1 + ratio);
    radius *= ratio;
    turning /= -ratio;
  }
  scene.bodies.back().torque = {0, 0, -brake};
  scene.seconds = 5;
  scene.errors = {Error::trajectory};
  scene.compared = Compared::nowhere;
  scene.probe_body = int(scene.bodies.size()) - 1;
  scene.probe = {1, 0, 0};  // 1 m off the axis: metres are radians
  scene.horizon = scene.seconds;
  scene.closed_form = [start = scene.bodies.back()](double time) -> Vector3d {
    const double angle = start.angular_velocity.z() * time;
    return start.pose.translation() + Vector3d(std::cos(angle), std::sin(angle), 0);
  };
  // m, or rad: on Bullet's solver ERP keeps five times what ten iterations leave in a step.
  scene.mended = {Error::trajectory, 0.3, 0.02};
  return scene;
}

}  // namespace scenes

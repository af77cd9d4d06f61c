// A motor turns a bar against stops that are two and a half turns apart, one after the other.

#include "../catalog.h"

namespace scenes {

Scene hinge_turns_scene() {
  const double stop = radians(450);
  Scene scene{"hinge_turns", "a motor turns a bar onto stops two and a half turns apart"};
  scene.show(Group::limits, "The turns of a hinge",
             "A motor turns a bar against its two stops. The spiral is the way between them.");
  const Eigen::Quaterniond frame = turn_between(Vector3d::UnitZ(), {0, -1, 0});
  const int bar = scene.add(box(2, {0.4, 0.05, 0.04}, frame * Vector3d(0.3, 0, 0), frame));
  Joint& joint = scene.connect(Kind::hinge, 0, bar, Isometry3d(frame));
  joint.in_b = at({-0.3, 0, 0});
  joint.range = {-stop, stop};
  joint.motor = {[](double time) { return time < 1.6 ? 10. : -10.; }, 40};
  scene.seconds = 4;
  scene.errors = {Error::overshoot, Error::gap, Error::axis};
  scene.compared = Compared::nowhere;
  return scene;
}

}  // namespace scenes

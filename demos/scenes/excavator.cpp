// An excavator: cylinders move boom, stick and bucket, each of them a slider between two hinges in a closed loop.

#include "catalog.h"

namespace scenes {

Scene excavator_scene() {
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();

  Scene scene{"excavator", "three cylinders move boom, stick and bucket"};
  scene.show(Group::known, "Excavator",
             "Three cylinders move boom, stick and bucket. Each closes a loop of three hinges and "
             "a slider.");
  scene.add(box(0, {1.6, 1.1, 0.3}, {-0.6, 0, 0.3}));  // its tracks
  const int house = scene.add(box(4000, {1.3, 0.9, 0.5}, {-0.7, 0, 1.15}));
  const int weight = scene.add(box(3000, {0.3, 0.9, 0.35}, {-2.3, 0, 1.2}));
  scene.connect(Kind::fixed, house, weight, at({-2.0, 0, 1.2}));
  scene.connect(Kind::hinge, 0, house, with_z({-0.7, 0, 0.62}, z)).motor = {
      [](double time) { return 0.5 * std::sin(2 * pi * time / 8); }, 2e5};
  // A limb from one point to another.
  const auto limb = [&](double mass, double half_width, const Vector3d& from, const Vector3d& to) {
    return scene.add(box(mass, {(to - from).norm() / 2, half_width, half_width}, (from + to) / 2,
                         turn_between(x, to - from)));
  };
  const auto hinge = [&](int a, int b, const Vector3d& point) {
    scene.connect(Kind::hinge, a, b, with_z(point, y));
  };
  const Vector3d foot(0.5, 0, 1.5), elbow(3.6, 0, 4.0), wrist(5.2, 0, 1.9), teeth(5.5, 0, 1.0);
  const int boom = limb(900, 0.16, foot, elbow),
            stick = limb(450, 0.13, elbow + Vector3d(-0.45, 0, 0.6), wrist);
  const int bucket =
      scene.add(box(400, {0.4, 0.5, 0.35}, (wrist + teeth) / 2, turn_between(x, teeth - wrist)));
  hinge(house, boom, foot);
  hinge(boom, stick, elbow);
  hinge(stick, bucket, wrist);
  // A barrel on one body and a rod on another, which its oil pushes apart: speed in m/s.
  const auto cylinder_of = [&](int a, const Vector3d& from, int b, const Vector3d& to, double reach,
                               double period) {
    const Vector3d along = to - from;
    const Eigen::Quaterniond turn = turn_between(z, along);
    const double half = 0.3 * along.norm();
    const int barrel = scene.add(cylinder(60, 0.09, half, from + 0.3 * along, turn));
    const int rod = scene.add(cylinder(30, 0.05, half, to - 0.3 * along, turn));
    hinge(a, barrel, from);
    hinge(b, rod, to);
    scene.connect(Kind::slider, barrel, rod, with_x((from + to) / 2, along)).motor = {
        [=](double time) { return reach * 2 * pi / period * std::sin(2 * pi * time / period); },
        4e5};
  };
  cylinder_of(house, {0.9, 0, 0.9}, boom, {2.2, 0, 2.65}, -0.08, 4);
  cylinder_of(boom, {1.9, 0, 3.1}, stick, {3.15, 0, 4.6}, 0.2, 4);
  cylinder_of(stick, {4.1, 0, 4.05}, bucket, {5.38, 0, 2.26}, 0.25, 4);
  scene.seconds = 8;
  scene.errors = {Error::gap, Error::axis};
  scene.compared = Compared::as_games_run;
  return scene;
}

}  // namespace scenes

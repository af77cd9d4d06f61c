// A forearm on an elbow falls and is thrown against the sides of its wedge: acute, about level; or
// beyond 180 degrees, about upright, where gravity still ends at a side.

#include "catalog.h"

namespace scenes {
namespace {

constexpr double arm = 0.3;  // m

}  // namespace

Scene elbow_scene(double total, const Eigen::Quaterniond& frame, const Vector3d& start) {
  Scene scene{"elbow", "forearm on an elbow in a wedge"};
  const auto turn = frame * turn_between(Vector3d::UnitX(), start);
  const int forearm = scene.add(box(1, {0.05, 0.05, 0.05}, turn * Vector3d(arm, 0, 0), turn));
  Joint& elbow = scene.connect(Kind::wedge, 0, forearm, Isometry3d(frame));
  elbow.in_b = at({-arm, 0, 0});
  elbow.range = {-total / 2, total / 2};
  scene.errors = {Error::overshoot};
  return scene;
}

Scene wedge_elbow_scene(double total) {
  const bool acute = total < pi;
  const Vector3d middle = acute ? Vector3d(1, 0, 0) : Vector3d(0, 0, 1), axis(0, 1, 0);
  Eigen::Matrix3d frame;
  frame << middle, axis.cross(middle), axis;
  Scene scene = elbow_scene(total, Eigen::Quaterniond(frame), Vector3d::UnitX());
  scene.name = acute ? "wedge_acute" : "wedge_wide";
  scene.title =
      "elbow in a wedge of " + std::to_string(int(std::lround(degrees(total)))) + " degrees";
  if (acute) {
    scene.show(Group::measured, "Elbow", "A wedge of 60 degrees.");
  } else {
    scene.show(Group::wrong, "A wedge past half a turn",
               "An elbow that may turn by 270 degrees. Look at how far it goes beyond.");
    scene.mended = {Error::overshoot, 0.3, 0.01};
  }
  scene.bodies.back().damping = 0.5;
  spin(scene.bodies.back(), {2, 3, 4}, {0, 0, 0});
  scene.errors = {Error::overshoot, Error::gap, Error::gained};
  scene.energy_scale = standard_gravity * arm;
  return scene;
}

}  // namespace scenes

// Two free boxes start with their joint badly violated, and the joint pulls itself together.
//
// The anchors of a hinge about z coincide at the start, but the second box is turned about them, so
// that the axes start apart by the angle if it is turned about a direction across them. Such errors
// come from teleports, from content made by hand, and from impacts. There is no closed form.
// Near 180 degrees the direction to turn in is barely defined.

#include "catalog.h"

namespace scenes {

Scene recovery_scene(double angle, const Vector3d& about) {
  const Vector3d half_extents(0.5, 0.1, 0.1), end(0.5, 0, 0);
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(angle, about.normalized()));
  Scene scene{"recovery", "two free boxes, their joint violated at the start"};
  scene.show(Group::measured, "Hinges that start apart",
             "Axes 120 degrees off find back together.");
  scene.gravity = 0;
  const int first = scene.add(box(1, half_extents, {0, 0, 0}));
  const int second = scene.add(box(1, half_extents, end + turn * end, turn));
  scene.connect(Kind::hinge, first, second, at(end)).in_b = at(-end);
  scene.seconds = 10;
  scene.errors = {Error::recovery, Error::gap};
  scene.compared = Compared::nowhere;
  return scene;
}

}  // namespace scenes

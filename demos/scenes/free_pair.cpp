// Two boxes on a hinge tumble freely: what nothing from outside acts on keeps its momentum.

#include "catalog.h"

namespace scenes {

Scene free_pair_scene() {
  const Vector3d spin_of_all = 3 * Vector3d(0.3, 0.2, 1).normalized();
  Scene scene{"free_pair", "two boxes on a hinge tumble freely"};
  scene.show(Group::measured, "Free pair",
             "Two bodies on a hinge, and nothing else: momentum must stay.");
  scene.gravity = 0;
  const int first = scene.add(box(1, {0.5, 0.1, 0.1}, {-0.5, 0, 0}));
  const int second = scene.add(box(1, {0.5, 0.1, 0.1}, {0.5, 0, 0}));
  spin(scene.bodies[first], spin_of_all, {0, 0, 0});
  spin(scene.bodies[second], spin_of_all, {0, 0, 0});
  scene.connect(Kind::hinge, first, second, at({0, 0, 0}));
  scene.errors = {Error::momentum, Error::trajectory, Error::gap, Error::axis, Error::energy};
  // Of the turning about z.
  scene.energy_scale = (1. / 3 * 0.26 + 0.25) * spin_of_all.squaredNorm();
  scene.probe_body = second;
  scene.horizon = scene.seconds;
  return scene;
}

}  // namespace scenes

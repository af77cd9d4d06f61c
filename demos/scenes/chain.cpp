// A chain of boxes on hinges falls from horizontal; its last link weighs `ratio` times the others.
//
// Hinge i stands at x = i; its axis is (0, 1, 0) for even i and (0, 0.8, 0.6) for odd i, so that
// the chain leaves its plane. Hinge 0 holds the first box to the ground.

#include "catalog.h"

namespace scenes {

Scene chain_scene(int links, double ratio) {
  Scene scene;
  scene.name = ratio == 1 ? "chain" : "chain_heavy";
  scene.title =
      "chain of " + std::to_string(links) + ", last link " + std::to_string(int(ratio)) + ":1";
  if (ratio == 1) {
    scene.show(Group::measured, "Chain", "Ten links on hinges of two directions.");
  } else {
    scene.show(
        Group::wrong, "A chain that tears",
        "The last of ten links weighs a hundred times the others. Look at the gaps between them.");
    scene.mended = {Error::gap, 0.15, 1e-3, true};
  }
  for (int i = 0; i < links; ++i) {
    const double mass = i + 1 == links ? ratio : 1;
    const int link = scene.add(box(mass, {0.5, 0.1, 0.1}, {i + 0.5, 0, 0}));
    const Vector3d axis = i % 2 == 0 ? Vector3d(0, 1, 0) : Vector3d(0, 0.8, 0.6);
    scene.connect(Kind::hinge, link - 1, link, with_z({double(i), 0, 0}, axis));
  }
  scene.errors = {Error::gap, Error::axis, Error::energy, Error::trajectory};
  scene.energy_scale = standard_gravity * (links - 1 + ratio) * links / 2;
  scene.probe_body = links;
  scene.horizon = 2;  // s: it is chaotic
  return scene;
}

}  // namespace scenes

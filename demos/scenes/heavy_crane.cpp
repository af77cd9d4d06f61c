// A hoist lifts ten tonnes by a rope of ten links of 100 g, and carries them along its jib.

#include <algorithm>

#include "catalog.h"

namespace scenes {

Scene heavy_crane_scene() {
  constexpr int links = 10;
  const double length = 0.3, load_mass = 10000;  // m, of a link; kg
  const Vector3d load_half(0.8, 0.8, 0.5);       // m
  const double height = 7.5, lift = 2, way = 3;  // m, of the jib; that the load moves
  const double lifting = 4, carrying = 5;        // s

  Scene scene{"heavy_crane", "a load of 10 t on a rope of 1 kg"};
  scene.show(Group::known, "Heavy crane",
             "Ten tonnes on a rope of ten links that weigh one kilogram together: lifted, then "
             "carried along.");
  // From rest to rest, from one time over another.
  const auto drive = [](Joint& joint, double distance, double from, double time, double force) {
    joint.motor = {[=](double now) {
                     const double part = std::clamp((now - from) / time, 0., 1.);
                     return distance / time * (1 - std::cos(2 * pi * part));
                   },
                   force};
  };
  scene.add(box(0, {3.6, 0.12, 0.12}, {1.2, 0.45, height}));  // two beams, and their masts
  scene.add(box(0, {3.6, 0.12, 0.12}, {1.2, -0.45, height}));
  for (const double y : {-0.45, 0.45})
    scene.add(box(0, {0.14, 0.12, height / 2}, {-2.2, y, height / 2 - 0.12}));
  const int trolley = scene.add(box(300, {0.4, 0.6, 0.12}, {0, 0, height + 0.24}));
  const int hoist = scene.add(box(2000, {0.25, 0.35, 0.25}, {0, 0, height - 2.4}));
  drive(scene.connect(Kind::slider, 0, trolley, with_x({0, 0, height + 0.24}, Vector3d::UnitX())),
        way, lifting, carrying, 1e5);
  const Vector3d drum(0, 0, height - 2.4), down(0, 0, -1);
  drive(scene.connect(Kind::slider, trolley, hoist, with_x(drum, Vector3d::UnitZ())), lift, 0,
        lifting, 3e5);
  int last = hoist;
  for (int i = 0; i < links; ++i) {
    const int link =
        scene.add(box(0.1, {0.03, 0.03, length / 2}, drum + (i + 0.5) * length * down));
    scene.connect(Kind::ball, last, link, at(drum + i * length * down));
    last = link;
  }
  const Vector3d hook = drum + links * length * down;
  const int load = scene.add(box(load_mass, load_half, hook + load_half.z() * down));
  scene.connect(Kind::ball, last, load, at(hook));
  scene.seconds = 10;
  scene.errors = {Error::gap, Error::axis};
  return scene;
}

}  // namespace scenes

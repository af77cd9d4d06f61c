// Bricard's mechanism falls from rest: five rods and six hinges in a loop through the ground. By
// the count of its constraints it could not move, but one of them is redundant. Problem A04 of the
// IFToMM library of multibody benchmarks, whose y is z here.

#include "catalog.h"

namespace scenes {

Scene bricard_scene() {
  const double mass = 1, thickness = 0.1;  // kg, m: of each rod, 1 m long
  const std::vector<Vector3d> points = {{0, 0, 0},   {1, 0, 0},   {1, 0, -1},
                                        {1, -1, -1}, {0, -1, -1}, {0, -1, 0}};

  Scene scene{"bricard", "Bricard's loop of six hinges"};
  scene.problem = "IFToMM A04";
  scene.show(Group::measured, "Bricard's mechanism",
             "A loop of six hinges that by the count of its constraints could not move.");
  int last = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    const bool closes = i + 1 == points.size();
    const Vector3d axis = Vector3d::Unit((2 * i + 2) % 3);  // z, y, x, and again
    const int before = last;
    if (!closes) {
      const Vector3d half = (points[i + 1] - points[i]).cwiseAbs() / 2;
      last = scene.add(box(mass, half.cwiseMax(thickness / 2), (points[i] + points[i + 1]) / 2));
    }
    scene.connect(Kind::hinge, closes ? 0 : before, last, with_z(points[i], axis));
  }
  scene.gravity = 9.81;
  scene.seconds = 10;
  scene.errors = {Error::energy, Error::trajectory, Error::gap};
  // The largest kinetic energy: the rods' middles fall by 2 sqrt(3) - 3 m in all.
  scene.energy_scale = mass * scene.gravity * (2 * std::sqrt(3.) - 3);
  scene.probe_body = 2;  // the library's P3
  scene.probe = {0, 0, -0.5};
  scene.horizon = scene.seconds;
  return scene;
}

}  // namespace scenes

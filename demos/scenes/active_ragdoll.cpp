// A ragdoll that hangs by its pelvis lifts arms and legs to a pose by twenty muscles, and holds it.

#include "catalog.h"

namespace scenes {

Scene active_ragdoll_scene() {
  Scene scene{"active_ragdoll", "twenty muscles take up a pose"};
  scene.show(Group::known, "Active ragdoll",
             "It hangs by its pelvis, and twenty muscles take up a pose. Do they hold it?");
  struct Limb {
    int parent, body;
    Vector3d pivot;
  };
  std::vector<Limb> limbs;
  const auto limb = [&](int parent, double mass, const Vector3d& half_extents,
                        const Vector3d& position, const Vector3d& pivot) {
    const int body = scene.add(box(mass, half_extents, position));
    limbs.push_back({parent, body, pivot});
    return body;
  };
  const double hip = 1.2, chest_height = 0.64;  // m
  const int pelvis = scene.add(box(0, {0.1, 0.16, 0.08}, {0, 0, hip}));
  int last = pelvis;
  for (double z = hip + 0.08; z < hip + 0.7; z += 0.16)
    last = limb(last, 8, {0.1, 0.15, 0.08}, {0, 0, z + 0.08}, {0, 0, z});
  const int chest = last;
  const double top = hip + 0.08 + chest_height;
  const int neck = limb(chest, 1, {0.05, 0.05, 0.05}, {0, 0, top + 0.05}, {0, 0, top});
  limb(neck, 4, {0.09, 0.08, 0.12}, {0, 0, top + 0.22}, {0, 0, top + 0.1});
  struct Part {
    double mass, length;
  };
  for (const double side : {-1., 1.}) {
    double y = 0.15;
    last = chest;
    for (const Part& part : {Part{1.5, 0.15}, Part{2, 0.3}, Part{1.5, 0.26}, Part{0.5, 0.18}}) {
      last = limb(last, part.mass, {0.045, part.length / 2, 0.045},
                  {0, side * (y + part.length / 2), top - 0.08}, {0, side * y, top - 0.08});
      y += part.length;
    }
    double z = hip - 0.08;
    last = pelvis;
    for (const Part& part : {Part{8, 0.4}, Part{4, 0.42}, Part{1, 0.1}}) {
      last = limb(last, part.mass, {0.07, 0.07, part.length / 2},
                  {0, side * 0.1, z - part.length / 2}, {0, side * 0.1, z});
      z -= part.length;
    }
  }
  // Each swings all that it carries at 10 Hz, critically damped, and each turns about a direction of its own.
  const double w = 2 * pi * 10;
  for (const Limb& from : limbs) {
    double inertia = 0;
    std::vector<bool> carried(scene.bodies.size(), false);
    for (const Limb& part : limbs) {
      if (part.body != from.body && !carried[size_t(part.parent)]) continue;
      carried[size_t(part.body)] = true;
      const Body& body = scene.bodies[size_t(part.body)];
      inertia += body.mass * (body.pose.translation() - from.pivot).squaredNorm() +
                 body.inertia.maxCoeff();
    }
    Joint& joint = scene.connect(Kind::cone_twist, from.parent, from.body, at(from.pivot));
    const double n = from.body;
    const Vector3d about(std::cos(n), std::sin(2 * n), std::cos(3 * n));
    joint.muscle = {
        Eigen::Quaterniond(Eigen::AngleAxisd(0.7 * std::sin(5 * n), about.normalized())),
        w * w * inertia, 2 * w * inertia, 1000};
  }
  scene.seconds = 4;
  scene.errors = {Error::axis, Error::gap};
  scene.compared = Compared::as_games_run;
  return scene;
}

}  // namespace scenes

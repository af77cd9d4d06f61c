#include "crowds.h"

namespace scenes {
namespace {

Scene on_floor() {
  Scene scene;
  scene.bodies[0] = solid(box(0, {200, 200, 1}, {0, 0, -1}));
  return scene;
}

// A motor of one speed (rad/s).
Motor motor_of(double speed, double max_torque) {
  return {[speed](double) { return speed; }, max_torque};
}

// Lies along x: cone-twist joints at neck, back, shoulders and hips, hinges with limits at elbows and knees.
Scene ragdoll() {
  const Vector3d x(1, 0, 0), y(0, 1, 0);
  Scene scene;
  const auto part = [&](double mass, const Vector3d& half_extents, double at_x, double at_y) {
    return scene.add(solid(box(mass, half_extents, {at_x, at_y, 0})));
  };
  const auto swing = [&](int body, int limb, const Vector3d& point, const Vector3d& along,
                         double span, double twist) {
    scene.connect(Kind::cone_twist, body, limb, with_x(point, along)).spans = {span, span, twist};
  };
  const auto bend = [&](int upper, int lower, const Vector3d& point) {
    scene.connect(Kind::hinge, upper, lower, with_z(point, y)).range = {-2, 0.1};
  };
  const int pelvis = part(12, {0.1, 0.15, 0.08}, 0, 0);
  const int chest = part(25, {0.2, 0.17, 0.1}, 0.32, 0);
  const int head = part(5, {0.1, 0.08, 0.09}, 0.66, 0);
  swing(pelvis, chest, {0.11, 0, 0}, x, 0.5, 0.4);
  swing(chest, head, {0.54, 0, 0}, x, 0.7, 0.7);
  for (const double side : {-1., 1.}) {
    const int upper_arm = part(2.5, {0.14, 0.05, 0.05}, 0.33, side * 0.24);
    const int lower_arm = part(2, {0.13, 0.04, 0.04}, 0.05, side * 0.24);
    const int thigh = part(8, {0.2, 0.07, 0.07}, -0.31, side * 0.09);
    const int shin = part(5, {0.2, 0.055, 0.055}, -0.72, side * 0.09);
    swing(chest, upper_arm, {0.47, side * 0.24, 0}, -x, 1.2, 0.8);
    bend(upper_arm, lower_arm, {0.185, side * 0.24, 0});
    swing(pelvis, thigh, {-0.11, side * 0.09, 0}, -x, 0.9, 0.4);
    bend(thigh, shin, {-0.515, side * 0.09, 0});
  }
  return scene;
}

// Each turned another way.
template <class Place>
Scene ragdolls_at(int count, const Place& place) {
  Scene scene = on_floor();
  for (int n = 0; n < count; ++n) {
    const Eigen::AngleAxisd turn(0.3 * n, Vector3d(0.3, 0.2, 1).normalized());
    scene.append(ragdoll(), Eigen::Translation3d(place(n)) * turn);
  }
  return scene;
}

Scene vehicle(double speed) {
  const Vector3d y(0, 1, 0), z(0, 0, 1);
  Scene scene;
  const int chassis = scene.add(solid(box(200, {1, 0.5, 0.2}, {0, 0, 0})));
  for (const double front : {-1., 1.}) {
    for (const double side : {-1., 1.}) {
      const Vector3d hub(0.8 * front, 0.75 * side, -0.3), inner = hub - 0.15 * side * y;
      const int knuckle = scene.add(box(10, {0.1, 0.05, 0.1}, inner));
      Body tyre = solid(cylinder(15, 0.3, 0.1, hub, turn_between(z, y)));
      tyre.friction = 1;
      const int wheel = scene.add(tyre);
      scene.connect(Kind::slider, chassis, knuckle, with_x(inner, z)).range = {-0.05, 0.05};
      scene.connect(Kind::hinge, knuckle, wheel, with_z(hub, y)).motor = motor_of(speed, 60);
    }
  }
  return scene;
}

// Plates at (0, 0) to (size - 1, size - 1), tied to each other by ball joints. Returns the first one's index.
int add_net(Scene& scene, int size) {
  const int first = int(scene.bodies.size());
  for (int j = 0; j < size; ++j) {
    for (int i = 0; i < size; ++i) {
      const Vector3d place(i, j, 0);
      const int plate = scene.add(solid(box(1, {0.4, 0.4, 0.1}, place)));
      if (i > 0) scene.connect(Kind::ball, plate - 1, plate, at(place - Vector3d(0.5, 0, 0)));
      if (j > 0) scene.connect(Kind::ball, plate - size, plate, at(place - Vector3d(0, 0.5, 0)));
    }
  }
  return first;
}

}  // namespace

Scene ragdolls_scene(int count) {
  return ragdolls_at(
      count, [](int n) { return Vector3d(1.2 * (n / 5), 0.6 * (n / 5 % 2), 1 + 0.7 * (n % 5)); });
}

Scene ragdoll_pile_scene(int count) {
  return ragdolls_at(count, [](int n) {
    return Vector3d(0.7 * (n % 3 - 1), 0.9 * (n / 3 % 3 - 1), 0.5 + 0.6 * (n / 9));
  });
}

Scene doors_scene(int count) {
  Scene scene;
  for (int n = 0; n < count; ++n) {
    const Vector3d place(2 * (n % 10), 2 * (n / 10), 1);
    const int door = scene.add(solid(box(20, {0.45, 0.02, 1}, place + Vector3d(0.45, 0, 0))));
    Joint& hinge = scene.connect(Kind::hinge, 0, door, at(place));
    hinge.range = {n % 3 == 2 ? 0 : -1.2, 1.2};
    if (n % 3 == 1) hinge.motor = motor_of(n % 2 ? 0.2 : -0.2, 30);
    if (n % 3 == 2) hinge.motor = motor_of(-1, 12);
  }
  return scene;
}

Scene vehicles_scene(int count) {
  Scene scene = on_floor();
  for (int n = 0; n < count; ++n)
    scene.append(vehicle(n % 2 ? 4 : -4), at({6. * (n % 4), 4. * (n / 4), 0.8}));
  return scene;
}

Scene net_scene(int size) {
  Scene scene;
  const double radius = size / 4., middle = (size - 1) / 2.;
  scene.add(solid(sphere(0, radius, {middle + 0.2, middle - 0.1, -radius - 0.5})));
  add_net(scene, size);
  return scene;
}

Scene hanging_net_scene(int size) {
  Scene scene;
  const int first = add_net(scene, size);
  scene.connect(Kind::ball, 0, first, at(Vector3d(-0.5, -0.5, 0)));
  scene.connect(Kind::ball, 0, first + size - 1, at(Vector3d(size - 0.5, -0.5, 0)));
  return scene;
}

Scene lying_net_scene(int size) {
  Scene scene;
  scene.bodies[0] = solid(box(0, {200, 200, 1}, {0, 0, -1.2}));
  add_net(scene, size);
  return scene;
}

Scene taut_net_scene(int size) {
  Scene scene;
  const int first = add_net(scene, size);
  const double middle = (size - 1) / 2., end = size - 0.5;
  for (int i = 0; i < size; ++i) {
    scene.connect(Kind::ball, 0, first + i, at(Vector3d(i, -0.5, 0)));
    scene.connect(Kind::ball, 0, first + (size - 1) * size + i, at(Vector3d(i, end, 0)));
    scene.connect(Kind::ball, 0, first + i * size, at(Vector3d(-0.5, i, 0)));
    scene.connect(Kind::ball, 0, first + i * size + size - 1, at(Vector3d(end, i, 0)));
  }
  scene.add(solid(sphere(50, 1, {middle + 0.2, middle - 0.1, 1.6})));
  return scene;
}

Scene loaded_bridge_scene(int planks, double ratio) {
  const Vector3d x(1, 0, 0), y(0, 1, 0);
  const double length = 0.25, mass = 10;  // m along x, kg, of a plank
  const double half = planks * length / 2, sag = half / 10;
  // On a parabola.
  const auto end = [&](int i) {
    const double part = i * length / half - 1;
    return Vector3d(part * half, 0, sag * (part * part - 1));
  };
  Scene scene;
  const auto bank = [&](double side) {
    return scene.add(solid(box(0, {1, 1, 1}, side * (half + 1) * x)));
  };
  int last = bank(-1);
  for (int i = 0; i < planks; ++i) {
    const Vector3d along = end(i + 1) - end(i);
    const int plank = scene.add(
        solid(box(mass, {along.norm() / 2, 1, 0.04}, end(i) + along / 2, turn_between(x, along))));
    scene.connect(Kind::hinge, last, plank, with_z(end(i), y));
    last = plank;
  }
  scene.connect(Kind::hinge, bank(1), last, with_z(end(planks), y));
  scene.add(solid(box(ratio * mass, {1, 0.8, 0.5}, {0, 0, 1.5 - sag})));
  return scene;
}

Scene track_scene(int links) {
  const Vector3d x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  const double pitch = 0.1, radius = 1, half_thickness = 0.03;  // m
  // Its line of pivots: two straights and two half circles, of chords of `pitch`.
  const double around = radius + half_thickness;
  const int on_arc = int(pi / (2 * std::asin(pitch / 2 / around))), half = links / 2,
            on_straight = half - on_arc;
  const double half_span = on_straight * pitch / 2;
  const auto pivot = [&](int i) -> Vector3d {
    const int k = i % half;
    const double side = i / half % 2 == 0 ? 1 : -1;  // above, below
    if (k < on_straight) return side * Vector3d(k * pitch - half_span, 0, around);
    const double angle = pi * (k - on_straight) / on_arc;
    return side * Vector3d(half_span + around * std::sin(angle), 0, around * std::cos(angle));
  };
  const auto grips = [](Body body) {
    body.friction = 1;
    return solid(body);
  };
  Scene scene;
  int last = 0;
  for (int i = 0; i < 2 * half; ++i) {
    const Vector3d along = pivot(i + 1) - pivot(i);
    const int link = scene.add(grips(box(1, {0.42 * along.norm(), 0.3, half_thickness},
                                         pivot(i) + along / 2, turn_between(x, along))));
    if (i > 0) scene.connect(Kind::hinge, last, link, with_z(pivot(i), y));
    last = link;
  }
  scene.probe_body = 1;
  scene.connect(Kind::hinge, last, 1, with_z(pivot(0), y));
  for (const double side : {-1., 1.}) {
    const Vector3d hub = side * half_span * x;
    const int wheel = scene.add(grips(cylinder(50, radius - 0.01, 0.3, hub, turn_between(z, y))));
    Joint& axle = scene.connect(Kind::hinge, 0, wheel, with_z(hub, y));
    if (side > 0) axle.motor = motor_of(3, 1200);
  }
  return scene;
}

CrateBridges crate_bridges(int count) {
  const int planks = 10;
  const Vector3d x(1, 0, 0), y(0, 1, 0);
  const double half_arc = 0.5;  // rad: it hangs through by a quarter of its length's half
  Scene bridge;
  Vector3d end(0, 0, 0);
  int last = 0;
  for (int k = 0; k < planks; ++k) {
    const Eigen::Quaterniond slope(
        Eigen::AngleAxisd(half_arc - 2 * half_arc * (k + 0.5) / planks, y));
    const Vector3d along = slope * x;
    const int plank =
        bridge.add(solid(box(10, {0.5, CrateBridges::half_width, 0.05}, end + along / 2, slope)));
    bridge.connect(Kind::hinge, last, plank, with_z(end, y));
    last = plank;
    end += along;
  }
  bridge.connect(Kind::hinge, last, 0, with_z(end, y));

  CrateBridges bridges{on_floor(), {}};
  for (int n = 0; n < count; ++n) {
    const Vector3d from(14. * (n % 5), 3. * (n / 5), 5), to = from + end;
    bridges.scene.append(bridge, at(from));
    const Vector3d middle = (from + to) / 2 + Vector3d(0.2 * (n % 7 - 3), 0, 0.5);
    bridges.crates.push_back(
        {bridges.scene.add(solid(box(50, {0.3, 0.3, 0.3}, middle))), from, to});
  }
  return bridges;
}

Scene boxes_scene(int count) {
  Scene scene = on_floor();
  for (int n = 0; n < count; ++n) {
    const Vector3d place(1.5 * (n / 5 % 5), 1.5 * (n / 25), 0.6 + 0.7 * (n % 5));
    const Eigen::AngleAxisd turn(0.1 * n, Vector3d::UnitZ());
    scene.add(solid(box(10, {0.3, 0.3, 0.3}, place, Eigen::Quaterniond(turn))));
  }
  return scene;
}

}  // namespace scenes

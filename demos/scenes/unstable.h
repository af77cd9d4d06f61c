// What the joints of too few or too many rows do where a sound one holds: a beam under its own
// weight, and a pair that turns freely.
//
// The beam: 1 kg, half extents (0.5, 0.1, 0.1) m, held to the world at its end x = -0.5 by a joint
// whose axis is z, upright. Gravity pulls its free end down, 4.9 N m across the axis, and it is
// pushed along y at the start, about the axis for a hinge. A sound hinge turns with its axis upright,
// and a sound lock stays as it is.
//   error         between the two axes, or of a lock between the two orientations, rad: the mean
//                 over the first and over the last second, and the largest
//
// The pair: two such boxes as in recovery.h, free, without gravity; the second one starts turned by
// 40 degrees about (0.6, 0.8, 0), and both spin about (0.3, 0.2, 1) at 3 rad/s. Nothing acts from
// outside: the angular momentum about the common centre stays what it is.
//   momentum      by how much it has changed at the end, relative

#pragma once

#include <algorithm>
#include <cmath>

#include "recovery.h"
#include "world.h"

namespace scenes {

struct BeamSettings {
  bool lock = false;     // the error is that of the whole orientation
  double push = 0.5;     // N s at the centre, along y
  double dt = 1.0 / 60;  // s
  int iterations = 10;
  double seconds = 10;
};

struct BeamResult {
  double first_error = 0, last_error = 0, max_error = 0;  // rad
  double max_angular_speed = 0;                           // rad/s
  bool finite = true;
  double microseconds_per_step = 0;  // wall-clock: does not repeat
};

inline Scene beam_scene(double push) {
  const Vector3d half_extents(0.5, 0.1, 0.1);
  Scene scene{"beam", "held level by its end"};
  const int post = scene.add(box(0, half_extents, {-1, 0, 0}));
  const int beam = scene.add(box(1, half_extents, {0, 0, 0}));
  scene.bodies.back().velocity = {0, push / scene.bodies.back().mass, 0};
  scene.connect(Kind::hinge, post, beam, at({-0.5, 0, 0}));
  return scene;
}

template <class Joint, class Configure = AsConstructed>
BeamResult beam(const BeamSettings& settings, Configure configure = {}) {
  const Scene scene = beam_scene(settings.push);
  World world(scene.gravity, settings.iterations);
  const std::vector<btRigidBody*> bodies = world.add_bodies(scene);
  configure(world.add_joint_of<Joint>(scene.joints[0], bodies));
  const btRigidBody &post = *bodies[1], &beam = *bodies[2];

  const auto error = [&] {
    if (settings.lock) return angle_between(post, beam);
    return angle_between({0, 0, 1}, direction_in_world(beam, {0, 0, 1}));
  };
  BeamResult result;
  const int steps = int(std::lround(settings.seconds / settings.dt));
  const int second = int(std::lround(1 / settings.dt));
  for (int step = 1; step <= steps; ++step) {
    world.step(settings.dt);
    const double now = error(), speed = to_eigen(beam.getAngularVelocity()).norm();
    result.finite = std::isfinite(now) && std::isfinite(speed);
    if (!result.finite) break;
    if (step <= second) result.first_error += now / second;
    if (step > steps - second) result.last_error += now / second;
    result.max_error = std::max(result.max_error, now);
    result.max_angular_speed = std::max(result.max_angular_speed, speed);
  }
  result.microseconds_per_step = world.microseconds_per_step();
  return result;
}

struct SpinSettings {
  bool lock = false;
  double angle = radians(40);  // rad, of the error at the start
  double dt = 1.0 / 60;        // s
  int iterations = 10;
  double seconds = 5;
};

struct SpinResult {
  double momentum_change = 0;  // relative
  double end_error = 0;        // rad
  bool finite = true;
  double microseconds_per_step = 0;  // wall-clock: does not repeat
};

// About the origin, in which the common centre of two bodies without momentum stays.
inline Eigen::Vector3d angular_momentum(const btRigidBody& body) {
  const Eigen::Matrix3d R = rotation(body);
  const Eigen::Vector3d spin = R.transpose() * to_eigen(body.getAngularVelocity());
  const Eigen::Vector3d own = R * to_eigen(body.getLocalInertia()).cwiseProduct(spin);
  return position(body).cross(to_eigen(body.getLinearVelocity())) / double(body.getInvMass()) + own;
}

// Its common centre is the origin.
inline Scene spinning_scene(double angle) {
  const Scene pair = recovery_scene(angle);
  const Vector3d centre =
      (pair.bodies[1].pose.translation() + pair.bodies[2].pose.translation()) / 2;
  Scene scene{"spin", "a free pair, violated at the start, spins"};
  scene.append(pair, at(-centre));
  scene.gravity = 0;
  for (Body& body : {std::ref(scene.bodies[1]), std::ref(scene.bodies[2])})
    spin(body, 3 * Vector3d(0.3, 0.2, 1).normalized(), {0, 0, 0});
  return scene;
}

template <class Joint, class Configure = AsConstructed>
SpinResult spin(const SpinSettings& settings, Configure configure = {}) {
  const Scene scene = spinning_scene(settings.angle);
  World world(scene.gravity, settings.iterations);
  const std::vector<btRigidBody*> bodies = world.add_bodies(scene);
  configure(world.add_joint_of<Joint>(scene.joints[0], bodies));
  const btRigidBody &a = *bodies[1], &b = *bodies[2];

  const auto momentum = [&]() -> Eigen::Vector3d {
    return angular_momentum(a) + angular_momentum(b);
  };
  const Eigen::Vector3d start = momentum();
  const int steps = int(std::lround(settings.seconds / settings.dt));
  for (int step = 1; step <= steps; ++step) world.step(settings.dt);
  SpinResult result;
  result.momentum_change = (momentum() - start).norm() / start.norm();
  result.end_error = settings.lock ? angle_between(a, b)
                                   : angle_between(direction_in_world(a, {0, 0, 1}),
                                                   direction_in_world(b, {0, 0, 1}));
  result.finite = std::isfinite(result.momentum_change) && std::isfinite(result.end_error);
  result.microseconds_per_step = world.microseconds_per_step();
  return result;
}

}  // namespace scenes

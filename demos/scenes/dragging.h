// A body under the mouse, as in Bullet's examples (CommonRigidBodyBase): a ball joint to the world whose pivot
// there is moved every frame, with an impulse clamp of 30 N s and m_tau of 0.001, or without.
//
// Measured over all frames:
//   spin  largest angular speed of the body, rad/s
//   lag   largest distance of the dragged point from where it should be, m
//   past  farthest that the dragged body passes the limits of the hinge that it hangs on, rad

#pragma once

#include <cstdio>

#include "playground.h"
#include "tangle.h"

namespace scenes {

enum class Path { line, to_and_fro, circle, jumps };

struct DragCase {
  Path path = Path::line;
  double speed = 0.05;  // m a frame
  double mass = 1;      // kg
  bool centre = true;   // pulled at the centre of mass
  bool clamp = true;
};

inline std::string name(const DragCase& drag) {
  const char* paths[] = {"line", "to and fro", "circle", "jumps"};
  char text[80];
  std::snprintf(text, sizeof(text), "%s, %g m, %g kg%s%s", paths[int(drag.path)], drag.speed,
                drag.mass, drag.centre ? ", centre" : ", off", drag.clamp ? ", clamp" : "");
  return text;
}

inline std::vector<DragCase> drag_cases() {
  std::vector<DragCase> cases;
  for (const Path path : {Path::line, Path::to_and_fro, Path::circle, Path::jumps})
    for (const double speed : {0.05, 0.5})
      for (const double mass : {1., 20.})
        for (const bool centre : {true, false})
          for (const bool clamp : {true, false})
            cases.push_back({path, speed, mass, centre, clamp});
  return cases;
}

// Where the mouse is at a frame, from the origin.
inline Eigen::Vector3d mouse(const DragCase& drag, int frame) {
  const double way = drag.speed * frame;
  switch (drag.path) {
    case Path::line: return {way, 0, 0};
    case Path::to_and_fro: {
      const double period = 4, phase = std::fmod(way, period);  // 2 m there, 2 m back
      return {phase < period / 2 ? phase : period - phase, 0, 0};
    }
    case Path::circle: return {3 * std::cos(way / 3) - 3, 3 * std::sin(way / 3), 0};
    case Path::jumps: {
      Dice dice(7);
      Eigen::Vector3d at(0, 0, 0);
      for (int k = 0; k < frame / 20; ++k) at += 20 * drag.speed * dice.direction();
      return at;
    }
  }
  return {0, 0, 0};
}

struct DragResult {
  double spin = 0, lag = 0, past = 0;
};

namespace detail {
template <class Family>
typename Family::Ball& grab(Playground& world, btRigidBody& body, const Eigen::Vector3d& pivot,
                            const DragCase& drag) {
  auto& ball = world.world().add_joint<typename Family::Ball>(body, to_bullet(pivot));
  if (drag.clamp) {
    ball.m_setting.m_impulseClamp = btScalar(30);
    ball.m_setting.m_tau = btScalar(0.001);
  }
  return ball;
}
}  // namespace detail

// A box, free but for the mouse.
template <class Family>
DragResult drag_free(const DragCase& drag, int frames = 300, int iterations = 10) {
  PlaygroundSettings settings;
  settings.iterations = iterations;
  Playground world(settings);
  btRigidBody& body = world.ghost(drag.mass, {0.5, 0.3, 0.2}, pose_at(btVector3(0, 0, 0)));
  const Eigen::Vector3d pivot =
      drag.centre ? Eigen::Vector3d(0, 0, 0) : Eigen::Vector3d(0.3, 0.2, 0.1);
  auto& ball = detail::grab<Family>(world, body, pivot, drag);
  DragResult result;
  for (int frame = 0; frame < frames; ++frame) {
    const Eigen::Vector3d to = pivot + mouse(drag, frame);
    ball.setPivotB(to_bullet(to));
    world.step(1. / 60);
    const double lag = (point_in_world(body, pivot) - to).norm();
    result.spin = std::max(result.spin, world.spin());
    result.lag = std::isfinite(lag) ? std::max(result.lag, lag) : HUGE_VAL;
  }
  return result;
}

// A board that hangs on a hinge with limits of 0.5 rad, pulled at its lower end or at its centre.
template <class Family>
DragResult drag_hung(const DragCase& drag, int frames = 300, int iterations = 10) {
  PlaygroundSettings settings;
  settings.iterations = iterations;
  Playground world(settings);
  const double limit = 0.5;
  btRigidBody& post = world.ghost(0, {0.1, 0.1, 0.1}, pose_at(btVector3(0, 0, 0)));
  btRigidBody& body =
      world.ghost(drag.mass, {0.05, 0.3, 0.5}, pose_at(btVector3(0, 0, btScalar(-0.5))));
  world.hinge<Family>(post, body, frame_along({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), limit);
  const Eigen::Vector3d pivot =
      drag.centre ? Eigen::Vector3d(0, 0, 0) : Eigen::Vector3d(0, 0.2, -0.45);
  auto& ball = detail::grab<Family>(world, body, pivot, drag);
  Unwrap unwrap(0);
  DragResult result;
  const Eigen::Vector3d start = point_in_world(body, pivot);
  for (int frame = 0; frame < frames; ++frame) {
    const Eigen::Vector3d to = start + mouse(drag, frame);
    ball.setPivotB(to_bullet(to));
    world.step(1. / 60);
    const Eigen::Vector3d down = direction_in_world(body, {0, 0, -1});
    const double angle = unwrap(std::atan2(-down.x(), -down.z()));
    const double lag = (point_in_world(body, pivot) - to).norm();
    result.spin = std::max(result.spin, world.spin());
    result.lag = std::isfinite(lag) ? std::max(result.lag, lag) : HUGE_VAL;
    result.past = std::isfinite(angle) ? std::max(result.past, std::abs(angle) - limit) : HUGE_VAL;
  }
  return result;
}

}  // namespace scenes

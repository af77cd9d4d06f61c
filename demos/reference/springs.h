// The springs of sliders and distances: how far they are drawn out, and what they pull.

#pragma once

#include "constraints.h"

namespace reference {

// Along a slider's axis, or between the points of a distance.
struct Extension {
  double value, speed;  // m, m/s
  Vector3d axis, arm_a, arm_b;

  Extension(const scenes::Joint& joint, const Coordinates& a, const Coordinates& b)
      : arm_a(a.q * joint.in_a.translation()), arm_b(b.q * joint.in_b.translation()) {
    const Vector3d apart = b.x + arm_b - a.x - arm_a;
    const bool strut = joint.kind == scenes::Kind::distance;
    axis = strut ? apart.normalized() : Vector3d(a.q * joint.in_a.linear().col(0));
    value = apart.dot(axis) - (strut ? joint.range.low : 0);
    speed = (b.v + b.w.cross(arm_b) - a.v - a.w.cross(arm_a)).dot(axis);
  }
};

// N/m and N s/m, by the mass that both bodies have against each other.
struct SpringConstants {
  double stiffness = 0, damping = 0;

  SpringConstants(const scenes::Scene& scene, const scenes::Joint& joint) {
    const auto inverse_mass = [&](int body) {
      return body == 0 ? 0 : 1 / scene.bodies[size_t(body)].mass;
    };
    const double mass = 1 / (inverse_mass(joint.a) + inverse_mass(joint.b)),
                 w = 2 * scenes::pi * joint.spring.frequency;
    stiffness = mass * w * w;
    damping = 2 * mass * joint.spring.damping_ratio * w;
  }
};

// Whether its force at the start of a step of h would swing it ever wider.
inline bool is_stiff(const scenes::Spring& spring, double h) {
  const double w = 2 * scenes::pi * spring.frequency * h;
  return w * w + 4 * spring.damping_ratio * w >= 4;
}

// One that acts at the end of a step instead: by an impulse of -(h k C + c (C - start)).
struct StiffSpring {
  const scenes::Joint* joint;
  double of_damper, softness;  // m, m / (N s)

  StiffSpring(const scenes::Scene& scene, const scenes::Joint& of, const Extension& start, double h)
      : joint(&of) {
    const SpringConstants spring(scene, of);
    softness = 1 / (h * spring.stiffness + spring.damping);
    of_damper = softness * spring.damping * start.value;
  }
  // m: what is missing to that.
  double error(double C, double impulse) const { return C - of_damper + softness * impulse; }
};

}  // namespace reference

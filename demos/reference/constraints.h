// What joints hold, by the definitions of their kinds, with first and second derivatives along a motion.

#pragma once

#include <stdexcept>

#include "../scenes/scene.h"
#include "taylor.h"

namespace reference {

using scenes::Vector3d;
using Vector = Eigen::Matrix<Taylor, 3, 1>;

struct Coordinates {
  Vector3d x;
  Eigen::Quaterniond q;
  Vector3d v, w;  // world
};

// A direction fixed in a body that turns at a constant w: its course near now. d' = w x d.
inline Vector direction(const Vector3d& d, const Vector3d& w) {
  const Vector3d first = w.cross(d), second = w.cross(first);
  Vector course;
  for (int i = 0; i < 3; ++i) course[i] = {d[i], first[i], second[i]};
  return course;
}

// The same of a point fixed in it.
inline Vector point(const Vector3d& x, const Vector3d& v, const Vector3d& arm, const Vector3d& w) {
  Vector course = direction(arm, w);
  for (int i = 0; i < 3; ++i) course[i] += Taylor(x[i], v[i], 0);
  return course;
}

// A joint's frame in a body, as it moves.
struct Frame {
  Vector origin, x, y, z;
  Frame(const Coordinates& body, const scenes::Isometry3d& local, const Vector3d& v,
        const Vector3d& w)
      : origin(point(body.x, v, body.q * local.translation(), w)),
        x(direction(body.q * local.linear().col(0), w)),
        y(direction(body.q * local.linear().col(1), w)),
        z(direction(body.q * local.linear().col(2), w)) {}
};

inline Taylor dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

inline int row_count(scenes::Kind kind) {
  switch (kind) {
    case scenes::Kind::ball: return 3;
    case scenes::Kind::hinge:
    case scenes::Kind::slider: return 5;
    case scenes::Kind::fixed: return 6;
    case scenes::Kind::distance: return 0;  // it is a spring
    default: throw std::invalid_argument("reference: a joint of this kind is not solved");
  }
}

// C(q) of the joint, each entry 0 where it holds.
inline void constraints(scenes::Kind kind, const Frame& a, const Frame& b, Taylor* C) {
  if (row_count(kind) == 0) return;
  const Vector apart = b.origin - a.origin;
  if (kind == scenes::Kind::slider) {
    *C++ = dot(apart, a.y);
    *C++ = dot(apart, a.z);
  } else {
    for (int i = 0; i < 3; ++i) *C++ = apart[i];
  }
  if (kind == scenes::Kind::ball) return;
  *C++ = dot(a.x, b.z);
  *C++ = dot(a.y, b.z);
  if (kind != scenes::Kind::hinge) *C++ = dot(a.x, b.y);
}

}  // namespace reference

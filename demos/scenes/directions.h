// Limits of directions by their definitions: swing and twist, the cone, the wedge.

#pragma once

#include <algorithm>

#include "angles.h"

namespace scenes {

// Of a joint frame against another one: a twist about x, then a swing.
struct SwingTwistAngles {
  double swing_1, swing_2;  // components of the swing's rotation vector about z and y, rad
  double twist;             // rad, in [-pi, pi]
  double swing() const { return std::hypot(swing_1, swing_2); }
};

inline SwingTwistAngles swing_twist_angles(const Eigen::Matrix3d& R) {
  const Eigen::Vector3d x = R.col(0);
  const double across = std::hypot(x.y(), x.z()), swing = std::atan2(across, x.x());
  const Eigen::Vector3d axis = across > 1e-12 ? Eigen::Vector3d(0, -x.z() / across, x.y() / across)
                                              : Eigen::Vector3d(0, 0, 1);
  const Eigen::Matrix3d T = Eigen::AngleAxisd(-swing, axis).toRotationMatrix() * R;
  return {swing * axis.z(), swing * axis.y(), std::atan2(T(2, 1), T(1, 1))};
}

// Distance of (x, y) from an ellipse, > 0 outside: the nearest of its points by search.
inline double distance_from_ellipse(double x, double y, double semiaxis_x, double semiaxis_y) {
  x = std::abs(x);
  y = std::abs(y);
  const auto distance = [&](double t) {
    return std::hypot(x - semiaxis_x * std::cos(t), y - semiaxis_y * std::sin(t));
  };
  constexpr int samples = 64;
  int nearest = 0;
  for (int i = 1; i <= samples; ++i) {
    if (distance(pi / 2 * i / samples) < distance(pi / 2 * nearest / samples)) nearest = i;
  }
  double low = pi / 2 * std::max(nearest - 1, 0) / samples,
         high = pi / 2 * std::min(nearest + 1, samples) / samples;
  for (int i = 0; i < 60; ++i) {
    const double left = low + (high - low) / 3, right = high - (high - low) / 3;
    (distance(left) < distance(right) ? high : low) =
        distance(left) < distance(right) ? right : left;
  }
  const bool outside = std::hypot(x / semiaxis_x, y / semiaxis_y) > 1;
  return outside ? distance(low) : -distance(low);
}

// A limit of a direction to a wedge, by its definition.
struct Wedge {
  double low, high;  // rad

  double total() const { return high - low; }
  double middle() const { return (low + high) / 2; }
  // From the nearer side, along the circle about the axis; above 0 outside.
  double off(double psi) const {
    return std::abs(std::remainder(psi - middle(), 2 * pi)) - total() / 2;
  }
  // The shortest turn (rad) that brings a direction of the frame inside.
  double outside(const Eigen::Vector3d& c) const {
    const double across = std::hypot(c.x(), c.y()), delta = off(std::atan2(c.y(), c.x()));
    if (delta <= 0) return 0;
    // Less than a quarter from a side its half circle is nearest, else the edge.
    if (delta >= pi / 2) return std::atan2(across, std::abs(c.z()));
    return std::asin(std::min(1., across * std::sin(delta)));
  }
};

}  // namespace scenes

// Angles and constants that scenes and measurements share. No Bullet.

#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

namespace scenes {

constexpr double pi = 3.14159265358979323846;
constexpr double standard_gravity = 9.81;  // m/s^2

constexpr double radians(double degrees) { return degrees * (pi / 180); }
constexpr double degrees(double radians) { return radians * (180 / pi); }

// Angle between two directions, rad, in [0, pi]. By atan2: acos loses half of the digits near 0.
inline double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

// Counts the turns of an angle that is known modulo 2 pi: each value continues the last one by the
// shortest way. Exact while the angle moves less than pi between two calls; Bullet turns a body by
// at most pi/4 a step, so a call after each step always is.
class Unwrap {
 public:
  explicit Unwrap(double start) : angle_(start) {}
  double operator()(double wrapped) {
    angle_ += std::remainder(wrapped - angle_, 2 * pi);
    return angle_;
  }

 private:
  double angle_;
};

}  // namespace scenes

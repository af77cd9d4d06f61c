// Purpose: how near a limit must be for a step to reach it. Farther ones cost no row.
#pragma once

#include <pintle/body_pair.h>
#include <pintle/equations/effective_mass.h>
#include <pintle/rows/axis.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// The first three lanes add up to a bound for the square of the angular acceleration (rad^2/s^4,
/// about any axis) that the force and the torque on a body give it, wherever a joint holds it: a
/// force F on the centre turns a body that is held at the distance r by at most F r / (r^2 + k^2) /
/// m
/// <= F / (2 k m), k its least radius of gyration; the trace of I^-1 is a bound for 1 / (m k^2).
inline Lanes accelerationBound2(const btRigidBody& body) {
  const btMatrix3x3& I_inv = body.getInvInertiaTensorWorld();
  const Scalar trace = I_inv[0].x() + I_inv[1].y() + I_inv[2].z();
  const LanesView F = lanes(body.getTotalForce()), T = lanes(body.getTotalTorque());
  // (x + y)^2 <= 2 (x^2 + y^2)
  return F * F * (Scalar(0.5) * trace * body.getInvMass()) + T * T * (2 * trace * trace);
}

/// How a coordinate may move in a step.
struct Reach {
  Scalar moved = 0;   ///< by the velocity of now
  Scalar gained = 0;  ///< at most, either way, by what forces add

  /// The same along an axis with a limit that is a spring, or with a servo.
  Reach of(const Axis& axis) const {
    if (axis.limit_spring.angular_frequency > 0) return {};
    // It may push however hard.
    if (axis.drive == Axis::Drive::servo) return {0, infinity};
    return *this;
  }
  /// Whether the step may come to a limit of `axis`: towards it at twice the speed of now, as the step
  /// may be longer than the last. `slack`: how far off `coordinate` may be.
  bool reaches(const Axis& axis, Scalar coordinate, Scalar slack = 0) const {
    const Scalar most = gained + slack;
    return coordinate - axis.low <= most + btMax(-2 * moved, -moved) ||
           axis.high - coordinate <= most + btMax(2 * moved, moved);
  }
};

/// Of an angle (rad) that moves as two bodies turn against each other (b against a) about the unit
/// vector h, or the other way (sign -1).
inline Reach angularReach(const BodyPair& pair, const Vec3& h, Scalar dt, Scalar sign = 1) {
  const Lanes gain2 = accelerationBound2(pair.a()) + accelerationBound2(pair.b());
  const Scalar gain = btSqrt(2 * (gain2[0] + gain2[1] + gain2[2]));
  return {sign * dt * h.dot(pair.w_b() - pair.w_a()), dt * dt * gain};
}

/// Of a distance (m) that changes by J v, J = [-L, -A_a, L, A_b] with the unit vector L, and by
/// `curvature`; r_a and r_b are the levers of the points that it is between.
inline Reach linearReach(const BodyPair& pair, const equations::Jacobian<Scalar>& J,
                         Scalar curvature, const Vec3& r_a, const Vec3& r_b, Scalar dt) {
  // (x + y + z + u)^2 <= 4 (x^2 + y^2 + z^2 + u^2)
  const auto gain2 = [](const btRigidBody& body, const Vec3& r) -> Lanes {
    const LanesView F = lanes(body.getTotalForce());
    return F * F * (body.getInvMass() * body.getInvMass()) + r.dot(r) * accelerationBound2(body);
  };
  const Lanes sum = gain2(pair.a(), r_a) + gain2(pair.b(), r_b);
  const Scalar velocity =
      J.L.dot(pair.v_b() - pair.v_a()) - J.A_a.dot(pair.w_a()) + J.A_b.dot(pair.w_b());
  return {dt * (velocity + Scalar(0.5) * dt * curvature),
          2 * dt * dt * btSqrt(sum[0] + sum[1] + sum[2])};
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

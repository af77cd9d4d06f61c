// Purpose: how near a limit must be for a step to reach it. Farther ones cost no row.
#pragma once

#include <pintle/body_pair.h>
#include <pintle/rows/axis.h>
#include <pintle/rows/unwrapped_angle.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// A bound for what a torque of 1 N m about any axis gives a body, rad/s^2.
inline Scalar inverseInertiaTrace(const btRigidBody& body) {
  const btMatrix3x3& I_inv = body.getInvInertiaTensorWorld();
  return I_inv[0].x() + I_inv[1].y() + I_inv[2].z();
}

/// The first three lanes add up to a bound for the square of the angular acceleration (rad^2/s^4,
/// about any axis) that the force and the torque on a body give it, wherever a joint holds it: a
/// force F on the centre turns a body that is held at the distance r by at most
/// F r / (r^2 + k^2) / m <= F / (2 k m), k its least radius of gyration; the trace of I^-1 is a bound
/// for 1 / (m k^2).
inline Lanes accelerationBound2(const btRigidBody& body) {
  const Scalar trace = inverseInertiaTrace(body);
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

/// Of a distance (m) along a unit vector, between points at these levers of the bodies: `speed` is J v of
/// its row, `curvature` what the motion adds (m/s^2). Whatever joints hold the bodies, the part along
/// J of an acceleration a by forces is at most sqrt(J M^-1 J^T a^T M a).
inline Reach linearReach(const BodyPair& pair, const Vec3& lever_a, const Vec3& lever_b,
                         Scalar speed, Scalar curvature, Scalar dt) {
  const btRigidBody &a = pair.a(), &b = pair.b();
  const Scalar I_a = inverseInertiaTrace(a), I_b = inverseInertiaTrace(b);
  const LanesView F_a = lanes(a.getTotalForce()), F_b = lanes(b.getTotalForce());
  const LanesView T_a = lanes(a.getTotalTorque()), T_b = lanes(b.getTotalTorque());
  const Lanes aMa = F_a * F_a * pair.inv_mass_a() + F_b * F_b * pair.inv_mass_b() +
                    T_a * T_a * I_a + T_b * T_b * I_b;
  const Scalar K = pair.inv_mass_a() + pair.inv_mass_b() + I_a * lever_a.dot(lever_a) +
                   I_b * lever_b.dot(lever_b);
  const Scalar most = btSqrt(K * (aMa[0] + aMa[1] + aMa[2])) + btFabs(curvature);
  return {dt * speed, dt * dt * most};
}

/// Whether anything acts along a coordinate in this step.
struct Acting {
  Scalar position = 0;  ///< of the coordinate, if anything does
  bool limit = false;   ///< the limit may
  bool row = false;     ///< anything does: it needs a row
};

/// Of the coordinate sign * `angle`, which moves as angularReach says. Its arc tangent is taken only if
/// it is near a limit.
inline Acting actingAngle(const BodyPair& pair, const Axis& axis, const UnwrappedAngle& angle,
                          const Vec3& h, Scalar dt, Scalar sign = 1) {
  Acting acting;
  Reach reach;
  bool broken = false, near = false;
  if (axis.limited()) {
    const Scalar rough = sign * angle.roughValue(), slack = UnwrappedAngle::rough_error;
    broken = axis.distance(rough) < -slack;
    if (!broken) {
      reach = angularReach(pair, h, dt, sign).of(axis);
      near = reach.reaches(axis, rough, slack);
    }
  }
  if (!near && !broken && !axis.driven()) return acting;
  acting.position = sign * angle.value();
  acting.limit = broken || (near && reach.reaches(axis, acting.position));
  acting.row = acting.limit || axis.driven();
  return acting;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

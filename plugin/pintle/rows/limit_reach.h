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

/// The first three lanes add up to a bound for half of the square of the angular acceleration
/// (rad^2/s^4, about any axis) that the force and the torque on a body give it, wherever a joint holds
/// it: a force F on the centre turns a body that is held at the distance r by at most
/// F r / (r^2 + k^2) / m <= F / (2 k m), k its least radius of gyration; the trace of I^-1 is a bound
/// for 1 / (m k^2).
inline Lanes accelerationBound2(const btRigidBody& body) {
  const Scalar trace = inverseInertiaTrace(body);
  const LanesView F = lanes(body.getTotalForce()), T = lanes(body.getTotalTorque());
  // (x + y)^2 / 2 <= x^2 + y^2
  const Lanes by_torque = trace * T;
  return F * F * (Scalar(0.25) * trace * body.getInvMass()) + by_torque * by_torque;
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
  /// Whether the step may come to a limit of `axis`, or begins beyond it and will not leave it by
  /// itself: towards it at twice the speed of now, as the step may be longer than the last. `slack`: how
  /// far off `coordinate` may be.
  bool reaches(const Axis& axis, Scalar coordinate, Scalar slack = 0) const {
    const Scalar most = gained + slack;
    return coordinate - axis.low <= most + btMax(-2 * moved, -moved) ||
           axis.high - coordinate <= most + btMax(2 * moved, moved);
  }
};

/// How an angle (rad) may move in a step as two bodies turn against each other (b against a).
class AngularReach {
 public:
  AngularReach(const BodyPair& pair, Scalar dt)
      : m_dt(dt),
        m_w(lanes(pair.b().getAngularVelocity()) - lanes(pair.a().getAngularVelocity())),
        m_gain2(accelerationBound2(pair.a()) + accelerationBound2(pair.b())) {}

  /// By how much forces add to the turn, at most.
  Scalar gained() const { return 2 * m_dt * m_dt * btSqrt(sum(m_gain2)); }
  /// About the unit vector h, or the other way (sign -1).
  Reach about(const Vec3& h, Scalar sign = 1) const {
    return {sign * m_dt * (h.x() * m_w[0] + h.y() * m_w[1] + h.z() * m_w[2]), gained()};
  }
  /// About any axis, either way, at twice the speed of now (Reach::reaches).
  Scalar most() const {
    // 2 dt |w| + 2 dt^2 |gain|, by (x + y)^2 <= 2 (x^2 + y^2)
    return m_dt * btSqrt(8 * sum(m_w * m_w + m_dt * m_dt * m_gain2));
  }

 private:
  static Scalar sum(const Lanes& l) { return l[0] + l[1] + l[2]; }

  Scalar m_dt;
  Lanes m_w, m_gain2;
};

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

/// Of the coordinate sign * `angle`, which moves as the bodies turn about h. makeReach() is its
/// AngularReach. Far from a limit no arc tangent is computed.
template <class MakeReach>
Acting actingAngle(const Axis& axis, const UnwrappedAngle& angle, const Vec3& h, Scalar sign,
                   const MakeReach& makeReach) {
  Acting acting;
  const bool limited = axis.limited(), driven = axis.driven();
  if (!limited && !driven) return acting;
  bool broken = false;
  if (limited && !driven) {
    const Scalar distance = axis.distance(sign * angle.roughValue());
    broken = distance < -UnwrappedAngle::rough_error;
    if (!broken && distance > makeReach().most() + UnwrappedAngle::rough_error) return acting;
  }
  acting.position = sign * angle.value();
  acting.limit =
      broken || (limited && makeReach().about(h, sign).of(axis).reaches(axis, acting.position));
  acting.row = acting.limit || driven;
  return acting;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

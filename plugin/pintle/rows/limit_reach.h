// Purpose: how near a limit must be for a step to reach it. Farther ones cost no row.
#pragma once

#include <pintle/body_pair.h>
#include <pintle/equations/effective_mass.h>
#include <pintle/rows/axis.h>
#include <pintle/rows/step_motion.h>
#include <pintle/rows/unwrapped_angle.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// A bound for what a torque of 1 N m about any axis gives a body, rad/s^2.
inline Scalar inverseInertiaTrace(const btRigidBody& body) {
  const btMatrix3x3& I_inv = body.getInvInertiaTensorWorld();
  return I_inv[0].x() + I_inv[1].y() + I_inv[2].z();
}

/// A bound for the angular acceleration (rad/s^2, about any axis) that the force and the torque on a body
/// give it, wherever a joint holds it: a force F on the centre turns a body that is held at the
/// distance r by at most F r / (r^2 + k^2) / m <= F / (2 k m), k its least radius of gyration; the trace
/// of I^-1 is a bound for 1 / (m k^2).
inline Scalar accelerationBound(const btRigidBody& body) {
  const Scalar trace = inverseInertiaTrace(body);
  return btSqrt(trace * body.getInvMass() * body.getTotalForce().length2()) / 2 +
         trace * body.getTotalTorque().length();
}

/// Lanes of which the first three add up to no less than 0.8 of its square, without a square root:
/// (x/2 + y)^2 <= 1.25 (x^2 + y^2).
inline Lanes accelerationBound2(const btRigidBody& body) {
  const Scalar trace = inverseInertiaTrace(body);
  const LanesView F = lanes(body.getTotalForce()), T = lanes(body.getTotalTorque());
  const Lanes by_torque = trace * T;
  return F * F * (trace * body.getInvMass()) + by_torque * by_torque;
}

/// How a coordinate may move in a step.
struct Reach {
  Scalar moved = 0;   ///< by the velocity of now
  Scalar gained = 0;  ///< at most, either way, by what forces add

  /// The same along an axis with a limit that is a spring, or with a servo.
  Reach of(const Axis& axis) const {
    if (axis.hasLimitSpring()) return {};
    // It may push however hard.
    if (axis.drive == Axis::Drive::servo) return {0, infinity};
    return *this;
  }
  /// Either way, at twice the speed of now (reaches).
  Scalar max() const { return gained + 2 * btFabs(moved); }
  /// Whether the step may come to a limit of `axis`, or begins beyond it and will not leave it by
  /// itself: towards it at twice the speed of now, as the step may be longer than the last. `slack`: how
  /// far off `coordinate` may be.
  bool reaches(const Axis& axis, Scalar coordinate, Scalar slack = 0) const {
    const Scalar margin = gained + slack;
    // A spring moves it to its rest at most.
    const Scalar pulled = axis.spring.isSet() ? axis.spring_rest - coordinate : Scalar(0);
    return coordinate - axis.low <=
               margin + btMax(-2 * moved, -moved) + btMax(-pulled, Scalar(0)) ||
           axis.high - coordinate <= margin + btMax(2 * moved, moved) + btMax(pulled, Scalar(0));
  }
};

/// How an angle (rad) may move in a step as two bodies turn against each other (b against a). Without a motion it may
/// go anywhere.
class AngularReach {
 public:
  /// `a_may_stop`: another joint, or a contact, may stop a, and b goes on as fast as it turns now.
  explicit AngularReach(const StepMotion* motion, bool a_may_stop = false)
      : m_motion(motion),
        m_a_may_stop(a_may_stop),
        m_max2(motion != nullptr ? maxTurn2(*motion) : infinity * infinity) {}

  /// The turn of now's velocities, a rotation vector.
  Vec3 moved() const {
    if (m_motion == nullptr) return Vec3::Zero();
    return m_motion->dt * (m_motion->pair.w_b() - m_motion->pair.w_a());
  }
  /// By how much forces, and what stops a, add to the turn, at most.
  Scalar gained() const {
    if (m_motion == nullptr) return infinity;
    const BodyPair& pair = m_motion->pair;
    const Scalar dt = m_motion->dt;
    const Scalar forces = dt * dt * (accelerationBound(pair.a()) + accelerationBound(pair.b()));
    return m_a_may_stop ? forces + dt * pair.w_a().norm() : forces;
  }
  /// About the unit vector h, or the other way (sign -1).
  Reach about(const Vec3& h, Scalar sign = 1) const { return {sign * h.dot(moved()), gained()}; }
  /// No less than the turn about any axis, either way, at twice the speed of now (Reach::reaches).
  Scalar max() const { return btSqrt(m_max2); }
  /// Whether that is less than `turn`.
  bool isLess(Scalar turn) const { return turn > 0 && turn * turn > m_max2; }

 private:
  // The square of 2 dt |w| + gained(), by (x + y)^2 <= 2 (x^2 + y^2) for both bodies and
  // (2 x + sqrt(2.5) y)^2 <= 6.5 (x^2 + y^2), and with z for what stops a 7.5 (x^2 + y^2 + z^2).
  Scalar maxTurn2(const StepMotion& motion) const {
    const btRigidBody &a = motion.pair.a(), &b = motion.pair.b();
    const LanesView w_a = lanes(a.getAngularVelocity());
    const Lanes w = lanes(b.getAngularVelocity()) - w_a;
    const Lanes gain2 = accelerationBound2(a) + accelerationBound2(b);
    Lanes sum = w * w + motion.dt * motion.dt * gain2;
    if (m_a_may_stop) sum += w_a * w_a;
    const Scalar factor = m_a_may_stop ? Scalar(7.5) : Scalar(6.5);
    return motion.dt * motion.dt * factor * (sum[2] + sum[0] + sum[1]);
  }

  const StepMotion* m_motion;
  bool m_a_may_stop;
  Scalar m_max2;
};

/// Of a coordinate (m) that moves by `moved` at the velocities of now, and by the curvature (m/s^2) beside. Whatever joints
/// hold the bodies, the part along J of an acceleration a by forces is at most sqrt(J M^-1 J^T a^T M a). L of J is a unit
/// vector; A_a2, A_b2: the squares of the lengths of its angular parts, which are no longer than their levers.
inline Reach linearReach(const StepMotion* motion, Scalar moved, Scalar A_a2, Scalar A_b2,
                         Scalar curvature) {
  if (motion == nullptr) return {0, infinity};
  const BodyPair& pair = motion->pair;
  const btRigidBody &a = pair.a(), &b = pair.b();
  const Scalar I_a = inverseInertiaTrace(a), I_b = inverseInertiaTrace(b);
  const LanesView F_a = lanes(a.getTotalForce()), F_b = lanes(b.getTotalForce());
  const LanesView T_a = lanes(a.getTotalTorque()), T_b = lanes(b.getTotalTorque());
  const Lanes aMa = F_a * F_a * pair.inv_mass_a() + F_b * F_b * pair.inv_mass_b() +
                    T_a * T_a * I_a + T_b * T_b * I_b;
  const Scalar K = pair.inv_mass_a() + pair.inv_mass_b() + I_a * A_a2 + I_b * A_b2;
  const Scalar max_acceleration = btSqrt(K * (aMa[0] + aMa[1] + aMa[2])) + btFabs(curvature);
  return {moved, motion->dt * motion->dt * max_acceleration};
}
inline Reach linearReach(const StepMotion* motion, const equations::Jacobian<Scalar>& J,
                         Scalar curvature) {
  if (motion == nullptr) return {0, infinity};
  const BodyPair& pair = motion->pair;
  const Scalar speed =
      J.L.dot(pair.v_b() - pair.v_a()) - J.A_a.dot(pair.w_a()) + J.A_b.dot(pair.w_b());
  return linearReach(motion, motion->dt * speed, J.A_a.dot(J.A_a), J.A_b.dot(J.A_b), curvature);
}

/// Whether anything acts along a coordinate in this step.
struct Acting {
  Scalar position = 0;  ///< of the coordinate, if anything does
  bool limit = false;   ///< the limit may
  bool row = false;     ///< anything does: it needs a row
};

/// Of the coordinate sign * makeAngle(), an UnwrappedAngle, which moves as the bodies turn about h. makeReach() is its
/// AngularReach. Far from a limit no arc tangent is computed.
template <class MakeAngle, class MakeReach>
Acting actingAngle(const Axis& axis, const MakeAngle& makeAngle, const Vec3& h, Scalar sign,
                   const MakeReach& makeReach) {
  Acting acting;
  const bool limited = axis.limited(), driven = axis.driven();
  if (!limited && !driven) return acting;
  const UnwrappedAngle angle = makeAngle();
  bool broken = false;
  if (limited && !driven) {
    const Scalar distance = axis.distance(sign * angle.roughValue());
    broken = distance < -UnwrappedAngle::rough_error;
    if (!broken && makeReach().isLess(distance - UnwrappedAngle::rough_error)) return acting;
  }
  acting.position = sign * angle.value();
  acting.limit =
      broken || (limited && makeReach().about(h, sign).of(axis).reaches(axis, acting.position));
  acting.row = acting.limit || driven;
  return acting;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

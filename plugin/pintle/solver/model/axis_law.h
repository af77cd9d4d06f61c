// Purpose: what an impulse along a row may be at the velocity u that the row ends with: a sum of parts, each
//   Lambda(u) = clamp((target - u) / softness, lower, upper),
// vertical if rigid. An equality is one part without bounds, a limit one with one bound, a motor and friction have two.
#pragma once

#include <pintle/rows/axis_settings.h>

#include <LinearMath/btScalar.h>

#include <array>
#include <cmath>

namespace pintle {
inline namespace PINTLE_PRECISION {

struct LawPart {
  double target, softness, lower, upper;
  bool drives = false;  ///< a motor, a servo, a spring, or friction: its work is not the joint's
  bool gives = false;   ///< a stop with a spring of its own (RowSpring), by which its target pulls
  int role = 0;  ///< which part of an axis it is (Axis::Part), or a bounded pull (Axis::parts)
  /// Of a spring and damper, Lambda = -dt k (C + dt u) - dt c u: dt^2 k softness. What is left of 1 is the damper's.
  double spring_share = 0;

  static constexpr double unbounded = 1e30;
  bool isLowerStop() const { return lower == 0 && upper == unbounded; }
  bool isUpperStop() const { return upper == 0 && lower == -unbounded; }
  bool isRigidStop() const {
    return (isLowerStop() || isUpperStop()) && !drives && !(softness > 0);
  }
  /// A drive at a velocity. It yields to walls, whatever its bound: so it is no equality.
  bool isMotor() const { return drives && role == Axis::motor && !(softness > 0); }
  /// Friction, or a motor that holds still: it takes alone.
  bool brakes() const {
    return drives && role != Axis::parts && target == 0 && lower < upper && !(spring_share > 0);
  }
  /// Of a stop: whether u is beyond it.
  bool isBeyond(double u) const {
    return (isLowerStop() && u < target) || (isUpperStop() && u > target);
  }
  bool rebounds() const {
    return !drives && !gives && ((isLowerStop() && target > 0) || (isUpperStop() && target < 0));
  }

  /// The spring pulls by `share` of the way of this step, and by all that it was stretched before: Lambda = -dt k (C + share dt u) -
  /// dt c u. Without a damper and a share of the way its impulse is known.
  void foresee(double share) {
    const double left = 1 - (1 - share) * spring_share;
    if (left > 1e-6) {  // of less, rounding would be most
      target /= left;
      softness /= left;
      spring_share *= share / left;
      return;
    }
    lower = upper = std::fmin(std::fmax(target / softness, lower), upper);
    target = softness = spring_share = 0;
  }

  double at(double u) const {
    if (softness > 0) return std::fmin(std::fmax((target - u) / softness, lower), upper);
    return u < target ? upper : lower;
  }
};

/// On which of its pieces a law is: there the velocity is `target` - softness * impulse, or the impulse is given.
struct LawPiece {
  bool acts;                ///< the row is an equation of u
  double target, softness;  ///< if it acts: u + softness Lambda = target
  double impulse;           ///< if it does not

  /// Lambda where u = free + K Lambda.
  double impulseAt(double free, double K) const {
    return acts ? (target - free) / (K + softness) : impulse;
  }
  /// u of that impulse, without what a solve has left of it.
  double velocityAt(double u, double lambda) const { return acts ? target - softness * lambda : u; }
};

class AxisLaw {
 public:
  static constexpr int max_parts = 5;

  /// Of one part.
  AxisLaw() = default;
  /// Of max_parts, for which there must be `room` as long as the law is in use. Copies share it.
  explicit AxisLaw(LawPart* room) : m_room(room) {}

  void add(const LawPart& part) {
    btAssert(m_parts < (m_room != nullptr ? max_parts : 1));
    m_is_equality = m_parts == 0 && isUnbounded(part) && !part.isMotor();
    m_has_drives = m_has_drives || part.drives;
    own(m_parts++) = part;
  }
  void setTarget(int part, double target) { own(part).target = target; }
  /// Its springs, as each part does.
  void foresee(double share) {
    for (int i = 0; i < m_parts; ++i)
      if (part(i).spring_share > 0) own(i).foresee(share);
    m_is_equality = m_parts == 1 && isUnbounded(part(0));
  }
  int parts() const { return m_parts; }
  const LawPart& part(int i) const { return first()[i]; }
  bool isEquality() const { return m_is_equality; }
  bool hasDrives() const { return m_has_drives; }

  /// Lambda. At the target of a rigid part, of which it may be any: as little as can be.
  double at(double u) const {
    double sum = 0;
    for (int i = 0; i < m_parts; ++i) {
      const LawPart& of = part(i);
      sum += !(of.softness > 0) && u == of.target ? std::fmin(std::fmax(0, of.lower), of.upper)
                                                  : of.at(u);
    }
    return sum;
  }
  /// The piece on which u = free + K Lambda and Lambda(u) meet.
  LawPiece meet(double free, double K) const {
    return isEquality() ? LawPiece{true, part(0).target, part(0).softness, 0}
                        : meetWithBounds(free, K);
  }
  using Parts = std::array<double, max_parts>;
  /// How the impulse of the whole is made of its parts' at that velocity.
  Parts split(double u, double impulse) const;

  static constexpr double unbounded = LawPart::unbounded;

 private:
  LawPiece meetWithBounds(double free, double K) const;

  static bool isUnbounded(const LawPart& part) {
    return part.lower == -unbounded && part.upper == unbounded;
  }
  const LawPart* first() const { return m_room != nullptr ? m_room : &m_only; }
  LawPart& own(int i) { return m_room != nullptr ? m_room[i] : m_only; }

  LawPart m_only;
  LawPart* m_room = nullptr;
  int m_parts = 0;
  bool m_is_equality = false, m_has_drives = false;
};

/// dt^2 k of its springs, N s^2/m.
inline double springs(const AxisLaw& law) {
  double sum = 0;
  for (int i = 0; i < law.parts(); ++i)
    if (const LawPart& part = law.part(i); part.spring_share > 0)
      sum += part.spring_share / part.softness;
  return sum;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

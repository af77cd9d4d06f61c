// Purpose: the Euler angles of a 6-dof joint as they have become, also past the pole, where the outer two are one and no coordinates. For
// the .cpp files of its model only.
//
// Within 5 degrees of the pole each angle goes on along its row as that was when it came there, fixed in a frame: an integral of the
// rotation, so nothing jumps. There the outer two are both the turn about the pole. That of the first axis is fixed in frame a, where it does
// not see that turn; that of the last one is, too, and then sees it, unless the first one is free: then it is fixed in frame b. So the turn is
// held if both are. Where the bodies leave that cap, on any side, the angles are Euler's again, of the side that fits better; what they
// differ by then is kept as an offset, which falls as the motion allows.
#pragma once

#include <pintle/equations/euler_angles.h>
#include <pintle/equations/orientation_lock.h>
#include <pintle/frame.h>
#include <pintle/rows/unwrapped_angle.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// An axis of a frame by its number.
inline Vec3 axisOf(const Frame& frame, int i) {
  return i == 0 ? frame.a() : i == 1 ? frame.b() : frame.c();
}

inline equations::EulerAxes<Scalar> eulerAxes(const Frame& a, const Frame& b,
                                              const equations::EulerOrder& order) {
  return {axisOf(a, order.first), axisOf(a, order.middle), axisOf(a, order.last),
          axisOf(b, order.first), axisOf(b, order.middle), axisOf(b, order.last),
          Scalar(order.sign())};
}

class EulerTurn {
 public:
  enum { first, middle, last, count };

  /// rad, of b against a, over any number of turns: by first, middle and last axis.
  Scalar value(int n) const { return m_is_in_cap ? m_in_cap[n] : m_angle[n].value() + m_offset[n]; }
  /// Takes the angles of the pose, in the turn that is nearest to the last. `holds_pole`: whether the turn about the pole is not free.
  void update(const Frame& a, const Frame& b, const equations::EulerOrder& order, bool holds_pole) {
    const auto axes = eulerAxes(a, b, order);
    const Scalar m = axes.a_k.dot(axes.b_i), c2 = 1 - m * m;
    if (!m_is_in_cap && c2 > min_c2) {
      take(axes);
      m_is_near = c2 < near_c2;
      if (m_is_near) remember(a, b, axes, holds_pole);
      return;
    }
    if (!m_is_in_cap && !m_is_near) {  // it starts there
      take(axes);
      remember(a, b, axes, holds_pole);
    }
    if (!goOnInCap(a, b)) {  // put there, by no motion
      *this = EulerTurn();
      take(axes);
      return;
    }
    if (c2 > min_c2) leaveCap(a, b, axes, holds_pole);
  }
  /// The other triple of the same pose (euler_angles.h).
  void changeSide() {
    m_side = -m_side;
    m_is_near = m_is_in_cap = false;
  }
  Scalar side() const { return m_side; }
  void turnTowards(int n, Scalar angle) {
    if (!m_is_in_cap) m_angle[n].turnTowards(angle - m_offset[n]);
  }
  /// Takes back at most so much (rad) of what an angle differs from Euler's by.
  void settle(int n, Scalar most) {
    Scalar& offset = m_offset[n];
    offset = offset > 0 ? btMax(Scalar(0), offset - most) : btMin(Scalar(0), offset + most);
  }
  /// Takes back all of it that moves nothing: within limits, and up to them.
  void settleWithin(int n, Scalar low, Scalar high) {
    Scalar& offset = m_offset[n];
    if (m_is_in_cap || offset == 0) return;
    const Scalar euler = m_angle[n].value(), now = euler + offset;
    if (low <= now && now <= high) offset = btMax(low, btMin(euler, high)) - euler;
  }
  /// J_b of the angles, and |c| of the pose by which those of the outer two are longer than 1.
  equations::EulerRows<Scalar> rows(const Frame& a, const Frame& b,
                                    const equations::EulerOrder& order) const {
    if (!m_is_in_cap) return equations::euler_rows(eulerAxes(a, b, order), m_side);
    return {a.axes() * m_row_first / m_c, a.axes() * m_row_middle,
            (m_last_is_in_a ? a.axes() : b.axes()) * m_row_last / m_c};
  }
  Scalar cosine(const Frame& a, const Frame& b, const equations::EulerOrder& order) const {
    if (m_is_in_cap) return m_c;
    const Scalar m = axisOf(a, order.last).dot(axisOf(b, order.first));
    return std::sqrt(btMax(min_c2, 1 - m * m));
  }

 private:
  // cos^2 of 85 degrees, of which the cap is the rest, and of 60: there it may be in the next step.
  static constexpr Scalar min_c2 = Scalar(0.0075961), near_c2 = Scalar(0.25);
  static constexpr Scalar max_turn = 1;  // rad, in a step

  // A step may have come past the pole, where the outer angles change by half a turn each; or somebody has put the bodies elsewhere.
  void take(const equations::EulerAxes<Scalar>& axes) {
    UnwrappedAngle there[count];
    const Scalar change = angles(axes, m_side, there);
    if (change > SIMD_PI) {
      UnwrappedAngle other[count];
      if (angles(axes, -m_side, other) < change) {
        m_side = -m_side;
        set(other);
        return;
      }
    }
    set(there);
  }
  void set(const UnwrappedAngle (&to)[count]) {
    for (int n = 0; n < count; ++n) m_angle[n] = to[n];
  }
  // Returns by how much the outer two have changed.
  Scalar angles(const equations::EulerAxes<Scalar>& axes, Scalar side,
                UnwrappedAngle (&to)[count]) const {
    const auto at = equations::euler_angles(axes, side);
    set(to, at);
    return btFabs(to[first].value() - m_angle[first].value()) +
           btFabs(to[last].value() - m_angle[last].value());
  }
  void set(UnwrappedAngle (&to)[count], const equations::EulerAngles<Scalar>& at) const {
    for (int n = 0; n < count; ++n) to[n] = m_angle[n];
    to[first].update(at.x_i, at.y_i);
    to[middle].update(at.x_j, at.y_j);
    to[last].update(at.x_k, at.y_k);
  }

  // The rows as they are here, for the cap, and how the frames stand.
  void remember(const Frame& a, const Frame& b, const equations::EulerAxes<Scalar>& axes,
                bool holds_pole) {
    m_R = a.axes().transpose() * b.axes();
    m_is_near = true;
    Vec3 n = axes.s * m_side * cross(axes.a_k, axes.b_i);
    const Scalar c = n.norm();
    m_c = btMax(c, std::sqrt(min_c2));
    n = c > SIMD_EPSILON ? Vec3(n / c) : any_tangent(axes.a_k);
    const Vec3 of_first = cross(n, axes.a_k) * (axes.s * m_side),
               of_last = cross(axes.b_i, n) * (axes.s * m_side);
    m_row_first = a.axes().transpose() * of_first;
    m_row_middle = a.axes().transpose() * n;
    m_last_is_in_a = holds_pole;
    m_row_last = (m_last_is_in_a ? a.axes() : b.axes()).transpose() * of_last;
  }
  // Returns false if no step turns that far.
  bool goOnInCap(const Frame& a, const Frame& b) {
    if (!m_is_in_cap) {
      for (int n = 0; n < count; ++n) m_in_cap[n] = m_angle[n].value() + m_offset[n];
      m_is_in_cap = true;
    }
    const Mat3 R = a.axes().transpose() * b.axes();
    const Vec3 turn = equations::rotation_vector(equations::quaternion(Mat3(R * m_R.transpose())));
    if (!(turn.dot(turn) < max_turn * max_turn)) return false;
    m_in_cap[first] += m_row_first.dot(turn) / m_c;
    m_in_cap[middle] += m_row_middle.dot(turn);
    m_in_cap[last] += m_row_last.dot(m_last_is_in_a ? turn : Vec3(m_R.transpose() * turn)) / m_c;
    m_R = R;
    return true;
  }
  void leaveCap(const Frame& a, const Frame& b, const equations::EulerAxes<Scalar>& axes,
                bool holds_pole) {
    m_is_in_cap = false;
    for (int n = 0; n < count; ++n) {
      m_angle[n].set(m_in_cap[n]);
      m_offset[n] = 0;
    }
    take(axes);
    for (int n = 0; n < count; ++n) m_offset[n] = m_in_cap[n] - m_angle[n].value();
    remember(a, b, axes, holds_pole);
  }

  UnwrappedAngle m_angle[count];
  Scalar m_offset[count] = {}, m_in_cap[count] = {};
  Scalar m_side = 1, m_c = 1;
  bool m_is_near = false, m_is_in_cap = false;
  bool m_last_is_in_a = false;
  // Near the pole: R_a^T R_b, and unit rows, each in its frame.
  Mat3 m_R = Mat3::Identity();
  Vec3 m_row_first = Vec3::Zero(), m_row_middle = Vec3::Zero(), m_row_last = Vec3::Zero();
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle

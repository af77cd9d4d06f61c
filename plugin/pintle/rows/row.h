// Purpose: what a joint says of itself at a pose: a short list of rows, without a time step.
//   J = [-L, -A_a, L, A_b] (document, 2.2), world space; C its position error; J v = d/dt C.
#pragma once

#include <pintle/rows/axis.h>
#include <pintle/rows/row_list.h>
#include <pintle/vectors.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Each vector is followed by a number, so that the solver's side (block.h) can take it as four lanes.
struct Row {
  Vec3 L;
  /// C of an equality, m or rad; the coordinate of an axis, m or rad.
  Scalar position;
  Vec3 A_a;
  Scalar target = 0;  ///< of J v in this step, set by the solver's side
  Vec3 A_b;
  /// d^2 C / dt^2 (of an axis: of the coordinate) at constant v, w: what J v leaves out of the
  /// motion of C, m/s^2 or rad/s^2.
  Scalar curvature;
  /// The most that a step may correct, m/s or rad/s.
  Scalar max_speed;
  /// Which of the joint's axes it is; -1: an equality.
  signed char axis;
  /// Which group of the joint's equalities it is of, with an ERP and a CFM of its own.
  unsigned char group;
  /// L = 0 and A_a = A_b.
  bool angular;
  /// Whether the limit of the axis may act in this step.
  bool limit;

  // The vectors, each with its number.
  LanesView lanesL() const { return LanesView(&L[0]); }
  LanesView lanesA_a() const { return LanesView(&A_a[0]); }
  LanesView lanesA_b() const { return LanesView(&A_b[0]); }
};

/// What Bullet's passes over the row of an equality have left from the last step.
struct RowHistory {
  Scalar impulse = 0;  ///< as Bullet counts it: what this step's begins with
  /// The velocity along the row that missed the target, m/s or rad/s. Between the passes of this step: the impulse
  /// after the first one.
  Scalar residual = 0;
};

/// Whether the directions of two rows, of which these are the products, are nearer than 45 degrees. A row
/// of the same number at another pose is the same row, unless another came in before it, or its direction
/// jumped: only then do its positions at both tell of its motion.
inline bool isSameDirection(double aa, double ab, double bb) {
  return ab > 0 && 2 * ab * ab > aa * bb;
}
inline bool isSameRow(const Row& a, const Row& b) {
  const auto sum = [](const Lanes& lanes) { return double(lanes[0] + lanes[1] + lanes[2]); };
  const auto dot = [&](const Row& x, const Row& y) {
    return sum(x.lanesL() * y.lanesL() + x.lanesA_a() * y.lanesA_a() + x.lanesA_b() * y.lanesA_b());
  };
  // Who ends as near as this lies within that angle, whatever its length: of nearly all that is enough.
  const double aa = dot(a, a);
  const double apart =
      sum((a.lanesL() - b.lanesL()).square() + (a.lanesA_a() - b.lanesA_a()).square() +
          (a.lanesA_b() - b.lanesA_b()).square());
  return 2 * apart < aa || isSameDirection(aa, dot(a, b), dot(b, b));
}

/// No joint has more rows.
constexpr int max_joint_rows = 8;

/// Room for the rows of a joint, `Axes` of which may be free coordinates.
template <int N, int Axes = 0>
struct RowMemory {
  Row rows[N];
  std::array<AxisState, Axes> axes;
};

inline Row& RowList::operator[](int i) { return m_rows[i]; }
inline const Row& RowList::operator[](int i) const { return m_rows[i]; }
inline AxisState& RowList::axis(int i) { return m_axes[i]; }
inline const AxisState& RowList::axis(int i) const { return m_axes[i]; }
inline RowHistory& RowList::history(int i) { return m_history[i]; }
inline const RowHistory& RowList::history(int i) const { return m_history[i]; }

/// What a joint adds its rows to.
class Rows : public RowList {
 public:
  template <int N, int Axes>
  Rows(RowMemory<N, Axes>& memory) : RowList(memory.rows, memory.axes.data(), nullptr, {N, Axes}) {}
  explicit Rows(const RowList& empty) : RowList(empty) {}

  Row& addEquality(const Vec3& L, const Vec3& A_a, const Vec3& A_b, Scalar C,
                   Scalar curvature = 0) {
    Row& row = add(C);
    row.L = L;
    row.A_a = A_a;
    row.A_b = A_b;
    row.curvature = curvature;
    return row;
  }
  /// An angular equality: J_a = -J_b.
  Row& addAngular(const Vec3& J_b, Scalar C, Scalar curvature = 0) {
    Row& row = addEquality(Vec3::Zero(), J_b, J_b, C, curvature);
    row.angular = true;
    return row;
  }

  /// The row of the joint's axis `index`, whose coordinate moves with sign * J. `limit`: whether the
  /// limit of the axis may act in this step (rows/limit_reach.h).
  Row& addAxis(int index, const Vec3& L, const Vec3& A_a, const Vec3& A_b, Scalar coordinate,
               const Axis& axis, bool limit, int sign = 1) {
    return setAxis(addEquality(L, A_a, A_b, coordinate), index, axis, limit, sign);
  }
  /// The same with J_a = -J_b.
  Row& addAngularAxis(int index, const Vec3& J_b, Scalar coordinate, const Axis& axis, bool limit,
                      int sign = 1) {
    return setAxis(addAngular(J_b, coordinate), index, axis, limit, sign);
  }

 private:
  Row& setAxis(Row& row, int index, const Axis& axis, bool limit, int sign) {
    m_axes[index].axis = &axis;
    m_axes[index].sign = static_cast<signed char>(sign);
    row.axis = static_cast<signed char>(index);
    row.limit = limit;
    row.target = 0;
    ++m_axis_rows;
    return row;
  }
  Row& add(Scalar position) {
    btAssert(m_size < m_capacity);
    Row& row = m_rows[m_size++];
    row.position = position;
    row.max_speed = infinity;
    row.axis = -1;
    row.group = 0;
    row.angular = row.limit = false;
    return row;
  }
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle

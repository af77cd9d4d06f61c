// Purpose: what a joint says of itself at a pose: a short list of rows, without a time step.
//   J = [-L, -A_a, L, A_b] (document, 2.2), world space; C its position error; J v = d/dt C.
#pragma once

#include <pintle/precision.h>
#include <pintle/rows/axis.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Each vector is followed by a zero, so that the solver's side (block.h) can take it as four lanes.
struct Row {
  Vec3 L;
  Scalar zero_L = 0;
  Vec3 A_a;
  Scalar zero_a = 0;
  Vec3 A_b;
  Scalar zero_b = 0;
  /// C of an equality, m or rad; the coordinate of an axis, m or rad.
  Scalar position;
  /// The most that a step may correct, m/s or rad/s.
  Scalar max_speed;
  /// d^2 C / dt^2 at constant v, w: what J v leaves out of the motion of C, m/s^2 or rad/s^2.
  Scalar curvature;
  /// The most that an equality may push or pull, N s or N m s.
  Scalar max_impulse;
  /// Null for an equality. Else the row is a free coordinate, and this is what acts along it.
  const Axis* axis;
  /// Whether the limit of the axis may act in this step.
  bool limit = false;
  /// Along which of the two directions of an axis Bullet counts its impulse positive (+1 or -1).
  Scalar sign = 1;
};

/// What the solver made of an equality: a row that other joints disturb after it was solved keeps a
/// velocity error, its residual (joint.cpp, feed_forward, says what for).
struct RowResidual {
  Scalar target = 0;      ///< of this step
  Scalar last = 0;        ///< the residual of the last step
  Scalar correction = 0;  ///< of the next target
};

/// Room for the rows of a joint, a member of its class.
template <int N>
struct RowMemory {
  Row rows[N];
  RowResidual residuals[N];
};

/// The rows of one joint. Equalities come first.
class Rows {
 public:
  template <int N>
  Rows(RowMemory<N>& memory) : m_rows(memory.rows), m_residuals(memory.residuals), m_capacity(N) {}

  int size() const { return m_size; }
  const Row& operator[](int i) const { return m_rows[i]; }
  RowResidual& residual(int i) { return m_residuals[i]; }
  void clear() { m_size = 0; }
  void forgetResiduals() {
    for (int i = 0; i < m_capacity; ++i) m_residuals[i] = {};
  }
  /// Bounds the impulse of each row so far.
  void clamp(Scalar max_impulse) {
    for (int i = 0; i < m_size; ++i) m_rows[i].max_impulse = max_impulse;
  }

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
  Row& addAngular(const Vec3& J_b, Scalar C) { return addEquality(Vec3::Zero(), J_b, J_b, C); }

  /// The row of a coordinate with J_b = d coordinate / d w_b = -J_a.
  Row& addAngularAxis(const Vec3& J_b, Scalar coordinate, const Axis& axis, bool limit,
                      Scalar sign) {
    Row& row = addAngular(J_b, coordinate);
    row.axis = &axis;
    row.limit = limit;
    row.sign = sign;
    return row;
  }

 private:
  Row& add(Scalar position) {
    btAssert(m_size < m_capacity);
    Row& row = m_rows[m_size++];
    row.position = position;
    row.max_speed = infinity;
    row.max_impulse = infinity;
    row.axis = nullptr;
    return row;
  }

  Row* m_rows;
  RowResidual* m_residuals;
  int m_size = 0;
  int m_capacity;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle

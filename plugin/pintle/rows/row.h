// Purpose: what a joint says of itself at a pose: a short list of rows, without a time step.
//   J = [-L, -A_a, L, A_b] (document, 2.2), world space; C its position error; J v = d/dt C.
#pragma once

#include <pintle/precision.h>
#include <pintle/rows/axis.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

struct Row {
  Vec3 L, A_a, A_b;
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
  /// Along which of the two directions of an axis Bullet counts its impulse positive (+1 or -1).
  Scalar sign;
};

/// What the solver made of an equality, and of the one before: a row that other joints disturb after it
/// was solved keeps a velocity error, its residual (Joint::target says what for).
struct RowResidual {
  Scalar target = 0;
  Scalar now = 0, last = 0;
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
  int capacity() const { return m_capacity; }
  const Row& operator[](int i) const { return m_rows[i]; }
  RowResidual& residual(int i) { return m_residuals[i]; }
  void clear() { m_size = 0; }

  Row& addEquality(const Vec3& L, const Vec3& A_a, const Vec3& A_b, Scalar C) {
    Row& row = add();
    row.L = L;
    row.A_a = A_a;
    row.A_b = A_b;
    row.position = C;
    row.curvature = 0;
    row.max_speed = infinity;
    row.max_impulse = infinity;
    row.axis = nullptr;
    return row;
  }
  /// An angular equality: J_a = -J_b.
  Row& addAngular(const Vec3& J_b, Scalar C) { return addEquality(Vec3::Zero(), J_b, J_b, C); }

  /// The row of a coordinate with J_b = d coordinate / d w_b = -J_a.
  Row& addAngularAxis(const Vec3& J_b, Scalar coordinate, const Axis& axis, Scalar sign) {
    Row& row = addAngular(J_b, coordinate);
    row.axis = &axis;
    row.sign = sign;
    return row;
  }

 private:
  Row& add() {
    btAssert(m_size < m_capacity);
    return m_rows[m_size++];
  }

  Row* m_rows;
  RowResidual* m_residuals;
  int m_size = 0;
  int m_capacity;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle

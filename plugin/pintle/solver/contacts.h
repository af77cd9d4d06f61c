// Purpose: contacts and friction on the bodies of an island, as rows of their own.
#pragma once

#include <pintle/solver/island.h>
#include <pintle/solver/span.h>

#include <BulletDynamics/ConstraintSolver/btSolverConstraint.h>

#include <algorithm>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// A row of Bullet's, or a part of a joint's with bounds: u = J v, u + softness p = target, lower <= p <= upper.
struct ContactRow {
  std::array<int, 2> body;  ///< of the island; below 0: one that does not move
  RowJacobian J;
  /// Of each body to an impulse of 1; where the joints of its component hold, with them.
  std::array<Vector6d, 2> answer = {Vector6d::Zero(), Vector6d::Zero()};
  double K_alone = 0, K = 0;  ///< of its velocity, without and with them
  double target, softness, lower, upper;
  int normal = -1;  ///< of friction: the row whose impulse bounds it; -1: its bounds are its own
  double friction = 0;                 ///< of friction: its coefficient
  double impulse;                      ///< N s
  double before = 0;                   ///< N s: before a pass
  btSolverConstraint* from = nullptr;  ///< null: it is of a joint

  bool isFriction() const { return normal >= 0; }
  /// Its impulse at which it is satisfied, where it has the velocity u now.
  double meet(double u) const {
    return std::min(std::max(impulse - (u + softness * impulse - target) / (K + softness), lower),
                    upper);
  }
  double velocity(const std::vector<Vector6d>& v) const {
    double u = 0;
    for (int side = 0; side < 2; ++side)
      if (body[size_t(side)] >= 0) u += J.along(side, v[size_t(body[size_t(side)])]);
    return u;
  }
  void push(double by, std::vector<Vector6d>& v) const {
    for (size_t side = 0; side < 2; ++side)
      if (body[side] >= 0) v[size_t(body[side])] += by * answer[side];
  }
  /// What the bodies bear of that, N s and N m s.
  void load(double by, std::vector<Vector6d>& impulses) const {
    for (size_t side = 0; side < 2; ++side)
      if (body[side] >= 0) {
        impulses[size_t(body[side])].head<3>() += by * J.L(int(side));
        impulses[size_t(body[side])].tail<3>() += by * J.A(int(side));
      }
  }
};
/// The bodies that such a row is on.
inline void touch(Span<const ContactRow> rows, std::vector<char>& touched) {
  for (const ContactRow& row : rows)
    for (const int body : row.body)
      if (body >= 0) touched[size_t(body)] = true;
}
/// Friction by its contact's impulse.
inline void boundFriction(Span<const ContactRow> rows, ContactRow& row) {
  if (!row.isFriction()) return;
  row.upper = row.friction * rows[size_t(row.normal)].impulse;
  row.lower = -row.upper;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

// Purpose: contacts and friction on the bodies of an island, as rows of their own: u + softness p = target while lower <= p <= upper. Those
// of a contact are 0 and none (Signorini), those of its friction are +-mu p of the contact (Coulomb).
#pragma once

#include <pintle/solver/linalg/memory.h>
#include <pintle/solver/model/island.h>

#include <BulletDynamics/ConstraintSolver/btSolverConstraint.h>

#include <algorithm>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// A row of Bullet's, or a part of a joint's with bounds: u = J v, u + softness p = target, lower <= p <= upper.
struct ContactRow {
  double target, softness, lower, upper;
  double recovery = 0;  ///< m/s: the part of its target that leads bodies out of each other
  double impulse;       ///< N s
  double K = 0;         ///< of its velocity
  // With K (ContactResponse::find):
  double aim = 0, compliance = 0;  ///< its target and its softness
  bool is_held = false;            ///< by equalities
  bool is_limit = false;  ///< of a joint: if it presses, it is a row of the factor in the end
  double before = 0;      ///< N s: that which `velocities` know of (ContactResponse)
  double friction = 0;    ///< of friction: its coefficient
  int normal = -1;     ///< of friction: the row whose impulse bounds it; -1: its bounds are its own
  unsigned parts = 0;  ///< of its response (ContactResponse): so many
  size_t first_part = 0;    ///< and where they begin
  std::array<int, 2> body;  ///< of the island; below 0: one that does not move
  RowJacobian J;
  /// Of each body to an impulse of 1, without joints.
  std::array<Vector6d, 2> answer = {Vector6d::Zero(), Vector6d::Zero()};
  btSolverConstraint* from = nullptr;  ///< null: it is of a joint

  bool isFriction() const { return normal >= 0; }
  /// Its impulse at which it is satisfied, where it has the velocity u now.
  double meet(double u) const {
    return std::min(std::max(impulse - (u + compliance * impulse - aim) / (K + compliance), lower),
                    upper);
  }
  /// For the next solve, with K of its bodies alone.
  void begin(double K_alone) {
    K = K_alone;
    aim = target;
    compliance = softness;
    is_held = false;
    parts = 0;
  }
  /// How many times its impulse it can have.
  double timesToBound() const {
    return impulse > 0 ? upper / impulse : impulse < 0 ? lower / impulse : infinity;
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
  /// What impulses since `before` do to `v`, without joints.
  void push(std::vector<Vector6d>& v) {
    if (impulse != before) push(impulse - before, v);
    before = impulse;
  }
};
/// Dual function D of impulses t lambda, from none to those of the warm start: D(t) - D(0) = slope t + curvature t^2 / 2.
struct DualFunction {
  double slope = 0, curvature = 0;

  /// A row.
  void add(double impulse, double target, double softness) {
    slope -= impulse * target;
    curvature += softness * impulse * impulse;
  }
  /// The best fraction of the warm start where all of it is worse than none, `most` where that is still too little, else all.
  double fraction(double most) const {
    if (slope + curvature / 2 > 0) return slope < 0 ? -slope / curvature : 0;
    return most > 1 && slope + most * curvature <= 0 ? most : 1;
  }
};

/// Friction by its contact's impulse.
inline void boundFriction(Span<const ContactRow> rows, ContactRow& row) {
  if (!row.isFriction()) return;
  row.upper = row.friction * rows[size_t(row.normal)].impulse;
  row.lower = -row.upper;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

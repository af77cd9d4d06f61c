// Purpose: what a joint says of itself at a pose: a short list of rows. It sees neither velocities nor a time step.
//   J = [-L, -A_a, L, A_b] (document, 2.2), world space; C its position error; J v = d/dt C.
#pragma once

#include <pintle/equations/velocity.h>
#include <pintle/rows/axis.h>
#include <pintle/rows/limit_reach.h>
#include <pintle/rows/row_list.h>
#include <pintle/rows/row_shape.h>
#include <pintle/rows/step_motion.h>
#include <pintle/vectors.h>

#include <type_traits>

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

/// Impulses of an equality's row, as Bullet counts them, N s or N m s.
struct RowHistory {
  Scalar impulse = 0;  ///< of the last step, in the end
  Scalar first = 0;    ///< of this step, after the first pass
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
constexpr int max_joint_rows = 9;

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

/// What a joint adds its rows to, for a step or for a pose alone. In a step it asks for the curvature of the motion, and for
/// the limits that the step may reach; without one for all limits, and curvatures are 0.
class Rows : public RowList {
 public:
  template <int N, int Axes>
  explicit Rows(RowMemory<N, Axes>& memory, const StepMotion* motion = nullptr,
                RowShape* shapes = nullptr)
      : RowList(memory.rows, memory.axes.data(), nullptr, {N, Axes}),
        m_motion(motion),
        m_shapes(shapes) {}
  Rows(const RowList& empty, const StepMotion& motion) : RowList(empty), m_motion(&motion) {}
  /// For a pose alone, in the memory of `empty`.
  Rows(const RowList& empty, RowShape* shapes)
      : RowList(empty), m_motion(nullptr), m_shapes(shapes) {}

  /// d^2 C / dt^2 at constant velocities, from what it is of them: function(v) with v.v_a(), v.w_a(), v.v_b(), v.w_b(), a
  /// Scalar or a Vec3.
  template <class Function>
  auto curvature(const Function& function) const {
    using Result = std::decay_t<decltype(function(m_motion->pair))>;
    if (m_motion != nullptr) return function(m_motion->pair);
    if constexpr (std::is_same_v<Result, Scalar>)
      return Scalar(0);
    else
      return Result(Result::Zero());
  }
  /// The same at the velocities to which the step's forces lead: function(v, dt, part), v an equations::Velocity, and `part`
  /// how much bodies that turn have of it (StepMotion::curved_part).
  template <class Function>
  Scalar endCurvature(const Function& function) const {
    if (m_motion == nullptr) return 0;
    const btRigidBody &a = m_motion->pair.a(), &b = m_motion->pair.b();
    const Scalar dt = m_motion->dt;
    const equations::Velocity<Scalar> v{freeLinear(a, dt), freeAngular(a, dt), freeLinear(b, dt),
                                        freeAngular(b, dt)};
    return function(v, dt, m_motion->curved_part);
  }
  /// How far the bodies may turn against each other, and how far a coordinate along J may move: farther limits need no row.
  AngularReach turn(bool a_may_stop = false) const { return AngularReach(m_motion, a_may_stop); }
  Reach slide(const equations::Jacobian<Scalar>& J, Scalar of_curvature) const {
    return linearReach(m_motion, J, of_curvature);
  }
  /// The same of a point at these levers that moves by `moved` (below) along the coordinate.
  Reach slide(Scalar moved, const Vec3& lever_a, const Vec3& lever_b, Scalar of_curvature) const {
    return linearReach(m_motion, moved, lever_a.dot(lever_a), lever_b.dot(lever_b), of_curvature);
  }
  /// How far something comes at the velocities of now, function(v) as of curvature.
  template <class Function>
  Vec3 moved(const Function& function) const {
    if (m_motion == nullptr) return Vec3::Zero();
    return m_motion->dt * function(m_motion->pair);
  }
  /// The same at this speed.
  Scalar advance(Scalar speed) const {
    return m_motion != nullptr ? m_motion->dt * speed : infinity;
  }
  /// s, of the step; 0: there is none.
  Scalar timeStep() const { return m_motion != nullptr ? m_motion->dt : Scalar(0); }
  /// Whether there is a step, and whether its velocities are those of the pose.
  bool inStep() const { return m_motion != nullptr; }
  bool inPlace() const { return m_motion != nullptr && m_motion->pair.inPlace(); }
  /// The part of a gap that is in the lever of body a (StepMotion::gapInLever).
  Scalar gapInLever(const Vec3& lever, const Vec3& gap) const {
    return m_motion != nullptr ? m_motion->gapInLever(lever, gap) : Scalar(0);
  }

  /// Says what C of the last row is made of. What is not said is RowShape::other, or RowShape::angle of an angular row.
  void shape(RowShape::Kind kind, const Vec3& a = Vec3::Zero(), const Vec3& b = Vec3::Zero(),
             Scalar length = 0) {
    if (m_shapes != nullptr) m_shapes[m_size - 1] = {kind, a, b, length};
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
  Row& addAngular(const Vec3& J_b, Scalar C, Scalar curvature = 0) {
    Row& row = addEquality(Vec3::Zero(), J_b, J_b, C, curvature);
    row.angular = true;
    shape(RowShape::angle, J_b, J_b);
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
    if (m_shapes != nullptr) m_shapes[m_size - 1] = {};
    return row;
  }

  const StepMotion* m_motion;
  RowShape* m_shapes = nullptr;  ///< null: nobody asks for them
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle

// Purpose: what Bullet's iterating solvers make of a joint's rows: it writes them as Bullet takes them, and acts between the passes over them.
#pragma once

#include <pintle/rows/axis_settings.h>
#include <pintle/rows/row_list.h>

#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>

#include <cstdint>
#include <limits>

struct btSolverConstraint;

namespace pintle {
inline namespace PINTLE_PRECISION {

class Block;
class BodyPair;
class Joint;
struct AxisMotion;
struct AxisRow;
struct BlockRow;

/// The rows of one joint on a solver of Bullet's. A part of the joint, which it knows.
class BulletRows {
 public:
  ///@{
  /// As Bullet asks a constraint.
  using Info1 = btTypedConstraint::btConstraintInfo1;
  using Info2 = btTypedConstraint::btConstraintInfo2;
  ///@}
  static constexpr int max_room = std::numeric_limits<signed char>::max();  ///< m_count

  /// The rows of this joint.
  explicit BulletRows(Joint& joint);

  /// Once a step, before all others.
  void beginStep();
  /// Nothing of the last step acts in this one: the joint is new to the world, or enabled again.
  void startAnew();
  ///@{
  /// getInfo1 and getInfo2 of a constraint. `room`: for so many rows.
  void announce(Info1& info, int room = max_room);
  void write(Info2& info);
  ///@}
  /// The same at other poses of the bodies, as Bullet's getInfo2NonVirtual has it. As many rows as were announced at the most: a limit
  /// that acts at these poses only has none. Velocities and inertias are the bodies' own.
  void writeAt(Info2& info, const btTransform& pose_a, const btTransform& pose_b);
  /// solveConstraintObsolete of a constraint, which comes after each pass over the rows of all joints, before that over the contacts.
  void afterPass(btSolverBody& a, btSolverBody& b);

  /// The impulse of one part of an axis in the last step, positive along the coordinate. Bullet hands
  /// out the last row's; those of other axes are read from the rows of its sequential solver, and are
  /// 0 with a solver that has none.
  Scalar axisImpulse(int axis, int part) const;

  ///@{
  /// True if the rows are those of addRows: none is made orthogonal to others, none predicts by how much its motion is curved, and what closes it
  /// grows with the rate of the steps, without a largest speed.
  bool arePlain() const { return m_are_plain; }
  void setPlain(bool plain) { m_are_plain = plain; }
  ///@}

  /// Another solver has solved them, one after the other.
  void setCount(int count) { m_count = static_cast<signed char>(count); }

 private:
  struct Step;

  Scalar curvedTime() const;
  void place(int room);
  void correct(const Step& step);
  void boundClosing(const Step& step, Scalar gap, Scalar other);
  bool isPutApart(const Step& step, Scalar last_gap, Scalar max_speed) const;
  void aim(const Step& step);
  void writePlain(Info2& info, const Step& step);
  void writeDelicate(Info2& info, const Step& step);
  void act(Row& row, const BlockRow* orthogonal, const Block* block, const Step& step,
           AxisRow (&parts)[Axis::parts]);
  void actBesideEqualities(Row& row, const Step& step, AxisRow (&parts)[Axis::parts]);
  bool solveSoft(Row& row, const BlockRow* orthogonal, const Block* block, const Step& step,
                 AxisMotion& motion, AxisRow (&parts)[Axis::parts]);

  void beginPasses(const Info2& info);
  void actBetweenPasses(btSolverBody& a, btSolverBody& b);
  void startWarm(btSolverBody& a, btSolverBody& b);
  const AxisState* onlyAxis() const;
  btSolverConstraint* onlyLimit() const;
  bool goesOn() const;
  void liftThresholds();
  void breakIfOverloaded(btSolverBody& a, btSolverBody& b);
  void rest(btSolverBody& a, btSolverBody& b, int done);
  bool isSettled(bool with_axes) const;
  void setPasses(int count);
  void solveRows(btSolverBody& a, btSolverBody& b);
  void seeAxis(const Row& row, const btSolverBody& a, const btSolverBody& b);
  void seeDisturbance(const Row& row, AxisState& axis, const btSolverBody& a,
                      const btSolverBody& b);

  Joint& m_joint;
  RowList& m_rows;                              ///< the joint's
  btSolverConstraint* m_solver_rows = nullptr;  ///< Bullet's of this step, while it is solved
  Scalar m_gap = -1;                ///< m, at the start of the last step; < 0: there was none
  Scalar m_start_left = 0;          ///< s: the joint starts apart, and may do so for so long
  Scalar m_last_dt = 0;             ///< s, of the last step
  Scalar m_last_limit_impulse = 0;  ///< of the only axis, in the last step
  Scalar m_last_load =
      0;  ///< N s or N m s, after the last pass over the rows of a joint that may break
  std::uint32_t m_velocities = 0;  ///< a hash of the bodies', while the joint rests
  /// Bullet's over the rows: all, and those until what the last one leaves is known.
  short m_passes = 0, m_passes_left = 0;
  signed char m_count = 0;  ///< of Bullet's rows: an axis may have one for each part
  bool m_are_plain : 1;
  bool m_remembers : 1;     ///< impulses of the last step, which others disturbed
  bool m_starts_warm : 1;   ///< this step, from them
  bool m_shows_passes : 1;  ///< Bullet's solver did so in the last step
  bool m_acts_in_each : 1;  ///< has something to do after each pass, not the last one alone
  bool m_rests : 1;         ///< its rows are left out of Bullet's passes
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle

// Purpose: the settings of a joint of six degrees of freedom, how they follow from one of Bullet's (six_dof_model.cpp), and its rows
// (document, 3.1.3 + 3.2.3, 3.2.4 and 3.2.9, and Euler angles; six_dof_rows.cpp).
#pragma once

#include <pintle/bullet/stock_bits.h>
#include <pintle/bullet/stock_six_dof.h>
#include <pintle/joints/driven_joint.h>
#include <pintle/joints/observed_joint.h>
#include <pintle/rows/unwrapped_angle.h>

#include <LinearMath/btTransform.h>

#include <memory>

namespace pintle {
inline namespace PINTLE_PRECISION {

class Complaints;
class EulerTurn;

/// Settings of a joint of six degrees of freedom.
struct SixDofSettings {
  btTransform frame_a;  ///< the joint frame in body a's frame (m)
  btTransform frame_b;  ///< the same in body b's
  Axis axes[6];         ///< along x, y, z of frame a (m), and the Euler angles of a against b (rad)
  int order[3];         ///< first, middle and last axis of these angles: of b, between, and of a
};

/// A 6-dof joint of Bullet's as Pintle holds it, of any of its classes. What stands in Bullet's object is read at the start of each
/// step; it says alone what the joint is. How the rotation is held depends on how many angles are locked:
/// - three: as in a fixed joint;
/// - two: as in a hinge, of which the angle counts its turns;
/// - one: as in a universal joint;
/// - none: limits are those of the Euler angles (joints/euler_turn.h).
class SixDofModel : public ObservedJoint<SixDofModel, DrivenJoint> {
 public:
  static constexpr RowCount row_count{6, 6};  ///< the most that it has

  ///@{
  /// Reads this constraint of Bullet's, which it is a part of, or which it stands for.
  SixDofModel(btGeneric6DofConstraint& joint, RowCount max_rows);
  SixDofModel(btGeneric6DofSpringConstraint& joint, RowCount max_rows);
  SixDofModel(btGeneric6DofSpring2Constraint& joint, RowCount max_rows);
  ///@}
  ~SixDofModel() override;

  const char* name() const override;
  /// The rows are solved as a block: setUseFrameOffset of the class that has it, which stands for the same.
  void setBlockRows(bool block) override;
  bool getBlockRows() const override;
  /// The frames, the box that the origin of b may go to, and the range of each angle that has one.
  void drawJoint(btIDebugDraw& drawer) const override;

 protected:
  ///@{
  static int rowsOfStock(btGeneric6DofConstraint& joint) { return countedRows(joint); }
  static int rowsOfStock(btGeneric6DofSpring2Constraint& joint) { return countedRows(joint); }
  ///@}
  void hideLimits();
  const ErpCfm* groups() const override { return m_erp_cfm; }
  DriveRoom driveRoom() const override { return {{9, axis_count + 3}, axis_count}; }

  ///@{
  /// Throw std::invalid_argument for an axis that is none of 0 to 5, or none of 3 to 5.
  int anyAxis(int axis) const;
  int angleAxis(int axis) const;
  ///@}
  /// rad: the Euler angle about axis 3 to 5, with all turns since it was last locked or freed.
  Scalar accumulatedAngle(int axis);
  /// Impulse of the last step along axis 0 to 5 (N s or N m s), positive along the coordinate.
  Scalar springImpulse(int axis) const {
    return axisImpulse(axis, Axis::spring_pull) + axisImpulse(axis, Axis::spring_yield);
  }

 private:
  friend ObservedJoint;
  static constexpr int first_angle = 3, axis_count = 6;  ///< of axes
  enum class Turning : unsigned char { locked, hinge, universal, box };

  struct Observation;
  Observation observe(const PosePair& poses) const;
  void remember(Observation& seen, bool in_step);
  void constrain(const Observation& seen, Rows& rows) const;
  void addTurnLocks(const Observation& seen, Rows& rows) const;
  void addLock(const Observation& seen, Rows& rows) const;
  void addUniversalRow(const Observation& seen, Rows& rows) const;
  void addAngles(const Observation& seen, Scalar driven, Rows& rows) const;
  void addPositionLocks(const Observation& seen, Rows& rows) const;
  void addPositions(const Observation& seen, Rows& rows) const;
  void prepareAxes(const Observation& seen);

  void begin();
  void read(Complaints* complaints) override;
  void readFrames(Complaints* complaints);
  bool readBits();
  void readSettings(Complaints* complaints);
  void takeAxis(int i, const StockAxis& from, Complaints* complaints);
  void settingsChanged(const StockSixDof& before);
  void setTurning();
  void setLockedFrames();
  void setParameters();
  /// Sets limit, motor and rest of an axis, of which one unit is `scale` of Bullet's.
  void setAxis(int i, Scalar scale);
  /// By its own unit vector in Bullet's way, which is shorter by `cosine` than the gradient of the angle, a spring pulls so much less.
  void setSpring(int i, Scalar stiffness, Scalar damping, Scalar cosine);
  bool isOuterAngle(int axis) const;
  int middleAngle() const;
  /// The angles of the pose that the bodies are in, in the turns of `last` (rad, by axis) or of their limits.
  void resetAngles(const Scalar (&last)[3]);
  void turnTowardsLimit(int angle);
  Scalar angleOf(int index) const;
  bool isLocked(int axis) const { return (m_locked >> axis & 1) != 0; }
  bool acts(int axis) const { return (m_acting >> axis & 1) != 0; }
  unsigned char group(int axis) const {
    return m_erp_cfm_differs ? static_cast<unsigned char>(axis) : 0;
  }

  btGeneric6DofConstraint* m_first = nullptr;  ///< Bullet's object is of this class,
  btGeneric6DofSpringConstraint* m_springs = nullptr;
  btGeneric6DofSpring2Constraint* m_second = nullptr;  ///< or of this one

  SixDofSettings m_settings;
  StockBits m_bits;
  StockSixDof m_read;  ///< the last good settings of Bullet's object
  AxisParameters m_parameters[6];
  ErpCfm m_erp_cfm[max_groups];
  // How they are held.
  unsigned char m_locked = 0, m_acting = 0;  ///< a bit an axis; acting: limited or driven
  Turning m_turning = Turning::box;
  bool m_is_shifted = false, m_is_turned = false;  ///< locked at values that are not 0
  bool m_has_changing_axes = false;                ///< what acts depends on the pose
  signed char m_hinge = 0;                         ///< the free axis of a hinge
  signed char m_of_a = 0, m_of_b = 0;  ///< of a universal joint: its axes, fixed in a and in b
  Scalar m_scale = 1;                  ///< of the outer angles of the box, in this step
  Scalar m_bend = 0;                   ///< rad: by which these two are locked off their right angle
  btVector3 m_shift = {0, 0, 0};       ///< m, along the axes of frame a
  btMatrix3x3 m_turn_a,
      m_turn_b;  ///< of the frames in themselves, to those that the rotation is held by
  UnwrappedAngle m_turns[3];           ///< of b against a about x, y, z; not of the box,
  std::unique_ptr<EulerTurn> m_euler;  ///< which has these
};

extern template class ObservedJoint<SixDofModel, DrivenJoint>;

}  // namespace PINTLE_PRECISION
}  // namespace pintle

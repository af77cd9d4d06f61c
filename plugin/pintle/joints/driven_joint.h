// Purpose: the base of the joints whose free rotation a pose drive can turn.
#pragma once

#include <pintle/joints/joint.h>
#include <pintle/joints/pose_drive.h>

#include <LinearMath/btQuaternion.h>

#include <memory>

namespace pintle {
inline namespace PINTLE_PRECISION {

class Frame;
class PoseDriveRows;

/// A joint about which b may turn against a, and may be driven to a pose. Without a drive it has no memory for one.
class DrivenJoint : public Joint {
 public:
  ~DrivenJoint() override;

  /// Turns b against a to `target`, the rotation of b's joint frame in a's (R_a^T R_b; of any length but 0), from the next step on, until
  /// clearPoseDrive. Call it in each step with another target, if you like: that takes no memory but for the first time. What the joint
  /// locks stays locked: there the drive does nothing. Limits are obeyed. Sleeping bodies are not woken, as by Bullet's motors.
  ///
  /// The length of the torque is never above max_torque. Below it the drive is the spring and damper that PoseDrive says, as long as the
  /// torque does not change in one step by more than half of what is left to the bound; at the bound it points to where that of the
  /// joint alone would.
  ///
  /// Throws std::invalid_argument for a target that is not finite or has no length, a frequency that is not above 0, a negative number,
  /// or one that is none, and then changes nothing.
  void setPoseDrive(const btQuaternion& target, const PoseDrive& settings);
  /// Turns it off.
  void clearPoseDrive();
  /// True after setPoseDrive.
  bool hasPoseDrive() const { return m_pose_drive && isDriveOn(); }
  ///@{
  /// The last settings of setPoseDrive, the target made unit. Without a drive the identity, and a drive of nothing.
  btQuaternion getPoseTarget() const;
  PoseDrive getPoseDrive() const;
  ///@}
  /// N m s: the impulse of the drive's torque in the last step, on b, in the world. Its length is at most max_torque times the step.
  btVector3 getPoseDriveImpulse() const;

 protected:
  DrivenJoint(btTypedConstraint& constraint, RowCount max_rows);

  /// Rows and axes of the joint with a drive, and the first of the drive's three axes.
  struct DriveRoom {
    RowCount count;
    int first_axis;
  };
  virtual DriveRoom driveRoom() const = 0;
  /// At the start of a step, before its rows are added.
  void beginPoseDrive() {
    if (m_pose_drive) beginDrive();
  }
  /// Adds the rows of the drive, if there is one, after those of the equalities. `friction`: N m, about each of its axes. Returns how far
  /// (rad) it turns the bodies in this step at most.
  Scalar addPoseDrive(const Frame& a, const Frame& b, Rows& rows, Scalar friction = 0) const;

 private:
  // Called with a drive only.
  bool isDriveOn() const;
  void beginDrive();

  std::unique_ptr<PoseDriveRows> m_pose_drive;  ///< made when one is first set
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle

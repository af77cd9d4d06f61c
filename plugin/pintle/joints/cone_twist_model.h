// Purpose: the settings of a cone-twist joint, how they follow from one of Bullet's (cone_twist_model.cpp), and its rows (document, 3.1.3 +
// 3.2.6, and the swing and twist of A.3.7; cone_twist_rows.cpp).
#pragma once

#include <pintle/bullet/stock_cone_twist.h>
#include <pintle/joints/driven_joint.h>
#include <pintle/joints/observed_joint.h>
#include <pintle/rows/far_limit.h>

#include <BulletDynamics/ConstraintSolver/btConeTwistConstraint.h>
#include <LinearMath/btQuaternion.h>
#include <LinearMath/btTransform.h>

#include <memory>

namespace pintle {
namespace equations {
template <class T>
struct SwingSpans;
template <class T>
struct Swing;
template <class T>
struct AngularRow;
}  // namespace equations

inline namespace PINTLE_PRECISION {

class Complaints;

/// From low to high, rad; low > high: free.
struct AngleRange {
  Scalar low;   ///< the smaller angle
  Scalar high;  ///< the larger one

  /// As Bullet's span, which holds nothing more: the larger side; below 0 if it is free by low > high.
  Scalar span() const { return low <= high ? btMax(high, -low) : btMin(high, -low); }
};

/// Settings of a cone-twist joint.
struct ConeTwistSettings {
  btTransform frame_a;  ///< the joint frame in body a's frame (m), x the twist axis
  btTransform frame_b;  ///< the same in body b's
  ///@{
  /// As set.
  AngleRange swing_1, swing_2, twist;
  ///@}
  Axis swing_limit;           ///< its coordinate is the distance out of the cone, or the one swing
  Axis twist_limit;           ///< of a against b
  bool angular_only = false;  ///< no position rows
};

/// Readings of a cone-twist joint.
struct ConeTwistReadings {
  Scalar twist;  ///< rad, its size; 0 if it is free by a span below 0
  ///@{
  /// Limits that are passed.
  bool past_swing, past_twist;
  ///@}
};

/// A cone-twist joint of Bullet's as Pintle holds it. What stands in Bullet's object is read at the start of each step; what Bullet
/// does not have (spans that differ on both sides, springs, a motor of a velocity, friction) is kept here.
class ConeTwistModel : public ObservedJoint<ConeTwistModel, DrivenJoint> {
 public:
  /// The numbers of its axes.
  enum AxisIndex {
    swing_axis,
    twist_axis,
    limits,
    rotation_axis = limits,
    axis_count = limits + 3
  };
  /// The most that it has without motor and friction.
  static constexpr RowCount row_count{6, limits};
  /// The same with them, or with a pose drive.
  static constexpr RowCount driven_row_count{8, axis_count};

  /// Reads this constraint of Bullet's, which it is a part of, or which it stands for.
  ConeTwistModel(btConeTwistConstraint& cone, RowCount max_rows);
  ~ConeTwistModel() override;

  const char* name() const override;
  /// The frames, the cone, and the range of the twist about x of b: as in Bullet with no softness, and about x
  /// of a where b does not move.
  void drawJoint(btIDebugDraw& drawer) const override;

 protected:
  static int rowsOfStock(const btConeTwistConstraint& cone) { return countedRows(cone); }
  void hideLimits() { hideBroken(cone()); }
  DriveRoom driveRoom() const override { return {driven_row_count, rotation_axis}; }

 private:
  friend ObservedJoint;
  friend class ConeTwistJoint;
  enum class Swings : unsigned char { cone, only_1, only_2, locked };

  struct Observation;
  struct Locks;
  struct Turning;
  // Needed by motor and friction alone, which act about three axes.
  struct Rotation {
    Axis axis;
    btVector3 velocity = {0, 0, 0};
    btQuaternion target = btQuaternion::getIdentity();  ///< the last good one of Bullet's object
    btQuaternion reachable_target = btQuaternion::getIdentity();  ///< where the limits really are
  };

  Observation observe(const PosePair& poses) const;
  void remember(const Observation& seen, bool in_step);
  void constrain(const Observation& seen, Rows& rows) const;
  Locks addLocks(const Observation& at, Rows& rows) const;
  void addPivotRows(const Observation& at, Rows& rows) const;
  Scalar addDrive(const Observation& at, const Locks& locks, Rows& rows) const;
  Scalar addRotation(const Observation& at, const Locks& locks, Rows& rows) const;
  equations::AngularRow<Scalar> coneRow(const Observation& at,
                                        const equations::Swing<Scalar>& swing) const;
  void addConeLimit(const Observation& at, const Turning& turning, Rows& rows) const;
  void addNearConeLimit(const Observation& at, const Turning& turning, Rows& rows) const;
  void addOneSwingLimit(const Observation& at, const Turning& turning, Rows& rows) const;
  void addTwistLimit(const Observation& at, const Turning& turning, Rows& rows) const;
  void addNearTwistLimit(const Observation& at, const Turning& turning, Rows& rows) const;

  /// Leaves in Bullet's object what a step of its own would.
  void show(const Observation& at) const;
  ConeTwistReadings look(const PosePair& poses) const;
  bool isPastSwingLimit(const Observation& at) const;
  bool isPastTwistLimit(Scalar twist) const;
  /// rad: the twist, and the component of the swing about an axis of frame b.
  Scalar twistNow() const;
  Scalar swingNow(int axis) const;
  btVector3 pointForAngle(Scalar angle, Scalar length) const;
  btVector3 rotationImpulse(Axis::Part part) const;

  btConeTwistConstraint& cone() const {
    return static_cast<btConeTwistConstraint&>(const_cast<ConeTwistModel*>(this)->constraint());
  }
  void read(Complaints* complaints) override;
  void readLimits(const StockConeLimits& from, Complaints* complaints);
  void readParameters(Complaints* complaints);
  void readMotor(Complaints* complaints);
  void readTarget(Complaints* complaints);
  Rotation& rotation();
  void setTarget(const btQuaternion& q);
  void setVelocity(const btVector3& velocity);
  /// Ranges that Bullet's object shows as spans.
  void keepSwings(const AngleRange& swing_1, const AngleRange& swing_2);
  void keepTwist(const AngleRange& twist);
  /// Spans that were written, though they may be those that stood there: the ranges are these.
  void spansWritten(int first, int last);
  void limitsChanged();
  equations::SwingSpans<Scalar> spans(Scalar softness) const;
  Scalar innerSpan() const;
  Scalar swingRadius(Scalar about_1, Scalar about_2, Scalar softness) const;
  btQuaternion limited(const btQuaternion& q, Scalar softness) const;
  /// The angle (rad, in [-pi, pi]) in the turn in which it is in the range, or nearest to it. A range
  /// lies within two turns either way.
  static Scalar inTurnOf(const Axis& range, Scalar angle) {
    const Scalar from_middle = angle - (range.low + range.high) / 2;
    if (from_middle > SIMD_PI) return angle - SIMD_2_PI;
    if (from_middle < -SIMD_PI) return angle + SIMD_2_PI;
    return angle;
  }

  ConeTwistSettings m_settings;
  StockConeLimits m_read;                         ///< the last good ones of Bullet's object
  ConeTwistReadings m_readings{0, false, false};  ///< as calcAngleInfo2 was told of the bodies
  bool m_seen = false;                            ///< since the last step
  bool m_circular = true;
  Swings m_swings = Swings::cone;
  std::unique_ptr<Rotation> m_rotation;  ///< made when motor or friction is first set
  CosineLimit m_cone_look;               ///< the smallest span of the cone
  DirectionLimit m_twist_look;           ///< the range of the twist
};

extern template class ObservedJoint<ConeTwistModel, DrivenJoint>;

}  // namespace PINTLE_PRECISION
}  // namespace pintle

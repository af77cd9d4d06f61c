// Purpose: the ball joint with limits of swing and twist (document, 3.1.3 + 3.2.6, and the swing and
// twist of A.3.7), in the place of btConeTwistConstraint.
#pragma once

#include <pintle/joints/frame_joint.h>
#include <pintle/rows/far_limit.h>

#include <LinearMath/btQuaternion.h>

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

/// A point of each body coincide, as in a shoulder. The rotation of a against b, from joint frame to
/// joint frame, is a twist about x followed by a swing about an axis normal to x. The swing stays in
/// a cone that is fixed in body b, the twist in a range.
///
/// Swing 1 is the component of the swing's rotation vector about the frame's z, swing 2 that about y
/// (rad). The cone is an ellipse of both: (swing 1 / span 1)^2 + (swing 2 / span 2)^2 <= 1. A swing
/// whose span is below the fix threshold (default 0.05 rad) is locked. With one swing locked the
/// other is the angle about y (z) of body a between the two x axes, as Bullet has it; with both
/// locked the joint turns about x only.
///
/// Everything that btConeTwistConstraint has, under the same name, with the same signs and defaults.
///
/// \image html cone_twist_joint.svg
class ConeTwistJoint : public FrameJoint {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();

  // --- btConeTwistConstraint ---------------------------------------------------------------------
  /// Joint frames in the bodies' frames, x the twist axis.
  ConeTwistJoint(btRigidBody& rbA, btRigidBody& rbB, const btTransform& rbAFrame,
                 const btTransform& rbBFrame);
  /// To the world, as Bullet has it: the world's frame has the axes of `rbAFrame` as they stand, and
  /// lies at the world's origin. (setFrames puts it elsewhere.)
  ConeTwistJoint(btRigidBody& rbA, const btTransform& rbAFrame);
  ~ConeTwistJoint() override;

  ///@{
  /// The joint frames in the bodies' frames, x the twist axis.
  const btTransform& getAFrame() const { return m_frame_a; }
  const btTransform& getBFrame() const { return m_frame_b; }
  ///@}

  /// Spans either side (rad). A swing span below the fix threshold locks, two of pi or more are free;
  /// a twist span of 0 locks, of less frees, as does one of pi or more. `softness` (>= 0) times a span
  /// is where the limit is. A step takes away biasFactor / relaxationFactor^2 of what is beyond it
  /// (at most all); a relaxation factor of 0 turns both limits off. (All as Bullet has it.)
  void setLimit(btScalar swingSpan1, btScalar swingSpan2, btScalar twistSpan,
                btScalar softness = 1.f, btScalar biasFactor = 0.3f,
                btScalar relaxationFactor = 1.0f);
  ///@{
  /// One of the spans: 3 is twist, 4 swing 2, 5 swing 1.
  void setLimit(int limitIndex, btScalar limitValue);
  btScalar getLimit(int limitIndex) const;
  ///@}

  ///@{
  /// The larger side, if set by setSwingLimits or setTwistLimit.
  btScalar getSwingSpan1() const { return btMax(m_max_1, -m_min_1); }
  btScalar getSwingSpan2() const { return btMax(m_max_2, -m_min_2); }
  btScalar getTwistSpan() const { return btMax(m_twist_high, -m_twist_low); }
  ///@}

  ///@{
  /// What setLimit set.
  btScalar getLimitSoftness() const { return m_softness; }
  btScalar getBiasFactor() const { return m_limit_erp.orElse(0); }
  btScalar getRelaxationFactor() const { return m_relaxation; }
  ///@}

  ///@{
  /// rad; a swing whose span is below it is locked. Default 0.05.
  btScalar getFixThresh() { return m_fix_threshold; }
  void setFixThresh(btScalar fixThresh);
  ///@}

  /// The next five say what holds now,
  void calcAngleInfo() { m_seen = false; }
  /// or at these poses of the bodies (world), until the next step or new frames. The inertias are not
  /// needed here.
  void calcAngleInfo2(const btTransform& transA, const btTransform& transB,
                      const btMatrix3x3& invInertiaWorldA, const btMatrix3x3& invInertiaWorldB);
  /// The size of the twist (rad, >= 0) now; as in Bullet 0 if it is free by a span below 0.
  btScalar getTwistAngle() const;
  /// As in Bullet always 0.
  btScalar getTwistLimitSign() { return 0; }
  ///@{
  /// Whether the twist, the swing is beyond its limit now. As in Bullet a locked swing always is.
  int getSolveTwistLimit() { return m_seen ? m_seen_past_twist : isPastTwistLimit(getTwist()); }
  int getSolveSwingLimit() { return isPastSwingLimit(); }
  bool isPastSwingLimit();
  ///@}

  ///@{
  /// Kept, and as in Bullet without effect.
  void setDamping(btScalar damping) { m_damping = notNegative("damping", damping); }
  btScalar getDamping() const { return m_damping; }
  ///@}

  /// The motor turns a against b to its target: each step goes biasFactor of the way, and may apply
  /// up to the maximal impulse (N m s; below 0: any) along it, and as much against what turns the
  /// bodies out of the way. Normalized: the impulse that changes the spin of a alone by so much
  /// (rad/s). Unlike Bullet's it brakes, keeps to the limits, and normalizes.
  void enableMotor(bool b);
  /// What enableMotor set.
  bool isMotorEnabled() const;
  /// N m s a step; below 0: any.
  void setMaxMotorImpulse(btScalar maxMotorImpulse) { setMotorBound(maxMotorImpulse, false); }
  /// rad/s of body a alone, a step; below 0: any.
  void setMaxMotorImpulseNormalized(btScalar maxMotorImpulse) {
    setMotorBound(maxMotorImpulse, true);
  }
  /// As the last of the two set it.
  btScalar getMaxMotorImpulse() const;
  /// Which of the two was the last.
  bool isMaxMotorImpulseNormalized() const;
  /// q: the rotation of body a against body b (of any length but 0). What is beyond the limits is
  /// cut off.
  void setMotorTarget(const btQuaternion& q);
  /// The same, of the joint frames.
  void setMotorTargetInConstraintSpace(const btQuaternion& q);
  /// Of the joint frames: the rotation of a against b.
  const btQuaternion& getMotorTarget() const;

  /// A point of the cone's edge in the frame of b, `length` (m) from the pivot: where x of a would be
  /// after the largest swing about (0, cos(angle), -sin(angle)).
  btVector3 GetPointForAngle(btScalar angleInRadians, btScalar length) const;

  /// As in Bullet, axis 0 to 2 is the position, every other one limits and motor: ERP (or STOP_ERP) is
  /// that of the position, or the bias factor; CFM (or STOP_CFM). All >= 0. Other parameters are
  /// ignored, and read as 0, as do axes beyond 0 to 5, -1 too. NaN and infinity are refused for all.
  void setParam(int num, btScalar value, int axis = -1) override;
  /// What setParam set.
  btScalar getParam(int num, int axis = -1) const override;
  /// BT_CONETWIST_FLAGS_* of the parameters that were set.
  int getFlags() const;
  /// The rows at other poses of the bodies; no more than getInfo1 announced. The inertias are the
  /// bodies' own, whatever is given.
  void getInfo2NonVirtual(btConstraintInfo2* info, const btTransform& transA,
                          const btTransform& transB, const btMatrix3x3& invInertiaWorldA,
                          const btMatrix3x3& invInertiaWorldB);

  // --- beyond Bullet -----------------------------------------------------------------------------
  /// Spans that differ on both sides: min <= 0 <= max (rad) for each swing, the cone's edge made of
  /// four quarters of ellipses. A side is at least 1e-4 rad wide.
  void setSwingLimits(btScalar min_1, btScalar max_1, btScalar min_2, btScalar max_2);
  /// low <= twist <= high (rad), both within 2 pi of 0; equal ones lock. low > high, or a range of a
  /// turn or more: free. A twist outside is brought to the nearer end.
  void setTwistLimit(btScalar low, btScalar high);
  ///@{
  /// Makes a limit a spring and damper (document, 2.4): frequency (Hz) and damping ratio (>= 0) of
  /// the joint as its bodies alone make it swing. Frequency 0: a hard limit again.
  void setSwingLimitSpring(btScalar frequency_hz, btScalar damping_ratio);
  void setTwistLimitSpring(btScalar frequency_hz, btScalar damping_ratio);
  ///@}

  /// Makes the motor turn a against b at `velocity` (rad/s, along the axes of frame b), as far as the
  /// limits let it and until a target is set, with the same bound.
  void setMotorVelocity(const btVector3& velocity);
  /// Dry friction of at most max_torque (N m, >= 0 or infinite) about each of the axes of frame b.
  void setFriction(btScalar max_torque);

  ///@{
  /// rad, of a against b now: the components of the swing about z and y of frame b, and the twist in
  /// (-pi, pi].
  btScalar getSwing1() const;
  btScalar getSwing2() const;
  btScalar getTwist() const;
  ///@}

  ///@{
  /// Impulses of the last step (N m s): of the limits outwards (swing), along the twist; and of motor
  /// and friction on body a, in the world.
  btScalar getSwingLimitImpulse() const { return axisImpulse(swing_axis, Axis::limit); }
  btScalar getTwistLimitImpulse() const { return axisImpulse(twist_axis, Axis::limit); }
  btVector3 getMotorImpulse() const { return rotationImpulse(Axis::motor); }
  btVector3 getFrictionImpulse() const { return rotationImpulse(Axis::friction); }
  ///@}

  /// The frames, the cone, and the range of the twist about x of b: as in Bullet with no softness, and about x
  /// of a where b does not move.
  void drawJoint(btIDebugDraw& drawer) const override;
  const char* name() const override { return "ConeTwistJoint"; }
  void addRows(const PosePair& poses, Rows& rows) const override;

 protected:
  void updateState(const PosePair&) override { m_seen = false; }
  void framesChanged() override { m_seen = false; }

 private:
  enum AxisIndex {
    swing_axis,
    twist_axis,
    limits,
    rotation_axis = limits,
    axis_count = limits + 3
  };
  enum class Swings : unsigned char { cone, only_1, only_2, locked };
  struct At;

  struct Locks;
  struct Turning;
  struct Rotation;

  Axis& rotation();
  void setUp(const btTransform& frame_a, const btTransform& frame_b);
  Scalar span(const char* field, Scalar value) const;
  void setMotorBound(Scalar max_impulse, bool normalized);
  void limitsChanged();
  equations::SwingSpans<Scalar> spans(Scalar softness) const;
  Scalar innerSpan() const;
  Scalar swingRadius(Scalar about_1, Scalar about_2, Scalar softness) const;
  btQuaternion limited(const btQuaternion& q, Scalar softness) const;
  At at(const PosePair& poses) const;
  bool isPastTwistLimit(Scalar twist) const;
  bool isPastSwingLimit(const PosePair& poses) const;
  Scalar twistAt(const PosePair& poses) const;
  btVector3 rotationImpulse(Axis::Part part) const;

  Locks addLocks(const At& at, Rows& rows) const;
  Scalar addRotation(const At& at, const Locks& locks, Rows& rows) const;
  equations::AngularRow<Scalar> coneRow(const At& at, const equations::Swing<Scalar>& swing) const;
  void addConeLimit(const At& at, const Turning& turning, Rows& rows) const;
  void addNearConeLimit(const At& at, const Turning& turning, Rows& rows) const;
  void addOneSwingLimit(const At& at, const Turning& turning, Rows& rows) const;
  void addTwistLimit(const At& at, const Turning& turning, Rows& rows) const;
  void addNearTwistLimit(const At& at, const Turning& turning, Rows& rows) const;

  Swings m_swings = Swings::cone;
  bool m_circular = true;
  bool m_seen : 1, m_seen_past_twist : 1, m_seen_past_swing : 1;  ///< by calcAngleInfo2
  Scalar m_fix_threshold = Scalar(0.05f);
  Scalar m_seen_twist = 0;
  Rotation* m_rotation = nullptr;  ///< of motor and friction; made when one of them is first set
  Axis m_swing;  ///< the limit; its coordinate is the distance out of the cone, or the one swing
  Axis m_twist;  ///< the limit, of a against b
  // As set.
  Scalar m_min_1 = -BT_LARGE_FLOAT, m_max_1 = BT_LARGE_FLOAT;
  Scalar m_min_2 = -BT_LARGE_FLOAT, m_max_2 = BT_LARGE_FLOAT;
  Scalar m_twist_low = -BT_LARGE_FLOAT, m_twist_high = BT_LARGE_FLOAT;
  Scalar m_softness = 1, m_relaxation = 1;
  Scalar m_damping = Scalar(0.01);
  CosineLimit m_cone_look;      ///< the smallest span of the cone
  DirectionLimit m_twist_look;  ///< the range of the twist
  static constexpr RowCount row_count{6, limits};
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle

// Purpose: the base of all joints. A joint is a list of rows at a pose (addRows); this turns it
// into what Bullet's solver asks for, step by step. It is no constraint of Bullet's: joint_of.h makes one of it.
#pragma once

#include <pintle/joints/bullet_rows.h>
#include <pintle/rows/axis_settings.h>
#include <pintle/rows/row_list.h>

#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <string>

class btIDebugDraw;

namespace pintle {
inline namespace PINTLE_PRECISION {

class BodyPair;
struct JointAccess;
class PosePair;
class Rows;
class Complaints;
struct AxisMotion;
struct StepMotion;

/// Which form of its equations a joint solves.
enum class Formulation : unsigned char {
  document,    ///< the document's, with its misprints corrected
  conditioned  ///< the same constraint, well conditioned at every error; the default
};

/// As Bullet has it (btConstraintSetting).
struct ImpulseSetting {
  Scalar damping = 1;             ///< the part of the velocity that the rows take away
  Scalar max_impulse = infinity;  ///< N s, of each equality; with a bound they are not mixed
};

/// The rows of a constraint of Bullet's, and what Pintle adds to every one of its joints. Joints are added to a world,
/// enabled, broken and read as any Bullet constraint is: each class derives from Bullet's own or, without a counterpart there,
/// from btTypedConstraint. Settings of Pintle's throw std::invalid_argument, naming joint, field and value, and
/// then change nothing; a step never throws, allocates or locks. An object belongs to one world;
/// different objects may be used from different threads.
class Joint {
 public:
  virtual ~Joint();
  Joint(const Joint&) = delete;
  Joint& operator=(const Joint&) = delete;

  ///@{
  /// The constraint of Bullet's that this is a part of.
  btTypedConstraint& constraint() { return m_constraint; }
  const btTypedConstraint& constraint() const { return m_constraint; }
  ///@}

  /// The type's name, as errors say it.
  virtual const char* name() const = 0;

  /// Appends the rows of the joint at these poses. Does not change the joint, and depends on nothing but the poses, the
  /// joint's settings and its count of turns: call it at any pose.
  virtual void addRows(const PosePair& poses, Rows& rows) const = 0;

  /// Takes over what stands in the constraint of Bullet's, which a client may have written by any pointer. A step does so by itself;
  /// addRows sees what was read last.
  void readFromBullet() { read(nullptr); }
  /// Which of the settings that stand there are not used, and why: a number that is not finite, of which the last good one stays.
  /// Empty: all are.
  std::string whyIgnored();

  /// Whether the rows of the joint are solved as a block (rows/block.h), so that one pass of
  /// Bullet's solver solves the joint by itself, and with the residual of the last step in view.
  /// Default on. A breaking threshold is compared with the load after the last pass: the components of
  /// the force at the pivot, N s, and the moment about it, N m s. (Of plain rows Bullet compares each
  /// impulse, as it does where its solver does not show its passes.)
  virtual void setBlockRows(bool block) { m_block_rows = block; }
  /// What setBlockRows set.
  virtual bool getBlockRows() const { return m_block_rows; }

  /// Default conditioned.
  void setFormulation(Formulation formulation) { m_formulation = formulation; }
  /// What setFormulation set.
  Formulation getFormulation() const { return m_formulation; }

  /// The angular speed (rad/s, > 0) at which a step may at most take away an error of orientation,
  /// or that of a broken limit. Default 8: a joint that starts far off neither explodes nor
  /// lingers.
  void setMaxCorrectionSpeed(btScalar speed);
  /// rad/s.
  btScalar getMaxCorrectionSpeed() const { return m_max_correction_speed; }

  /// The speed (m/s, > 0) at which the pivots of a joint that starts apart are brought together: one that is new or
  /// enabled again, or of which a body has been put elsewhere. Default 1, and more where the
  /// gap would take more than a second. Gaps that a load opens, or that a second has not closed, are closed as ERP says, and on
  /// ExactJointSolver all are. It holds at any time while the boxes (AABB) of bodies that may collide with each other overlap: contacts do not yield.
  void setMaxLinearCorrectionSpeed(btScalar speed);
  /// m/s.
  btScalar getMaxLinearCorrectionSpeed() const { return m_max_linear_correction_speed; }

  /// Draws the joint as Bullet draws its own: frames, axes and limits, of the size getDbgDrawSize().
  virtual void drawJoint(btIDebugDraw& drawer) const = 0;

 protected:
  /// The most rows that it has. Memory for them is taken here, and kept as long as the joint.
  Joint(btTypedConstraint& constraint, RowCount max_rows);
  /// Another number, from the next step on. Those of the last one are forgotten.
  void setRowCount(RowCount max_rows);
  /// Those of the last step.
  const RowList& rows() const { return m_rows; }

  /// Does the work of readFromBullet, and tells the complaints, if any are given, of each value that is not used.
  virtual void read(Complaints*) {}
  /// Takes what the joint remembers of the poses (turns of an angle). Called once a step or more.
  virtual void updateState(const PosePair&) {}
  /// Both together, at the start of a step (observed_joint.h).
  virtual void prepare(const PosePair& poses, Rows& rows) {
    updateState(poses);
    addRows(poses, rows);
  }
  virtual ImpulseSetting impulseSetting() const { return {}; }
  /// max_groups, by Row::group, if m_erp_cfm_differs.
  virtual const ErpCfm* groups() const { return nullptr; }
  static constexpr int max_groups = 6;
  using Info1 = btTypedConstraint::btConstraintInfo1;
  using Info2 = btTypedConstraint::btConstraintInfo2;
  ///@{
  /// The calls of Bullet's solver to a constraint: buildJacobian, getInfo1, getInfo2 and, after each pass,
  /// solveConstraintObsolete.
  void buildJacobian();
  void announceRows(Info1& info, int room = max_room) { m_bullet_rows.announce(info, room); }
  void writeRows(Info2& info) { m_bullet_rows.write(info); }
  void afterPass(btSolverBody& a, btSolverBody& b) { m_bullet_rows.afterPass(a, b); }
  ///@}
  static constexpr int max_room = BulletRows::max_room;
  ///@{
  /// How many rows Bullet's own getInfo2 of a constraint would write, as its limits were last tested; and that none is broken.
  static int rowsOfStock(const btTypedConstraint&) { return max_room; }
  void hideLimits() {}
  ///@}
  /// writeRows at other poses of the bodies, as Bullet's getInfo2NonVirtual has it.
  void writeRowsAt(Info2& info, const btTransform& pose_a, const btTransform& pose_b) {
    m_bullet_rows.writeAt(info, pose_a, pose_b);
  }
  bool breakable() const { return m_constraint.getBreakingImpulseThreshold() < infinity; }
  btRigidBody& bodyA() const { return m_constraint.getRigidBodyA(); }
  btRigidBody& bodyB() const { return m_constraint.getRigidBodyB(); }

  /// The length of the last step; before the first one, Bullet's default.
  Scalar timeStep() const { return m_time_step; }
  /// rad/s, of the faster body, at the start of this step or of the last one, whichever is more.
  Scalar angularSpeed() const { return btMax(m_angular_speed, m_last_angular_speed); }
  /// The impulse of one part of an axis in the last step, positive along the coordinate (bullet_rows.h).
  Scalar axisImpulse(int axis, Axis::Part part) const {
    return m_bullet_rows.axisImpulse(axis, part);
  }

  Parameter m_erp, m_cfm;              ///< of equalities
  Parameter m_limit_erp, m_limit_cfm;  ///< of limits
  Parameter m_motor_cfm;
  /// Whether the equalities differ; else m_erp and m_cfm hold for all, and Row::group is 0.
  bool m_erp_cfm_differs : 1;
  /// Whether the curvature of its rows is that at the end of the step. Else it is that of now, and
  /// what the bodies' turning suggests is made of it.
  bool m_foresees_curvature : 1;
  /// Whether its bodies are shafts, which turn fast about axes that hold still.
  bool m_turns_shafts : 1;

  // Throw std::invalid_argument naming the joint, `field` and the value.
  [[noreturn]] void reject(const char* field, double value, const char* why) const;
  Scalar number(const char* field, Scalar value) const;  ///< finite or infinite
  Scalar finite(const char* field, Scalar value) const;
  Scalar notNegative(const char* field, Scalar value) const;  ///< finite and >= 0
  Scalar positive(const char* field, Scalar value) const;     ///< finite and > 0
  Scalar bound(const char* field, Scalar value) const;  ///< >= 0; infinite is Bullet's infinity
  const btVector3& point(const char* field, const btVector3& value) const;
  btVector3 direction(const char* field, const btVector3& value) const;  ///< made unit
  const btTransform& frame(const char* field, const btTransform& value) const;
  /// How errors name the value of a parameter of setParam.
  static const char* parameterName(int num);
  // What a setter of an axis does, checks included.
  void setAxisLimit(Axis& axis, Scalar low, Scalar high) const;
  /// The same of an angle: as in Bullet (-pi, pi) is free.
  void setAngleLimit(Axis& axis, Scalar low, Scalar high) const;
  void setAxisSpring(Axis& axis, Scalar frequency_hz, Scalar damping_ratio) const;
  void setAxisMotor(Axis& axis, bool on, Scalar velocity, Scalar max_impulse) const;
  /// The same, bounded by a force (N, or N m of an angle).
  void setAxisForceMotor(Axis& axis, bool on, Scalar velocity, Scalar max_force,
                         const char* force_field = "motor max torque") const;
  void setAxisServo(Axis& axis, Scalar target, Scalar frequency_hz, Scalar damping_ratio,
                    Scalar max_force, const char* force_field = "servo max torque") const;
  void setAxisFriction(Axis& axis, Scalar max_force,
                       const char* force_field = "friction max torque") const;

 private:
  friend class BulletRows;
  friend struct JointAccess;

  /// How much of the curvature of their motion (rows/row.h) bodies that turn this fast have in a
  /// step, from 1 (slow) to 0. A body that turns half a radian in a step has hardly the velocity that it
  /// had: the curvature is left out from there on, and by degrees before, on the side of losing energy.
  /// Shafts keep theirs: up to a radian.
  Scalar curvedPart() const { return curvedPart(m_angular_speed); }
  Scalar curvedPart(Scalar angular_speed) const {
    const Scalar part = (m_turns_shafts ? Scalar(1) : Scalar(2)) * angular_speed * m_time_step;
    return btMax(Scalar(0), 1 - part * part);
  }
  StepMotion motion(const BodyPair& pair) const;
  AxisMotion axisMotion(const Row& row, const AxisState& state, const BodyPair& pair, Scalar fps,
                        Scalar default_limit_erp) const;
  /// Once after each buildJacobian, however often.
  void beginStep();

  bool m_block_rows : 1;
  Formulation m_formulation : 1;
  bool m_step_begins : 1;  ///< buildJacobian was called, and no rows asked for since

  btTypedConstraint& m_constraint;
  RowList m_rows;
  /// rad/s, of the faster body, at the start of this step and of the last one
  Scalar m_angular_speed = 0, m_last_angular_speed = 0;
  Scalar m_time_step = Scalar(1) / 60;
  Scalar m_max_correction_speed = 8;
  Scalar m_max_linear_correction_speed = 1;
  BulletRows m_bullet_rows;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle

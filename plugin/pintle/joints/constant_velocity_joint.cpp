#include <pintle/joints/constant_velocity_joint.h>

#include <pintle/body_pair.h>
#include <pintle/equations/cone_twist.h>
#include <pintle/equations/constant_velocity.h>
#include <pintle/equations/position.h>
#include <pintle/frame.h>
#include <pintle/joints/drawing.h>
#include <pintle/joints/observed_joint_rows.h>
#include <pintle/rows/row.h>
#include <pintle/rows/turn_of_step.h>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// rad: less than this has no direction but that of rounding errors.
constexpr Scalar straight = Scalar(1e-5);

btVector3 toBullet(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace

// The joint frames in the world, and the shaft angle at them.
struct ConstantVelocityJoint::Observation {
  Frame a, b;
  Vec3 d;  ///< from the pivot of a to that of b
  Vec3 x_a = a.a(), x_b = b.a();
  equations::AngleAbout<Scalar> shaft = equations::shaft_angle(x_a, a.b(), x_b);

  // Straight on there is none: the last one stands.
  bool hasShaftAngle() const { return shaft.x * shaft.x + shaft.y * shaft.y > Scalar(1e-6); }
  // Of b against a, F the axes of a.
  Quaternion<Scalar> turn(const Mat3& F) const {
    return equations::quaternion(Mat3(F.transpose() * b.axes()));
  }
  Scalar sum() const { return d.sum() + a.trace(b) + x_b.sum(); }
};

ConstantVelocityJoint::ConstantVelocityJoint(btRigidBody& rbA, btRigidBody& rbB,
                                             const btVector3& pivotInA, const btVector3& pivotInB,
                                             const btVector3& shaftInA, const btVector3& shaftInB)
    : ObservedJoint(rbA, rbB, row_count) {
  const btVector3 x_in_a = direction("shaftInA", shaftInA),
                  x_in_b = direction("shaftInB", shaftInB);
  point("pivotInA", pivotInA);
  point("pivotInB", pivotInB);
  const btMatrix3x3 &R_a = rbA.getCenterOfMassTransform().getBasis(),
                    &R_b = rbB.getCenterOfMassTransform().getBasis();
  const Vec3 x_a = view(R_a * x_in_a), x_b = view(R_b * x_in_b), y_a = any_tangent(x_a);
  const Vec3 y_b = equations::rotate(equations::shortest_rotation(x_a, x_b), y_a);
  const auto local = [](const btMatrix3x3& R, const btVector3& x, const Vec3& y) {
    const btVector3 across = toBullet(y) * R;  // R^T y
    return basisOf(x, (across - across.dot(x) * x).normalized());
  };
  setFrames(btTransform(local(R_a, x_in_a, y_a), pivotInA),
            btTransform(local(R_b, x_in_b, y_b), pivotInB));
}

ConstantVelocityJoint::ConstantVelocityJoint(btRigidBody& rbA, btRigidBody& rbB,
                                             const btTransform& frameInA,
                                             const btTransform& frameInB)
    : ObservedJoint(rbA, rbB, row_count) {
  setFrames(frameInA, frameInB);
}

ConstantVelocityJoint::ConstantVelocityJoint(btRigidBody& rbA, const btTransform& frameInA)
    : ObservedJoint(rbA, row_count) {
  setFrames(frameInA, coincident(frameInA));
}

Axis ConstantVelocityJoint::freeBend() {
  Axis axis;
  axis.low = -infinity;
  axis.high = infinity;
  // As the universal joint's limits: no part of a correction is held back, and none rebounds.
  axis.bias = 1;
  axis.relaxation = 0;
  return axis;
}

// --- angles --------------------------------------------------------------------------------------

inline ConstantVelocityJoint::Observation ConstantVelocityJoint::observe(
    const PosePair& poses) const {
  const Frame a(poses.pose_a(), m_frame_a), b(poses.pose_b(), m_frame_b);
  return {a, b, equations::position_error(poses.x_a(), a.r(), poses.x_b(), b.r())};
}

inline UnwrappedAngle ConstantVelocityJoint::shaftAngle(const Observation& seen) const {
  UnwrappedAngle angle = m_shaft_angle;
  if (seen.hasShaftAngle()) angle.update(seen.shaft.x, seen.shaft.y);
  return angle;
}

inline void ConstantVelocityJoint::remember(const Observation& seen, bool) {
  if (!seen.hasShaftAngle()) return;
  const auto& to = seen.shaft;
  const Scalar dt = timeStep();
  if (turnIsNearest(m_rbA, m_rbB, dt, angularSpeed()))
    m_shaft_angle.update(to.x, to.y);
  else
    m_shaft_angle.update(to.x, to.y, to.J_b().dot(turnOfStep(m_rbA, m_rbB, dt)));
}

void ConstantVelocityJoint::framesChanged() {
  m_shaft_angle = {};
  updateState(BodyPair(m_rbA, m_rbB));
}

btScalar ConstantVelocityJoint::getBend() const {
  const Observation at = observe(BodyPair(m_rbA, m_rbB));
  return equations::swing(at.x_a, at.x_b).angle;
}

btScalar ConstantVelocityJoint::getTwist() const {
  const Observation at = observe(BodyPair(m_rbA, m_rbB));
  const Mat3 F = at.a.axes();
  return equations::constant_velocity_row<Scalar>(at.turn(F), F, Vec3::UnitX()).C;
}

btScalar ConstantVelocityJoint::getShaftAngle() const {
  return shaftAngle(observe(BodyPair(m_rbA, m_rbB))).value();
}

// --- settings ------------------------------------------------------------------------------------

void ConstantVelocityJoint::setBendLimit(btScalar max_bend) {
  const Scalar limit = bound("bend limit", max_bend);
  m_bend.high = limit < SIMD_PI ? limit : infinity;
  m_bend_look = CosineLimit(limit);
}

void ConstantVelocityJoint::setBendLimitSpring(btScalar frequency_hz, btScalar damping_ratio) {
  setAxisSpring(m_bend, frequency_hz, damping_ratio);
}

void ConstantVelocityJoint::setBendLimitBounce(btScalar bounce) {
  m_bend.relaxation = notNegative("bend limit bounce", bounce);
}

void ConstantVelocityJoint::setBendFriction(btScalar max_torque) {
  setAxisFriction(m_bend, max_torque);
}

void ConstantVelocityJoint::enableBendMotor(bool on, btScalar velocity, btScalar max_torque) {
  setAxisForceMotor(m_bend, on, velocity, max_torque);
}

void ConstantVelocityJoint::enableBendMotor(bool on) { m_bend.enable(on); }

void ConstantVelocityJoint::setBendServo(btScalar target_bend, btScalar frequency_hz,
                                         btScalar damping_ratio, btScalar max_torque) {
  if (finite("servo target bend", target_bend) < 0 || target_bend > SIMD_PI)
    reject("servo target bend", target_bend, "must be in [0, pi]");
  setAxisServo(m_bend, target_bend, frequency_hz, damping_ratio, max_torque);
}

void ConstantVelocityJoint::enableMotor(bool on, btScalar velocity, btScalar max_torque) {
  setAxisForceMotor(m_shaft, on, velocity, max_torque);
}

void ConstantVelocityJoint::enableMotor(bool on) { m_shaft.enable(on); }

void ConstantVelocityJoint::setMotorServo(btScalar target_angle, btScalar frequency_hz,
                                          btScalar damping_ratio, btScalar max_torque) {
  setAxisServo(m_shaft, target_angle, frequency_hz, damping_ratio, max_torque);
}

void ConstantVelocityJoint::setFriction(btScalar max_torque) {
  setAxisFriction(m_shaft, max_torque);
}

void ConstantVelocityJoint::drawJoint(btIDebugDraw& drawer) const {
  FrameJoint::drawJoint(drawer);
  if (!drawsLimits(drawer) || m_bend.high >= SIMD_PI) return;
  const btTransform a = m_rbA.getCenterOfMassTransform() * m_frame_a;
  const btScalar along = m_dbgDrawSize * btCos(m_bend.high);
  const btScalar across = m_dbgDrawSize * btSin(m_bend.high);
  constexpr int segments = 32;
  drawCone(drawer, a.getOrigin(), segments, [&](int i) {
    const btScalar way = SIMD_2_PI * btScalar(i) / btScalar(segments);
    return a(btVector3(along, across * btCos(way), across * btSin(way)));
  });
}

// --- rows ----------------------------------------------------------------------------------------

// By the chord between the shafts' ends, 2 sin(bend/2), which moves no faster than the bend.
PINTLE_NOINLINE bool ConstantVelocityJoint::bendMayReachLimit(const Observation& seen,
                                                              Scalar cosine,
                                                              const Rows& rows) const {
  const AngularReach reach = rows.turn();
  if (m_bend_look.isFarInside(cosine, reach.max())) return false;
  const Vec3 now = seen.x_b - seen.x_a;
  const Vec3 moved = rows.moved(
      [&](const BodyPair& v) { return Vec3(cross(v.w_b(), seen.x_b) - cross(v.w_a(), seen.x_a)); });
  // At twice the speed of now, as the step may be longer than the last.
  const Vec3 next = now + 2 * moved;
  const Scalar chord = btSqrt(btMax(now.dot(now), next.dot(next)));
  return chord + reach.gained() >= 2 * btSin(m_bend.high / 2);
}

inline void ConstantVelocityJoint::constrain(const Observation& seen, Rows& rows) const {
  const bool document = getFormulation() == Formulation::document;
  const Mat3 F = seen.a.axes();
  const auto row = document
                       ? equations::constant_velocity_dot_row<Scalar>({seen.a.b(), seen.a.c()},
                                                                      {seen.b.b(), seen.b.c()})
                       : equations::constant_velocity_row<Scalar>(seen.turn(F), F, Vec3::UnitX());
  const Scalar length2 = row.J_b.dot(row.J_b);
  if (document) {
    rows.addAngular(row.J_b, row.C).max_speed = getMaxCorrectionSpeed() * btSqrt(length2);
  } else {
    const Scalar curvature = rows.curvature([&](const BodyPair& v) {
      return equations::constant_velocity_curvature<Scalar>(row.J_b, v.w_a(), v.w_b());
    });
    rows.addAngular(row.J_b, row.C, curvature).max_speed = getMaxCorrectionSpeed();
  }
  addPivotRows({seen.a.r(), seen.b.r(), seen.d}, rows);

  const bool near_limit =
      m_bend.high < infinity && bendMayReachLimit(seen, seen.x_a.dot(seen.x_b), rows);
  if (near_limit || m_bend.driven()) {
    const auto bend =
        equations::cone_row(equations::swing(seen.x_a, seen.x_b), seen.x_a, Scalar(0));
    // A spring acts from beyond its limit only.
    const bool limit =
        near_limit && (bend.C > m_bend.high || !(m_bend.limit_spring.angular_frequency > 0));
    // They are at right angles while the joint holds. Far from there they need not be, and what pulls along both at
    // once would throw the bodies.
    const Scalar common = bend.J_b.dot(row.J_b), apart = length2 - 2 * common * common;
    if (bend.C > straight && apart > 0 && (limit || m_bend.driven()))
      rows.addAngularAxis(0, bend.J_b, bend.C, m_bend, limit).max_speed =
          getMaxCorrectionSpeed() * apart / length2;
  }
  if (m_shaft.driven() && seen.shaft.length > minMotorSine())
    rows.addAngularAxis(1, seen.shaft.J_b(), shaftAngle(seen).value(), m_shaft, false);
}

template class ObservedJoint<ConstantVelocityJoint, FrameJoint>;

}  // namespace PINTLE_PRECISION
}  // namespace pintle

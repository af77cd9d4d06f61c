#include <pintle/joints/distance_joint.h>

#include <pintle/body_pair.h>
#include <pintle/equations/distance.h>
#include <pintle/equations/impulse_reaction.h>
#include <pintle/joints/drawing.h>
#include <pintle/joints/observed_joint_rows.h>
#include <pintle/rows/row.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

struct DistanceJoint::Observation {
  Vec3 r_a, r_b;
  equations::Distance<Scalar> d;

  Scalar sum() const { return d.length + d.n.sum() + r_a.sum() + r_b.sum(); }
};

DistanceJoint::DistanceJoint(btRigidBody& rbA, btRigidBody& rbB, const btVector3& pivotInA,
                             const btVector3& pivotInB, btScalar length)
    : ObservedJoint(rbA, rbB, row_count) {
  const btMatrix3x3& upright = btMatrix3x3::getIdentity();
  setFrames(btTransform(upright, point("pivotInA", pivotInA)),
            btTransform(upright, point("pivotInB", pivotInB)));
  setDefaults();
  m_axis.low = m_axis.high = notNegative("length", length);
}

DistanceJoint::DistanceJoint(btRigidBody& rbA, btRigidBody& rbB, const btTransform& frameInA,
                             const btTransform& frameInB)
    : ObservedJoint(rbA, rbB, row_count) {
  setFrames(frameInA, frameInB);
  setDefaults();
  m_axis.low = m_axis.high = getDistance();
}

DistanceJoint::DistanceJoint(btRigidBody& rbA, const btTransform& frameInA)
    : ObservedJoint(rbA, row_count) {
  setFrames(frameInA, coincident(frame("frameInA", frameInA)));
  setDefaults();
  m_axis.low = m_axis.high = 0;
}

void DistanceJoint::setDefaults() {
  m_axis.relaxation = 0;
  // A swing on a rod does not hang on the bodies' own turning.
  m_foresees_curvature = true;
}

// --- settings ------------------------------------------------------------------------------------

void DistanceJoint::setLimit(btScalar low, btScalar high) {
  if (low <= high && high < 0) reject("upper limit", high, "leaves no distance");
  // No distance is below 0; a limit there would only hold coincident points on one side.
  setAxisLimit(m_axis, low <= 0 && high > 0 ? -infinity : low, high);
}

void DistanceJoint::setLimitSpring(btScalar frequency_hz, btScalar damping_ratio) {
  setAxisSpring(m_axis, frequency_hz, damping_ratio);
}

void DistanceJoint::enableMotor(bool enable, btScalar target_velocity, btScalar max_impulse) {
  setAxisMotor(m_axis, enable, target_velocity, max_impulse);
}

void DistanceJoint::enableMotor(bool enable) { m_axis.enable(enable); }

void DistanceJoint::setMotorServo(btScalar target_distance, btScalar frequency_hz,
                                  btScalar damping_ratio, btScalar max_force) {
  setAxisServo(m_axis, target_distance, frequency_hz, damping_ratio, max_force, "servo max force");
}

void DistanceJoint::setFriction(btScalar max_force) {
  setAxisFriction(m_axis, max_force, "friction max force");
}

// --- readings ------------------------------------------------------------------------------------

inline DistanceJoint::Observation DistanceJoint::observe(const PosePair& poses) const {
  Observation seen;
  seen.r_a = poses.R_a() * view(m_frame_a.getOrigin());
  seen.r_b = poses.R_b() * view(m_frame_b.getOrigin());
  const Vec3 d = equations::position_error(poses.x_a(), seen.r_a, poses.x_b(), seen.r_b);
  seen.d = equations::distance(d, Vec3(view(m_direction)));
  return seen;
}

btScalar DistanceJoint::getDistance() const { return observe(BodyPair(m_rbA, m_rbB)).d.length; }

btScalar DistanceJoint::getLimitImpulse() const {
  return rigidRod() ? -m_appliedImpulse : axisImpulse(0, Axis::limit);
}

inline void DistanceJoint::remember(const Observation& seen, bool) {
  const Vec3& n = seen.d.n;
  if (seen.d.length > 0 && PosePair::is_finite(n.sum())) m_direction = {n.x(), n.y(), n.z()};
}

void DistanceJoint::drawJoint(btIDebugDraw& drawer) const {
  FrameJoint::drawJoint(drawer);
  if (!drawsLimits(drawer)) return;
  drawer.drawLine(m_rbA.getCenterOfMassTransform()(m_frame_a.getOrigin()),
                  m_rbB.getCenterOfMassTransform()(m_frame_b.getOrigin()), limitColor());
}

// --- rows ----------------------------------------------------------------------------------------

inline Scalar DistanceJoint::curvature(const Observation& seen, const Rows& rows) const {
  if (getFormulation() == Formulation::document) return 0;
  return rows.endCurvature([&](const equations::Velocity<Scalar>& v, Scalar dt, Scalar part) {
    const Scalar passing =
        equations::passing_curvature(seen.d, equations::relative_velocity(v, seen.r_a, seen.r_b));
    const Scalar centripetal =
        seen.d.n.dot(equations::position_curvature(v.w_a, seen.r_a, v.w_b, seen.r_b));
    // Points that pass by more than |d| in the step are beyond what a curvature says.
    return btMin(passing, seen.d.length / (dt * dt)) + part * centripetal;
  });
}

inline void DistanceJoint::constrain(const Observation& seen, Rows& rows) const {
  if (rigidRod()) {
    const auto row = equations::distance_row(seen.d, m_axis.low, seen.r_a, seen.r_b);
    rows.addEquality(row.J.L, row.J.A_a, row.J.A_b, row.C, curvature(seen, rows));
    rows.shape(RowShape::distance, seen.r_a, seen.r_b, seen.d.length);
    return;
  }
  if (!m_axis.driven() && !m_axis.limited()) return;
  const auto J = equations::position_row(seen.d.n, seen.r_a, seen.r_b);
  const Scalar bend = curvature(seen, rows);
  const bool limit =
      m_axis.limited() && rows.slide(J, bend).of(m_axis).reaches(m_axis, seen.d.length);
  if (!limit && !m_axis.driven()) return;
  Row& row = rows.addAxis(0, J.L, J.A_a, J.A_b, seen.d.length, m_axis, limit);
  rows.shape(RowShape::distance, seen.r_a, seen.r_b, seen.d.length);
  row.curvature = bend;
  row.max_speed = getMaxCorrectionSpeed();
}

template class ObservedJoint<DistanceJoint, FrameJoint>;

}  // namespace PINTLE_PRECISION
}  // namespace pintle

#include <pintle/joints/distance_joint.h>

#include <pintle/body_pair.h>
#include <pintle/equations/distance.h>
#include <pintle/equations/impulse_reaction.h>
#include <pintle/joints/drawing.h>
#include <pintle/rows/limit_reach.h>
#include <pintle/rows/row.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

struct DistanceJoint::Points {
  Vec3 r_a, r_b;
  equations::Distance<Scalar> d;
};

DistanceJoint::DistanceJoint(btRigidBody& rbA, btRigidBody& rbB, const btVector3& pivotInA,
                             const btVector3& pivotInB, btScalar length)
    : FrameJoint(rbA, rbB, row_count) {
  const btMatrix3x3& upright = btMatrix3x3::getIdentity();
  setFrames(btTransform(upright, point("pivotInA", pivotInA)),
            btTransform(upright, point("pivotInB", pivotInB)));
  setDefaults();
  m_axis.low = m_axis.high = notNegative("length", length);
}

DistanceJoint::DistanceJoint(btRigidBody& rbA, btRigidBody& rbB, const btTransform& frameInA,
                             const btTransform& frameInB)
    : FrameJoint(rbA, rbB, row_count) {
  setFrames(frameInA, frameInB);
  setDefaults();
  m_axis.low = m_axis.high = getDistance();
}

DistanceJoint::DistanceJoint(btRigidBody& rbA, const btTransform& frameInA)
    : FrameJoint(rbA, row_count) {
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

inline DistanceJoint::Points DistanceJoint::points(const BodyPair& pair) const {
  Points at;
  at.r_a = pair.R_a() * view(m_frame_a.getOrigin());
  at.r_b = pair.R_b() * view(m_frame_b.getOrigin());
  const Vec3 d = equations::position_error(pair.x_a(), at.r_a, pair.x_b(), at.r_b);
  at.d = equations::distance(d, Vec3(view(m_direction)));
  return at;
}

btScalar DistanceJoint::getDistance() const { return points({m_rbA, m_rbB}).d.length; }

btScalar DistanceJoint::getLimitImpulse() const {
  return rigidRod() ? -m_appliedImpulse : axisImpulse(0, Axis::limit);
}

inline void DistanceJoint::look(const Points& at) {
  const Vec3& n = at.d.n;
  if (at.d.length > 0 && BodyPair::is_finite(n.sum())) m_direction = {n.x(), n.y(), n.z()};
}

void DistanceJoint::updateState(const BodyPair& pair) { look(points(pair)); }

void DistanceJoint::drawJoint(btIDebugDraw& drawer) const {
  FrameJoint::drawJoint(drawer);
  if (!drawsLimits(drawer)) return;
  drawer.drawLine(m_rbA.getCenterOfMassTransform()(m_frame_a.getOrigin()),
                  m_rbB.getCenterOfMassTransform()(m_frame_b.getOrigin()), limitColor());
}

// --- rows ----------------------------------------------------------------------------------------

PINTLE_FLATTEN void DistanceJoint::prepare(const BodyPair& pair, Rows& rows) {
  const Points at = points(pair);
  look(at);
  addRows(pair, at, rows);
}

void DistanceJoint::addRows(const BodyPair& pair, Rows& rows) const {
  addRows(pair, points(pair), rows);
}

inline Scalar DistanceJoint::curvature(const BodyPair& pair, const Points& at) const {
  if (getFormulation() == Formulation::document) return 0;
  const Scalar dt = timeStep();
  const equations::Velocity<Scalar> v{freeLinear(pair.a(), dt), freeAngular(pair.a(), dt),
                                      freeLinear(pair.b(), dt), freeAngular(pair.b(), dt)};
  const Scalar passing =
      equations::passing_curvature(at.d, equations::relative_velocity(v, at.r_a, at.r_b));
  const Scalar centripetal =
      at.d.n.dot(equations::position_curvature(v.w_a, at.r_a, v.w_b, at.r_b));
  // Points that pass by more than |d| in the step are beyond what a curvature says.
  return btMin(passing, at.d.length / (dt * dt)) + curvedPart() * centripetal;
}

inline void DistanceJoint::addRows(const BodyPair& pair, const Points& at, Rows& rows) const {
  if (!BodyPair::is_finite(at.d.length + at.d.n.sum() + at.r_a.sum() + at.r_b.sum())) return;
  if (rigidRod()) {
    const auto row = equations::distance_row(at.d, m_axis.low, at.r_a, at.r_b);
    rows.addEquality(row.J.L, row.J.A_a, row.J.A_b, row.C, curvature(pair, at));
    return;
  }
  if (!m_axis.driven() && !m_axis.limited()) return;
  const auto J = equations::position_row(at.d.n, at.r_a, at.r_b);
  const Scalar bend = curvature(pair, at);
  const Scalar speed =
      equations::row_velocity<Scalar>(J, {pair.v_a(), pair.w_a(), pair.v_b(), pair.w_b()});
  const Reach reach = linearReach(pair, J.A_a, J.A_b, speed, bend, timeStep()).of(m_axis);
  const bool limit = m_axis.limited() && reach.reaches(m_axis, at.d.length);
  if (!limit && !m_axis.driven()) return;
  Row& row = rows.addAxis(0, J.L, J.A_a, J.A_b, at.d.length, m_axis, limit);
  row.curvature = bend;
  row.max_speed = getMaxCorrectionSpeed();
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

#include <pintle/joints/angular_limit.h>

#include <pintle/body_pair.h>
#include <pintle/equations/angular_limit.h>
#include <pintle/joints/drawing.h>
#include <pintle/joints/observed_joint_rows.h>
#include <pintle/rows/row.h>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// Of x of b off z of a, as a sine: nearer, and the angle's gradient is more than twenty times as
// long as a unit vector.
constexpr Scalar min_length = Scalar(0.05);

}  // namespace

// World space.
struct AngularLimit::Observation {
  Vec3 a_a, c_a, a_b;
  equations::AngleAbout<Scalar> to;
  UnwrappedAngle angle;
  Scalar places;  ///< a body that is nowhere gets no row, even of its angle

  // Near the axis the last angle stands.
  bool hasAngle() const { return to.length > min_length; }
  Scalar sum() const { return to.x + to.y + to.unit.sum() + places; }
};

AngularLimit::AngularLimit(btRigidBody& rbA, btRigidBody& rbB, const btTransform& frameInA,
                           const btTransform& frameInB)
    : ObservedJoint(rbA, rbB, row_count) {
  setFrames(frameInA, frameInB);
  m_axis.relaxation = 0;
}

AngularLimit::AngularLimit(btRigidBody& rbA, const btTransform& frameInA)
    : ObservedJoint(rbA, row_count) {
  setFrames(frameInA, coincident(frame("frameInA", frameInA)));
  m_axis.relaxation = 0;
}

void AngularLimit::framesChanged() {
  // Another zero: the turns counted from the old one mean nothing.
  m_angle = {};
  m_turn_given = false;
  updateState(BodyPair(m_rbA, m_rbB));
}

// --- angle ---------------------------------------------------------------------------------------

inline AngularLimit::Observation AngularLimit::observe(const PosePair& poses) const {
  const auto column = [](const MatrixView& R, const btMatrix3x3& frame, int i) {
    return Vec3(R * Vec3(view(frame).col(i)));
  };
  Observation seen;
  seen.a_a = column(poses.R_a(), m_frame_a.getBasis(), 0);
  seen.c_a = column(poses.R_a(), m_frame_a.getBasis(), 2);
  seen.a_b = column(poses.R_b(), m_frame_b.getBasis(), 0);
  seen.to = equations::angle_about(seen.c_a, seen.a_a, seen.a_b);
  seen.places = poses.x_a().sum() + poses.x_b().sum();
  seen.angle = m_angle;
  if (seen.hasAngle() && PosePair::is_finite(seen.to.x + seen.to.y))
    seen.angle.update(seen.to.x, seen.to.y);
  return seen;
}

inline void AngularLimit::remember(const Observation& seen, bool) { m_angle = seen.angle; }

btScalar AngularLimit::getAngle() const { return observe(BodyPair(m_rbA, m_rbB)).to.angle(); }

btScalar AngularLimit::getAccumulatedAngle() {
  updateState(BodyPair(m_rbA, m_rbB));
  return m_angle.value();
}

void AngularLimit::setAccumulatedAngle(btScalar angle) {
  m_angle.set(finite("accumulated angle", angle));
  m_turn_given = true;
}

// --- settings ------------------------------------------------------------------------------------

void AngularLimit::setLimit(btScalar low, btScalar high) {
  setAxisLimit(m_axis, low, high);
  if (!m_turn_given && m_axis.limited() && high - low < SIMD_2_PI)
    m_angle.turnTowards((low + high) / 2);
}

void AngularLimit::setLimitSpring(btScalar frequency_hz, btScalar damping_ratio) {
  setAxisSpring(m_axis, frequency_hz, damping_ratio);
}

void AngularLimit::enableAngularMotor(bool enable, btScalar target_velocity, btScalar max_impulse) {
  setAxisMotor(m_axis, enable, target_velocity, max_impulse);
}

void AngularLimit::enableMotor(bool enable) { m_axis.enable(enable); }

void AngularLimit::setMotorServo(btScalar target_angle, btScalar frequency_hz,
                                 btScalar damping_ratio, btScalar max_torque) {
  setAxisServo(m_axis, target_angle, frequency_hz, damping_ratio, max_torque);
}

void AngularLimit::setFriction(btScalar max_torque) { setAxisFriction(m_axis, max_torque); }

void AngularLimit::drawJoint(btIDebugDraw& drawer) const {
  FrameJoint::drawJoint(drawer);
  if (!drawsLimits(drawer) || m_axis.locked()) return;
  const btTransform tr = m_rbA.getCenterOfMassTransform() * m_frame_a;
  drawRange(drawer, tr.getOrigin(), tr.getBasis().getColumn(2), tr.getBasis().getColumn(0),
            m_dbgDrawSize, m_axis.low, m_axis.high);
}

// --- rows ----------------------------------------------------------------------------------------

inline void AngularLimit::constrain(const Observation& seen, Rows& rows) const {
  if (!seen.hasAngle() || (!m_axis.driven() && !m_axis.limited())) return;
  Vec3 J_b = seen.to.J_b();
  if (getFormulation() == Formulation::document) {
    const equations::Basis<Scalar> basis{seen.a_a, cross(seen.c_a, seen.a_a), seen.c_a};
    J_b = equations::angular_limit_row(basis, seen.a_b, Scalar(0)).J_b;
  }
  bool limit = false;
  const Scalar coordinate = seen.angle.value();
  if (m_axis.limited()) {
    // The angle gains as much more by forces as its row is longer than a unit vector.
    Reach reach = rows.turn().about(J_b);
    reach.gained /= seen.to.length;
    limit = reach.of(m_axis).reaches(m_axis, coordinate);
  }
  if (limit || m_axis.driven()) rows.addAngularAxis(0, J_b, coordinate, m_axis, limit);
}

template class ObservedJoint<AngularLimit, FrameJoint>;

}  // namespace PINTLE_PRECISION
}  // namespace pintle

#include <pintle/joints/angular_limit.h>

#include <pintle/body_pair.h>
#include <pintle/equations/angular_limit.h>
#include <pintle/joints/drawing.h>
#include <pintle/rows/limit_reach.h>
#include <pintle/rows/row.h>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// Of x of b off z of a, as a sine: nearer, and the angle's gradient is more than twenty times as
// long as a unit vector.
constexpr Scalar min_length = Scalar(0.05);

}  // namespace

// World space.
struct AngularLimit::Directions {
  Vec3 a_a, c_a, a_b;
  equations::AngleAbout<Scalar> to;
};

AngularLimit::AngularLimit(btRigidBody& rbA, btRigidBody& rbB, const btTransform& frameInA,
                           const btTransform& frameInB)
    : FrameJoint(rbA, rbB, row_count) {
  setFrames(frameInA, frameInB);
  m_axis.relaxation = 0;
}

AngularLimit::AngularLimit(btRigidBody& rbA, const btTransform& frameInA)
    : FrameJoint(rbA, row_count) {
  setFrames(frameInA, coincident(frame("frameInA", frameInA)));
  m_axis.relaxation = 0;
}

void AngularLimit::framesChanged() {
  // Another zero: the turns counted from the old one mean nothing.
  m_angle = {};
  m_turn_given = false;
  updateState({m_rbA, m_rbB});
}

// --- angle ---------------------------------------------------------------------------------------

inline AngularLimit::Directions AngularLimit::directions(const BodyPair& pair) const {
  const auto column = [](const MatrixView& R, const btMatrix3x3& frame, int i) {
    return Vec3(R * Vec3(view(frame).col(i)));
  };
  Directions at;
  at.a_a = column(pair.R_a(), m_frame_a.getBasis(), 0);
  at.c_a = column(pair.R_a(), m_frame_a.getBasis(), 2);
  at.a_b = column(pair.R_b(), m_frame_b.getBasis(), 0);
  at.to = equations::angle_about(at.c_a, at.a_a, at.a_b);
  return at;
}

inline void AngularLimit::look(const equations::AngleAbout<Scalar>& to,
                               UnwrappedAngle& angle) const {
  // Near the axis the last angle stands; so it does in a frame that its owner has spoiled.
  if (to.length > min_length && BodyPair::is_finite(to.x + to.y)) angle.update(to.x, to.y);
}

void AngularLimit::updateState(const BodyPair& pair) { look(directions(pair).to, m_angle); }

btScalar AngularLimit::getAngle() const { return directions({m_rbA, m_rbB}).to.angle(); }

btScalar AngularLimit::getAccumulatedAngle() {
  updateState({m_rbA, m_rbB});
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

PINTLE_FLATTEN void AngularLimit::prepare(const BodyPair& pair, Rows& rows) {
  const Directions at = directions(pair);
  look(at.to, m_angle);
  addRows(pair, at, m_angle, rows);
}

void AngularLimit::addRows(const BodyPair& pair, Rows& rows) const {
  const Directions at = directions(pair);
  UnwrappedAngle angle = m_angle;
  look(at.to, angle);
  addRows(pair, at, angle, rows);
}

inline void AngularLimit::addRows(const BodyPair& pair, const Directions& at,
                                  const UnwrappedAngle& angle, Rows& rows) const {
  if (!m_axis.driven() && !m_axis.limited()) return;
  // Written so that NaN is not above. (A body that is nowhere gets no row, even of its angle.)
  const Scalar sum = at.to.unit.sum() + pair.x_a().sum() + pair.x_b().sum();
  if (!(at.to.length > min_length && BodyPair::is_finite(sum))) return;
  Vec3 J_b = at.to.J_b();
  if (getFormulation() == Formulation::document) {
    const equations::Basis<Scalar> basis{at.a_a, cross(at.c_a, at.a_a), at.c_a};
    J_b = equations::angular_limit_row(basis, at.a_b, Scalar(0)).J_b;
  }
  bool limit = false;
  const Scalar coordinate = angle.value();
  if (m_axis.limited()) {
    // The angle gains as much more by forces as its row is longer than a unit vector.
    Reach reach = AngularReach(pair, timeStep()).about(J_b);
    reach.gained /= at.to.length;
    limit = reach.of(m_axis).reaches(m_axis, coordinate);
  }
  if (limit || m_axis.driven()) rows.addAngularAxis(0, J_b, coordinate, m_axis, limit);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

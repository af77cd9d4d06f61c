#include <pintle/joints/gear_side.h>

#include <pintle/equations/contact.h>
#include <pintle/equations/gear.h>
#include <pintle/equations/quaternion_hinge_limit.h>
#include <pintle/frame.h>
#include <pintle/joints/constants.h>
#include <pintle/joints/turning.h>

#include <cmath>
#include <limits>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

Vector3<double> inDoubles(const btVector3& v) {
  return {double(v.x()), double(v.y()), double(v.z())};
}

Vector3<double> turnedBy(const btMatrix3x3& R, const Vector3<double>& v) {
  return {inDoubles(R[0]).dot(v), inDoubles(R[1]).dot(v), inDoubles(R[2]).dot(v)};
}

}  // namespace

void GearSide::name(const GearCoordinate& coordinate, const btVector3& axis, const GearPoses& at) {
  m_named = coordinate;
  m_a = coordinate.m_a;
  m_b = coordinate.m_b;
  m_axis = axis;
  m_has_axis = true;
  m_factor = coordinate.m_sign;
  m_turns = double(coordinate.m_turns);
  begin(at);
}

bool GearSide::hasAxis(const btVector3& axis) const {
  return m_has_axis && axis.x() == m_axis.x() && axis.y() == m_axis.y() && axis.z() == m_axis.z();
}

void GearSide::takeAxis(const btVector3& axis, const btRigidBody& body, const GearPoses& at) {
  const Vector3<double> from = inDoubles(axis);
  const double length = std::sqrt(from.dot(from));
  m_named.reset();
  m_a = nullptr;
  m_b = &body;
  m_axis = axis;
  m_has_axis = true;
  m_factor = Scalar(length);
  m_turns = 0;
  m_n_in_b.setZero();
  if (length > 0) m_n_in_b = from / length;
  m_v_in_b = any_tangent(m_n_in_b);
  begin(at);
}

// Before anything is known of its motion.
void GearSide::begin(const GearPoses& at) {
  const btMatrix3x3& R = at[*m_b].getBasis();
  m_n = turnedBy(R, m_n_in_b);
  m_x = turnedBy(R, m_v_in_b);
  m_rest = 0;
  const GearReading now = read(at);
  if (now.isFinite()) m_rest = now.rest;
}

// --- where it is ---------------------------------------------------------------------------------

GearReading GearSide::read(const GearPoses& at) const {
  return !m_named ? readRotation(at) : m_named->m_is_position ? readPosition(at) : readAngle(at);
}

GearReading GearSide::readRotation(const GearPoses& at) const {
  GearReading now;
  const btMatrix3x3& R = at[*m_b].getBasis();
  now.L.setZero();
  now.A_a.setZero();
  now.A_b = view(R * m_axis);
  now.n = m_n;
  now.x = m_x;
  if (!(m_factor > 0)) return now;
  const Vector3<double> n = turnedBy(R, m_n_in_b);
  now.n = n / std::sqrt(n.dot(n));
  now.x = equations::carried(m_x, m_n, now.n);
  now.rest = equations::angle_against(now.x, now.n, turnedBy(R, m_v_in_b));
  return now;
}

GearReading GearSide::readAngle(const GearPoses& at) const {
  const int p = (m_named->m_main + 1) % 3, q = (m_named->m_main + 2) % 3;
  const Mat3 a = Frame(at[*m_a], m_named->m_frame_a).axes(),
             b = Frame(at[*m_b], m_named->m_frame_b).axes();
  const auto twist = equations::twist<Scalar>(a.col(p).dot(b.col(p)), a.col(q).dot(b.col(q)),
                                              a.col(q).dot(b.col(p)), a.col(p).dot(b.col(q)));
  GearReading now;
  now.L.setZero();
  now.A_a = now.A_b = m_factor * equations::twist_row<Scalar>(Vec3(a.col(m_named->m_main)),
                                                              Vec3(b.col(m_named->m_main)));
  // Where the axes of the joint are all but opposite there is no angle.
  now.rest = isSeen(twist) ? std::atan2(double(twist.y), double(twist.x))
                           : std::numeric_limits<double>::quiet_NaN();
  return now;
}

GearReading GearSide::readPosition(const GearPoses& at) const {
  const btTransform &pose_a = at[*m_a], &pose_b = at[*m_b];
  const Frame a(pose_a, m_named->m_frame_a), b(pose_b, m_named->m_frame_b);
  const equations::Anchors<Scalar> anchors{
      a.r(), b.r(),
      equations::position_error(view(pose_a.getOrigin()), a.r(), view(pose_b.getOrigin()), b.r())};
  const auto row = equations::contact_row(a.a(), anchors);
  GearReading now;
  now.L = m_factor * row.J.L;
  now.A_a = m_factor * row.J.A_a;
  now.A_b = m_factor * row.J.A_b;
  now.rest = double(row.C);
  return now;
}

// --- how far it has come -------------------------------------------------------------------------

double GearSide::change(const GearReading& now, double expected) const {
  const double change = now.rest - m_rest;
  return isPosition() ? change : change + 2 * pi * std::round((expected - change) / (2 * pi));
}

// Two fast bodies may turn against each other by more than half a turn: then it is their velocities that tell.
GearSide::Change GearSide::changeInStep(const GearReading& now, Scalar dt) const {
  if (now.rest == m_rest) return {0, false};  // looked already
  const double most = isPosition() ? double(max_strange_move) : double(max_strange_turn);
  const double nearest = nearestChange(now);
  const bool is_far = turnsFar(dt);
  if (!is_far && std::abs(nearest) <= most) return {nearest, false};
  const double expected = expectedChange(now, dt), size = is_far ? change(now, expected) : nearest;
  return {size, std::abs(size - expected) > std::abs(expected) + most};
}

// rad or m: what velocities of the last step have made of it.
double GearSide::expectedChange(const GearReading& now, Scalar dt) const {
  if (!(btFabs(m_factor) > 0)) return 0;
  const auto moved = [&](const Vec3& A, const btRigidBody& body) {
    return A.dot(turnOfStep(body.getInterpolationAngularVelocity(), dt));
  };
  Scalar sum = moved(now.A_b, *m_b);
  if (m_a != nullptr) {
    sum -= moved(now.A_a, *m_a);
    sum += dt * now.L.dot(view(m_b->getInterpolationLinearVelocity()) -
                          view(m_a->getInterpolationLinearVelocity()));
  }
  const double expected = double(sum) / double(m_factor);
  return isFinite(expected) ? expected : 0;
}

bool GearSide::turnsFar(Scalar dt) const {
  if (m_a == nullptr || isPosition()) return false;
  const Scalar speed2 = btMax(m_a->getInterpolationAngularVelocity().length2(),
                              m_b->getInterpolationAngularVelocity().length2());
  return speed2 * dt * dt >= 1 && !turnIsNearest(*m_a, *m_b, dt, btSqrt(speed2));
}

void GearSide::follow(const GearReading& now, double change) {
  if (!isPosition()) m_turns += std::round((change - (now.rest - m_rest)) / (2 * pi));
  m_rest = now.rest;
  if (m_named) return;
  m_n = now.n;
  m_x = now.x;
}

btVector3 GearSide::place() const {
  const btTransform& pose = m_b->getCenterOfMassTransform();
  return m_named ? pose(m_named->m_frame_b.getOrigin()) : pose.getOrigin();
}

btVector3 GearSide::axis() const {
  const btMatrix3x3& R = m_b->getCenterOfMassTransform().getBasis();
  return R * (m_named ? m_named->axisIn(*m_b) : m_axis / m_factor);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

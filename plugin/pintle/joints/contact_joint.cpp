#include <pintle/joints/contact_joint.h>

#include <pintle/body_pair.h>
#include <pintle/equations/contact.h>
#include <pintle/equations/impulse_reaction.h>
#include <pintle/joints/drawing.h>
#include <pintle/rows/limit_reach.h>
#include <pintle/rows/row.h>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

btMatrix3x3 basisWithZ(const btVector3& z) {
  btVector3 x, y;
  btPlaneSpace1(z, x, y);
  return columns(x, y, z);
}

}  // namespace

// The normal in the world, and where it holds the bodies.
struct ContactJoint::At : equations::Anchors<Scalar> {
  Vec3 n;
};

ContactJoint::ContactJoint(btRigidBody& rbA, btRigidBody& rbB, const btVector3& pivotInA,
                           const btVector3& pivotInB, const btVector3& normalInA)
    : FrameJoint(rbA, rbB, row_count) {
  setFrames(btTransform(basisWithZ(direction("normalInA", normalInA)), point("pivotInA", pivotInA)),
            btTransform(btMatrix3x3::getIdentity(), point("pivotInB", pivotInB)));
  setDefaults();
}

ContactJoint::ContactJoint(btRigidBody& rbA, btRigidBody& rbB, const btTransform& frameInA,
                           const btTransform& frameInB)
    : FrameJoint(rbA, rbB, row_count) {
  setFrames(frameInA, frameInB);
  setDefaults();
}

ContactJoint::ContactJoint(btRigidBody& rbA, const btTransform& frameInA)
    : FrameJoint(rbA, row_count) {
  setFrames(frameInA, coincident(frame("frameInA", frameInA)));
  setDefaults();
}

void ContactJoint::setDefaults() {
  m_axis.low = 0;
  m_axis.high = infinity;
  setRestitution(0);
}

void ContactJoint::setRestitution(btScalar restitution) {
  if (notNegative("restitution", restitution) > 1)
    reject("restitution", restitution, "must not be above 1");
  m_axis.relaxation = restitution / m_axis.bias;  // the rebound is their product
}

void ContactJoint::setLimitSpring(btScalar frequency_hz, btScalar damping_ratio) {
  setAxisSpring(m_axis, frequency_hz, damping_ratio);
}

void ContactJoint::framesChanged() {
  m_world_normal = m_rbA.getCenterOfMassTransform().getBasis() * m_frame_a.getBasis().getColumn(2);
}

inline ContactJoint::At ContactJoint::at(const PosePair& pair) const {
  At at;
  if (getFormulation() == Formulation::document)
    at.n = view(m_world_normal);
  else
    at.n = pair.R_a() * Vec3(view(m_frame_a.getBasis()).col(2));
  at.r_a = pair.R_a() * view(m_frame_a.getOrigin());
  at.r_b = pair.R_b() * view(m_frame_b.getOrigin());
  at.d = equations::position_error(pair.x_a(), at.r_a, pair.x_b(), at.r_b);
  return at;
}

btScalar ContactJoint::getDistance() const {
  const At now = at(BodyPair(m_rbA, m_rbB));
  return now.n.dot(now.d);
}

btScalar ContactJoint::getNormalImpulse() const {
  return isEquality() ? -m_appliedImpulse : axisImpulse(0, Axis::limit);
}

void ContactJoint::drawJoint(btIDebugDraw& drawer) const {
  FrameJoint::drawJoint(drawer);
  if (!drawsLimits(drawer)) return;
  const btTransform plane = m_rbA.getCenterOfMassTransform() * m_frame_a;
  drawRange(drawer, plane.getOrigin(), plane.getBasis().getColumn(2), plane.getBasis().getColumn(0),
            m_dbgDrawSize, 1, -1);
}

PINTLE_FLATTEN void ContactJoint::addRows(const PosePair& poses, Rows& rows) const {
  const At here = at(poses);
  const equations::Anchors<Scalar>& anchors = here;
  const bool document = getFormulation() == Formulation::document;
  const auto row = document ? equations::contact_row_world(here.n, anchors)
                            : equations::contact_row(here.n, anchors);
  // Also a frame that its owner has spoiled.
  if (!PosePair::is_finite(row.C + here.d.sum() + row.J.A_a.sum() + row.J.A_b.sum())) return;
  const Scalar curvature = document ? Scalar(0) : rows.curvature([&](const BodyPair& v) {
    return Scalar(here.n.dot(equations::position_curvature_conserving<Scalar>(
        anchors, {v.v_a(), v.w_a(), v.v_b(), v.w_b()})));
  });
  if (isEquality()) {
    rows.addEquality(row.J.L, row.J.A_a, row.J.A_b, row.C, curvature);
    return;
  }
  if (!rows.slide(row.J, curvature).of(m_axis).reaches(m_axis, row.C)) return;
  Row& axis = rows.addAxis(0, row.J.L, row.J.A_a, row.J.A_b, row.C, m_axis, true);
  axis.curvature = curvature;
  axis.max_speed = getMaxCorrectionSpeed();
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

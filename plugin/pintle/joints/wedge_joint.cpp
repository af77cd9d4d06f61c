#include <pintle/joints/wedge_joint.h>

#include <pintle/body_pair.h>
#include <pintle/equations/wedge.h>
#include <pintle/frame.h>
#include <pintle/joints/drawing.h>
#include <pintle/rows/position_rows.h>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// A joint frame with x in the plane of both.
btMatrix3x3 basisWith(const btVector3& z, const btVector3& x) {
  const btVector3 y = z.cross(x).normalized(), across = y.cross(z);
  return {across.x(), y.x(), z.x(), across.y(), y.y(), z.y(), across.z(), y.z(), z.z()};
}

btVector3 anyNormal(const btVector3& x) {
  btVector3 y(0, 0, 0), z(0, 0, 0);
  btPlaneSpace1(x, y, z);
  return y;
}

}  // namespace

// World space: the joint frame of a, and c_b.
struct WedgeJoint::Reference {
  const Frame& frame;
  Vec3 c_b;
};

// World space: the joint frame of a, c_b, the rotation vector by which it turns in it in a step, and what the forces may
// add to that, rad.
struct WedgeJoint::Directions {
  const Frame& frame;
  Vec3 c_b;
  Vec3 turn;
  Scalar gained;
};

// One plane of the wedge: how far c_b is on its inner side, as a sine, and by how much less after a
// step that brings it nearest.
struct WedgeJoint::Plane {
  Index index;
  equations::AngularRow<Scalar> row;
  Scalar nearest;

  Plane(Index which, const btVector3& n, const Directions& at) : index(which) {
    const Vec3 world = n[0] * at.frame.a() + n[1] * at.frame.b();
    row = equations::wedge_row(world, at.c_b);
    const Scalar moved = row.J_b.dot(at.turn);
    nearest = row.C + btMin(2 * moved, moved) - at.gained;
  }
  bool reached() const { return nearest <= 0; }
};

WedgeJoint::WedgeJoint(btRigidBody& rbA, btRigidBody& rbB, const btVector3& pivotInA,
                       const btVector3& pivotInB, const btVector3& referenceInA,
                       const btVector3& referenceInB, const btVector3& wedgeAxisInA)
    : FrameJoint(rbA, rbB, row_count) {
  const btVector3 c_a = direction("referenceInA", referenceInA),
                  c_b = direction("referenceInB", referenceInB),
                  w = direction("wedgeAxisInA", wedgeAxisInA);
  const Scalar across = w.cross(c_a).length();
  if (across < Scalar(1e-3)) reject("referenceInA", across, "must not lie along wedgeAxisInA");
  setFrames(btTransform(basisWith(w, c_a), point("pivotInA", pivotInA)),
            btTransform(basisWith(anyNormal(c_b), c_b), point("pivotInB", pivotInB)));
  setDefaults();
}

WedgeJoint::WedgeJoint(btRigidBody& rbA, btRigidBody& rbB, const btTransform& frameInA,
                       const btTransform& frameInB)
    : FrameJoint(rbA, rbB, row_count) {
  setFrames(frameInA, frameInB);
  setDefaults();
}

WedgeJoint::WedgeJoint(btRigidBody& rbA, const btTransform& frameInA) : FrameJoint(rbA, row_count) {
  setFrames(frameInA, coincident(frame("frameInA", frameInA)));
  setDefaults();
}

void WedgeJoint::setDefaults() {
  m_side.relaxation = m_corner.relaxation = 0;
  for (Axis& plane : m_plane) plane.relaxation = 0;
  m_corner.low = 0;
  m_corner.high = infinity;
  setLimit(m_side.low, m_side.high);
}

// --- settings ------------------------------------------------------------------------------------

void WedgeJoint::setLimit(btScalar low, btScalar high) {
  setAxisLimit(m_side, low, high);
  // Of a plane the other side's stop would be a circle, which that side touches: rows that hold both repeat each other.
  m_plane[low_side].low = low;
  m_plane[high_side].high = high;
  m_plane[low_side].high = m_side.locked() ? high : infinity;
  m_plane[high_side].low = m_side.locked() ? low : -infinity;
  const Scalar total = high - low;
  const bool limited = total >= 0 && total < SIMD_2_PI;
  // Half a turn, give or take rounding, has one plane.
  m_convex = limited && total < SIMD_PI - 8 * SIMD_EPSILON;
  m_reflex = limited && !m_convex;
  m_acute = limited && total < SIMD_HALF_PI;
  m_look = {};
  if (!limited) return;
  const auto to_bullet = [](const Vec3& v) { return btVector3(v.x(), v.y(), v.z()); };
  const auto wedge = equations::wedge<Scalar>(Vec3::Unit(2), Vec3::Unit(0), low, high);
  m_n_min = to_bullet(wedge.n_min);
  m_n_max = to_bullet(wedge.n_max);
  m_middle = to_bullet(wedge.middle);
  m_look = {low, high, btMin(total / 2, SIMD_HALF_PI)};
}

void WedgeJoint::setLimitSpring(btScalar frequency_hz, btScalar damping_ratio) {
  setAxisSpring(m_side, frequency_hz, damping_ratio);
  m_corner.limit_spring = m_side.limit_spring;
  for (Axis& plane : m_plane) plane.limit_spring = m_side.limit_spring;
}

void WedgeJoint::enableAngularMotor(bool enable, btScalar target_velocity, btScalar max_impulse) {
  setAxisMotor(m_side, enable, target_velocity, max_impulse);
}

void WedgeJoint::enableMotor(bool enable) { m_side.enable(enable); }

void WedgeJoint::setMotorServo(btScalar target_angle, btScalar frequency_hz, btScalar damping_ratio,
                               btScalar max_torque) {
  setAxisServo(m_side, target_angle, frequency_hz, damping_ratio, max_torque);
}

void WedgeJoint::setFriction(btScalar max_torque) { setAxisFriction(m_side, max_torque); }

// --- readings ------------------------------------------------------------------------------------

inline Scalar WedgeJoint::angle(const equations::AngleAbout<Scalar>& to) const {
  if (!limited()) return to.angle();
  const Scalar middle = (m_side.low + m_side.high) / 2;
  if (!(to.length > 0)) return middle;
  return middle + std::remainder(to.angle() - middle, SIMD_2_PI);
}

btScalar WedgeJoint::getAngle() const {
  const Frame a(m_rbA.getCenterOfMassTransform(), m_frame_a),
      b(m_rbB.getCenterOfMassTransform(), m_frame_b);
  return angle(equations::angle_about(a.c(), a.a(), b.a()));
}

bool WedgeJoint::isInside() const {
  if (!limited()) return true;
  const Frame a(m_rbA.getCenterOfMassTransform(), m_frame_a),
      b(m_rbB.getCenterOfMassTransform(), m_frame_b);
  const Directions at{a, b.a(), Vec3::Zero(), 0};
  const bool above_low = Plane(low_side, m_n_min, at).row.C >= 0;
  const bool below_high = Plane(high_side, m_n_max, at).row.C >= 0;
  return m_convex ? above_low && below_high : above_low || below_high;
}

void WedgeJoint::drawJoint(btIDebugDraw& drawer) const {
  FrameJoint::drawJoint(drawer);
  if (!drawsLimits(drawer)) return;
  const btTransform tr = m_rbA.getCenterOfMassTransform() * m_frame_a;
  drawRange(drawer, tr.getOrigin(), tr.getBasis().getColumn(2), tr.getBasis().getColumn(0),
            m_dbgDrawSize, m_side.low, m_side.high);
}

// --- rows ----------------------------------------------------------------------------------------

PINTLE_FLATTEN void WedgeJoint::addRows(const PosePair& poses, Rows& rows) const {
  const Frame a(poses.pose_a(), m_frame_a);
  const Vec3 r_b = poses.R_b() * view(m_frame_b.getOrigin());
  const Vec3 c_b = poses.R_b() * Vec3(view(m_frame_b.getBasis()).col(0));
  const Vec3 d = equations::position_error(poses.x_a(), a.r(), poses.x_b(), r_b);
  const Lanes components = a.components(c_b);
  // Also a frame that its owner has spoiled.
  if (!PosePair::is_finite(d.sum() + components[0] + components[1] + components[2])) return;
  addPivotRows({a.r(), r_b, d}, rows);
  if (!limited() && !m_side.driven()) return;
  // Of two limbs that turn together one stops at its own wedge: the other's is reached in the same step, which then
  // is to hold it. Rows of the next would find it behind its edge, and turned anyhow.
  const AngularReach reach = rows.turn(true);
  if (m_side.driven() || !m_look.isFarInside(components[0], components[1], 1, reach.max()))
    addWedgeRows({a, c_b}, reach, rows);
}

PINTLE_NOINLINE void WedgeJoint::addWedgeRows(const Reference& reference, const AngularReach& reach,
                                              Rows& rows) const {
  const bool spring = m_side.limit_spring.angular_frequency > 0;
  const Directions at{reference.frame, reference.c_b, spring ? Vec3(Vec3::Zero()) : reach.moved(),
                      Reach{0, reach.gained()}.of(m_corner).gained};
  bool near_side = false;  // whether the row of the side that c_b is nearer to is a limit
  // Of a pose alone nobody knows whether it is reached: what acts along the angle then has a row of its own.
  Index side = rows.inStep() ? low_side : drive;
  if (isFarBehindEdge(at)) {
    const auto row = equations::edge_distance<Scalar>(at.frame.c(), at.c_b);
    rows.addAngularAxis(corner, row.J_b, row.C, m_corner, true);
  } else if (limited()) {
    const Plane low(low_side, m_n_min, at), high(high_side, m_n_max, at);
    if (m_acute) {
      const Plane extra(corner, m_middle, at);
      const bool acts = getFormulation() == Formulation::document ? low.row.C < 0 && high.row.C < 0
                                                                  : extra.reached();
      if (acts) addPlaneRow(extra, at, m_corner, rows);
    }
    const bool low_is_nearer = m_convex ? low.row.C <= high.row.C : isInLowHalf(at);
    const Plane &nearer = low_is_nearer ? low : high, &other = low_is_nearer ? high : low;
    // The nearer one last: what the solver leaves over is then no violation.
    if (m_convex && !m_side.locked() && other.reached())
      addPlaneRow(other, at, m_plane[other.index], rows);
    near_side = nearer.reached() && (m_convex || other.reached());
    const bool drives = rows.inStep() && m_side.driven();
    if (near_side) addPlaneRow(nearer, at, drives ? m_side : m_plane[nearer.index], rows);
    if (rows.inStep()) side = nearer.index;
  }
  if ((near_side && rows.inStep()) || !m_side.driven()) return;
  const auto to = equations::angle_about(at.frame.c(), at.frame.a(), at.c_b);
  rows.addAngularAxis(side, to.unit, angle(to), m_side, false);
}

inline equations::Wedge<Scalar> WedgeJoint::wedge() const {
  return {view(m_n_min), view(m_n_max), view(m_middle)};
}

// Near the edge the planes' rows lead over it together, and hold what rests there.
inline bool WedgeJoint::isFarBehindEdge(const Directions& at) const {
  if (!m_convex || getFormulation() == Formulation::document) return false;
  const Vec3 c_b(at.frame.a().dot(at.c_b), at.frame.b().dot(at.c_b), at.frame.c().dot(at.c_b));
  return 2 * c_b.z() * c_b.z() < 1 && equations::behind_edge<Scalar>(wedge(), Vec3::Unit(2), c_b);
}

inline bool WedgeJoint::isInLowHalf(const Directions& at) const {
  const Vec3 c_b(at.frame.a().dot(at.c_b), at.frame.b().dot(at.c_b), 0);
  const auto planes = wedge();
  return &equations::nearer_plane<Scalar>(planes, Vec3::Unit(2), c_b) == &planes.n_min;
}

inline void WedgeJoint::addPlaneRow(const Plane& plane, const Directions& at, const Axis& axis,
                                    Rows& rows) const {
  auto row = plane.row;
  if (getFormulation() == Formulation::conditioned)
    row = equations::plane_distance(row, at.frame.c());
  // Along the angle: inside is above the low side, and below the high one.
  const Scalar side = plane.index == high_side ? Scalar(-1) : Scalar(1);
  const Scalar edge = plane.index == high_side ? axis.high : axis.low;
  Row& added = rows.addAngularAxis(plane.index, side * row.J_b, edge + side * row.C, axis, true);
  // The document's row turns the bodies by as much more as it is shorter than a unit vector.
  if (getFormulation() == Formulation::document)
    added.max_speed = getMaxCorrectionSpeed() * row.J_b.norm();
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

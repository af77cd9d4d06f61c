#include <pintle/joints/cone_twist_model.h>

#include <pintle/arctangent.h>
#include <pintle/body_pair.h>
#include <pintle/equations/angle_about.h>
#include <pintle/equations/cone_twist.h>
#include <pintle/equations/universal.h>
#include <pintle/frame.h>
#include <pintle/joints/drawing.h>
#include <pintle/joints/observed_joint_rows.h>
#include <pintle/joints/turning.h>
#include <pintle/rows/position_rows.h>
#include <pintle/rows/swing_rows.h>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// 1 + cos(swing) below which the twist has too few digits, and moves too fast, to be held.
constexpr Scalar min_twist_length = Scalar(0.005);
// Nearer to its target (rad) than this, or slower (rad/s), the motor has no direction worth following.
constexpr Scalar near_target = Scalar(0.1);
// Farther out of the cone (rad, across its smallest span) the way back is that to its nearest point.
constexpr Scalar far_out = Scalar(0.05);
// The smallest cosine between the normals of an edge that is no tip, where a step's forces lead and where it is nearest.
constexpr Scalar same_edge = Scalar(0.95);

bool isCone(const Axis& swing) { return swing.low <= -infinity; }

// The row of a limit at both ends, whose angle moves with -J_b. As in Bullet its impulse is positive at either.
void addRange(Rows& rows, int index, const Vec3& J_b, Scalar angle, const Axis& axis) {
  const int sign = !axis.locked() && axis.high - angle < angle - axis.low ? 1 : -1;
  rows.addAngularAxis(index, -Scalar(sign) * J_b, angle, axis, true, sign);
}

}  // namespace

// Where the joint's frames are.
struct ConeTwistModel::Observation {
  Observation(const PosePair& poses, const btTransform& frame_a, const btTransform& frame_b)
      : a(poses.pose_a(), frame_a),
        b(poses.pose_b(), frame_b),
        d(equations::position_error(poses.x_a(), a.r(), poses.x_b(), b.r())) {}
  Scalar sum() const { return d.sum() + dots[0] + dots[1] + dots[2]; }

  /// The twist of b against a: minus that of a against b.
  equations::Twist<Scalar> twist() const {
    return equations::twist<Scalar>(dots[1], dots[2], a.c().dot(b.b()), a.b().dot(b.c()));
  }
  /// The swing of a against b, as b sees it. Worked out once.
  const equations::Swing<Scalar>& swing() const {
    if (!m_knows_swing) m_swing = equations::swing(x_b, x_a);
    m_knows_swing = true;
    return m_swing;
  }

  Frame a, b;
  Vec3 d;  ///< p_b - p_a
  Vec3 x_a = a.a(), x_b = b.a();
  Lanes dots = a.dots(b);
  Scalar cosine = dots[0];  ///< of the swing

 private:
  mutable bool m_knows_swing = false;
  mutable equations::Swing<Scalar> m_swing;
};

// How the bodies may turn against each other in this step: by themselves, and (rad) by the motor.
struct ConeTwistModel::Turning {
  AngularReach reach;
  Scalar driven;
  Scalar max = reach.max() + driven;

  Scalar gained() const { return reach.gained() + driven; }
  /// The reach of an angle that moves with J . (w_b - w_a), |J| no longer than `length` in the step.
  Reach along(const Vec3& J, Scalar length) const {
    return {J.dot(reach.moved()), gained() * length};
  }
};

// Unit vectors about which the bodies do not turn against each other.
struct ConeTwistModel::Locks {
  int count = 0;
  Vec3 about[2];
};

inline ConeTwistModel::Observation ConeTwistModel::observe(const PosePair& poses) const {
  return {poses, m_settings.frame_a, m_settings.frame_b};
}

inline void ConeTwistModel::remember(const Observation& seen, bool in_step) {
  m_seen = false;
  if (!in_step) return;
  beginPoseDrive();
  show(seen);
}

// --- what a client reads -------------------------------------------------------------------------

// A load on a limit has broken it in Bullet; here it may be at it to the last bit.
inline void ConeTwistModel::show(const Observation& at) const {
  const auto presses = [&](int axis) { return rows().axis(axis).impulse[Axis::limit] != 0; };
  Scalar twist = 0;
  if (m_settings.twist.span() >= 0) {
    const auto to = at.twist();
    twist = -arctangent(to.y, to.x);
  }
  showAngles(cone(), btFabs(twist), isPastSwingLimit(at) || presses(swing_axis),
             isPastTwistLimit(twist) || presses(twist_axis));
}

ConeTwistReadings ConeTwistModel::look(const PosePair& poses) const {
  const Observation seen = observe(poses);
  const bool is_free = m_settings.twist.span() < 0;
  const Scalar twist = is_free ? Scalar(0) : -equations::twist_angle(seen.twist());
  return {btFabs(twist), isPastSwingLimit(seen), isPastTwistLimit(twist)};
}

inline bool ConeTwistModel::isPastSwingLimit(const Observation& at) const {
  if (m_swings != Swings::cone) return true;
  if (!m_settings.swing_limit.limited() || m_cone_look.isFarInside(at.cosine, 0)) return false;
  const auto& s = at.swing();
  return equations::cone_ratio2(s.sigma.dot(at.b.c()), s.sigma.dot(at.b.b()),
                                spans(m_read.softness)) > 1;
}

inline bool ConeTwistModel::isPastTwistLimit(Scalar twist) const {
  const Axis& axis = m_settings.twist_limit;
  return axis.limited() && axis.distance(inTurnOf(axis, twist)) < 0;
}

Scalar ConeTwistModel::twistNow() const {
  return -equations::twist_angle(observe(BodyPair(bodyA(), bodyB())).twist());
}

Scalar ConeTwistModel::swingNow(int axis) const {
  const Observation now = observe(BodyPair(bodyA(), bodyB()));
  return now.swing().sigma.dot(axis == 1 ? now.b.b() : now.b.c());
}

btVector3 ConeTwistModel::rotationImpulse(Axis::Part part) const {
  Vec3 sum = Vec3::Zero();
  for (int i = rotation_axis; m_rotation && i < axis_count; ++i) {
    const Scalar impulse = axisImpulse(i, part);
    if (impulse == 0) continue;
    // Rows of older steps may lie behind those of this one.
    const Row* row = &rows()[0];
    while (row->axis != i) ++row;
    sum -= impulse * row->A_b;
  }
  return {sum.x(), sum.y(), sum.z()};
}

// --- drawing -------------------------------------------------------------------------------------

btVector3 ConeTwistModel::pointForAngle(Scalar angle_in_cone, Scalar length) const {
  const Scalar about_1 = -btSin(angle_in_cone), about_2 = btCos(angle_in_cone);
  const Scalar angle = btMin(swingRadius(about_1, about_2, 1), Scalar(pi));
  const Scalar across = length * btSin(angle);
  return {length * btCos(angle), about_1 * across, -about_2 * across};
}

void ConeTwistModel::drawJoint(btIDebugDraw& drawer) const {
  const_cast<ConeTwistModel*>(this)->readFromBullet();
  const btTransform A = bodyA().getCenterOfMassTransform() * m_settings.frame_a,
                    B = bodyB().getCenterOfMassTransform() * m_settings.frame_b;
  const btScalar size = cone().getDbgDrawSize();
  drawFrames(drawer, A, B, size);
  if (!drawsLimits(drawer)) return;
  if (m_settings.swing_limit.limited() || m_swings == Swings::locked) {
    constexpr int segments = 32;
    drawCone(drawer, B.getOrigin(), segments,
             [&](int i) { return B * pointForAngle(SIMD_2_PI * Scalar(i) / segments, size); });
  }
  // As Bullet has it: in a where b does not move. There the range of a's own y goes back by the twist.
  const bool in_b = bodyB().getInvMass() > 0;
  const btTransform& tr = in_b ? B : A;
  const Scalar twist = in_b ? Scalar(0) : twistNow();
  const bool held = m_settings.twist_limit.limited();
  drawRange(drawer, tr.getOrigin(), tr.getBasis().getColumn(0), tr.getBasis().getColumn(1), size,
            held ? m_settings.twist.low - twist : 1, held ? m_settings.twist.high - twist : -1);
}

// --- rows ----------------------------------------------------------------------------------------

inline void ConeTwistModel::constrain(const Observation& here, Rows& rows) const {
  const Locks locks = m_swings == Swings::cone ? Locks() : addLocks(here, rows);
  if (!m_settings.angular_only) addPivotRows(here, rows);
  const Scalar driven = addDrive(here, locks, rows);
  const Axis &swing = m_settings.swing_limit, &twist = m_settings.twist_limit;
  if (!swing.limited() && !twist.limited()) return;
  const Turning turning{rows.turn(), driven};
  if (swing.limited())
    isCone(swing) ? addConeLimit(here, turning, rows) : addOneSwingLimit(here, turning, rows);
  if (twist.limited()) addTwistLimit(here, turning, rows);
}

inline void ConeTwistModel::addPivotRows(const Observation& at, Rows& rows) const {
  const equations::Anchors<Scalar> anchors{at.a.r(), at.b.r(), at.d};
  if (getFormulation() == Formulation::document)
    addDocumentPositionRows(anchors, rows);
  else
    addConservingPositionRows(anchors, rows);
}

ConeTwistModel::Locks ConeTwistModel::addLocks(const Observation& at, Rows& rows) const {
  Locks locks;
  if (m_swings != Swings::locked) {
    const Vec3 hinge = m_swings == Swings::only_1 ? at.a.c() : at.a.b();
    const auto row = equations::universal_row(hinge, at.x_b);
    const Scalar curvature = rows.curvature([&](const BodyPair& v) {
      return equations::universal_curvature<Scalar>(hinge, at.x_b, v.w_a(), v.w_b());
    });
    rows.addAngular(row.J_b, row.C, curvature).max_speed = getMaxCorrectionSpeed();
    locks.about[locks.count++] = row.J_b;
    return locks;
  }
  const auto swing = equations::swing(at.x_a, at.x_b);
  for (const Vec3& u : addSwingRows(swing, getMaxCorrectionSpeed(), rows))
    locks.about[locks.count++] = u;
  return locks;
}

// A pose drive takes the place of Bullet's motor, and has friction along.
inline Scalar ConeTwistModel::addDrive(const Observation& at, const Locks& locks,
                                       Rows& rows) const {
  if (hasPoseDrive())
    return addPoseDrive(at.a, at.b, rows, m_rotation ? m_rotation->axis.max_friction : Scalar(0));
  return m_rotation && m_rotation->axis.driven() ? addRotation(at, locks, rows) : Scalar(0);
}

// Motor and friction: about the way to the target, and about two axes across it, so that the motor's
// bound is that of one straight push. Returns how far (rad) the motor turns the bodies in this step.
Scalar ConeTwistModel::addRotation(const Observation& at, const Locks& locks, Rows& rows) const {
  // The way to the target, or the velocity, of b against a.
  Vec3 error = Vec3::Zero(), along = at.x_b, across = at.b.b();
  Scalar length = 0, turn = 0;
  if (m_rotation->axis.drive != Axis::Drive::off) {
    if (m_rotation->axis.drive == Axis::Drive::rate) {
      error = at.b.axes() * -view(m_rotation->velocity);
      length = error.norm();
      turn = rows.advance(length);
    } else {
      error = turnBetween(at.a, at.b.turned(btMatrix3x3(m_rotation->reachable_target)));
      length = error.norm();
      turn = m_rotation->axis.motor_gain * length;
    }
    if (length > near_target) {
      along = error / length;
      across = any_tangent(along);
    }
  }
  int index = rotation_axis;
  const auto add = [&](const Vec3& u) {
    rows.addAngularAxis(index++, u, error.dot(u), m_rotation->axis, false);
  };
  if (locks.count == 2) {
    add(cross(locks.about[0], locks.about[1]));
    return turn;
  }
  if (locks.count == 1) {
    across = locks.about[0];
    along -= along.dot(across) * across;
    const Scalar left = along.norm();
    along = left > near_target ? Vec3(along / left) : any_tangent(across);
  } else {
    add(across);
  }
  add(cross(along, across));
  add(along);
  return turn;
}

// C > 0 outside, and J_a.
inline equations::AngularRow<Scalar> ConeTwistModel::coneRow(
    const Observation& at, const equations::Swing<Scalar>& swing) const {
  const auto e = spans(m_read.softness);
  if (!m_circular)
    return equations::elliptic_cone_row<Scalar>(swing, at.x_b, at.b.c(), at.b.b(), e);
  if (getFormulation() == Formulation::conditioned)
    return equations::cone_row<Scalar>(swing, at.x_b, e.above_1);
  const auto row = equations::cone_dot_row<Scalar>(at.x_b, at.x_a, e.above_1);
  return {-row.J_b, -row.C};
}

inline void ConeTwistModel::addConeLimit(const Observation& at, const Turning& turning,
                                         Rows& rows) const {
  // The edge is no nearer than the smallest span is: no more is asked of a swing that is well inside.
  if (!m_cone_look.isFarInside(at.cosine, turning.max)) addNearConeLimit(at, turning, rows);
}

void ConeTwistModel::addNearConeLimit(const Observation& at, const Turning& turning,
                                      Rows& rows) const {
  const bool spring = m_settings.swing_limit.limit_spring.angular_frequency > 0;
  const auto& s = at.swing();
  const Vec3 e_1 = at.b.c(), e_2 = at.b.b();
  const auto e = spans(m_read.softness);
  const bool document = m_circular && getFormulation() == Formulation::document;
  // Where the bodies will be they have another velocity. The edge is the nearest one there, but in a tip.
  const bool inPlace = rows.inPlace();
  const Scalar far = 1 + far_out / innerSpan();
  const bool ahead =
      rows.inStep() && !spring && !document &&
      equations::cone_ratio2<Scalar>(s.sigma.dot(e_1), s.sigma.dot(e_2), e) < far * far;
  auto row = ahead ? equations::elliptic_cone_row_ahead<Scalar>(
                         s, at.x_b, e_1, e_2, e, Vec3(-turning.reach.moved()),
                         inPlace ? Scalar(0.5) : Scalar(0), turning.gained())
                   : coneRow(at, s);
  if (ahead && !inPlace) {
    const auto nearest = coneRow(at, s);
    if (row.J_b.dot(nearest.J_b) > same_edge * nearest.J_b.norm() * row.J_b.norm()) row = nearest;
  }
  if (turning.along(-row.J_b, row.J_b.norm())
          .of(m_settings.swing_limit)
          .reaches(m_settings.swing_limit, row.C))
    rows.addAngularAxis(swing_axis, -row.J_b, row.C, m_settings.swing_limit, true);
}

// The one swing that is not locked, as body a sees it.
void ConeTwistModel::addOneSwingLimit(const Observation& at, const Turning& turning,
                                      Rows& rows) const {
  const Vec3 hinge = m_swings == Swings::only_1 ? at.a.c() : at.a.b();
  const auto to = equations::angle_about(hinge, at.x_a, at.x_b);
  if (!(to.length > near_target)) return;  // first the lock has to bring it back
  const Vec3 J_b = to.J_b();
  const Scalar angle = inTurnOf(m_settings.swing_limit, -to.angle());
  if (turning.along(-J_b, J_b.norm())
          .of(m_settings.swing_limit)
          .reaches(m_settings.swing_limit, angle))
    addRange(rows, swing_axis, J_b, angle, m_settings.swing_limit);
}

inline void ConeTwistModel::addTwistLimit(const Observation& at, const Turning& turning,
                                          Rows& rows) const {
  const Scalar length = 1 + at.cosine;
  if (!(length > min_twist_length)) return;
  const auto to = at.twist();
  // J_b is no longer than 2 / length.
  if (!m_twist_look.isFarInside(to.x, -to.y, length, 2 * turning.max))
    addNearTwistLimit(at, turning, rows);
}

void ConeTwistModel::addNearTwistLimit(const Observation& at, const Turning& turning,
                                       Rows& rows) const {
  const auto to = at.twist();
  const Vec3 J_b = equations::twist_row(at.x_a, at.x_b);
  const Scalar angle = inTurnOf(m_settings.twist_limit, -arctangent(to.y, to.x));
  const Reach reach = turning.along(-J_b, 2 / (1 + at.cosine)).of(m_settings.twist_limit);
  if (reach.reaches(m_settings.twist_limit, angle))
    addRange(rows, twist_axis, J_b, angle, m_settings.twist_limit);
}

template class ObservedJoint<ConeTwistModel, DrivenJoint>;

}  // namespace PINTLE_PRECISION
}  // namespace pintle

#include <pintle/arctangent.h>
#include <pintle/body_pair.h>
#include <pintle/bullet/stock_limits.h>
#include <pintle/equations/contact.h>
#include <pintle/equations/orientation_lock.h>
#include <pintle/equations/quaternion_hinge_limit.h>
#include <pintle/equations/universal.h>
#include <pintle/frame.h>
#include <pintle/joints/constants.h>
#include <pintle/joints/euler_turn.h>
#include <pintle/joints/observed_joint_rows.h>
#include <pintle/joints/six_dof_model.h>
#include <pintle/joints/turning.h>
#include <pintle/rows/position_rows.h>
#include <pintle/rows/swing_rows.h>

#include <optional>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// Bullet's angles are those of a against b, the equations' of b against a.
constexpr int angle_sign = -1;
constexpr int all_positions = 7, all_angles = 7 << 3;  // bits of axes

// A frame turned in itself.
Frame turnedBy(const Frame& frame, const btMatrix3x3& R, bool is_turned) {
  return is_turned ? frame.turned(R) : frame;
}

// The damper, N s/m, in the place of the damping that Bullet's first spring has: a number from 0 to 1 that bounds the velocity
// towards the rest by 6 / (kg s) times it times the force (fps / iterations, of 60 Hz and 10 iterations), and the force by the
// spring's. Of a body at the rate w = sqrt(k K) of the spring that is v <= rate |x|, and
//   rate > w: it brakes by what is left of the way, by which the amplitude falls in each half period by sqrt((1 - r) / (1 + r)),
//             r = (w / rate)^2: the damping ratio z of pi z / sqrt(1 - z^2) = artanh(r);
//   else:     it creeps as exp(-rate t), the slower root of z = (w / rate + rate / w) / 2.
Scalar damperOf(Scalar fraction, Scalar stiffness, Scalar K) {
  constexpr Scalar bullets_rate = 6, most = Scalar(1e12);
  if (!(stiffness > 0 && K > 0)) return 0;
  const Scalar rate = bullets_rate * fraction * stiffness, w2 = stiffness * K;
  const Scalar r = rate * rate * most > w2 ? w2 / (rate * rate) : most;
  Scalar ratio;
  if (r < 1) {
    const Scalar decay = std::atanh(r);
    ratio = decay / std::sqrt(Scalar(pi * pi) + decay * decay);
  } else {
    ratio = (std::sqrt(r) + 1 / std::sqrt(r)) / 2;
  }
  return 2 * ratio * std::sqrt(stiffness / K);
}

}  // namespace

// Where the joint's frames are, and the angles as they have become there.
struct SixDofModel::Observation {
  const SixDofModel& of;
  Frame a, b;               ///< as set
  Vec3 d;                   ///< from the origin of a to that of b
  Lanes offset;             ///< the same along the axes of a
  Frame turn_a, turn_b;     ///< those that the rotation is held by
  UnwrappedAngle turns[3];  ///< of b against a
  std::optional<EulerTurn> euler = {};

  Scalar sum() const {
    const Lanes dots = a.dots(b);
    return d.sum() + dots[0] + dots[1] + dots[2];
  }
  Vec3 axisA(int i) const { return axisOf(turn_a, i); }
  Vec3 axisB(int i) const { return axisOf(turn_b, i); }
  equations::EulerOrder order() const {
    return {of.m_settings.order[0], of.m_settings.order[1], of.m_settings.order[2]};
  }

  equations::Twist<Scalar> twist() const {
    const int f = of.m_hinge, g = (f + 1) % 3, h = (f + 2) % 3;
    const Vec3 a_g = axisA(g), a_h = axisA(h), b_g = axisB(g), b_h = axisB(h);
    return equations::twist<Scalar>(a_g.dot(b_g), a_h.dot(b_h), a_h.dot(b_g), a_g.dot(b_h));
  }
  equations::Swing<Scalar> swing() const {
    return equations::swing(axisA(of.m_hinge), axisB(of.m_hinge));
  }
  /// A universal joint's: 1 if its axes and the third are cyclic, else -1.
  Scalar crossSign() const { return (of.m_of_a + 1) % 3 == of.m_of_b ? Scalar(1) : Scalar(-1); }
  Scalar crossCosine() const { return axisA(of.m_of_a).dot(axisB(of.m_of_b)); }

  /// Takes the angles over from the pose. `turn`: what the bodies turned by, where that may be more than half a turn.
  void follow(const Vec3* turn);

  /// J_b of the angle about an axis that is not locked, where it has one.
  Vec3 row(int i) const;
  /// rad, of a against b.
  Scalar angle(int i) const {
    if (!euler) return angle_sign * turns[i].value();
    const equations::EulerOrder o = order();
    return angle_sign * euler->value(i == o.first    ? EulerTurn::first
                                     : i == o.middle ? EulerTurn::middle
                                                     : EulerTurn::last);
  }
  /// The part of an angle's unit that its axis is scaled by, so that its row is a unit vector at the start of the step.
  Scalar scale(int i) const {
    if (!euler || i == of.m_settings.order[EulerTurn::middle]) return 1;
    return of.m_scale;
  }
  /// How much shorter the unit vector that a spring of Bullet's turns about is than the gradient of its angle, where that has its
  /// own unit.
  Scalar springCosine(int axis) const {
    if (euler || !of.isOuterAngle(axis)) return 1;
    const int middle = of.middleAngle();
    const Scalar cosine =
        btCos(of.isLocked(middle) ? of.m_read.axes[middle].low : angle(middle - first_angle));
    return cosine * cosine > min_cosine_of_springs * min_cosine_of_springs ? cosine
                                                                           : min_cosine_of_springs;
  }
  equations::Anchors<Scalar> anchors() const { return {a.r(), b.r(), d}; }
};

inline SixDofModel::Observation SixDofModel::observe(const PosePair& poses) const {
  const Frame a(poses.pose_a(), m_settings.frame_a), b(poses.pose_b(), m_settings.frame_b);
  const Vec3 d = equations::position_error(poses.x_a(), a.r(), poses.x_b(), b.r());
  Observation seen{*this,
                   a,
                   b,
                   d,
                   a.components(d),
                   turnedBy(a, m_turn_a, m_is_turned),
                   turnedBy(b, m_turn_b, m_is_turned),
                   {m_turns[0], m_turns[1], m_turns[2]}};
  if (m_turning == Turning::box && (m_acting & all_angles) != 0) seen.euler = *m_euler;
  seen.follow(nullptr);
  return seen;
}

void SixDofModel::Observation::follow(const Vec3* turn) {
  if (euler) {
    euler->update(a, b, order(), of.acts(first_angle + order().first));
  } else if (of.m_turning == Turning::hinge) {
    const auto to = twist();
    if (isSeen(to)) turns[of.m_hinge].update(to.x, to.y);
  } else if (of.m_turning == Turning::universal) {
    const int p = of.m_of_a, q = of.m_of_b, third = 3 - p - q;
    const Vec3 a_p = axisA(p), b_q = axisB(q);
    if (!(crossCosine() * crossCosine() < Scalar(0.99))) return;
    const Scalar s = crossSign();
    const auto take = [&](UnwrappedAngle& angle, Scalar x, Scalar y, const Vec3& axis) {
      turn != nullptr ? angle.update(x, y, axis.dot(*turn)) : angle.update(x, y);
    };
    take(turns[p], axisA(q).dot(b_q), s * axisA(third).dot(b_q), a_p);
    take(turns[q], axisB(p).dot(a_p), s * axisB(third).dot(a_p), b_q);
  }
}

inline Vec3 SixDofModel::Observation::row(int i) const {
  if (euler) {
    const auto rows = euler->rows(a, b, order());
    return i == order().first ? rows.i : i == order().middle ? rows.j : rows.k;
  }
  if (of.m_turning == Turning::hinge) return equations::twist_row(swing());
  const Vec3 a_p = axisA(of.m_of_a), b_q = axisB(of.m_of_b);
  const Scalar cosine = a_p.dot(b_q);
  return (i == of.m_of_a ? a_p - cosine * b_q : b_q - cosine * a_p) / (1 - cosine * cosine);
}

void SixDofModel::remember(Observation& seen, bool in_step) {
  if (m_turning == Turning::hinge) {
    followStep(m_turns[m_hinge], seen.twist(), seen.axisA(m_hinge), seen.axisB(m_hinge), bodyA(),
               bodyB(), timeStep(), angularSpeed());
    seen.turns[m_hinge] = m_turns[m_hinge];
  } else if (m_turning == Turning::universal) {
    if (!turnIsNearest(bodyA(), bodyB(), timeStep(), angularSpeed())) {
      for (int i = 0; i < 3; ++i) seen.turns[i] = m_turns[i];
      const Vec3 turn = turnOfStep(bodyA(), bodyB(), timeStep());
      seen.follow(&turn);
    }
    for (int i = 0; i < 3; ++i) m_turns[i] = seen.turns[i];
  } else if (seen.euler) {
    for (int n = 0; in_step && n < EulerTurn::count; ++n) {
      const StockAxis& axis = m_read.axes[first_angle + m_settings.order[n]];
      // (A spring is not to jump.)
      if (!axis.spring) {
        const bool is_held = m_settings.axes[first_angle + m_settings.order[n]].limited();
        seen.euler->settleWithin(n, is_held ? -axis.high : -infinity,
                                 is_held ? -axis.low : infinity);
      }
      seen.euler->settle(n, settling_speed * timeStep());
    }
    *m_euler = *seen.euler;
  }
  if (!in_step) return;
  beginPoseDrive();
  if (m_has_changing_axes && PosePair::is_finite(seen.sum())) prepareAxes(seen);
  if (m_second != nullptr)
    showPoses(*m_second);
  else
    showPoses(*m_first);
}

// Sets the springs and servos that depend on the pose at the start of the step.
void SixDofModel::prepareAxes(const Observation& seen) {
  const BodyPair pair(bodyA(), bodyB());
  const equations::InverseMass<Scalar> M{pair.inv_mass_a(), pair.inv_mass_b(), pair.inv_inertia_a(),
                                         pair.inv_inertia_b()};
  const auto inverseMass = [&](const equations::Jacobian<Scalar>& J) {
    return equations::inverse_effective_mass(J, M, J);
  };
  if (seen.euler) m_scale = seen.euler->cosine(seen.a, seen.b, seen.order());
  for (int i = 0; i < 6; ++i) {
    if (!acts(i)) continue;
    const StockAxis& axis = m_read.axes[i];
    const bool is_angle = i >= first_angle;
    const Scalar scale = is_angle ? seen.scale(i - first_angle) : Scalar(1);
    setAxis(i, scale);
    if (axis.spring) {
      const Scalar stiffness = axis.stiffness / scale;
      Scalar damping = axis.damping;
      if (m_read.damping_is_fraction) {
        const Vec3 row = is_angle ? Vec3(scale * seen.row(i - first_angle)) : axisOf(seen.a, i);
        damping =
            damperOf(axis.damping, stiffness,
                     inverseMass(is_angle ? equations::Jacobian<Scalar>{Vec3::Zero(), row, row}
                                          : equations::contact_row(row, seen.anchors()).J));
      }
      setSpring(i, stiffness, damping, seen.springCosine(i));
    }
    if (!(is_angle && axis.motor && axis.servo)) continue;
    // The nearest way.
    Scalar& target = m_settings.axes[i].servo_target;
    const Scalar way = scale * seen.angle(i - first_angle) - target, turn = scale * SIMD_2_PI;
    if (!m_settings.axes[i].limited()) target += turn * std::round(way / turn);
  }
}

Scalar SixDofModel::angleOf(int index) const {
  if (m_turning != Turning::box || (m_acting & all_angles) == 0)
    return angle_sign * m_turns[index].value();
  for (int n = 0; n < EulerTurn::count; ++n)
    if (m_settings.order[n] == index) return angle_sign * m_euler->value(n);
  return 0;
}

Scalar SixDofModel::accumulatedAngle(int axis) {
  readFromBullet();
  const BodyPair pair(bodyA(), bodyB());
  if (pair.finite()) updateState(pair);
  return angleOf(axis - first_angle);
}

void SixDofModel::turnTowardsLimit(int angle) {
  const StockAxis& axis = m_read.axes[first_angle + angle];
  if (!(axis.low < axis.high && axis.high - axis.low < SIMD_2_PI)) return;
  const Scalar middle = angle_sign * (axis.low + axis.high) / 2;
  if (m_turning != Turning::box) return m_turns[angle].turnTowards(middle);
  for (int n = 0; n < EulerTurn::count; ++n)
    if (m_settings.order[n] == angle) m_euler->turnTowards(n, middle);
}

void SixDofModel::resetAngles(const Scalar (&last)[3]) {
  *m_euler = EulerTurn();
  for (UnwrappedAngle& angle : m_turns) angle = {};
  const BodyPair pair(bodyA(), bodyB());
  const auto look = [&] {
    Observation seen = observe(pair);
    if (!pair.finite() || !PosePair::is_finite(seen.sum())) return;
    for (int i = 0; i < 3; ++i) m_turns[i] = seen.turns[i];
    if (seen.euler) *m_euler = *seen.euler;
  };
  const auto turn = [&] {
    for (int i = 0; i < 3; ++i) {
      m_turns[i].turnTowards(angle_sign * last[i]);
      for (int n = 0; n < EulerTurn::count; ++n)
        if (m_settings.order[n] == i) m_euler->turnTowards(n, angle_sign * last[i]);
      turnTowardsLimit(i);
    }
  };
  // How far the angles are out of their limits.
  const auto excess = [&] {
    Scalar sum = 0;
    for (int i = 0; i < 3; ++i) {
      const StockAxis& axis = m_read.axes[first_angle + i];
      sum += btFabs(beyond(angleOf(i), axis.low, axis.high));
    }
    return sum;
  };
  look();
  turn();
  if (m_turning != Turning::box || (m_acting & all_angles) == 0) return;
  const Scalar on_this_side = excess();
  if (!(on_this_side > 0)) return;
  const EulerTurn first = *m_euler;
  m_euler->changeSide();
  look();
  turn();
  if (excess() >= on_this_side) *m_euler = first;
}

// --- rows ----------------------------------------------------------------------------------------

inline void SixDofModel::constrain(const Observation& seen, Rows& rows) const {
  if (m_turning != Turning::box) addTurnLocks(seen, rows);
  if ((m_locked & all_positions) != 0) addPositionLocks(seen, rows);
  const bool turns = (m_acting & all_angles) != 0, travels = (m_acting & all_positions) != 0;
  const Scalar driven = hasPoseDrive() && m_turning != Turning::locked
                            ? addPoseDrive(seen.a, seen.b, rows)
                            : Scalar(0);
  // As Bullet has them: the last one's impulse is known.
  if (travels && !m_read.frame_offset) addPositions(seen, rows);
  if (turns) addAngles(seen, driven, rows);
  if (travels && m_read.frame_offset) addPositions(seen, rows);
}

void SixDofModel::addTurnLocks(const Observation& seen, Rows& rows) const {
  if (m_turning == Turning::locked) return addLock(seen, rows);
  if (m_turning == Turning::universal) return addUniversalRow(seen, rows);
  const int locked = m_hinge == 0 ? 1 : 0;  // the first one's ERP and CFM are those of both
  addSwingRows(seen.swing(), getMaxCorrectionSpeed(), rows, group(first_angle + locked));
}

void SixDofModel::addLock(const Observation& seen, Rows& rows) const {
  const Vec3 phi = turnBetween(seen.turn_a, seen.turn_b);
  const Vec3 curvature = rows.curvature([](const BodyPair& v) {
    return Vec3(equations::orientation_curvature<Scalar>(v.w_a(), v.w_b()));
  });
  const Scalar angle = btSqrt(phi.dot(phi));
  const Scalar speed_per_error = angle > 0 ? getMaxCorrectionSpeed() / angle : Scalar(0);
  for (int i = 0; i < 3; ++i) {
    // Along the world's axes, but where each has an ERP or a CFM of its own.
    const Vec3 u = m_erp_cfm_differs ? seen.axisA(i) : Vec3(Vec3::Unit(i));
    Row& row = rows.addAngular(u, u.dot(phi), u.dot(curvature));
    row.max_speed = speed_per_error * btFabs(row.position);
    row.group = group(first_angle + i);
  }
}

void SixDofModel::addUniversalRow(const Observation& seen, Rows& rows) const {
  const Vec3 z = seen.axisA(m_of_a), y = seen.axisB(m_of_b);
  const auto row = equations::universal_row(z, y);
  const Scalar curvature = rows.curvature([&](const BodyPair& v) {
    return equations::universal_curvature<Scalar>(z, y, v.w_a(), v.w_b());
  });
  Row& added = rows.addAngular(row.J_b, row.C - m_bend, m_bend == 0 ? curvature : Scalar(0));
  added.max_speed = getMaxCorrectionSpeed();
  added.group = group(first_angle + 3 - m_of_a - m_of_b);
}

void SixDofModel::addAngles(const Observation& seen, Scalar driven, Rows& rows) const {
  if (m_turning == Turning::universal &&
      seen.crossCosine() * seen.crossCosine() > max_cross_cosine2)
    return;
  if (m_turning == Turning::hinge && !(seen.swing().h_scale < max_h_scale)) return;
  const AngularReach reach = rows.turn();
  for (int n = 0; n < EulerTurn::count; ++n) {
    const int i = m_settings.order[n];
    if (!acts(first_angle + i)) continue;
    const Axis& axis = m_settings.axes[first_angle + i];
    const Scalar scale = seen.scale(i), angle = scale * seen.angle(i);
    const Vec3 J_b = scale * seen.row(i);
    const Reach along =
        Reach{angle_sign * J_b.dot(reach.moved()), (reach.gained() + driven) * J_b.norm()}.of(axis);
    const bool limit = axis.limited() && along.reaches(axis, angle);
    if (!limit && !axis.driven()) continue;
    rows.addAngularAxis(first_angle + i, J_b, angle, axis, limit, angle_sign);
    if (m_turning == Turning::hinge) rows.shape(RowShape::turn);
  }
}

void SixDofModel::addPositionLocks(const Observation& seen, Rows& rows) const {
  equations::Anchors<Scalar> at = seen.anchors();
  if (m_is_shifted) {
    const Vec3 shift = seen.a.axes() * view(m_shift);
    at = {at.r_a + shift, at.r_b, at.d - shift};
  }
  const bool all = (m_locked & all_positions) == all_positions;
  if (all && getFormulation() == Formulation::document) return addDocumentPositionRows(at, rows);
  if (all && !m_erp_cfm_differs) return addConservingPositionRows(at, rows);
  const Vec3 bend = rows.curvature([&](const BodyPair& v) {
    return Vec3(
        equations::position_curvature_conserving<Scalar>(at, {v.v_a(), v.w_a(), v.v_b(), v.w_b()}));
  });
  for (int i = 0; i < 3; ++i) {
    if (!isLocked(i)) continue;
    const Vec3 u = axisOf(seen.a, i);
    const auto row = equations::contact_row(u, at);
    rows.addEquality(row.J.L, row.J.A_a, row.J.A_b, row.C, u.dot(bend)).group = group(i);
  }
}

void SixDofModel::addPositions(const Observation& seen, Rows& rows) const {
  const equations::Anchors<Scalar> at = seen.anchors();
  const Vec3 lever_a = at.r_a + at.d;
  const Lanes bend = seen.a.components(rows.curvature([&](const BodyPair& v) {
    return Vec3(
        equations::position_curvature_conserving<Scalar>(at, {v.v_a(), v.w_a(), v.v_b(), v.w_b()}));
  }));
  const Vec3 moved = rows.moved([&](const BodyPair& v) {
    return Vec3(equations::relative_velocity<Scalar>({v.v_a(), v.w_a(), v.v_b(), v.w_b()}, lever_a,
                                                     at.r_b));
  });
  for (int i = 0; i < 3; ++i) {
    if (!acts(i)) continue;
    const Axis& axis = m_settings.axes[i];
    const Vec3 u = axisOf(seen.a, i);
    const Reach reach = rows.slide(u.dot(moved), lever_a, at.r_b, bend[i]);
    const bool limit = axis.limited() && reach.of(axis).reaches(axis, seen.offset[i]);
    if (!limit && !axis.driven()) continue;
    const auto J = equations::contact_row(u, at).J;
    rows.addAxis(i, J.L, J.A_a, J.A_b, seen.offset[i], axis, limit).curvature = bend[i];
  }
}

template class ObservedJoint<SixDofModel, DrivenJoint>;

}  // namespace PINTLE_PRECISION
}  // namespace pintle

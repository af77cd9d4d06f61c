#include <pintle/joints/bullet_rows.h>

#include <pintle/body_pair.h>
#include <pintle/equations/effective_mass.h>
#include <pintle/joints/constants.h>
#include <pintle/joints/joint.h>
#include <pintle/joints/solver_rows.h>
#include <pintle/row_writer.h>
#include <pintle/rows/axis_part.h>
#include <pintle/rows/block.h>

#include <algorithm>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// An impulse that is given, as that of a soft spring, does not see what other joints do to its coordinate
// in the step. They are going to do again what they did; half of what has changed is taken over in a
// step, as springs that bear on each other would else answer each other for ever, and next to nothing
// of what was not there before, which may be a blow.
Scalar carryOver(Scalar now, Scalar before) {
  const bool agree = now * before > min_speed * min_speed;
  return agree ? (now + before) / 2 : now / 16;
}

// J v at the end of the step, if nothing acted along the row.
Scalar freeVelocity(const Lanes& L, const Lanes& A_a, const Lanes& A_b, const btRigidBody& a,
                    const btRigidBody& b, Scalar dt) {
  return L.head<3>().matrix().dot(freeLinear(b, dt) - freeLinear(a, dt)) -
         A_a.head<3>().matrix().dot(freeAngular(a, dt)) +
         A_b.head<3>().matrix().dot(freeAngular(b, dt));
}

// Turns so much more easily about one axis than about another that the other is lost in the rounding
// of I^-1: rows that are made orthogonal by it are not, and need not converge.
bool isNeedle(const btRigidBody& body) {
  const btVector3& I = body.getInvInertiaDiagLocal();
  return rounding_of_K * btMax(btMax(I[0], I[1]), I[2]) > btMin(btMin(I[0], I[1]), I[2]);
}

// True if J M^-1 J^T of a row is nothing but the rounding of I^-1 in the world, R I^-1 R^T. An impulse
// along it would turn the bodies anywhere, and further in each pass.
bool isRounding(const Row& row, const BodyPair& pair) {
  const auto product = [](const Vec3& x, const MatrixView& M, const Vec3& y) {
    return x.dot(M * y);
  };
  const auto largest = [](const Vec3& x, const MatrixView& M) {
    return x.cwiseAbs().dot(M.cwiseAbs() * x.cwiseAbs());
  };
  const Scalar linear = (pair.inv_mass_a() + pair.inv_mass_b()) * row.L.dot(row.L);
  const Scalar K = linear + product(row.A_a, pair.inv_inertia_a(), row.A_a) +
                   product(row.A_b, pair.inv_inertia_b(), row.A_b);
  const Scalar terms =
      largest(row.A_a, pair.inv_inertia_a()) + largest(row.A_b, pair.inv_inertia_b());
  return !(K > 8 * SIMD_EPSILON * terms);
}

// True if the two may collide with each other, and their boxes overlap.
bool mayTouch(const btRigidBody& a, const btRigidBody& b) {
  const btBroadphaseProxy *in_a = a.getBroadphaseHandle(), *in_b = b.getBroadphaseHandle();
  if (in_a == nullptr || in_b == nullptr) return false;
  const bool collide = (in_a->m_collisionFilterGroup & in_b->m_collisionFilterMask) != 0 &&
                       (in_b->m_collisionFilterGroup & in_a->m_collisionFilterMask) != 0;
  for (int i = 0; i < 3; ++i)
    if (in_a->m_aabbMin[i] > in_b->m_aabbMax[i] || in_b->m_aabbMin[i] > in_a->m_aabbMax[i])
      return false;
  return collide && a.checkCollideWith(&b) && b.checkCollideWith(&a);
}

// The rows of what acts along an axis, all along the same J; `target`: what their own targets are added to.
inline void writeParts(RowWriter& out, const AxisState& axis, const Lanes& L, const Lanes& A_a,
                       const Lanes& A_b, Scalar target, const AxisRow (&parts)[Axis::parts]) {
  for (const Axis::Part i : Axis::each_part)
    if (axis.row[i] >= 0)
      out.write(L, A_a, A_b, target + parts[i].target, parts[i].cfm, parts[i].lower,
                parts[i].upper);
}

bool hasSoftness(const AxisRow (&parts)[Axis::parts]) {
  return std::any_of(parts, parts + Axis::parts, [](const AxisRow& part) { return part.cfm > 0; });
}

}  // namespace

// Numbers that all rows of a joint share in a step.
struct BulletRows::Step {
  BodyPair pair;
  Scalar dt, fps;
  Scalar limit_erp;  ///< unless the limit has its own
  Scalar rate[Joint::max_groups],
      cfm[Joint::max_groups];  ///< of equalities: erp / dt, and softness
  bool rigid;                  ///< no equality is soft
  bool is_needle;              ///< one of the bodies
  Scalar curved_time;          ///< s: with the curvature, what it adds to a mean velocity
  ImpulseSetting setting;

  Step(const Joint& joint, const Info2& info, Scalar default_cfm, Scalar curved)
      : pair(joint.bodyA(), joint.bodyB()),
        dt(1 / info.fps),
        fps(info.fps),
        is_needle(isNeedle(joint.bodyA()) || isNeedle(joint.bodyB())),
        curved_time(curved),
        setting(joint.impulseSetting()) {
    limit_erp = joint.m_erp.orElse(info.erp);
    rate[0] = limit_erp * fps;
    cfm[0] = joint.m_cfm.orElse(default_cfm);
    rigid = cfm[0] == 0;
    if (joint.m_erp_cfm_differs) setGroups(joint, info, default_cfm);
  }

  void setGroups(const Joint& joint, const Info2& info, Scalar default_cfm) {
    rigid = true;
    const ErpCfm* const all = joint.groups();
    for (int i = 0; i < Joint::max_groups; ++i) {
      const ErpCfm& group = all[i];
      rate[i] = group.factor * group.erp.orElse(info.erp) * fps;
      cfm[i] = group.cfm.orElse(default_cfm);
      rigid = rigid && cfm[i] == 0;
    }
  }

  // True if Bullet's iteration would diverge for an equality.
  bool tooSoft(const Joint& joint) const {
    const int n = joint.m_erp_cfm_differs ? Joint::max_groups : 1;
    return !std::all_of(cfm, cfm + n, [](Scalar c) { return c < diverging_cfm; });
  }

  // True if the passes leave its equalities at their targets: a soft row is not to end there, and a damped one will not.
  bool hasExactPasses() const { return rigid && setting.damping == 1; }

  // The contribution of the curvature to the mean velocity of the row in this step.
  Scalar gain(const Row& row) const { return curved_time * row.curvature; }

  // True for a row of a gap, whose speed of correction boundClosing bounds.
  bool closes(const Row& row) const { return !(row.max_speed < infinity); }

  // The velocity that takes away the part erp of C (2.3).
  Scalar closing(const Row& row) const { return -rate[row.group] * row.position; }
  // The same within the largest speed of the row.
  Scalar correction(const Row& row) const {
    const Scalar away = closing(row);
    const Scalar speed = btFabs(away) > min_speed ? away : Scalar(0);
    return btMax(-row.max_speed, btMin(speed, row.max_speed));
  }
};

BulletRows::BulletRows(Joint& joint)
    : m_joint(joint),
      m_rows(joint.m_rows),
      m_are_plain(false),
      m_remembers(false),
      m_starts_warm(false),
      m_shows_passes(false),
      m_acts_in_each(false),
      m_rests(false) {}

void BulletRows::beginStep() {
  m_solver_rows = nullptr;
  // A solver that did not show its passes, or not all: what is remembered is old.
  if (m_passes_left > 0) m_remembers = false;
  if (m_passes_left > 0 && m_passes_left == m_passes) m_shows_passes = false;
  m_starts_warm = m_rests = false;
  m_passes = m_passes_left = 0;
}

void BulletRows::startAnew() {
  m_remembers = false;
  m_gap = -1;
}

void BulletRows::announce(Info1& info, int room) {
  m_joint.beginStep();
  const int before = m_rows.equalities();
  m_rows.clear();
  const BodyPair pair(m_joint.bodyA(), m_joint.bodyB());
  const StepMotion now = m_joint.motion(pair);
  Rows rows(m_rows, now);
  if (pair.finite()) m_joint.prepare(pair, rows);
  m_rows = rows;
  // Other rows: what is remembered is not theirs.
  if (m_rows.equalities() != before) m_remembers = false;
  m_rows.truncate(room);
  place(room);
  info.m_numConstraintRows = m_count;
  info.nub = 0;
}

// Gives each part of each axis its place among Bullet's rows, of which there are so many.
void BulletRows::place(int room) {
  int n = m_rows.equalities();
  for (int i = n; i < m_rows.size(); ++i) {
    AxisState& state = m_rows.axis(m_rows[i].axis);
    const Axis& axis = *state.axis;
    const auto place = [&](Axis::Part part, bool acts) {
      state.row[part] = static_cast<signed char>(acts && n < room ? n++ : -1);
    };
    place(Axis::spring_pull, axis.spring.isSet());
    place(Axis::spring_yield, axis.spring.isSet() && state.yields);
    place(Axis::friction, axis.max_friction > 0);
    place(Axis::motor, axis.drive != Axis::Drive::off);
    place(Axis::limit, m_rows[i].limit);
  }
  m_count = static_cast<signed char>(n);
}

// s: with the curvature of a row it is what that adds to its mean velocity in this step: half the step, of a motion that goes on as it does. It
// goes with the square of the angular velocity at the end of the step, which is about as much more than that at its start as the last step added.
// (A solver of all joints at once finds the end of the step by itself.)
inline Scalar BulletRows::curvedTime() const {
  if (m_are_plain) return 0;
  const Scalar half = Scalar(0.5) * m_joint.m_time_step;
  if (m_joint.m_foresees_curvature) return half;
  const Scalar w = m_joint.m_angular_speed, last = m_joint.m_last_angular_speed;
  Scalar change = 1;
  if (last > 0 && w > 0) change = btMax(1 / max_spin_change, btMin(2 - last / w, max_spin_change));
  return half * m_joint.curvedPart() * (change * change);
}

// Gives each equality the velocity that takes its error away.
inline void BulletRows::correct(const Step& step) {
  Scalar gap2 = 0, other2 = 0;
  for (int i = 0; i < m_rows.equalities(); ++i) {
    Row& row = m_rows[i];
    row.target = m_are_plain ? step.closing(row) : step.correction(row);
    (step.closes(row) ? gap2 : other2) += row.position * row.position;
  }
  if (!m_are_plain) boundClosing(step, btSqrt(gap2), btSqrt(other2));
}

// A gap closes at less than ERP asks for, and at no more than the largest speed, in two cases: the joint starts apart; or contacts between its bodies
// may be what holds it open, which do not yield: what joint and contact ask of each other in vain becomes energy. (An error of orientation has a
// largest speed in any step: Row::max_speed.)
inline void BulletRows::boundClosing(const Step& step, Scalar gap, Scalar other) {
  const Scalar last = m_gap, rate = step.rate[0], speed = rate * gap;
  m_gap = gap;
  const Scalar largest = m_joint.m_max_linear_correction_speed;
  if (!(speed > apart_fraction * largest ||
        rate * other > apart_fraction * m_joint.m_max_correction_speed)) {
    m_start_left = 0;
    return;
  }
  const Scalar bound = btMax(largest, gap / longest_start);
  if (last < 0 || (speed > largest && isPutApart(step, last, bound)))
    m_start_left = longest_start;
  else
    m_start_left = btMax(Scalar(0), m_start_left - step.dt);
  if (!(m_start_left > 0) && !(speed > bound && mayTouch(m_joint.bodyA(), m_joint.bodyB()))) return;
  const Scalar times = speed / bound;
  const Scalar part = times < infinity ? 1 / btSqrt(1 + times * times) : Scalar(0);  // also NaN
  for (int i = 0; i < m_rows.equalities(); ++i)
    if (step.closes(m_rows[i])) m_rows[i].target *= part;
}

// Between bodies that move, a gap that no velocity explains is a start, too: one of them has been put elsewhere, or the
// joint back into the world.
PINTLE_NOINLINE bool BulletRows::isPutApart(const Step& step, Scalar last_gap,
                                            Scalar max_speed) const {
  const BodyPair& pair = step.pair;
  if (!(pair.inv_mass_a() > 0 && pair.inv_mass_b() > 0)) return false;
  // J v, whichever way the bodies have turned in the step.
  const Scalar v = (pair.v_b() - pair.v_a()).norm(), w_a = pair.w_a().norm(),
               w_b = pair.w_b().norm();
  Scalar speed2 = 0;
  for (int i = 0; i < m_rows.equalities(); ++i) {
    const Row& row = m_rows[i];
    if (!step.closes(row)) continue;
    const Scalar largest = row.L.norm() * v + row.A_a.norm() * w_a + row.A_b.norm() * w_b;
    speed2 += largest * largest;
  }
  return m_gap > last_gap + (max_speed + 2 * btSqrt(speed2)) * step.dt;
}

// Adds to the corrections what the bend of the rows asks for: J v says how C moves to first order; Bullet then turns the
// bodies by more than that, and the curvature is what it adds in a step. With it a turning joint does not drift. (All at
// once: a lane that is read just after a number of it was written waits for that.)
inline void BulletRows::aim(const Step& step) {
  for (int i = 0; i < m_rows.equalities(); ++i) m_rows[i].target -= step.gain(m_rows[i]);
}

// The parts that act along an axis in this step. `orthogonal` is its row after the elimination in `block`,
// whose target is what the equalities' targets came to in it; both null: as it stands.
inline void BulletRows::act(Row& row, const BlockRow* orthogonal, const Block* block,
                            const Step& step, AxisRow (&parts)[Axis::parts]) {
  AxisState& state = m_rows.axis(row.axis);
  const Axis& axis = *state.axis;
  const Scalar sign = state.sign;
  state.acted = true;
  state.incoming = 0;
  const BodyPair& pair = step.pair;
  AxisMotion motion = m_joint.axisMotion(row, state, pair, step.fps, step.limit_erp);
  // All velocities of an axis are means over the step, and so is the target that comes of them.
  motion.gain = step.gain(row);
  motion.velocity = motion.gain + sign * (row.angular ? row.A_b.dot(pair.w_b() - pair.w_a())
                                                      : velocity(row, pair.v_b() - pair.v_a(),
                                                                 pair.w_a(), pair.w_b()));
  const Scalar softest = row.limit ? btMax(motion.limit_cfm, motion.motor_cfm) : motion.motor_cfm;
  if (axis.isSoft(row.limit) || !(softest < diverging_cfm)) {
    // A copy of its own: the one here need not lie in memory for all that are rigid.
    AxisMotion soft = motion;
    state.given = solveSoft(row, orthogonal, block, step, soft, parts);
  } else {
    if (axis.drive != Axis::Drive::off) parts[Axis::motor] = motorPart(axis, motion).row;
    if (axis.max_friction > 0) parts[Axis::friction] = frictionPart(axis, motion).row;
    if (row.limit) parts[Axis::limit] = limitPart(axis, motion, state.incoming).row;
  }
  row.target = sign * (parts[Axis::limit].target - motion.gain);
  for (const Axis::Part i : Axis::each_part) {
    AxisRow& part = parts[i];
    part.target -= motion.gain;
    // From along the coordinate to along J.
    if (sign < 0) part = {-part.target, part.cfm, -part.upper, -part.lower};
  }
}

PINTLE_FLATTEN void BulletRows::write(Info2& info) {
  m_last_dt = m_joint.m_time_step;
  m_joint.m_time_step = 1 / info.fps;
  const int n = m_rows.size();
  if (n == 0) return;
  m_solver_rows = solverRows(info);
  RowWriter out(info);
  const Step step(m_joint, info, out.cfm(), curvedTime());
  info.m_damping = step.setting.damping;
  correct(step);
  aim(step);

  const int equalities = m_rows.equalities();
  if (const AxisState* const axis = onlyAxis()) m_last_limit_impulse = axis->impulse[Axis::limit];
  for (int i = 0; i < m_rows.axisCount(); ++i) m_rows.axis(i).impulse = {};
  if (step.is_needle || (!step.rigid && !m_are_plain && step.tooSoft(m_joint)))
    return writeDelicate(info, step);
  // Bullet compares a threshold with single rows, which are those of the joint if they are not mixed. Where its passes
  // are shown, breakIfOverloaded compares it with the load.
  const bool may_mix = !(step.setting.max_impulse < infinity) &&
                       (!m_joint.breakable() || (m_shows_passes && step.hasExactPasses()));
  // Rows that are orthogonal within a joint serve a solver that takes one by one.
  if (!m_joint.m_block_rows || m_are_plain || !may_mix) return writePlain(info, step);

  Block block(step.pair);
  for (int i = 0; i < equalities; ++i) block.add(m_rows[i]);
  // Rows that say the same, or contradict each other, as in games of two dimensions: the passes share out what they ask for.
  if (!block.independent()) return writePlain(info, step);
  for (int i = 0; i < equalities; ++i) {
    const BlockRow& to = block[i];
    out.write(to.L, to.A_a, to.A_b, to.target(), step.cfm[m_rows[i].group], -infinity, infinity);
  }
  // Several axes are not orthogonal among themselves, and so are iterated: with a remainder of
  // rounding errors that does not end well. One alone takes no harm.
  const bool several = n > equalities + 1;
  for (int i = equalities; i < n; ++i) {
    BlockRow to;
    m_rows[i].target = 0;
    if (several)
      block.orthogonalize(to, m_rows[i]);
    else
      block.eliminate(to, m_rows[i]);
    AxisRow parts[Axis::parts];
    act(m_rows[i], &to, &block, step, parts);
    writeParts(out, m_rows.axis(m_rows[i].axis), to.L, to.A_a, to.A_b, to.target(), parts);
  }
  if (step.hasExactPasses()) beginPasses(info);
}

// Rows as they stand.
PINTLE_NOINLINE void BulletRows::writePlain(Info2& info, const Step& step) {
  RowWriter out(info);
  const Scalar bound = step.setting.max_impulse;
  const int equalities = m_rows.equalities();
  for (int i = 0; i < equalities; ++i) {
    const Row& row = m_rows[i];
    out.write(row.lanesL(), row.lanesA_a(), row.lanesA_b(), row.target, step.cfm[row.group], -bound,
              bound);
  }
  for (int i = equalities; i < m_rows.size(); ++i) {
    Row& row = m_rows[i];
    AxisRow parts[Axis::parts];
    const bool soft = m_rows.axis(row.axis).axis->isSoft(row.limit);
    if (!soft) act(row, nullptr, nullptr, step, parts);
    if (soft || hasSoftness(parts)) actBesideEqualities(row, step, parts);
    writeParts(out, m_rows.axis(row.axis), row.lanesL(), row.lanesA_a(), row.lanesA_b(), 0, parts);
  }
}

// Plain rows move as the equalities let them, too. Softness is a fraction of the K that is left then, of
// which the solver does not know.
PINTLE_NOINLINE void BulletRows::actBesideEqualities(Row& row, const Step& step,
                                                     AxisRow (&parts)[Axis::parts]) {
  Block block(step.pair);
  for (int i = 0; i < m_rows.equalities(); ++i) block.add(m_rows[i]);
  BlockRow plain, orthogonal;
  row.target = 0;
  Block::take(plain, row);
  block.weigh(plain);
  block.eliminate(orthogonal, row);
  block.weigh(orthogonal);
  act(row, &orthogonal, &block, step, parts);
  if (!(plain.K > orthogonal.K)) return;
  for (const Axis::Part i : Axis::each_part) parts[i].cfm *= orthogonal.K / plain.K;
}

// Plain rows of needles, and such of which an equality is so soft that Bullet's iteration would diverge: it
// is written as a rigid row, to where the soft one would come by itself.
PINTLE_NOINLINE void BulletRows::writeDelicate(Info2& info, const Step& step) {
  RowWriter out(info);
  const btRigidBody &a = m_joint.bodyA(), &b = m_joint.bodyB();
  for (int i = 0; i < m_rows.size(); ++i) {
    Row& row = m_rows[i];
    const LanesView L = row.lanesL(), A_a = row.lanesA_a(), A_b = row.lanesA_b();
    if (row.axis >= 0) {
      AxisRow parts[Axis::parts];
      act(row, nullptr, nullptr, step, parts);
      writeParts(out, m_rows.axis(row.axis), L, A_a, A_b, 0, parts);
      continue;
    }
    Scalar cfm = step.cfm[row.group], target = row.target;
    if (!m_are_plain && !(cfm < diverging_cfm)) {
      // Bullet takes this part of the free velocity away.
      const Scalar free = step.setting.damping * freeVelocity(L, A_a, A_b, a, b, step.dt);
      target = free + (target - free) / (1 + cfm);
      cfm = 0;
    }
    const Scalar bound =
        step.is_needle && isRounding(row, step.pair) ? Scalar(0) : step.setting.max_impulse;
    out.write(L, A_a, A_b, target, cfm, -bound, bound);
  }
}

bool BulletRows::solveSoft(Row& row, const BlockRow* orthogonal, const Block* block,
                           const Step& step, AxisMotion& motion, AxisRow (&parts)[Axis::parts]) {
  const BodyPair& pair = step.pair;
  BlockRow alone;
  if (orthogonal != nullptr) {
    alone = *orthogonal;
    block->weigh(alone);
  } else {
    Block::take(alone, row);
    Block(pair).weigh(alone);
  }
  // A coordinate that the bodies' factors hold (2D games) has a K of rounding errors. One of less than epsilon
  // Bullet's solver passes over: where it does not hold the joint, a spring is not to pull at it alone.
  const equations::InverseMass<Scalar> M{pair.inv_mass_a(), pair.inv_mass_b(), pair.inv_inertia_a(),
                                         pair.inv_inertia_b()};
  const equations::Jacobian<Scalar> J{row.L, row.A_a, row.A_b};
  const Scalar own = equations::inverse_effective_mass(J, M, J);
  const Scalar passed_over = m_are_plain ? Scalar(0) : SIMD_EPSILON;
  motion.K = alone.K > btMax(rounding_of_K * own, passed_over) ? alone.K : Scalar(0);
  AxisState& state = m_rows.axis(row.axis);
  const Scalar free =
      freeVelocity(alone.L, alone.A_a, alone.A_b, m_joint.bodyA(), m_joint.bodyB(), step.dt);
  motion.free_velocity = motion.gain + Scalar(state.sign) * (free - alone.target());
  if (state.seen) {
    state.foreseen_disturbance = carryOver(state.disturbance, state.foreseen_disturbance);
    state.seen = false;
    state.foreseen = true;
  } else if (!state.foreseen) {
    state.foreseen_disturbance = 0;
  }
  const Scalar alone_velocity = motion.free_velocity - motion.gain;
  motion.free_velocity += state.foreseen_disturbance;
  const bool given = solveAxis(*state.axis, motion, state, parts);
  state.K = motion.K;
  state.expected = alone_velocity;
  for (const Axis::Part i : Axis::each_part)
    if (parts[i].lower == parts[i].upper) state.expected += motion.K * parts[i].upper;
  return given;
}

void BulletRows::writeAt(Info2& info, const btTransform& pose_a, const btTransform& pose_b) {
  btRigidBody &a = m_joint.bodyA(), &b = m_joint.bodyB();
  if (!(pose_a == a.getCenterOfMassTransform() && pose_b == b.getCenterOfMassTransform())) {
    const int announced = m_count;
    m_rows.clear();
    const BodyPair pair(a, pose_a, b, pose_b);
    const StepMotion now = m_joint.motion(pair);
    Rows rows(m_rows, now);
    if (pair.finite()) m_joint.addRows(pair, rows);
    m_rows = rows;
    // Bullet has no room for more.
    m_rows.truncate(announced);
    place(announced);
  }
  write(info);
}

Scalar BulletRows::axisImpulse(int axis, int part) const {
  const AxisState& state = m_rows.axis(axis);
  if (!state.acted || m_rows.size() == 0) return 0;
  const bool last = state.row[size_t(part)] == m_count - 1;
  return last ? -state.sign * m_joint.constraint().internalGetAppliedImpulse()
              : state.impulse[size_t(part)];
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

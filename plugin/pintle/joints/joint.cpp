#include <pintle/joints/joint.h>
#include <pintle/joints/joint_passes.h>

#include <pintle/body_pair.h>
#include <pintle/equations/effective_mass.h>
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
  return agree(now, before) ? (now + before) / 2 : now / 16;
}

// A joint starts apart if it is to be corrected at more than this part of its largest speeds of correction. Until it has
// come together it begins each step from nothing.
constexpr Scalar apart_fraction = Scalar(0.1);

// s, about: longer than so many no gap is to take, of however many metres.
constexpr Scalar longest_closing = 1;

// What the passes of the last step left along a row is going to be left again as far as it is a load: the target
// makes up for this part of it. Joints that fight each other for good then ask for 1 / (1 - feed_forward) times what
// they would: bounded.
constexpr Scalar feed_forward = Scalar(0.6);

// A bend that changed by more than this part of itself in the last step was hit, and may be hit again: so much less of it
// is foreseen. With this part the joints of 50 rope bridges give crates that fall on them less energy than stock joints
// do, at 60 to 240 Hz, and a pendulum's joint is open by 1e-5 m (tests/bench/frames.cpp).
constexpr Scalar smooth = Scalar(0.2);

// Bullet iterates a soft row by lambda <- rhs - cfm lambda: from here on it diverges.
constexpr Scalar diverging_cfm = 1;

// Of body a about an angular row, or of b if a cannot turn; Bullet's bounds have only a's, and none
// for a body of no inertia.
Scalar motorInertia(const Row& row, const BodyPair& pair) {
  const Scalar a = row.A_a.dot(pair.inv_inertia_a() * row.A_a),
               b = row.A_b.dot(pair.inv_inertia_b() * row.A_b);
  const Scalar inverse = a > 0 ? a : b;
  return inverse > 0 ? 1 / inverse : Scalar(0);
}

// btTypedConstraint::getMotorFactor: a motor that would pass a limit in the time in which a correction is made goes as
// much slower.
Scalar motorFactor(Scalar position, Scalar low, Scalar high, Scalar velocity, Scalar rate) {
  if (low > high) return 1;
  if (low == high || velocity == 0) return 0;
  const Scalar way = velocity / rate;
  const Scalar left = velocity < 0 ? low - position : high - position;
  const Scalar part = left / way;
  return part < 0 ? Scalar(0) : part < 1 ? part : Scalar(1);
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

// Whether J M^-1 J^T of a row is nothing but the rounding of I^-1 in the world, R I^-1 R^T. An impulse
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

// The rows of what acts along an axis, all along the same J; `target`: what their own targets are added to.
inline void writeParts(RowWriter& out, const AxisState& axis, const Lanes& L, const Lanes& A_a,
                       const Lanes& A_b, Scalar target, const AxisRow (&parts)[Axis::parts]) {
  for (const Axis::Part i : Axis::each_part)
    if (axis.row[i] >= 0)
      out.write(L, A_a, A_b, target + parts[i].target, parts[i].cfm, parts[i].lower,
                parts[i].upper);
}

// Whether a spring is a row (axis_part.h).
bool isStiff(const Spring& spring, Scalar dt, Scalar K) {
  return softnessOf(spring, dt, K).gamma <= max_yield_cfm * dt;
}

bool hasSoftness(const AxisRow (&parts)[Axis::parts]) {
  return std::any_of(parts, parts + Axis::parts, [](const AxisRow& part) { return part.cfm > 0; });
}

}  // namespace

// What all rows of a joint share in a step.
struct Joint::Step {
  Scalar fps;
  Scalar limit_erp;                          ///< unless the limit has its own
  Scalar rate[max_groups], cfm[max_groups];  ///< of equalities: erp / dt, and softness
  bool rigid;                                ///< no equality is soft
  Scalar curved_time;   ///< s: with the curvature, what it adds to a mean velocity
  Scalar foreseen = 1;  ///< the part of that that equalities reckon with

  Step(const Joint& joint, const Info2& info, Scalar default_cfm)
      : fps(info.fps), curved_time(joint.m_curved_time) {
    limit_erp = joint.m_erp.orElse(info.erp);
    rate[0] = limit_erp * fps;
    cfm[0] = joint.m_cfm.orElse(default_cfm);
    rigid = cfm[0] == 0;
    if (joint.m_erp_cfm_differs) setGroups(joint, info, default_cfm);
  }

  void setGroups(const Joint& joint, const Info2& info, Scalar default_cfm) {
    rigid = true;
    const ErpCfm* const all = joint.groups();
    for (int i = 0; i < max_groups; ++i) {
      const ErpCfm& group = all[i];
      rate[i] = group.factor * group.erp.orElse(info.erp) * fps;
      cfm[i] = group.cfm.orElse(default_cfm);
      rigid = rigid && cfm[i] == 0;
    }
  }

  // Whether Bullet's iteration would diverge for an equality.
  bool tooSoft(const Joint& joint) const {
    const int n = joint.m_erp_cfm_differs ? max_groups : 1;
    return !std::all_of(cfm, cfm + n, [](Scalar c) { return c < diverging_cfm; });
  }

  // What the curvature adds to the mean velocity of the row in this step.
  Scalar gain(const Row& row) const { return curved_time * row.curvature; }

  // Whether it is of a gap, whose speed of correction only a start bounds.
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

Joint::Joint(btTypedConstraint& constraint, RowCount max_rows)
    : m_erp_cfm_differs(false),
      m_foresees_curvature(false),
      m_turns_shafts(false),
      m_starts_warm(true),
      m_block_rows(true),
      m_solved_at_once(false),
      m_formulation(Formulation::conditioned),
      m_looks_ahead(false),
      m_remembers(false),
      m_learned(false),
      m_may_start_warm(false),
      m_might_start_warm(false),
      m_relaxed(false),
      m_undisturbed(false),
      m_acts_in_each(false),
      m_rests(false),
      m_starts_apart(false),
      m_shows_passes(false),
      m_type_is_known(false),
      m_is_clients(false),
      m_step_begins(true),
      m_constraint(constraint),
      m_rows(makeRows(max_rows)) {}

Joint::~Joint() { deleteRows(m_rows); }

void Joint::setRowCount(RowCount max_rows) {
  const RowList old = m_rows;
  m_rows = makeRows(max_rows);
  deleteRows(old);
}

// Clients call this at any time, and so does Bullet where a client sets frames: a step begins where its rows are asked for.
void Joint::buildJacobian() {
  m_step_begins = true;
  if (m_constraint.isEnabled()) return;
  // A disabled joint has no rows, but its angle goes on turning.
  beginStep();
  forget();
  m_gap = -1;
  const BodyPair pair(bodyA(), bodyB());
  if (pair.finite()) updateState(pair);
}

void Joint::beginStep() {
  readFromBullet();
  if (!m_step_begins) return;
  m_step_begins = false;
  m_last_angular_speed = m_angular_speed;
  m_angular_speed =
      btSqrt(btMax(bodyA().getAngularVelocity().length2(), bodyB().getAngularVelocity().length2()));
  for (int i = 0; i < m_rows.axisCount(); ++i) {
    AxisState& state = m_rows.axis(i);
    state.beginStep();
    if (state.axis != nullptr && state.axis->spring.isSet())
      state.yields = !(state.K > 0) || isStiff(state.axis->spring, m_time_step, state.K);
  }
  m_solver_rows = nullptr;
  // A solver that did not show its passes, or not all: what is remembered is old.
  m_remembers = m_learned && m_passes_left == 0;
  if (m_passes_left > 0 && m_passes_left == m_passes) m_shows_passes = false;
  if (m_passes == 0) m_undisturbed = false;
  m_might_start_warm = m_may_start_warm;
  m_learned = m_may_start_warm = m_relaxed = m_rests = m_looks_ahead = false;
  m_last_foreseen = m_foreseen;
  m_foreseen = -1;
  m_passes = m_passes_left = 0;
}

void Joint::announceRows(Info1& info, int room) {
  beginStep();
  const int before = m_rows.equalities();
  m_rows.clear();
  const BodyPair pair(bodyA(), bodyB());
  const StepMotion now = motion(pair);
  Rows rows(m_rows, now);
  if (pair.finite()) prepare(pair, rows);
  m_rows = rows;
  // Other rows: what is remembered is not theirs.
  if (m_rows.equalities() != before) forget();
  m_rows.truncate(room);
  placeRows(room);
  info.m_numConstraintRows = m_solver_row_count;
  info.nub = 0;
}

StepMotion Joint::motion(const BodyPair& pair) const {
  return {pair, m_time_step, angularSpeed() * m_time_step, curvedPart(), m_solved_at_once};
}

// Gives each equality the velocity that takes its error away.
inline void Joint::correct(const Step& step) {
  Scalar gap2 = 0, other2 = 0;
  for (int i = 0; i < m_rows.equalities(); ++i) {
    Row& row = m_rows[i];
    row.target = m_solved_at_once ? step.closing(row) : step.correction(row);
    (step.closes(row) ? gap2 : other2) += row.position * row.position;
  }
  if (!m_solved_at_once) limitClosing(step, gap2, other2);
}

// A joint that starts apart closes at less than its gap asks for, and at no more than the largest speed. (An error of
// orientation has a largest speed in any step: Row::max_speed.)
inline void Joint::limitClosing(const Step& step, Scalar gap2, Scalar other2) {
  const Scalar last = m_gap, rate = step.rate[0];
  m_gap = btSqrt(gap2);
  const Scalar speed = rate * m_gap,
               max_speed = btMax(m_max_linear_correction_speed, m_gap / longest_closing);
  if (!(speed > apart_fraction * max_speed ||
        rate * btSqrt(other2) > apart_fraction * m_max_correction_speed)) {
    m_starts_apart = false;
    return;
  }
  m_starts_apart =
      m_starts_apart || last < 0 || (speed > max_speed && isPutApart(step, last, max_speed));
  if (!m_starts_apart) return;
  const Scalar times = speed / max_speed;
  const Scalar part = times < infinity ? 1 / btSqrt(1 + times * times) : Scalar(0);  // also NaN
  for (int i = 0; i < m_rows.equalities(); ++i)
    if (step.closes(m_rows[i])) m_rows[i].target *= part;
}

// Between bodies that move, a gap that no velocity explains is a start, too: one of them has been put elsewhere, or the
// joint back into the world.
PINTLE_NOINLINE bool Joint::isPutApart(const Step& step, Scalar last_gap, Scalar max_speed) const {
  if (!(bodyA().getInvMass() > 0 && bodyB().getInvMass() > 0)) return false;
  // J v, whichever way the bodies have turned in the step.
  const BodyPair pair(bodyA(), bodyB());
  const Scalar v = (pair.v_b() - pair.v_a()).norm(), w_a = pair.w_a().norm(),
               w_b = pair.w_b().norm();
  Scalar speed2 = 0;
  for (int i = 0; i < m_rows.equalities(); ++i) {
    const Row& row = m_rows[i];
    if (!step.closes(row)) continue;
    const Scalar largest = row.L.norm() * v + row.A_a.norm() * w_a + row.A_b.norm() * w_b;
    speed2 += largest * largest;
  }
  return m_gap > last_gap + (max_speed + 2 * btSqrt(speed2)) * m_time_step;
}

// At the start of a step a row that the last one solved moves at
//   J v = correction + residual + gain,
// for it was to have correction - gain, and J has turned by twice the gain since. What else is left along it is how its
// bend has changed. The targets, which hold the corrections, make up for what is still left of the residual; and a bend
// is foreseen only as far as it lasts: returns that part. An impulse lambda of the row works by
// lambda . J (v0 + v1) / 2, v0 and v1 the velocities before and after the step: a bend that lasts turns v0 into -v1
// along the row, and does no work whatever the load. One that a blow has made feeds what hits the joint next.
inline Scalar Joint::compareWithLast(const Step& step, const BodyPair& pair) {
  const int n = m_rows.equalities();
  Scalar bend2 = 0;
  if (m_last_foreseen >= 0 && !m_foresees_curvature) {
    for (int i = 0; i < n; ++i) {
      const Row& row = m_rows[i];
      if (!row.angular) bend2 += step.gain(row) * step.gain(row);
    }
  }
  // Where a pivot hardly moves there is nothing but rounding.
  const Scalar moves = m_angular_speed * m_angular_speed * m_time_step;
  const bool bends = bend2 > SIMD_EPSILON * moves * moves;
  const bool makes_up = m_remembers && !m_starts_apart;
  if (!bends && !makes_up) return 1;

  const RelativeVelocity V(pair.v_a(), pair.w_a(), pair.v_b(), pair.w_b());
  const Scalar part = feed_forward * curvedPart();
  Scalar change2 = 0;
  for (int i = 0; i < n; ++i) {
    Row& row = m_rows[i];
    if (row.angular && !makes_up) continue;
    const Scalar gain = step.gain(row), left = V.along(row) - gain - row.target;
    const Scalar residual = makes_up ? m_rows.history(i).residual : Scalar(0);
    row.target -= part * agreed(residual, left);
    if (row.angular) continue;
    const Scalar change = residual - left + (1 - m_last_foreseen) * gain;
    change2 += change * change;
  }
  // Twice, since the gain is half of what J has turned by.
  const Scalar max_change2 = 4 * smooth * smooth * bend2;
  return bends && change2 > max_change2 ? btSqrt(max_change2 / change2) : Scalar(1);
}

// Adds to the corrections what the bend of the rows asks for: J v says how C moves to first order; Bullet then turns the
// bodies by more than that, and the curvature is what it adds in a step. With it a turning joint does not drift. (All at
// once: a lane that is read just after a number of it was written waits for that.)
inline void Joint::aim(Step& step, const BodyPair& pair) {
  if (!m_solved_at_once) {
    // A joint that nothing disturbed in the last step was not hit.
    m_foreseen = step.foreseen =
        m_undisturbed && m_shows_passes ? Scalar(1) : compareWithLast(step, pair);
    if (step.foreseen == 1) step.curved_time = m_curved_time = lastingTime();
  }
  const Scalar bend = step.foreseen * step.curved_time;
  for (int i = 0; i < m_rows.equalities(); ++i) m_rows[i].target -= bend * m_rows[i].curvature;
}

void Joint::placeRows(int room) {
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
  m_solver_row_count = static_cast<signed char>(n);
}

// Without its velocity and gain.
AxisMotion Joint::axisMotion(const Row& row, const AxisState& state, const BodyPair& pair,
                             Scalar fps, Scalar default_limit_erp) {
  const Axis& axis = *state.axis;
  AxisMotion motion;
  motion.position = row.position;
  motion.max_speed = m_solved_at_once
                         ? infinity
                         : btMin(row.angular ? m_max_correction_speed : infinity, row.max_speed);
  motion.incoming = state.last_incoming;
  motion.limit = row.limit;
  motion.fps = fps;
  motion.limit_erp = m_limit_erp.orElse(default_limit_erp);
  motion.motor_erp = motion.limit_erp;
  motion.motor_cfm = m_motor_cfm.orElse(0);
  Parameter limit_cfm = m_limit_cfm;
  if (axis.own != nullptr) {
    motion.limit_erp = axis.own->limit_erp.orElse(motion.limit_erp);
    motion.motor_cfm = axis.own->motor_cfm.orElse(motion.motor_cfm);
    motion.motor_erp = axis.own->motor_erp.orElse(motion.limit_erp);
    if (axis.own->limit_cfm.isSet()) limit_cfm = axis.own->limit_cfm;
  }
  // As Bullet has it: the motor's unless the limit has its own.
  motion.limit_cfm =
      limit_cfm.orElse(axis.drive == Axis::Drive::off ? Scalar(0) : motion.motor_cfm);
  // Bullet's own: a motor slows down before a limit. It changes nothing in the constraint.
  if (axis.drive == Axis::Drive::velocity)
    motion.motor_factor =
        motorFactor(row.position, axis.low, axis.high, axis.motor_velocity, fps * motion.motor_erp);
  if (axis.normalized_motor) motion.motor_inertia = motorInertia(row, pair);
  return motion;
}

// What acts along an axis in this step, part by part. `orthogonal` is its row after the elimination in `block`,
// whose target is what the equalities' targets came to in it; both null: as it stands.
inline void Joint::act(Row& row, const BlockRow* orthogonal, const Block* block, const Step& step,
                       AxisRow (&parts)[Axis::parts]) {
  AxisState& state = m_rows.axis(row.axis);
  const Axis& axis = *state.axis;
  const Scalar sign = state.sign;
  state.acted = true;
  state.incoming = 0;
  const BodyPair pair(bodyA(), bodyB());
  AxisMotion motion = axisMotion(row, state, pair, step.fps, step.limit_erp);
  // All velocities of an axis are means over the step, and so is the target that comes of them.
  motion.gain = step.gain(row);
  motion.velocity = motion.gain + sign * (row.angular ? row.A_b.dot(pair.w_b() - pair.w_a())
                                                      : velocity(row, pair.v_b() - pair.v_a(),
                                                                 pair.w_a(), pair.w_b()));
  const Scalar softest = row.limit ? btMax(motion.limit_cfm, motion.motor_cfm) : motion.motor_cfm;
  if (axis.isSoft(row.limit) || !(softest < diverging_cfm)) {
    // A copy of its own: the one here need not lie in memory for all that are rigid.
    AxisMotion soft = motion;
    state.given = solveSoft(row, orthogonal, block, soft, parts);
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

// Of the last step only what a limit begins with (joint_passes.cpp) is kept, where passes are shown.
inline void Joint::forgetImpulses() {
  for (int i = 0; i < m_rows.axisCount(); ++i) {
    AxisState& state = m_rows.axis(i);
    const Scalar limit = state.impulse[Axis::limit];
    state.impulse = {};
    if (m_solver_rows != nullptr && state.row[Axis::limit] >= 0) state.impulse[Axis::limit] = limit;
  }
}

PINTLE_FLATTEN void Joint::writeRows(Info2& info) {
  m_last_time_step = m_time_step;
  m_time_step = 1 / info.fps;
  // A solver of all joints at once finds the end of the step by itself: it takes J v at the start, not what a motion adds to it.
  m_curved_time = m_solved_at_once ? Scalar(0) : curvedTime();
  const int n = m_rows.size();
  if (n == 0) return;
  m_solver_rows = solverRows(info);
  RowWriter out(info);
  Step step(*this, info, out.cfm());
  const BodyPair pair(bodyA(), bodyB());
  correct(step);
  const ImpulseSetting setting = impulseSetting();
  info.m_damping = setting.damping;

  const int equalities = m_rows.equalities();
  if (n > equalities) forgetImpulses();
  // Bullet compares a threshold with single rows, which are those of the joint if they are not mixed. Where its passes
  // are shown, joint_passes.cpp compares it with the load.
  // A soft row is not to end at its target, and a damped one will not.
  const bool remembers = step.rigid && setting.damping == 1;
  const auto mayMix = [&] {
    return !(setting.max_impulse < infinity) && (!breakable() || (m_shows_passes && remembers));
  };
  if (isNeedle(bodyA()) || isNeedle(bodyB()) ||
      (!step.rigid && !m_solved_at_once && step.tooSoft(*this)))
    return writeDelicate(info);
  // Rows that are orthogonal within a joint serve a solver that takes one by one.
  if (!m_block_rows || m_solved_at_once || !mayMix()) {
    const Scalar bound = setting.max_impulse;
    m_remembers = false;
    aim(step, pair);
    for (int i = 0; i < equalities; ++i) {
      const Row& row = m_rows[i];
      out.write(row.lanesL(), row.lanesA_a(), row.lanesA_b(), row.target, step.cfm[row.group],
                -bound, bound);
    }
    for (int i = equalities; i < n; ++i) {
      Row& row = m_rows[i];
      AxisRow parts[Axis::parts];
      const bool soft = m_rows.axis(row.axis).axis->isSoft(row.limit);
      if (!soft) act(row, nullptr, nullptr, step, parts);
      if (soft || hasSoftness(parts)) actBesideEqualities(row, step, parts);
      writeParts(out, m_rows.axis(row.axis), row.lanesL(), row.lanesA_a(), row.lanesA_b(), 0,
                 parts);
    }
    return;
  }

  if (remembers)
    beginPasses(info);
  else
    m_remembers = false;
  aim(step, pair);
  m_looks_ahead = m_looks_ahead && step.foreseen == 1;

  Block block(pair);
  for (int i = 0; i < equalities; ++i) {
    const Row& row = m_rows[i];
    const BlockRow& to = block.add(row);
    out.write(to.L, to.A_a, to.A_b, to.target(), step.cfm[row.group], -infinity, infinity);
  }
  // A row that depends on others shares its impulse with them as it comes.
  if (!block.independent()) {
    m_looks_ahead = m_may_start_warm = false;
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
}

// Plain rows move as the equalities let them, too. Softness is a fraction of the K that is left then, of
// which the solver does not know.
PINTLE_NOINLINE void Joint::actBesideEqualities(Row& row, const Step& step,
                                                AxisRow (&parts)[Axis::parts]) {
  const BodyPair pair(bodyA(), bodyB());
  Block block(pair);
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
PINTLE_NOINLINE void Joint::writeDelicate(Info2& info) {
  RowWriter out(info);
  Step step(*this, info, out.cfm());
  const ImpulseSetting setting = impulseSetting();
  const BodyPair pair(bodyA(), bodyB());
  // Nothing is compared with the last step.
  m_remembers = false;
  m_last_foreseen = -1;
  aim(step, pair);
  const bool needle = isNeedle(bodyA()) || isNeedle(bodyB());
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
    if (!m_solved_at_once && !(cfm < diverging_cfm)) {
      // Bullet takes this part of the free velocity away.
      const Scalar free =
          setting.damping * freeVelocity(L, A_a, A_b, bodyA(), bodyB(), m_time_step);
      target = free + (target - free) / (1 + cfm);
      cfm = 0;
    }
    const Scalar bound = needle && isRounding(row, pair) ? Scalar(0) : setting.max_impulse;
    out.write(L, A_a, A_b, target, cfm, -bound, bound);
  }
}

bool Joint::solveSoft(Row& row, const BlockRow* orthogonal, const Block* block, AxisMotion& motion,
                      AxisRow (&parts)[Axis::parts]) {
  const BodyPair pair(bodyA(), bodyB());
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
  const Scalar passed_over = m_solved_at_once ? Scalar(0) : SIMD_EPSILON;
  motion.K = alone.K > btMax(rounding_of_K * own, passed_over) ? alone.K : Scalar(0);
  AxisState& state = m_rows.axis(row.axis);
  const Scalar free = freeVelocity(alone.L, alone.A_a, alone.A_b, bodyA(), bodyB(), m_time_step);
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

Scalar Joint::axisImpulse(int axis, Axis::Part part) const {
  const AxisState& state = m_rows.axis(axis);
  if (!state.acted || m_rows.size() == 0) return 0;
  const bool last = state.row[part] == m_solver_row_count - 1;
  return last ? -state.sign * m_constraint.internalGetAppliedImpulse() : state.impulse[part];
}

const Row* Joint::limitAt(int solver_row) const {
  for (int i = m_rows.equalities(); i < m_rows.size(); ++i)
    if (m_rows.axis(m_rows[i].axis).row[Axis::limit] == solver_row) return &m_rows[i];
  return nullptr;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

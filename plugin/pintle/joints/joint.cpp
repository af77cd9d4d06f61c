#include <pintle/joints/joint.h>
#include <pintle/joints/joint_passes.h>

#include <pintle/body_pair.h>
#include <pintle/equations/effective_mass.h>
#include <pintle/row_writer.h>
#include <pintle/rows/axis_part.h>
#include <pintle/rows/block.h>

#include <algorithm>
#include <limits>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// In the range of btTypedConstraintType and none of its values: Bullet's debug drawing and importer
// cast by type.
constexpr auto pintle_type = btTypedConstraintType(15);

constexpr int max_firmness = 3;

// An impulse that is given, as that of a soft spring, does not see what other joints do to its coordinate
// in the step. They are going to do again what they did; half of what has changed is taken over in a
// step, as springs that bear on each other would else answer each other for ever, and next to nothing
// of what was not there before, which may be a blow.
Scalar carryOver(Scalar now, Scalar before) {
  return agree(now, before) ? (now + before) / 2 : now / 16;
}

// Of what a start from rest shows, relative to what is foreseen: a tenth of it, squared.
constexpr Scalar rounding_of_start = Scalar(0.01);

// A joint starts apart if it is to be corrected at more than this part of its largest speeds of correction. Until it has
// come together it begins each step from nothing.
constexpr Scalar apart = Scalar(0.1);

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

bool hasSoftness(const AxisRow (&parts)[Axis::parts]) {
  return std::any_of(parts, parts + Axis::parts, [](const AxisRow& part) { return part.cfm > 0; });
}

}  // namespace

// What all rows of a joint share in a step.
struct Joint::Step {
  Scalar fps;
  Scalar limit_erp;                              ///< unless the limit has its own
  Scalar rate[max_firmness], cfm[max_firmness];  ///< of equalities: erp / dt, and softness
  bool rigid;                                    ///< no equality is soft
  Scalar curved_time;                            ///< with the curvature, what it adds to a velocity
  Scalar closing = 1;                            ///< part of a linear correction that is taken
  Scalar foreseen[2] = {1, 1};                   ///< parts of the linear and the angular curvature

  Step(const Joint& joint, const btConstraintInfo2& info, Scalar default_cfm)
      : fps(info.fps), curved_time(joint.curvedTime()) {
    limit_erp = joint.m_erp.orElse(info.erp);
    rate[0] = limit_erp * fps;
    cfm[0] = joint.m_cfm.orElse(default_cfm);
    rigid = cfm[0] == 0;
    if (joint.m_firmness_differs) setFirmness(joint, info, default_cfm);
  }

  void setFirmness(const Joint& joint, const btConstraintInfo2& info, Scalar default_cfm) {
    rigid = true;
    const Firmness* const all = joint.firmness();
    for (int i = 0; i < max_firmness; ++i) {
      const Firmness& firmness = all[i];
      rate[i] = firmness.factor * firmness.erp.orElse(info.erp) * fps;
      cfm[i] = firmness.cfm.orElse(default_cfm);
      rigid = rigid && cfm[i] == 0;
    }
  }

  // Whether Bullet's iteration would diverge for an equality.
  bool tooSoft(const Joint& joint) const {
    const int n = joint.m_firmness_differs ? max_firmness : 1;
    return !std::all_of(cfm, cfm + n, [](Scalar c) { return c < diverging_cfm; });
  }

  // What the curvature adds to the mean velocity of the row in this step.
  Scalar gain(const Row& row) const { return curved_time * row.curvature; }

  // The velocity that takes away the part erp of C (2.3).
  Scalar correction(const Row& row) const {
    const Scalar away = -rate[row.firmness] * (row.angular ? Scalar(1) : closing) * row.position;
    const Scalar speed = btFabs(away) > least_speed ? away : Scalar(0);
    return btMax(-row.max_speed, btMin(speed, row.max_speed));
  }

  // J v says how C moves to first order; Bullet then turns the bodies by more than that, and the curvature is what
  // it adds in a step: with it a turning joint does not drift.
  Scalar target(const Row& row) const {
    return correction(row) - foreseen[row.angular] * gain(row);
  }
};

Joint::Joint(btRigidBody& a, btRigidBody& b, RowCount most)
    : btTypedConstraint(pintle_type, a, b),
      m_firmness_differs(false),
      m_foresees_curvature(false),
      m_turns_shafts(false),
      m_starts_warm(true),
      m_block_rows(true),
      m_solved_at_once(false),
      m_last(Last::nothing),
      m_next(Last::nothing),
      m_formulation(Formulation::conditioned),
      m_looks_ahead(false),
      m_passes_done(0),
      m_relaxed(false),
      m_starts_apart(false),
      m_shows_passes(false),
      m_rows(makeRows(most)) {}

Joint::Joint(btRigidBody& a, RowCount most) : Joint(a, getFixedBody(), most) {}

Joint::~Joint() { deleteRows(m_rows); }

void Joint::setRowCount(RowCount most) {
  const RowList old = m_rows;
  m_rows = makeRows(most);
  deleteRows(old);
}

void Joint::buildJacobian() {
  m_last_angular_speed = m_angular_speed;
  m_angular_speed =
      btSqrt(btMax(m_rbA.getAngularVelocity().length2(), m_rbB.getAngularVelocity().length2()));
  for (int i = 0; i < m_rows.axisCount(); ++i) m_rows.axis(i).beginStep();
  m_solver_rows = nullptr;
  // A solver that did not show its passes, or not all: what is remembered is old.
  if (m_passes_left > 0 || m_last != m_next) m_last = Last::nothing;
  if (m_passes_left > 0 && m_passes_done == 0) m_shows_passes = false;
  m_relaxed = false;
  m_next = Last::nothing;
  m_passes_left = 0;
  m_looks_ahead = false;
  // A disabled joint has no rows, but its angle goes on turning.
  if (!isEnabled()) {
    forget();
    m_gap = -1;
    const BodyPair pair(m_rbA, m_rbB);
    if (pair.finite()) updateState(pair);
  }
}

void Joint::getInfo1(btConstraintInfo1* info) {
  const int before = m_rows.size();
  m_rows.clear();
  const BodyPair pair(m_rbA, m_rbB);
  Rows rows(m_rows);
  if (pair.finite()) prepare(pair, rows);
  m_rows = rows;
  // Other rows: what is remembered is not theirs.
  if (m_rows.size() != before) forget();
  placeRows(std::numeric_limits<signed char>::max());
  info->m_numConstraintRows = m_solver_row_count;
  info->nub = 0;
}

GapInLevers Joint::sharesOfGap() const {
  const auto isFree = [](const btRigidBody& body) {
    const btVector3& f = body.getLinearFactor();
    return body.getInvMass() > 0 && f.x() == 1 && f.y() == 1 && f.z() == 1;
  };
  if (!isFree(m_rbA) || !isFree(m_rbB)) return {};
  const Scalar a = m_rbA.getInvMass(), b = m_rbB.getInvMass();
  return {b / (a + b), a / (a + b)};
}

GapInLevers Joint::gapInLevers() const {
  constexpr Scalar from = Scalar(0.1), to = SIMD_PI / 4;
  const Scalar part = (to - angularSpeed() * m_time_step) / (to - from);
  if (!(part > 0)) return {};
  const GapInLevers shares = sharesOfGap();
  return part < 1 ? GapInLevers{part * shares.a, part * shares.b} : shares;
}

// The part of a linear correction that is taken: less than all where the joint starts apart. Between bodies that move,
// a gap that no velocity explains is a start, too: one of them has been put elsewhere, or the joint back into the world.
Scalar Joint::closingPart(Scalar rate) {
  Scalar gap2 = 0, turn2 = 0;
  const int n = m_rows.equalities();
  for (int i = 0; i < n; ++i)
    (m_rows[i].angular ? turn2 : gap2) += m_rows[i].position * m_rows[i].position;
  const Scalar most = m_max_linear_correction_speed, last = m_gap;
  m_gap = btSqrt(gap2);
  const Scalar speed = rate * m_gap;
  const Scalar angular = apart * m_max_correction_speed;
  if (!(speed > apart * most || rate * rate * turn2 > angular * angular)) {
    m_starts_apart = false;
    return 1;
  }
  if (last < 0) m_starts_apart = true;
  if (!(speed > most)) return 1;
  if (!m_starts_apart && m_rbA.getInvMass() > 0 && m_rbB.getInvMass() > 0) {
    const BodyPair pair(m_rbA, m_rbB);
    Scalar speed2 = 0;
    for (int i = 0; i < n; ++i) {
      if (m_rows[i].angular) continue;
      const Scalar v = velocity(m_rows[i], pair.v_b() - pair.v_a(), pair.w_a(), pair.w_b());
      speed2 += v * v;
    }
    m_starts_apart = m_gap > last + (most + 2 * btSqrt(speed2)) * m_time_step;
  }
  return m_starts_apart ? most / speed : Scalar(1);
}

// The velocity that a row foresees, g = -gain, undoes in the mean over the step what the last one left along it,
// u = -J v0: then
//   lambda . J (v0 + v1) / 2 = 0,
// and its impulse does no work whatever the load. A blow changes u and not g: where u is further from g than nothing at
// all is, no more of g is foreseen than u has shown; and nothing while the books are overdrawn.
inline void Joint::foresee(Step& step, const BodyPair& pair) const {
  if (!foresees()) return;
  if (isOverdrawn()) {
    step.foreseen[0] = step.foreseen[1] = 0;
    return;
  }
  const Vec3 v = pair.v_b() - pair.v_a(), w_a = pair.w_a(), w_b = pair.w_b();
  Scalar uu[2] = {}, ug[2] = {}, gg[2] = {};
  for (int i = 0; i < m_rows.equalities(); ++i) {
    const Row& row = m_rows[i];
    const Scalar g = -step.gain(row);
    if (g == 0) continue;
    const Scalar u = -velocity(row, v, w_a, w_b);
    uu[row.angular] += u * u;
    ug[row.angular] += u * g;
    gg[row.angular] += g * g;
  }
  for (int i = 0; i < 2; ++i)
    if (uu[i] > 2 * ug[i] + rounding_of_start * gg[i] && ug[i] < gg[i])
      step.foreseen[i] = btMax(Scalar(0), ug[i] / gg[i]);
}

void Joint::placeRows(int room) {
  int n = m_rows.equalities();
  for (int i = n; i < m_rows.size(); ++i) {
    AxisState& state = m_rows.axis(m_rows[i].axis);
    const Axis& axis = *state.axis;
    const auto place = [&](Axis::Part part, bool acts) {
      state.row[part] = static_cast<signed char>(acts && n < room ? n++ : -1);
    };
    place(Axis::motor, axis.drive != Axis::Drive::off);
    place(Axis::friction, axis.max_friction > 0);
    place(Axis::limit, m_rows[i].limit);
  }
  m_solver_row_count = static_cast<signed char>(n);
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
  const BodyPair pair(m_rbA, m_rbB);
  AxisMotion motion;
  motion.position = row.position;
  // All velocities of an axis are means over the step, and so is the target that comes of them.
  motion.gain = step.gain(row);
  motion.velocity = motion.gain + sign * (row.angular ? row.A_b.dot(pair.w_b() - pair.w_a())
                                                      : velocity(row, pair.v_b() - pair.v_a(),
                                                                 pair.w_a(), pair.w_b()));
  motion.max_speed = btMin(row.angular ? m_max_correction_speed : infinity, row.max_speed);
  motion.incoming = state.last_incoming;
  motion.limit = row.limit;
  motion.fps = step.fps;
  motion.limit_erp = m_limit_erp.orElse(step.limit_erp);
  motion.motor_cfm = m_motor_cfm.orElse(0);
  Parameter limit_cfm = m_limit_cfm;
  if (axis.own != nullptr) {
    motion.limit_erp = axis.own->limit_erp.orElse(motion.limit_erp);
    motion.motor_cfm = axis.own->motor_cfm.orElse(motion.motor_cfm);
    if (axis.own->limit_cfm.isSet()) limit_cfm = axis.own->limit_cfm;
  }
  // As Bullet has it: the motor's unless the limit has its own.
  motion.limit_cfm =
      limit_cfm.orElse(axis.drive == Axis::Drive::off ? Scalar(0) : motion.motor_cfm);
  // Bullet's own: a motor slows down before a limit. It changes nothing in the constraint.
  if (axis.drive == Axis::Drive::velocity)
    motion.motor_factor = getMotorFactor(row.position, axis.low, axis.high, axis.motor_velocity,
                                         step.fps * motion.limit_erp);
  if (axis.normalized_motor) motion.motor_inertia = motorInertia(row, pair);
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
  for (int i = 0; i < Axis::parts; ++i) {
    AxisRow& part = parts[i];
    part.target -= motion.gain;
    // From along the coordinate to along J.
    if (sign < 0) part = {-part.target, part.cfm, -part.upper, -part.lower};
  }
}

// What joint_passes.cpp starts limits with, as Bullet counts it.
inline void Joint::takeLastImpulses() {
  for (int i = m_rows.equalities(); i < m_rows.size(); ++i) {
    AxisState& state = m_rows.axis(m_rows[i].axis);
    state.last_limit = isLimit(m_rows[i]) ? -state.sign * state.impulse[Axis::limit] : Scalar(0);
  }
  for (int i = 0; i < m_rows.axisCount(); ++i) m_rows.axis(i).impulse = {};
}

PINTLE_FLATTEN void Joint::getInfo2(btConstraintInfo2* info) {
  m_last_time_step = m_time_step;
  m_time_step = 1 / info->fps;
  const int n = m_rows.size();
  if (n == 0) return;
  m_solver_rows = solverRows(*info);
  RowWriter out(*info);
  Step step(*this, *info, out.cfm());
  step.closing = closingPart(step.rate[0]);
  const BodyPair pair(m_rbA, m_rbB);
  foresee(step, pair);
  const ImpulseSetting setting = impulseSetting();
  info->m_damping = setting.damping;
  const auto write_axis = [&](const Row& row, const Lanes& L, const Lanes& A_a, const Lanes& A_b,
                              Scalar target, const AxisRow (&parts)[Axis::parts]) {
    const AxisState& state = m_rows.axis(row.axis);
    for (int i = 0; i < Axis::parts; ++i)
      if (state.row[i] >= 0)
        out.write(L, A_a, A_b, target + parts[i].target, parts[i].cfm, parts[i].lower,
                  parts[i].upper);
  };

  const int equalities = m_rows.equalities();
  if (n > equalities) takeLastImpulses();
  // Bullet compares a threshold with single rows, which are those of the joint if they are not mixed. Where its passes
  // are shown, joint_passes.cpp compares it with the load.
  const auto mayMix = [&] {
    return !(setting.max_impulse < infinity) &&
           (!breakable() || m_shows_passes);
  };
  if (isNeedle(m_rbA) || isNeedle(m_rbB) ||
      (!step.rigid && !m_solved_at_once && step.tooSoft(*this)))
    return writeDelicate(*info);
  // Rows that are orthogonal within a joint serve a solver that takes one by one.
  if (!m_block_rows || m_solved_at_once || !mayMix()) {
    const Scalar bound = setting.max_impulse;
    for (int i = 0; i < equalities; ++i) {
      Row& row = m_rows[i];
      out.write(row.lanesL(), row.lanesA_a(), row.lanesA_b(), step.target(row),
                step.cfm[row.firmness], -bound, bound);
    }
    for (int i = equalities; i < n; ++i) {
      Row& row = m_rows[i];
      AxisRow parts[Axis::parts];
      const bool soft = m_rows.axis(row.axis).axis->isSoft(row.limit);
      if (!soft) act(row, nullptr, nullptr, step, parts);
      if (soft || hasSoftness(parts)) actBesideEqualities(row, step, parts);
      write_axis(row, row.lanesL(), row.lanesA_a(), row.lanesA_b(), 0, parts);
    }
    return;
  }

  // A soft row is not to end at its target, and a damped one will not.
  const bool remembers = step.rigid && setting.damping == 1;
  if (remembers) beginPasses(*info);
  if (step.foreseen[0] < 1 || step.foreseen[1] < 1) m_looks_ahead = false;
  const bool correct = m_next == Last::residual && m_last == Last::residual;

  Block block(pair);
  for (int i = 0; i < equalities; ++i) {
    Row& row = m_rows[i];
    row.target = step.target(row) - (correct ? row.correction : Scalar(0));
    const BlockRow& to = block.add(row);
    out.write(to.L, to.A_a, to.A_b, to.target(), step.cfm[row.firmness], -infinity, infinity);
  }
  // A row that depends on others shares its impulse with them as it comes.
  if (!block.independent()) {
    m_looks_ahead = false;
    if (m_next == Last::impulse) m_next = Last::nothing;
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
    write_axis(m_rows[i], to.L, to.A_a, to.A_b, to.target(), parts);
  }
}

// Plain rows move as the equalities let them, too. Softness is a fraction of the K that is left then, of
// which the solver does not know.
PINTLE_NOINLINE void Joint::actBesideEqualities(Row& row, const Step& step,
                                                AxisRow (&parts)[Axis::parts]) {
  const BodyPair pair(m_rbA, m_rbB);
  Block block(pair);
  for (int i = 0; i < m_rows.equalities(); ++i) {
    m_rows[i].target = step.target(m_rows[i]);
    block.add(m_rows[i]);
  }
  BlockRow plain, orthogonal;
  row.target = 0;
  Block::take(plain, row);
  block.weigh(plain);
  block.eliminate(orthogonal, row);
  block.weigh(orthogonal);
  act(row, &orthogonal, &block, step, parts);
  if (!(plain.K > orthogonal.K)) return;
  for (int i = 0; i < Axis::parts; ++i) parts[i].cfm *= orthogonal.K / plain.K;
}

// Plain rows of needles, and such of which an equality is so soft that Bullet's iteration would diverge: it
// is written as a rigid row, to where the soft one would come by itself.
PINTLE_NOINLINE void Joint::writeDelicate(btConstraintInfo2& info) {
  RowWriter out(info);
  Step step(*this, info, out.cfm());
  step.closing = closingPart(step.rate[0]);
  const ImpulseSetting setting = impulseSetting();
  const BodyPair pair(m_rbA, m_rbB);
  const bool needle = isNeedle(m_rbA) || isNeedle(m_rbB);
  for (int i = 0; i < m_rows.size(); ++i) {
    Row& row = m_rows[i];
    const LanesView L = row.lanesL(), A_a = row.lanesA_a(), A_b = row.lanesA_b();
    if (row.axis >= 0) {
      AxisRow parts[Axis::parts];
      act(row, nullptr, nullptr, step, parts);
      const AxisState& state = m_rows.axis(row.axis);
      for (int k = 0; k < Axis::parts; ++k)
        if (state.row[k] >= 0)
          out.write(L, A_a, A_b, parts[k].target, parts[k].cfm, parts[k].lower, parts[k].upper);
      continue;
    }
    Scalar cfm = step.cfm[row.firmness], target = step.target(row);
    if (!m_solved_at_once && !(cfm < diverging_cfm)) {
      // Bullet takes this part of the free velocity away.
      const Scalar free = setting.damping * freeVelocity(L, A_a, A_b, m_rbA, m_rbB, m_time_step);
      target = free + (target - free) / (1 + cfm);
      cfm = 0;
    }
    const Scalar bound = needle && isRounding(row, pair) ? Scalar(0) : setting.max_impulse;
    out.write(L, A_a, A_b, target, cfm, -bound, bound);
  }
}

bool Joint::solveSoft(Row& row, const BlockRow* orthogonal, const Block* block, AxisMotion& motion,
                      AxisRow (&parts)[Axis::parts]) {
  const BodyPair pair(m_rbA, m_rbB);
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
  const Scalar free = freeVelocity(alone.L, alone.A_a, alone.A_b, m_rbA, m_rbB, m_time_step);
  motion.free_velocity = motion.gain + Scalar(state.sign) * (free - alone.target());
  if (state.seen) {
    row.correction = carryOver(row.last, row.correction);
    state.seen = false;
    state.foreseen = true;
  } else if (!state.foreseen) {
    row.correction = 0;
  }
  const Scalar alone_velocity = motion.free_velocity - motion.gain;
  motion.free_velocity += row.correction;
  const bool given = solveAxis(*state.axis, motion, state, parts);
  state.K = motion.K;
  state.expected = alone_velocity;
  for (int i = 0; i < Axis::parts; ++i)
    if (parts[i].lower == parts[i].upper) state.expected += motion.K * parts[i].upper;
  return given;
}

Scalar Joint::axisImpulse(int axis, Axis::Part part) const {
  const AxisState& state = m_rows.axis(axis);
  if (!state.acted || m_rows.size() == 0) return 0;
  const bool last = state.row[part] == m_solver_row_count - 1;
  return last ? -state.sign * m_appliedImpulse : state.impulse[part];
}

const Row* Joint::limitAt(int solver_row) const {
  for (int i = m_rows.equalities(); i < m_rows.size(); ++i)
    if (m_rows.axis(m_rows[i].axis).row[Axis::limit] == solver_row) return &m_rows[i];
  return nullptr;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

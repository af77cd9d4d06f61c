#include <pintle/joints/joint_passes.h>

#include <pintle/body_pair.h>
#include <pintle/joints/joint.h>
#include <pintle/solver_body.h>

#include <cstdint>
#include <cstring>
#include <limits>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// Bullet starts the rows of every joint from nothing in each step, and the few passes that it makes do not
// carry a load from one end of a chain to the other. Impulses of the last step are most of what this one
// is going to need: after its first pass all joints go on from this part of them. All of it would let
// what the joints of a loop say twice add up for ever.
constexpr Scalar warm_start = Scalar(0.8);

// Limits, which push one way, have nobody to say the same: what lies on one is borne the sooner.
constexpr Scalar warm_limit = Scalar(0.95);

// Bullet makes no second pass if the first one changed nothing, or less than its residual threshold: what
// started then would stay as it is. A row that the first one changed by more than this (m/s, rad/s) says
// that there is another.
constexpr Scalar goes_on = Scalar(1e-3);

// A joint whose impulses the passes after the first one change by no more than this part is not disturbed
// by others, and needs none of this.
constexpr Scalar undisturbed = Scalar(1e-3);

// Between the first pass and the last each goes beyond what it asks of the rows by this part of it: successive
// over-relaxation, with which joints that bear on each other converge in half the passes. The last one leaves
// them where it should.
constexpr Scalar over_relaxation = Scalar(0.4);

// With up to so many passes a start that is not right is not made up for.
constexpr int few_passes = 3;

// Row::curvature is that of the velocities at the start of the step. Where a body turns by more than the first of
// these in a step, rad, it is found anew from where the velocities of now lead, each time that the number of
// passes has doubled; by more than the second that need not converge. Nor for a joint that is further open
// than it closes in a step at this speed, m/s or rad/s. (The document's form has no curvature.)
constexpr Scalar min_look_turn = Scalar(0.05), max_look_turn = Scalar(0.3),
                 open_speed = Scalar(0.3);

// A joint may rest from this pass on, and if its impulses have changed by no more than this part of the largest: what the
// rounding of single precision leaves of rows that are orthogonal.
constexpr int passes_to_rest = 3;
constexpr Scalar rounding_of_impulses = 64 * SIMD_EPSILON;

// Looks come after one, two, four and eight passes.
constexpr int last_look = 8;

// Others may disturb the rows of a joint by so many times what a look changes: beyond it is too early. What a look changes
// may grow by max_growth until the next one of the step. (That leaves out one in sixty of the looks that have an effect in
// the scenes of demos/scenes/catalog.cpp, with 10 iterations.)
constexpr Scalar max_disturbance = 3, max_growth = 3;

// Sets to 0 what is slower than min_speed of the velocity that `part` and `others` make.
void stopIfSlow(btVector3& part, const btVector3& others) {
  for (int i = 0; i < 3; ++i)
    if (btFabs(part[i] + others[i]) < min_speed) part[i] = -others[i];
}
void stopIfSlow(btSolverBody& body) {
  stopIfSlow(body.m_deltaLinearVelocity, body.m_linearVelocity + body.m_externalForceImpulse);
  stopIfSlow(body.m_deltaAngularVelocity, body.m_angularVelocity + body.m_externalTorqueImpulse);
}

// Bullet's gyroscopic term multiplies the velocity of what turns by thousands of radians in a step. None leaves
// its joints faster than this, rad: Bullet turns no body by more than pi/4.
constexpr Scalar max_turn = 1000;
void boundTurn(btSolverBody& body, Scalar dt) {
  const btVector3 w = angularVelocity(body);
  const Scalar turn2 = w.length2() * dt * dt;
  if (turn2 > max_turn * max_turn && !body.internalGetInvMass().isZero())
    body.m_deltaAngularVelocity -= (1 - max_turn / btSqrt(turn2)) * w;
}

Vec3 linearOf(const btSolverBody& body) { return view(linearVelocity(body)); }
Vec3 angularOf(const btSolverBody& body) { return view(angularVelocity(body)); }

bool isPowerOfTwo(int n) { return (n & (n - 1)) == 0; }

// Of what a step's impulses have given the bodies so far: another one if a number is another. (FNV-1a, by words.)
std::uint32_t hashOfVelocities(const btSolverBody& a, const btSolverBody& b) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const btVector3* v : {&a.m_deltaLinearVelocity, &a.m_deltaAngularVelocity,
                             &b.m_deltaLinearVelocity, &b.m_deltaAngularVelocity}) {
    for (int i = 0; i < 3; ++i) {
      std::uint64_t bits = 0;
      std::memcpy(&bits, &(*v)[i], sizeof(btScalar));
      hash = (hash ^ bits) * 0x100000001b3u;
    }
  }
  return static_cast<std::uint32_t>(hash ^ hash >> 32);
}

// J M^-1 J^T of two rows of a joint, both of the same sign.
Scalar product(const Row& row, const btSolverConstraint& other, const btSolverBody& a,
               const btSolverBody& b) {
  const btVector3 by_a = other.m_contactNormal1 * a.internalGetInvMass(),
                  by_b = other.m_contactNormal2 * b.internalGetInvMass();
  return row.L.dot(view(by_a) - view(by_b)) + row.A_a.dot(view(other.m_angularComponentA)) -
         row.A_b.dot(view(other.m_angularComponentB));
}

// Changes of the impulses of a joint's rows, given to its bodies at once: all rows act on the same two.
class ImpulseSum {
 public:
  void setImpulse(btSolverConstraint& row, Scalar impulse) {
    const Scalar change = impulse - row.m_appliedImpulse;
    m_linear += change * row.m_contactNormal1;
    m_angular_a += change * row.m_angularComponentA;
    m_angular_b += change * row.m_angularComponentB;
    row.m_appliedImpulse = impulse;
  }
  void apply(btSolverBody& a, btSolverBody& b) const {
    a.internalApplyImpulse(m_linear * a.internalGetInvMass(), m_angular_a, 1);
    b.internalApplyImpulse(-m_linear * b.internalGetInvMass(), m_angular_b, 1);
  }

 private:
  btVector3 m_linear{0, 0, 0}, m_angular_a{0, 0, 0}, m_angular_b{0, 0, 0};
};

// As Bullet's pass does.
void solveRow(btSolverConstraint& row, btSolverBody& a, btSolverBody& b) {
  const Scalar velocity = row.m_contactNormal1.dot(a.m_deltaLinearVelocity) +
                          row.m_relpos1CrossNormal.dot(a.m_deltaAngularVelocity) +
                          row.m_contactNormal2.dot(b.m_deltaLinearVelocity) +
                          row.m_relpos2CrossNormal.dot(b.m_deltaAngularVelocity);
  const Scalar impulse =
      row.m_appliedImpulse * (1 - row.m_cfm) + row.m_rhs - velocity * row.m_jacDiagABInv;
  ImpulseSum sum;
  sum.setImpulse(row, btMax(row.m_lowerLimit, btMin(impulse, row.m_upperLimit)));
  sum.apply(a, b);
}

// The same row with a Jacobian so many times as long: its impulse is that much smaller.
void lengthen(btSolverConstraint& row, Scalar times) {
  for (btVector3* J : {&row.m_contactNormal1, &row.m_relpos1CrossNormal, &row.m_angularComponentA,
                       &row.m_contactNormal2, &row.m_relpos2CrossNormal, &row.m_angularComponentB})
    *J *= times;
  row.m_appliedImpulse /= times;
  row.m_rhs /= times;
  row.m_jacDiagABInv /= times * times;
}

}  // namespace

void Joint::beginPasses(const Info2& info) {
  const int own = m_constraint.getOverrideNumSolverIterations();
  const int passes = own > 0 ? own : info.m_numIterations;
  // Bullet shows none beyond its own number; so many are enough for any joint.
  const bool shown = m_solver_rows != nullptr && passes <= info.m_numIterations &&
                     passes <= std::numeric_limits<short>::max();
  m_passes = m_passes_left = static_cast<short>(shown ? passes : 0);
  m_acts_in_each = true;
  // Forces on bodies that turn far in a step are others in the next one, and so is what a motor makes of them.
  const auto is_driven = [this] {
    for (int i = m_rows.equalities(); i < m_rows.size(); ++i) {
      const Axis::Drive drive = m_rows.axis(m_rows[i].axis).axis->drive;
      if (drive != Axis::Drive::off && drive != Axis::Drive::servo) return true;
    }
    return false;
  };
  m_may_start_warm = m_starts_warm && !m_starts_apart && m_passes_left > few_passes &&
                     curvedPart() > 0 && !is_driven();
  m_last_load = -1;
  m_look_change = infinity;
  const Scalar turn = m_angular_speed * m_time_step;
  m_looks_ahead =
      m_formulation == Formulation::conditioned && turn > min_look_turn && turn < max_look_turn;
}

PINTLE_NOINLINE void Joint::forget() {
  m_remembers = m_undisturbed = false;
  for (int i = 0; i < m_rows.axisCount(); ++i) m_rows.axis(i).seen = false;
}

// A threshold is compared with the load (breakIfOverloaded): until then no row is to stop at it.
void Joint::liftThresholds() {
  for (int i = 0; i < m_rows.equalities(); ++i) {
    m_solver_rows[i].m_lowerLimit = -infinity;
    m_solver_rows[i].m_upperLimit = infinity;
  }
}

// The load is the force impulse at the pivot, N s, of which Bullet compares the components, and the moment about it, N m s,
// of all rows. One that is too much is cut down to the threshold, as Bullet does, and the joint disabled. Else Bullet, which
// is going to look at the rows as they have been mixed, is to find none at the threshold.
void Joint::breakIfOverloaded(btSolverBody& a, btSolverBody& b) {
  Vec3 P = Vec3::Zero(), T = Vec3::Zero();
  const int n = m_rows.equalities();
  for (int i = 0; i < m_solver_row_count; ++i) {
    const btSolverConstraint& row = m_solver_rows[i];
    P += row.m_appliedImpulse * view(row.m_contactNormal2);
    T += row.m_appliedImpulse * view(row.m_relpos2CrossNormal);
  }
  for (int i = 0; i < n; ++i)
    if (!m_rows[i].angular) T -= P.dot(m_rows[i].L) * m_rows[i].A_b;
  const Scalar load = btMax(P.cwiseAbs().maxCoeff(), T.norm()),
               threshold = m_constraint.getBreakingImpulseThreshold();
  // Bullet ends a step whose passes change nothing: what has settled may be the end.
  const bool settled = load == m_last_load;
  m_last_load = load;
  if (m_passes_left > 0 && !settled) return;
  if (load >= threshold) {
    ImpulseSum sum;
    for (int i = 0; i < n; ++i) {
      btSolverConstraint& row = m_solver_rows[i];
      sum.setImpulse(row, threshold / load * row.m_appliedImpulse);
      row.m_lowerLimit = row.m_upperLimit = row.m_appliedImpulse;
    }
    sum.apply(a, b);
    m_constraint.setEnabled(false);
    return;
  }
  for (int i = 0; i < n; ++i) {
    const Scalar times =
        2 * btFabs(m_solver_rows[i].m_appliedImpulse) / btMax(threshold, SIMD_EPSILON);
    if (times >= 2) lengthen(m_solver_rows[i], times);
  }
}

inline bool Joint::goesOn() const {
  for (int i = 0; i < m_rows.equalities(); ++i) {
    const btSolverConstraint& row = m_solver_rows[i];
    if (btFabs(row.m_appliedImpulse) > goes_on * row.m_jacDiagABInv) return true;
  }
  return false;
}

btSolverConstraint* Joint::rigidLimit(const Row& row) const {
  if (m_solver_rows == nullptr || row.axis < 0 || !isLimit(row)) return nullptr;
  btSolverConstraint& of = m_solver_rows[m_rows.axis(row.axis).row[Axis::limit]];
  return of.m_cfm == 0 ? &of : nullptr;
}

// A load takes so much less in a shorter step; in a longer one what made up for an error of velocity takes no more.
inline Scalar Joint::lasting() const {
  return curvedPart() * btMin(Scalar(1), m_time_step / m_last_time_step);
}

// The impulse from which a row with bounds may go on: this part of the last step's.
Scalar Joint::warmLimit(int solver_row, Scalar part) const {
  const Row* const row = limitAt(solver_row);
  if (row == nullptr || breakable()) return 0;
  const btSolverConstraint* const of = rigidLimit(*row);
  if (of == nullptr) return 0;
  const AxisState& state = m_rows.axis(row->axis);
  const Scalar impulse = part * lasting() * -state.sign * state.impulse[Axis::limit];
  return btMax(of->m_lowerLimit, btMin(impulse, of->m_upperLimit));
}

// After the first pass: the rows go on from what they had in the last step, over-relaxed from there on. (No K: Bullet
// passes over the row.)
inline void Joint::startWarm(btSolverBody& a, btSolverBody& b) {
  const Scalar part = warm_start * lasting();
  ImpulseSum sum;
  if (goesOn()) {
    for (int i = 0; i < m_rows.equalities(); ++i)
      if (m_solver_rows[i].m_jacDiagABInv > 0)
        sum.setImpulse(m_solver_rows[i], part * m_rows.history(i).impulse);
    for (int i = m_rows.equalities(); i < m_rows.size(); ++i) {
      const AxisState& state = m_rows.axis(m_rows[i].axis);
      btSolverConstraint* const row =
          state.impulse[Axis::limit] != 0 ? rigidLimit(m_rows[i]) : nullptr;
      if (row != nullptr && row->m_jacDiagABInv > 0)
        sum.setImpulse(*row, warmLimit(state.row[Axis::limit], warm_limit));
    }
    sum.apply(a, b);
  }
  relax(relaxation());
  m_relaxed = true;
}

inline Scalar Joint::relaxation() const { return 1 + over_relaxation * curvedPart(); }

inline void Joint::relax(Scalar factor) {
  const auto scale = [factor](btSolverConstraint& row) {
    row.m_jacDiagABInv *= factor;
    row.m_rhs *= factor;
  };
  for (int i = 0; i < m_rows.equalities(); ++i) scale(m_solver_rows[i]);
  for (int i = m_rows.equalities(); i < m_rows.size(); ++i)
    if (btSolverConstraint* const row = rigidLimit(m_rows[i])) scale(*row);
}

// In the place of the residual of the last step, of which the targets have been made.
inline void Joint::rememberPass() {
  for (int i = 0; i < m_rows.equalities(); ++i)
    m_rows.history(i).residual = m_solver_rows[i].m_appliedImpulse;
}

// Whether others have changed the impulses since the first pass.
inline bool Joint::isDisturbed() const {
  Scalar largest = 0, change = 0;
  for (int i = 0; i < m_rows.equalities(); ++i) {
    const Scalar impulse = m_solver_rows[i].m_appliedImpulse;
    largest = btMax(largest, btFabs(impulse));
    change = btMax(change, btFabs(impulse - m_rows.history(i).residual));
  }
  return change > undisturbed * largest;
}

// What the passes have come to, and the velocities that they leave.
inline void Joint::learn(const btSolverBody& a, const btSolverBody& b) {
  const RelativeVelocity V(linearOf(a), angularOf(a), linearOf(b), angularOf(b));
  for (int i = 0; i < m_rows.equalities(); ++i) {
    RowHistory& history = m_rows.history(i);
    history.impulse = m_solver_rows[i].m_appliedImpulse;
    history.residual = V.along(m_rows[i]) - m_rows[i].target;
  }
  m_learned = true;
}

// How far the rows move besides J v with the velocities of now, and the targets to match: these go through the
// elimination of rows/block.h as they did there.
PINTLE_NOINLINE void Joint::lookAhead(const btSolverBody& a, const btSolverBody& b) {
  const Vec3 v_ab = linearOf(b) - linearOf(a), w_a = angularOf(a), w_b = angularOf(b);
  const Scalar max_w = max_look_turn / m_time_step;
  if (!(btMax(w_a.squaredNorm(), w_b.squaredNorm()) < max_w * max_w)) return;
  const int n = m_rows.equalities();
  Scalar now[max_joint_rows], disturbance = 0;
  for (int i = 0; i < n; ++i) {
    const Row& row = m_rows[i];
    if (btFabs(row.position) > open_speed * m_time_step) return;
    now[i] = velocity(row, v_ab, w_a, w_b);
    disturbance += btFabs(now[i] - row.target);
  }
  // Still too early, by what the last look found.
  if (disturbance > max_growth * max_disturbance * m_look_change) return;
  btTransform end_a, end_b;
  endOfStep(bodyA().getCenterOfMassTransform(), a, m_time_step, end_a);
  endOfStep(bodyB().getCenterOfMassTransform(), b, m_time_step, end_b);
  RowMemory<max_joint_rows, max_joint_rows> memory;
  Rows end(memory);
  addRows(PosePair(end_a, end_b), end);
  if (end.equalities() != n) return;
  const Scalar curved_time = m_curved_time;
  Scalar change[max_joint_rows], sum = 0;
  for (int i = 0; i < m_rows.size(); ++i) {
    const Row& row = m_rows[i];
    const bool is_equality = i < n;
    change[i] = 0;
    if (!is_equality && rigidLimit(row) == nullptr) continue;
    // At the end more limits may have a row.
    int at_end = i;
    while (at_end < end.size() && end[at_end].axis != row.axis) ++at_end;
    if (at_end == end.size() || !isSameRow(row, end[at_end])) {
      if (is_equality) return;
      continue;
    }
    const Scalar sign = is_equality ? Scalar(1) : Scalar(m_rows.axis(row.axis).sign);
    if (!is_equality) now[i] = velocity(row, v_ab, w_a, w_b);
    const Scalar gain = (end[at_end].position - row.position) / m_time_step - sign * now[i];
    change[i] = sign * (curved_time * row.curvature - gain);
    if (is_equality) sum += btFabs(change[i]);
  }
  m_look_change = sum;
  if (!(disturbance < max_disturbance * sum && sum < infinity)) return;  // also NaN
  Scalar by_K[max_joint_rows];
  for (int i = 0; i < m_rows.size(); ++i) {
    Row& row = m_rows[i];
    Scalar eliminated = 0;
    for (int j = 0; j < i && j < n; ++j)
      eliminated -= product(row, m_solver_rows[j], a, b) * by_K[j];
    const auto move = [](btSolverConstraint& of, Scalar by) { of.m_rhs -= by * of.m_jacDiagABInv; };
    if (i < n) {
      eliminated += change[i];
      row.curvature -= change[i] / curved_time;
      row.target += change[i];
      move(m_solver_rows[i], eliminated);
      by_K[i] = eliminated / product(row, m_solver_rows[i], a, b);
      continue;
    }
    // Of a limit what the motion adds to its coordinate, too; a motor's velocity is that of the end.
    const AxisState& state = m_rows.axis(row.axis);
    row.curvature -= state.sign * change[i] / curved_time;
    for (const Axis::Part k : Axis::each_part)
      if (state.row[k] >= 0)
        move(m_solver_rows[state.row[k]], eliminated + (k == Axis::limit ? change[i] : 0));
  }
}

// Bullet calls this after each pass over the rows of all joints, before that over the contacts.
void Joint::afterPass(btSolverBody& a, btSolverBody& b) {
  m_shows_passes = true;
  if (m_passes_left > 0 && (--m_passes_left <= 1 || m_acts_in_each)) actBetweenPasses(a, b);
  if (m_solver_rows == nullptr) return;
  for (int i = m_rows.equalities(); i < m_rows.size(); ++i) seeAxis(m_rows[i], a, b);
}

PINTLE_NOINLINE void Joint::actBetweenPasses(btSolverBody& a, btSolverBody& b) {
  const int done = m_passes - m_passes_left;
  // Not after the last one: nothing would come of it. And soon: Bullet ends a step whose passes change nothing.
  if (m_looks_ahead && m_passes_left > 0 && done <= last_look && isPowerOfTwo(done))
    lookAhead(a, b);
  if (done == 1) {
    m_undisturbed = false;
    rememberPass();
    if (breakable()) liftThresholds();
    if (m_may_start_warm && m_might_start_warm && m_remembers) startWarm(a, b);
    if (m_relaxed && !m_looks_ahead && !breakable()) m_acts_in_each = false;
  } else if (breakable()) {
    breakIfOverloaded(a, b);
  }
  if (m_acts_in_each && !m_looks_ahead && !breakable()) rest(a, b, done);
  if (m_passes_left == 1 && m_relaxed) relax(1 / relaxation());
  if (m_passes_left > 0) return;
  boundTurn(a, m_time_step);
  boundTurn(b, m_time_step);
  if (!m_starts_apart) {
    m_undisturbed = done > 1 && !isDisturbed();
    if (!m_undisturbed) learn(a, b);
  }
  stopIfSlow(a);
  stopIfSlow(b);
}

// A joint that nobody disturbs is solved by one pass, and Bullet is spared the others: a pass after which its impulses are
// as they were has found nothing to do, and the next one would not, either, while its bodies stay as they are. What moves
// one wakes the joint, which makes up for the pass that it was left out of: before the contacts, as if it had been in it.
// (Two passes have to agree: btNNCGConstraintSolver moves bodies by what the last but one did.)
inline void Joint::rest(btSolverBody& a, btSolverBody& b, int done) {
  if (m_rests && hashOfVelocities(a, b) != m_velocities) {
    m_undisturbed = m_rests = false;
    setPasses(m_passes);
    solveRows(a, b);
  } else if (done > 1 && !m_rests) {
    m_undisturbed = isSettled();
    m_rests = m_undisturbed && done == passes_to_rest;
    if (m_rests) {
      // Another joint may have moved a body since this pass.
      solveRows(a, b);
      setPasses(0);
    }
    if (m_undisturbed) {
      stopIfSlow(a);
      stopIfSlow(b);
    }
  }
  m_acts_in_each = done == 1 || m_undisturbed;
  if (m_rests) m_velocities = hashOfVelocities(a, b);
}

inline void Joint::solveRows(btSolverBody& a, btSolverBody& b) {
  for (int i = 0; i < m_solver_row_count; ++i) solveRow(m_solver_rows[i], a, b);
}

// Whether the impulses have not changed, but for rounding: those of equalities since the first pass, those of axes since
// the last one.
inline bool Joint::isSettled() const {
  Scalar largest = 0, change = 0;
  const auto see = [&](Scalar now, Scalar before) {
    largest = btMax(largest, btFabs(now));
    change = btMax(change, btFabs(now - before));
  };
  for (int i = 0; i < m_rows.equalities(); ++i)
    see(m_solver_rows[i].m_appliedImpulse, m_rows.history(i).residual);
  for (int i = m_rows.equalities(); i < m_rows.size(); ++i) {
    const AxisState& axis = m_rows.axis(m_rows[i].axis);
    for (const Axis::Part k : Axis::each_part)
      if (axis.row[k] >= 0)
        see(-axis.sign * m_solver_rows[axis.row[k]].m_appliedImpulse, axis.impulse[k]);
  }
  return change <= rounding_of_impulses * largest;
}

// Of Bullet's passes over all rows.
inline void Joint::setPasses(int count) {
  for (int i = 0; i < m_solver_row_count; ++i)
    m_solver_rows[i].m_overrideNumSolverIterations = count;
}

// What the parts of an axis have come to, and what others do to a coordinate along which an impulse is given.
inline void Joint::seeAxis(const Row& row, const btSolverBody& a, const btSolverBody& b) {
  AxisState& axis = m_rows.axis(row.axis);
  for (const Axis::Part k : Axis::each_part)
    if (axis.row[k] >= 0)
      axis.impulse[k] = -axis.sign * m_solver_rows[axis.row[k]].m_appliedImpulse;
  axis.seen = axis.given;
  if (axis.given) seeDisturbance(row, axis, a, b);
}

PINTLE_NOINLINE void Joint::seeDisturbance(const Row& row, AxisState& axis, const btSolverBody& a,
                                           const btSolverBody& b) {
  Scalar taken = 0;  // by rows of the axis itself
  for (const Axis::Part k : Axis::each_part) {
    if (axis.row[k] < 0) continue;
    const btSolverConstraint& part = m_solver_rows[axis.row[k]];
    if (part.m_lowerLimit != part.m_upperLimit) taken += axis.impulse[k];
  }
  const Scalar now = velocity(row, linearOf(b) - linearOf(a), angularOf(a), angularOf(b));
  axis.disturbance = axis.sign * now - axis.expected - axis.K * taken;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

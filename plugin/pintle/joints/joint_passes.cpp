#include <pintle/joints/joint_passes.h>

#include <pintle/body_pair.h>
#include <pintle/joints/joint.h>
#include <pintle/solver_body.h>

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
constexpr Scalar least_look = Scalar(0.05), most_look = Scalar(0.3), open_speed = Scalar(0.3);

// Looks come after one, two, four and eight passes: more are not counted.
constexpr int most_passes_done = 15;

// Others may disturb the rows of a joint by so many times what that changes: beyond it is too early.
constexpr Scalar most_disturbance = 3;

// Stops a velocity that is made of `others` and `part`, by that part.
void stopIfSlow(btVector3& part, const btVector3& others) {
  for (int i = 0; i < 3; ++i) {
    if (btFabs(part[i] + others[i]) < least_speed) part[i] = -others[i];
    if (btFabs(part[i]) < least_speed) part[i] = 0;
  }
}
void stopIfSlow(btSolverBody& body) {
  stopIfSlow(body.m_deltaLinearVelocity, body.m_linearVelocity + body.m_externalForceImpulse);
  stopIfSlow(body.m_deltaAngularVelocity, body.m_angularVelocity + body.m_externalTorqueImpulse);
}

// Bullet's gyroscopic term multiplies the velocity of what turns by thousands of radians in a step. None leaves
// its joints faster than this, rad: Bullet turns no body by more than pi/4.
constexpr Scalar fastest_turn = 1000;
void boundTurn(btSolverBody& body, Scalar dt) {
  const btVector3 w = angularVelocity(body);
  const Scalar turn2 = w.length2() * dt * dt;
  if (turn2 > fastest_turn * fastest_turn && !body.internalGetInvMass().isZero())
    body.m_deltaAngularVelocity -= (1 - fastest_turn / btSqrt(turn2)) * w;
}

Vec3 linear(const btSolverBody& body) { return view(linearVelocity(body)); }
Vec3 angular(const btSolverBody& body) { return view(angularVelocity(body)); }

bool isPowerOfTwo(int n) { return (n & (n - 1)) == 0; }

// J M^-1 J^T of two rows of a joint, both of the same sign.
Scalar product(const Row& row, const btSolverConstraint& other, const btSolverBody& a,
               const btSolverBody& b) {
  const btVector3 by_a = other.m_contactNormal1 * a.internalGetInvMass(),
                  by_b = other.m_contactNormal2 * b.internalGetInvMass();
  return row.L.dot(view(by_a) - view(by_b)) + row.A_a.dot(view(other.m_angularComponentA)) -
         row.A_b.dot(view(other.m_angularComponentB));
}

void setImpulse(btSolverConstraint& row, btSolverBody& a, btSolverBody& b, Scalar impulse) {
  const Scalar change = impulse - row.m_appliedImpulse;
  a.internalApplyImpulse(row.m_contactNormal1 * a.internalGetInvMass(), row.m_angularComponentA,
                         change);
  b.internalApplyImpulse(row.m_contactNormal2 * b.internalGetInvMass(), row.m_angularComponentB,
                         change);
  row.m_appliedImpulse = impulse;
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

void Joint::beginPasses(const btConstraintInfo2& info) {
  m_solver_rows = solverRows(info);
  const int own = getOverrideNumSolverIterations();
  const int passes = own > 0 ? own : info.m_numIterations;
  // Bullet shows none beyond its own number; so many are enough for any joint.
  const bool shown = m_solver_rows != nullptr && passes <= info.m_numIterations &&
                     passes <= std::numeric_limits<short>::max();
  m_passes_left = static_cast<short>(shown ? passes : 0);
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
  const Scalar turn = m_angular_speed * m_time_step;
  m_looks_ahead =
      m_formulation == Formulation::conditioned && turn > least_look && turn < most_look;
  m_passes_done = 0;
}

PINTLE_NOINLINE void Joint::forget() {
  m_remembers = false;
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
               threshold = getBreakingImpulseThreshold();
  // Bullet ends a step whose passes change nothing: what has settled may be the end.
  const bool settled = m_passes_done > 1 && load == m_last_load;
  m_last_load = load;
  if (m_passes_left > 0 && !settled) return;
  if (load >= threshold) {
    for (int i = 0; i < n; ++i) {
      btSolverConstraint& row = m_solver_rows[i];
      setImpulse(row, a, b, threshold / load * row.m_appliedImpulse);
      row.m_lowerLimit = row.m_upperLimit = row.m_appliedImpulse;
    }
    setEnabled(false);
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

// The rows go on from what they had in the last step. (No K: Bullet passes over the row.)
inline void Joint::start(btSolverBody& a, btSolverBody& b) {
  const Scalar part = warm_start * lasting();
  for (int i = 0; i < m_rows.equalities(); ++i)
    if (m_solver_rows[i].m_jacDiagABInv > 0)
      setImpulse(m_solver_rows[i], a, b, part * m_rows.history(i).impulse);
  for (int i = m_rows.equalities(); i < m_rows.size(); ++i) {
    const AxisState& state = m_rows.axis(m_rows[i].axis);
    btSolverConstraint* const row =
        state.impulse[Axis::limit] != 0 ? rigidLimit(m_rows[i]) : nullptr;
    if (row != nullptr && row->m_jacDiagABInv > 0)
      setImpulse(*row, a, b, warmLimit(state.row[Axis::limit], warm_limit));
  }
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
  const Vec3 v_ab = linear(b) - linear(a), w_a = angular(a), w_b = angular(b);
  for (int i = 0; i < m_rows.equalities(); ++i) {
    RowHistory& history = m_rows.history(i);
    history.impulse = m_solver_rows[i].m_appliedImpulse;
    history.residual = velocity(m_rows[i], v_ab, w_a, w_b) - m_rows[i].target;
  }
  m_learned = true;
}

// How far the rows move besides J v with the velocities of now, and the targets to match: these go through the
// elimination of rows/block.h as they did there.
PINTLE_NOINLINE void Joint::lookAhead(const btSolverBody& a, const btSolverBody& b) {
  const Vec3 v_ab = linear(b) - linear(a), w_a = angular(a), w_b = angular(b);
  const Scalar most = most_look / m_time_step;
  if (!(btMax(w_a.squaredNorm(), w_b.squaredNorm()) < most * most)) return;
  btTransform end_a, end_b;
  endOfStep(m_rbA.getCenterOfMassTransform(), a, m_time_step, end_a);
  endOfStep(m_rbB.getCenterOfMassTransform(), b, m_time_step, end_b);
  RowMemory<most_joint_rows, most_joint_rows> memory;
  Rows end(memory);
  addRows(BodyPair(m_rbA, end_a, m_rbB, end_b), end);
  const int n = m_rows.equalities();
  if (end.equalities() != n) return;
  const Scalar curved_time = m_curved_time;
  Scalar change[most_joint_rows], sum = 0, disturbance = 0;
  for (int i = 0; i < m_rows.size(); ++i) {
    const Row& row = m_rows[i];
    const bool is_equality = i < n;
    change[i] = 0;
    if (is_equality && btFabs(row.position) > open_speed * m_time_step) return;
    // A limit that the step leaves has no row at its end.
    if (!is_equality && !(rigidLimit(row) != nullptr && i < end.size() && end[i].axis == row.axis))
      continue;
    if (!isSameRow(row, end[i])) {
      if (is_equality) return;
      continue;
    }
    const Scalar sign = is_equality ? Scalar(1) : Scalar(m_rows.axis(row.axis).sign);
    const Scalar now = velocity(row, v_ab, w_a, w_b);
    const Scalar gain = (end[i].position - row.position) / m_time_step - sign * now;
    change[i] = sign * (curved_time * row.curvature - gain);
    if (!is_equality) continue;
    sum += btFabs(change[i]);
    disturbance += btFabs(now - row.target);
  }
  if (!(disturbance < most_disturbance * sum && sum < infinity)) return;  // also NaN
  Scalar by_K[most_joint_rows];
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
void Joint::solveConstraintObsolete(btSolverBody& a, btSolverBody& b, btScalar) {
  m_shows_passes = true;
  if (m_passes_left > 0) {
    if (m_passes_done < most_passes_done) ++m_passes_done;
    --m_passes_left;
    if (m_passes_left % 2 == 0) {
      stopIfSlow(a);
      stopIfSlow(b);
    }
    // Not after the last one: nothing would come of it. And soon: Bullet ends a step whose passes change nothing.
    if (m_looks_ahead && m_passes_left > 0 && isPowerOfTwo(m_passes_done)) lookAhead(a, b);
    if (m_passes_left == 0) {
      boundTurn(a, m_time_step);
      boundTurn(b, m_time_step);
    }
    if (m_passes_done == 1 && breakable()) liftThresholds();
    if (m_passes_done > 1 && breakable()) breakIfOverloaded(a, b);
    const bool warm = m_may_start_warm && m_might_start_warm && m_remembers;
    if (m_passes_done == 1) {
      rememberPass();
      if (warm) {
        if (goesOn()) start(a, b);
        relax(relaxation());
        m_relaxed = true;
      }
    } else if (m_passes_left == 1 && m_relaxed) {
      relax(1 / relaxation());
    }
    if (m_passes_left == 0 && !m_starts_apart && (m_passes_done == 1 || isDisturbed())) learn(a, b);
  }
  if (m_solver_rows == nullptr) return;
  for (int i = m_rows.equalities(); i < m_rows.size(); ++i) seeAxis(m_rows[i], a, b);
}

// What the parts of an axis have come to, and what others do to a coordinate along which an impulse is given.
void Joint::seeAxis(Row& row, const btSolverBody& a, const btSolverBody& b) {
  AxisState& axis = m_rows.axis(row.axis);
  Scalar taken = 0;  // by rows of the axis itself
  for (const Axis::Part k : Axis::each_part) {
    axis.impulse[k] = 0;
    if (axis.row[k] < 0) continue;
    const btSolverConstraint& part = m_solver_rows[axis.row[k]];
    axis.impulse[k] = -axis.sign * part.m_appliedImpulse;
    if (part.m_lowerLimit != part.m_upperLimit) taken += axis.impulse[k];
  }
  axis.seen = axis.given;
  if (!axis.given) return;
  const Scalar now = velocity(row, linear(b) - linear(a), angular(a), angular(b));
  axis.disturbance = axis.sign * now - axis.expected - axis.K * taken;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

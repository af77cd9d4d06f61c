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
constexpr Scalar over_relaxation = Scalar(0.3);

// With up to so many passes a start that is not right is not made up for. They leave a joint with what the
// others did to it after its turn, the residual. One that lasts (the part in which two steps agree: a
// load, not a blow) is going to come again, and the next target makes up for this part of it. Joints that
// fight each other for good then ask for 1 / (1 - feed_forward) times what they would: bounded.
constexpr int few_passes = 3;
constexpr Scalar feed_forward = Scalar(0.6);

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

}  // namespace

void Joint::beginPasses(const btConstraintInfo2& info) {
  m_solver_rows = solverRows(info);
  const int own = getOverrideNumSolverIterations();
  const int passes = own > 0 ? own : info.m_numIterations;
  // Bullet shows none beyond its own number; so many are enough for any joint.
  const bool shown = m_solver_rows != nullptr && passes <= info.m_numIterations &&
                     passes <= std::numeric_limits<short>::max();
  m_passes_left = static_cast<short>(shown ? passes : 0);
  // Forces on bodies that turn far in a step are others in the next.
  const bool lasts = m_starts_warm && curvedPart() > 0;
  m_next = m_passes_left > few_passes && lasts ? Last::impulse
           : m_passes_left > 0                 ? Last::residual
                                               : Last::nothing;
  const Scalar turn = m_angular_speed * m_time_step;
  m_looks_ahead =
      m_formulation == Formulation::conditioned && turn > least_look && turn < most_look;
  m_passes_done = 0;
}

PINTLE_NOINLINE void Joint::forget() {
  m_last = Last::nothing;
  for (int i = 0; i < m_rows.axisCount(); ++i) m_rows.axis(i).seen = false;
}

inline bool Joint::goesOn() const {
  for (int i = 0; i < m_rows.equalities(); ++i) {
    const btSolverConstraint& row = m_solver_rows[i];
    if (btFabs(row.m_appliedImpulse) > goes_on * row.m_jacDiagABInv) return true;
  }
  return false;
}

inline bool Joint::isRigidLimit(int row) const {
  return isLimitAlone(m_rows[row]) && m_solver_rows[row].m_cfm == 0;
}

// A load takes so much less in a shorter step; in a longer one what made up for an error of velocity takes no more.
inline Scalar Joint::lasting() const {
  return curvedPart() * btMin(Scalar(1), m_time_step / m_last_time_step);
}

// The impulse from which a row with bounds may go on: this part of the last step's.
Scalar Joint::warmLimit(int row, Scalar part) const {
  if (row < m_rows.equalities() || m_solver_rows == nullptr || breakable() || !isRigidLimit(row))
    return 0;
  const btSolverConstraint& of = m_solver_rows[row];
  const Scalar impulse = part * lasting() * m_rows[row].last;
  return btMax(of.m_lowerLimit, btMin(impulse, of.m_upperLimit));
}

// The rows go on from what they had in the last step.
inline void Joint::start(btSolverBody& a, btSolverBody& b) {
  const Scalar part = warm_start * lasting();
  for (int i = 0; i < m_rows.size(); ++i) {
    btSolverConstraint& row = m_solver_rows[i];
    // No K: Bullet passes over the row.
    if (!(row.m_jacDiagABInv > 0)) continue;
    if (i < m_rows.equalities()) {
      setImpulse(row, a, b, part * m_rows[i].last);
    } else if (m_rows[i].last != 0 && isRigidLimit(i)) {
      setImpulse(row, a, b, warmLimit(i, warm_limit));
    }
  }
}

inline Scalar Joint::relaxation() const { return 1 + over_relaxation * curvedPart(); }

inline void Joint::relax(Scalar factor) {
  for (int i = 0; i < m_rows.size(); ++i) {
    if (i >= m_rows.equalities() && !isRigidLimit(i)) continue;
    m_solver_rows[i].m_jacDiagABInv *= factor;
    m_solver_rows[i].m_rhs *= factor;
  }
}

// Row::correction holds those of the first pass.
inline void Joint::takeImpulses() {
  Scalar largest = 0, change = 0;
  for (int i = 0; i < m_rows.equalities(); ++i) {
    const Scalar impulse = m_solver_rows[i].m_appliedImpulse;
    largest = btMax(largest, btFabs(impulse));
    change = btMax(change, btFabs(impulse - m_rows[i].correction));
    m_rows[i].last = impulse;
  }
  m_last = change > undisturbed * largest ? Last::impulse : Last::nothing;
}

inline void Joint::takeResiduals(const btSolverBody& a, const btSolverBody& b) {
  const Vec3 v_ab = linear(b) - linear(a), w_a = angular(a), w_b = angular(b);
  for (int i = 0; i < m_rows.equalities(); ++i) {
    Row& row = m_rows[i];
    const Scalar now = velocity(row, v_ab, w_a, w_b) - row.target;
    const Scalar last = m_last == Last::residual ? row.last : Scalar(0);
    row.correction =
        agree(now, last) ? feed_forward * (btFabs(now) < btFabs(last) ? now : last) : Scalar(0);
    row.last = now;
  }
  m_last = Last::residual;
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
  const Scalar curved_time = curvedTime();
  Scalar change[most_joint_rows], sum = 0, disturbance = 0;
  for (int i = 0; i < m_rows.size(); ++i) {
    const Row& row = m_rows[i];
    const bool is_equality = i < n;
    change[i] = 0;
    if (is_equality && btFabs(row.position) > open_speed * m_time_step) return;
    // A limit that the step leaves has no row at its end.
    if (!is_equality && !(isRigidLimit(i) && i < end.size() && end[i].axis == row.axis)) continue;
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
    btSolverConstraint& solver_row = m_solver_rows[i];
    const Scalar sign = i < n ? Scalar(1) : Scalar(m_rows.axis(row.axis).sign);
    row.curvature -= sign * change[i] / curved_time;
    if (i < n) row.target += change[i];
    Scalar eliminated = change[i];
    for (int j = 0; j < i && j < n; ++j)
      eliminated -= product(row, m_solver_rows[j], a, b) * by_K[j];
    solver_row.m_rhs -= eliminated * solver_row.m_jacDiagABInv;
    if (i < n) by_K[i] = eliminated / product(row, solver_row, a, b);
  }
}

// Bullet calls this after each pass over the rows of all joints, before that over the contacts.
void Joint::solveConstraintObsolete(btSolverBody& a, btSolverBody& b, btScalar) {
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
    if (m_next == Last::impulse) {
      if (m_passes_done == 1) {
        for (int i = 0; i < m_rows.equalities(); ++i)
          m_rows[i].correction = m_solver_rows[i].m_appliedImpulse;
        if (m_last == Last::impulse) {
          if (goesOn()) start(a, b);
          relax(relaxation());
        }
      } else if (m_passes_left == 1) {
        if (m_last == Last::impulse) relax(1 / relaxation());
      } else if (m_passes_left == 0) {
        takeImpulses();
      }
    } else if (m_next == Last::residual && m_passes_left == 0) {
      takeResiduals(a, b);
    }
  }
  for (int i = m_rows.equalities(); i < m_rows.size(); ++i) {
    Row& row = m_rows[i];
    AxisState& axis = m_rows.axis(row.axis);
    if (m_solver_rows != nullptr) axis.whole = -axis.sign * m_solver_rows[i].m_appliedImpulse;
    axis.seen = axis.given;
    if (!axis.given) continue;
    const Scalar now = velocity(row, linear(b) - linear(a), angular(a), angular(b));
    row.last = axis.sign * now - row.target;
  }
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

#include <pintle/body_pair.h>
#include <pintle/joints/bullet_rows.h>
#include <pintle/joints/constants.h>
#include <pintle/joints/joint.h>
#include <pintle/joints/solver_rows.h>
#include <pintle/solver_body.h>

#include <cstdint>
#include <cstring>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// Sets to 0 what is slower than min_speed of the velocity that `part` and `others` make.
void stopIfSlow(btVector3& part, const btVector3& others) {
  for (int i = 0; i < 3; ++i)
    if (btFabs(part[i] + others[i]) < min_speed) part[i] = -others[i];
}
void stopIfSlow(btSolverBody& body) {
  stopIfSlow(body.m_deltaLinearVelocity, body.m_linearVelocity + body.m_externalForceImpulse);
  stopIfSlow(body.m_deltaAngularVelocity, body.m_angularVelocity + body.m_externalTorqueImpulse);
}

void boundTurn(btSolverBody& body, Scalar dt) {
  const btVector3 w = angularVelocity(body);
  const Scalar turn2 = w.length2() * dt * dt;
  if (turn2 > max_turn_of_step * max_turn_of_step && !body.internalGetInvMass().isZero())
    body.m_deltaAngularVelocity -= (1 - max_turn_of_step / btSqrt(turn2)) * w;
}

Vec3 linearOf(const btSolverBody& body) { return view(linearVelocity(body)); }
Vec3 angularOf(const btSolverBody& body) { return view(angularVelocity(body)); }

// A hash of the velocities that a step's impulses have given the bodies so far. (FNV-1a, by words.)
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

}  // namespace

void BulletRows::beginPasses(const Info2& info) {
  const int own = m_joint.constraint().getOverrideNumSolverIterations();
  const int passes = own > 0 ? own : info.m_numIterations;
  // Bullet shows none beyond its own number; so many are enough for any joint.
  const bool shown = m_solver_rows != nullptr && passes <= info.m_numIterations &&
                     passes <= std::numeric_limits<short>::max();
  m_passes = m_passes_left = static_cast<short>(shown ? passes : 0);
  m_starts_warm = m_remembers && m_start_left == 0 && m_passes > few_passes &&
                  m_joint.curvedPart(m_joint.angularSpeed()) > 0;
  m_acts_in_each = true;
  m_last_load = -1;
}

void BulletRows::afterPass(btSolverBody& a, btSolverBody& b) {
  m_shows_passes = true;
  if (m_passes_left > 0 && (--m_passes_left == 0 || m_acts_in_each)) actBetweenPasses(a, b);
  if (m_solver_rows == nullptr) return;
  for (int i = m_rows.equalities(); i < m_rows.size(); ++i) seeAxis(m_rows[i], a, b);
}

PINTLE_NOINLINE void BulletRows::actBetweenPasses(btSolverBody& a, btSolverBody& b) {
  const int done = m_passes - m_passes_left;
  if (m_joint.breakable()) {
    if (done == 1) liftThresholds();
    if (done > 1) breakIfOverloaded(a, b);
  }
  if (done == 1) {
    for (int i = 0; i < m_rows.equalities(); ++i)
      m_rows.history(i).first = m_solver_rows[i].m_appliedImpulse;
    if (m_starts_warm) startWarm(a, b);
  }
  if (m_acts_in_each && !m_joint.breakable()) rest(a, b, done);
  if (m_passes_left > 0) return;
  boundTurn(a, m_joint.m_time_step);
  boundTurn(b, m_joint.m_time_step);
  stopIfSlow(a);
  stopIfSlow(b);
  // Impulses that nobody disturbed are found by the first pass of the next step, too.
  m_remembers = done > 1 && !isSettled(false);
  for (int i = 0; i < m_rows.equalities(); ++i)
    m_rows.history(i).impulse = m_solver_rows[i].m_appliedImpulse;
}

// The few passes that Bullet makes from nothing do not carry a load from one end of a chain to the other. Impulses of the last step are most of
// what this one is going to need: the rows go on from a part of them. (No K: Bullet passes over the row.) A load takes so much less in a shorter
// step; in a longer one what made up for an error of velocity takes no more.
inline void BulletRows::startWarm(btSolverBody& a, btSolverBody& b) {
  if (!goesOn()) return;
  const Scalar lasting = m_joint.curvedPart(m_joint.angularSpeed()) *
                         btMin(Scalar(1), m_joint.m_time_step / m_last_dt);
  ImpulseSum sum;
  for (int i = 0; i < m_rows.equalities(); ++i)
    if (m_solver_rows[i].m_jacDiagABInv > 0)
      sum.setImpulse(m_solver_rows[i], warm_start * lasting * m_rows.history(i).impulse);
  if (btSolverConstraint* const limit = onlyLimit()) {
    const Scalar impulse = lasting * -onlyAxis()->sign * m_last_limit_impulse;
    sum.setImpulse(*limit, btMax(limit->m_lowerLimit, btMin(impulse, limit->m_upperLimit)));
  }
  sum.apply(a, b);
}

// Several axis rows are not orthogonal to each other: they do not go on from impulses of the last step.
const AxisState* BulletRows::onlyAxis() const {
  const int n = m_rows.equalities();
  return m_rows.size() == n + 1 ? &m_rows.axis(m_rows[n].axis) : nullptr;
}

// The row of a rigid limit, if it is that of the only axis; else null.
inline btSolverConstraint* BulletRows::onlyLimit() const {
  const AxisState* const axis = onlyAxis();
  if (axis == nullptr || axis->row[Axis::limit] < 0) return nullptr;
  btSolverConstraint& row = m_solver_rows[axis->row[Axis::limit]];
  return row.m_cfm == 0 && row.m_jacDiagABInv > 0 ? &row : nullptr;
}

inline bool BulletRows::goesOn() const {
  for (int i = 0; i < m_rows.equalities(); ++i) {
    const btSolverConstraint& row = m_solver_rows[i];
    if (btFabs(row.m_appliedImpulse) > goes_on * row.m_jacDiagABInv) return true;
  }
  return false;
}

// A threshold is compared with the load (breakIfOverloaded): until then no row is to stop at it.
void BulletRows::liftThresholds() {
  for (int i = 0; i < m_rows.equalities(); ++i) {
    m_solver_rows[i].m_lowerLimit = -infinity;
    m_solver_rows[i].m_upperLimit = infinity;
  }
}

// The load is the force impulse at the pivot, N s, of which Bullet compares the components, and the moment about it, N m s,
// of all rows. One that is too much is cut down to the threshold, as Bullet does, and the joint disabled. Else Bullet, which
// is going to look at the rows as they have been mixed, is to find none at the threshold.
void BulletRows::breakIfOverloaded(btSolverBody& a, btSolverBody& b) {
  Vec3 P = Vec3::Zero(), T = Vec3::Zero();
  const int n = m_rows.equalities();
  for (int i = 0; i < m_count; ++i) {
    const btSolverConstraint& row = m_solver_rows[i];
    P += row.m_appliedImpulse * view(row.m_contactNormal2);
    T += row.m_appliedImpulse * view(row.m_relpos2CrossNormal);
  }
  for (int i = 0; i < n; ++i)
    if (!m_rows[i].angular) T -= P.dot(m_rows[i].L) * m_rows[i].A_b;
  const Scalar load = btMax(P.cwiseAbs().maxCoeff(), T.norm()),
               threshold = m_joint.constraint().getBreakingImpulseThreshold();
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
    m_joint.constraint().setEnabled(false);
    return;
  }
  for (int i = 0; i < n; ++i) {
    const Scalar times =
        2 * btFabs(m_solver_rows[i].m_appliedImpulse) / btMax(threshold, SIMD_EPSILON);
    if (times >= 2) lengthen(m_solver_rows[i], times);
  }
}

// A joint that nobody disturbs is solved by one pass, and Bullet is spared the others: a pass after which its impulses are
// as they were has found nothing to do, and the next one would not, either, while its bodies stay as they are. What moves
// one wakes the joint, which makes up for the pass that it was left out of: before the contacts, as if it had been in it.
inline void BulletRows::rest(btSolverBody& a, btSolverBody& b, int done) {
  bool settled = false;
  if (m_rests && hashOfVelocities(a, b) != m_velocities) {
    m_rests = false;
    setPasses(m_passes);
    solveRows(a, b);
  } else if (done > 1 && !m_rests) {
    settled = isSettled(true);
    m_rests = settled && done == passes_to_rest;
    if (m_rests) {
      // Another joint may have moved a body since this pass.
      solveRows(a, b);
      setPasses(0);
    }
    if (settled) {
      stopIfSlow(a);
      stopIfSlow(b);
    }
  }
  m_acts_in_each = done == 1 || m_rests || settled;
  if (m_rests) m_velocities = hashOfVelocities(a, b);
}

// The number of Bullet's passes over all rows.
inline void BulletRows::setPasses(int count) {
  for (int i = 0; i < m_count; ++i) m_solver_rows[i].m_overrideNumSolverIterations = count;
}

inline void BulletRows::solveRows(btSolverBody& a, btSolverBody& b) {
  for (int i = 0; i < m_count; ++i) solveRow(m_solver_rows[i], a, b);
}

// True if the impulses have not changed, but for rounding: those of equalities since the first pass, those of axes since
// the last one.
inline bool BulletRows::isSettled(bool with_axes) const {
  Scalar largest = 0, change = 0;
  const auto see = [&](Scalar now, Scalar before) {
    largest = btMax(largest, btFabs(now));
    change = btMax(change, btFabs(now - before));
  };
  for (int i = 0; i < m_rows.equalities(); ++i)
    see(m_solver_rows[i].m_appliedImpulse, m_rows.history(i).first);
  for (int i = m_rows.equalities(); with_axes && i < m_rows.size(); ++i) {
    const AxisState& axis = m_rows.axis(m_rows[i].axis);
    for (const Axis::Part k : Axis::each_part)
      if (axis.row[k] >= 0)
        see(-axis.sign * m_solver_rows[axis.row[k]].m_appliedImpulse, axis.impulse[k]);
  }
  return change <= rounding_of_impulses * largest;
}

// Keeps the impulses of an axis, and sees the effect of others on a coordinate along which an impulse is given.
inline void BulletRows::seeAxis(const Row& row, const btSolverBody& a, const btSolverBody& b) {
  AxisState& axis = m_rows.axis(row.axis);
  for (const Axis::Part k : Axis::each_part)
    if (axis.row[k] >= 0)
      axis.impulse[k] = -axis.sign * m_solver_rows[axis.row[k]].m_appliedImpulse;
  axis.seen = axis.given;
  if (axis.given) seeDisturbance(row, axis, a, b);
}

PINTLE_NOINLINE void BulletRows::seeDisturbance(const Row& row, AxisState& axis,
                                                const btSolverBody& a, const btSolverBody& b) {
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

#include <pintle/joints/joint_passes.h>

#include <pintle/body_pair.h>
#include <pintle/joints/joint.h>

#include <limits>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// Bullet starts the rows of every joint from nothing in each step, and the few passes that it makes do not
// carry a load from one end of a chain to the other. Impulses of the last step are most of what this one
// is going to need: after its first pass all joints go on from this part of them. All of it would let
// what the joints of a loop say twice add up for ever.
constexpr Scalar warm_start = Scalar(0.8);

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

// The velocity of a body as the solver has it.
Vec3 linear(const btSolverBody& body) {
  return view(body.m_linearVelocity) + view(body.m_externalForceImpulse) +
         view(body.m_deltaLinearVelocity);
}
Vec3 angular(const btSolverBody& body) {
  return view(body.m_angularVelocity) + view(body.m_externalTorqueImpulse) +
         view(body.m_deltaAngularVelocity);
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
  m_is_first_pass = true;
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

// The equalities go on from what they had in the last step.
inline void Joint::start(btSolverBody& a, btSolverBody& b) {
  // A load takes so much less in a shorter step; in a longer one what made up for an error of velocity takes no more.
  const Scalar part = warm_start * curvedPart() * btMin(Scalar(1), m_time_step / m_last_time_step);
  for (int i = 0; i < m_rows.equalities(); ++i) {
    btSolverConstraint& row = m_solver_rows[i];
    // No K: Bullet passes over the row.
    if (!(row.m_jacDiagABInv > 0)) continue;
    const Scalar impulse = part * m_rows[i].last, change = impulse - row.m_appliedImpulse;
    a.internalApplyImpulse(row.m_contactNormal1 * a.internalGetInvMass(), row.m_angularComponentA,
                           change);
    b.internalApplyImpulse(row.m_contactNormal2 * b.internalGetInvMass(), row.m_angularComponentB,
                           change);
    row.m_appliedImpulse = impulse;
  }
}

inline Scalar Joint::relaxation() const { return 1 + over_relaxation * curvedPart(); }

inline void Joint::relax(Scalar factor) {
  for (int i = 0; i < m_rows.equalities(); ++i) {
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

// Bullet calls this after each pass over the rows of all joints, before that over the contacts.
void Joint::solveConstraintObsolete(btSolverBody& a, btSolverBody& b, btScalar) {
  if (m_passes_left > 0) {
    --m_passes_left;
    if (m_passes_left % 2 == 0) {
      stopIfSlow(a);
      stopIfSlow(b);
    }
    if (m_next == Last::impulse) {
      if (m_is_first_pass) {
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
    m_is_first_pass = false;
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

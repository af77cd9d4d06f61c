#include <pintle/joints/joint.h>

#include <pintle/body_pair.h>
#include <pintle/row_writer.h>
#include <pintle/rows/block.h>

#include <BulletDynamics/ConstraintSolver/btSolverBody.h>

#include <sstream>
#include <stdexcept>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// In the range of btTypedConstraintType and none of its values: Bullet's debug drawing and importer
// cast by type.
constexpr auto pintle_type = btTypedConstraintType(15);

constexpr int max_rows = 8;

// Bullet turns a pose by at most pi/4 a step, whatever the body's velocity (btTransformUtil).
constexpr Scalar max_turn = Scalar(pi / 4);

// The part of a lasting residual that the next target makes up for. Joints that fight each other for
// good then ask for 1 / (1 - feed_forward) times what they would: bounded.
constexpr Scalar feed_forward = Scalar(0.6);

Scalar velocity(const Row& row, const Vec3& v_ab, const Vec3& w_a, const Vec3& w_b) {
  return row.L.dot(v_ab) - row.A_a.dot(w_a) + row.A_b.dot(w_b);
}

// Velocities at the end of the step if its forces were all that acted.
Vec3 freeLinear(const btRigidBody& body, Scalar dt) {
  return view(body.getLinearVelocity()) +
         dt * body.getInvMass() *
             view(body.getTotalForce()).cwiseProduct(view(body.getLinearFactor()));
}
Vec3 freeAngular(const btRigidBody& body, Scalar dt) {
  return view(body.getAngularVelocity()) +
         dt * (view(body.getInvInertiaTensorWorld()) * view(body.getTotalTorque()))
                  .cwiseProduct(view(body.getAngularFactor()));
}

}  // namespace

// What all rows of a joint share in a step.
struct Joint::Step {
  Scalar fps, erp, cfm;
  Scalar half;  ///< of the time step, for the curvature
  bool block;

  Step(const Joint& joint, const RowWriter& out)
      : fps(out.fps()),
        erp(joint.m_erp.orElse(out.erp())),
        cfm(joint.m_cfm.orElse(out.cfm())),
        half(Scalar(0.5) / fps),
        block(joint.m_block_rows && joint.rowsMayMix()) {
    // Bullet turns a pose no further than max_turn: the curvature that it sees is less by the square.
    const Scalar turn2 = btMax(joint.m_rbA.getAngularVelocity().length2(),
                               joint.m_rbB.getAngularVelocity().length2());
    if (turn2 > max_turn * max_turn * fps * fps) half *= max_turn * max_turn * fps * fps / turn2;
  }

  // The velocity that takes away the part erp of C (2.3). J v says how C moves to first order; Bullet
  // then turns the bodies by more than that, and the curvature is what it adds in a step: with it a
  // turning joint does not drift.
  Scalar target(const Row& row) const {
    const Scalar speed = btMin(btFabs(erp * fps * row.position), row.max_speed);
    return (row.position > 0 ? -speed : speed) - half * row.curvature;
  }

  // The same, less what the other joints are going to add after this row: their residual of the last
  // two steps, as far as the two agree. Bullet starts every step from nothing; this is the part of
  // the last solution that a joint can hand on.
  Scalar feedForward(RowResidual& residual, Scalar wanted) const {
    const Scalar now = residual.now, last = residual.last;
    if (now * last > 0) wanted -= feed_forward * (btFabs(now) < btFabs(last) ? now : last);
    residual = {wanted, Scalar(0), now};
    return wanted;
  }
};

Joint::Joint(btRigidBody& a, btRigidBody& b, Rows rows)
    : btTypedConstraint(pintle_type, a, b), m_rows(rows) {}

Joint::Joint(btRigidBody& a, Rows rows) : btTypedConstraint(pintle_type, a), m_rows(rows) {}

void Joint::buildJacobian() {
  m_last_incoming = m_incoming;
  m_incoming = 0;
  m_axis_row = {};
  // A disabled joint has no rows, but its angle goes on turning.
  if (!isEnabled()) {
    const BodyPair pair(m_rbA, m_rbB);
    if (pair.finite()) updateState(pair);
  }
}

void Joint::getInfo1(btConstraintInfo1* info) {
  const int before = m_rows.size();
  m_rows.clear();
  const BodyPair pair(m_rbA, m_rbB);
  if (pair.finite()) {
    updateState(pair);
    addRows(pair, m_rows);
  }
  // Other rows: the residuals are not theirs.
  if (m_rows.size() != before)
    for (int i = 0; i < m_rows.capacity(); ++i) m_rows.residual(i) = {};
  info->m_numConstraintRows = m_rows.size();
  info->nub = 0;
}

void Joint::getInfo2(btConstraintInfo2* info) {
  RowWriter out(*info);
  m_time_step = 1 / out.fps();
  m_iterations_left = 0;
  const int n = m_rows.size();
  if (n == 0) return;
  out.setDamping(damping());
  const Step step(*this, out);

  if (!step.block && m_rows[n - 1].axis == nullptr) {
    for (int i = 0; i < n; ++i) {
      const Row& row = m_rows[i];
      out.write(row.L, row.A_a, row.A_b, step.target(row), step.cfm, -row.max_impulse,
                row.max_impulse);
    }
    return;
  }

  // A soft row is not to end at its target, and a damped one will not.
  const bool feed = step.block && step.cfm == 0 && damping() == 1 &&
                    getOverrideNumSolverIterations() <= info->m_numIterations;
  if (feed) m_iterations_left = info->m_numIterations;

  const BodyPair pair(m_rbA, m_rbB);
  const BlockMass mass(pair);
  BlockRow rows[max_rows];
  int equalities = 0;
  for (int i = 0; i < n; ++i) {
    const Row& row = m_rows[i];
    Scalar wanted = 0;
    if (row.axis == nullptr) {
      ++equalities;
      wanted = step.target(row);
      if (feed) wanted = step.feedForward(m_rows.residual(i), wanted);
    }
    rows[i].J = {lanes(row.L, wanted), lanes(row.A_a), lanes(row.A_b)};
    mass.weigh(rows[i]);
    if (step.block) orthogonalise(rows, i, equalities);
    const BlockRow& b = rows[i];
    if (row.axis == nullptr) {
      out.write(b.J.L, b.J.A_a, b.J.A_b, b.target(), step.cfm, -row.max_impulse, row.max_impulse);
      continue;
    }
    AxisMotion motion = axisMotion(row, step, pair);
    motion.K = b.K;
    // Less what the equalities do to it: their targets came along in the elimination.
    motion.free_velocity = b.J.L.head<3>().matrix().dot(freeLinear(m_rbB, m_time_step) -
                                                        freeLinear(m_rbA, m_time_step)) -
                           b.J.A_a.head<3>().matrix().dot(freeAngular(m_rbA, m_time_step)) +
                           b.J.A_b.head<3>().matrix().dot(freeAngular(m_rbB, m_time_step)) -
                           b.target();
    m_axis_row = solveAxis(*row.axis, motion);
    m_axis_sign = row.sign;
    m_incoming = m_axis_row.incoming;
    // The same row along the direction in which Bullet counts its impulse.
    const Scalar s = row.sign;
    const Lanes L = s * b.J.L, A_a = s * b.J.A_a, A_b = s * b.J.A_b;
    out.write(L, A_a, A_b, s * (m_axis_row.target + b.target()), m_axis_row.cfm,
              s > 0 ? m_axis_row.lower : -m_axis_row.upper,
              s > 0 ? m_axis_row.upper : -m_axis_row.lower);
  }
}

AxisMotion Joint::axisMotion(const Row& row, const Step& step, const BodyPair& pair) const {
  const Axis& axis = *row.axis;
  AxisMotion motion = {};
  motion.position = row.position;
  motion.velocity = velocity(row, pair.v_b() - pair.v_a(), pair.w_a(), pair.w_b());
  motion.incoming = m_last_incoming;
  motion.max_motion = 2 * max_turn;
  motion.fps = step.fps;
  motion.limit_erp = m_limit_erp.orElse(step.erp);
  motion.motor_cfm = m_motor_cfm.orElse(step.cfm);
  motion.limit_cfm = m_limit_cfm.orElse(motion.motor_cfm);
  // Bullet's own: a motor slows down before a limit. It changes nothing in the constraint.
  motion.motor_factor = const_cast<Joint*>(this)->getMotorFactor(
      row.position, axis.low, axis.high, axis.motor_velocity, step.fps * motion.limit_erp);
  return motion;
}

// Bullet calls this after each pass over the rows. The last one shows what they were left with.
void Joint::solveConstraintObsolete(btSolverBody& a, btSolverBody& b, btScalar) {
  if (m_iterations_left == 0 || --m_iterations_left > 0) return;
  const auto linear = [](const btSolverBody& body) -> Vec3 {
    return view(body.m_linearVelocity) + view(body.m_externalForceImpulse) +
           view(body.m_deltaLinearVelocity);
  };
  const auto angular = [](const btSolverBody& body) -> Vec3 {
    return view(body.m_angularVelocity) + view(body.m_externalTorqueImpulse) +
           view(body.m_deltaAngularVelocity);
  };
  const Vec3 v_ab = linear(b) - linear(a), w_a = angular(a), w_b = angular(b);
  for (int i = 0; i < m_rows.size() && m_rows[i].axis == nullptr; ++i) {
    RowResidual& residual = m_rows.residual(i);
    residual.now = velocity(m_rows[i], v_ab, w_a, w_b) - residual.target;
  }
}

void Joint::setMaxCorrectionSpeed(btScalar speed) {
  m_max_correction_speed = positive("max correction speed", speed);
}

void Joint::reject(const char* field, double value, const char* why) const {
  std::ostringstream message;
  message << "pintle::" << name() << ": " << field << " = " << value << ": " << why;
  throw std::invalid_argument(message.str());
}

Scalar Joint::finite(const char* field, Scalar value) const {
  if (!BodyPair::is_finite(value)) reject(field, value, "must be finite");
  return value;
}

Scalar Joint::notNegative(const char* field, Scalar value) const {
  if (finite(field, value) < 0) reject(field, value, "must not be negative");
  return value;
}

Scalar Joint::positive(const char* field, Scalar value) const {
  if (finite(field, value) <= 0) reject(field, value, "must be above zero");
  return value;
}

Scalar Joint::bound(const char* field, Scalar value) const {
  if (!(value >= 0)) reject(field, value, "must not be negative");
  return btMin(value, infinity);
}

const btVector3& Joint::point(const char* field, const btVector3& value) const {
  for (int i = 0; i < 3; ++i) finite(field, value[i]);
  return value;
}

btVector3 Joint::direction(const char* field, const btVector3& value) const {
  const Scalar length = point(field, value).length();
  if (!(length > SIMD_EPSILON && length < infinity)) reject(field, length, "must have a direction");
  return value / length;
}

const btTransform& Joint::frame(const char* field, const btTransform& value) const {
  point(field, value.getOrigin());
  const btMatrix3x3& R = value.getBasis();
  for (int i = 0; i < 3; ++i) {
    point(field, R[i]);
    for (int j = 0; j <= i; ++j) {
      const Scalar product = R.getColumn(i).dot(R.getColumn(j));
      if (btFabs(product - Scalar(i == j)) > Scalar(1e-3))
        reject(field, product, "its axes must be unit vectors at right angles");
    }
  }
  if (R.determinant() < 0) reject(field, R.determinant(), "must be right-handed");
  return value;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

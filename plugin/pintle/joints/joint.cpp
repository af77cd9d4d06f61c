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

// A body that turns this far (rad) in a step has hardly the velocity that it had: the curvature is
// left out from there on, and by degrees before, on the side of losing energy.
constexpr Scalar max_curved_turn = Scalar(0.5);

// Bullet starts every step from nothing, and leaves a joint with what the others did to it after its
// last turn, the residual. A residual that lasts (the part in which two steps agree: a load, not a
// blow) is going to come again, and the next target makes up for this part of it. Joints that fight
// each other for good then ask for 1 / (1 - feed_forward) times what they would: bounded.
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
    // The curvature goes with the square of the angular velocity at the end of the step, which is
    // about as much more than that at its start as the last step added. Without this a pendulum
    // gains energy.
    const Scalar w = joint.m_angular_speed, turn = w / fps;
    if (joint.m_last_angular_speed > 0 && w > 0) {
      const Scalar next = btMax(w / 2, btMin(2 * w - joint.m_last_angular_speed, 2 * w)) / w;
      half *= next * next;
    }
    half *= btMax(Scalar(0), 1 - turn * turn / (max_curved_turn * max_curved_turn));
  }

  // The velocity that takes away the part erp of C (2.3). J v says how C moves to first order; Bullet
  // then turns the bodies by more than that, and the curvature is what it adds in a step: with it a
  // turning joint does not drift.
  Scalar target(const Row& row) const {
    const Scalar speed = -erp * fps * row.position;
    return btMax(-row.max_speed, btMin(speed, row.max_speed)) - half * row.curvature;
  }
};

Joint::Joint(btRigidBody& a, btRigidBody& b, Rows rows)
    : btTypedConstraint(pintle_type, a, b), m_rows(rows) {}

Joint::Joint(btRigidBody& a, Rows rows) : btTypedConstraint(pintle_type, a), m_rows(rows) {}

void Joint::buildJacobian() {
  m_last_incoming = m_incoming;
  m_incoming = 0;
  m_last_angular_speed = m_angular_speed;
  m_angular_speed = btSqrt(
      btMax(m_rbA.getAngularVelocity().length2(), m_rbB.getAngularVelocity().length2()));
  if (m_axis_acted) m_axis_row = {};
  m_axis_acted = false;
  // A solver that did not show the residuals: those at hand are old.
  if (m_iterations_left > 0) m_rows.forgetResiduals();
  m_iterations_left = 0;
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
  if (pair.finite()) prepare(pair, m_rows);
  // Other rows: the residuals are not theirs.
  if (m_rows.size() != before) m_rows.forgetResiduals();
  info->m_numConstraintRows = m_rows.size();
  info->nub = 0;
}

PINTLE_FLATTEN void Joint::getInfo2(btConstraintInfo2* info) {
  RowWriter out(*info);
  m_time_step = 1 / out.fps();
  const int n = m_rows.size();
  if (n == 0) return;
  out.setDamping(damping());
  const Step step(*this, out);

  // An axis is eliminated last, and takes its part out of the impulses that a threshold looks at.
  if (!step.block || (breakable() && m_rows[n - 1].axis != nullptr)) {
    for (int i = 0; i < n; ++i) {
      const Row& row = m_rows[i];
      if (row.axis != nullptr) {
        writeAxis(row, nullptr, step, out);
      } else {
        out.write(row.L, row.A_a, row.A_b, step.target(row), step.cfm, -row.max_impulse,
                  row.max_impulse);
      }
    }
    return;
  }

  // A soft row is not to end at its target, and a damped one will not.
  const bool feed = step.cfm == 0 && damping() == 1 && !breakable() &&
                    getOverrideNumSolverIterations() <= info->m_numIterations;
  m_iterations_left = feed ? info->m_numIterations : 0;
  if (!feed) m_rows.forgetResiduals();

  const BlockMass mass(BodyPair(m_rbA, m_rbB));
  BlockRow rows[max_rows];
  int equalities = n;
  while (equalities > 0 && m_rows[equalities - 1].axis != nullptr) --equalities;
  // The later a row is eliminated, the less of the others is in its impulse. Where the impulses are
  // compared with a threshold, the angular rows go first and leave the pivot's force as it is.
  int first = 0;
  if (breakable())
    while (first < equalities && m_rows[first].L != Vec3::Zero()) ++first;
  for (int i = 0; i < n; ++i) {
    int at = i;
    if (first > 0 && i < equalities) at = (i + first) % equalities;
    const Row& row = m_rows[at];
    if (row.axis != nullptr) {
      addToBlock(rows, i, equalities, row, 0, mass);
      writeAxis(row, &rows[i], step, out);
      continue;
    }
    Scalar target = step.target(row);
    if (feed) {
      RowResidual& residual = m_rows.residual(at);
      target -= residual.correction;
      residual.target = target;
    }
    addToBlock(rows, i, i, row, target, mass);
    out.write(rows[i].L, rows[i].A_a, rows[i].A_b, rows[i].target(), step.cfm, -infinity, infinity);
  }
}

// `block`: the row after the elimination, whose target is what the equalities' targets came to in it;
// null: as it stands.
void Joint::writeAxis(const Row& row, const BlockRow* block, const Step& step, RowWriter& out) {
  const BodyPair pair(m_rbA, m_rbB);
  BlockRow alone;
  AxisMotion motion = axisMotion(row, step, pair);
  if (!row.axis->isSimple(row.limit)) {
    if (block == nullptr) {
      addToBlock(&alone, 0, 0, row, 0, BlockMass(pair));
      block = &alone;
    }
    // A coordinate that the bodies' factors hold (2D games) has a K of rounding errors.
    const Scalar own = row.L.squaredNorm() * (pair.inv_mass_a() + pair.inv_mass_b()) +
                       row.A_a.dot(pair.inv_inertia_a() * row.A_a) +
                       row.A_b.dot(pair.inv_inertia_b() * row.A_b);
    motion.K = block->K > rounding_of_K * own ? block->K : Scalar(0);
    motion.free_velocity =
        block->L.head<3>().matrix().dot(freeLinear(m_rbB, m_time_step) -
                                        freeLinear(m_rbA, m_time_step)) -
        block->A_a.head<3>().matrix().dot(freeAngular(m_rbA, m_time_step)) +
        block->A_b.head<3>().matrix().dot(freeAngular(m_rbB, m_time_step)) - block->target();
  }
  m_axis_row = solveAxis(*row.axis, motion);
  m_axis_sign = row.sign;
  m_axis_acted = true;
  m_incoming = m_axis_row.incoming;
  // Along the direction in which Bullet counts its impulse.
  const Scalar s = row.sign, target = s * m_axis_row.target;
  const Scalar lower = s > 0 ? m_axis_row.lower : -m_axis_row.upper;
  const Scalar upper = s > 0 ? m_axis_row.upper : -m_axis_row.lower;
  if (block != nullptr) {
    out.write(Lanes(s * block->L), Lanes(s * block->A_a), Lanes(s * block->A_b),
              target + s * block->target(), m_axis_row.cfm, lower, upper);
  } else {
    out.write(Vec3(s * row.L), Vec3(s * row.A_a), Vec3(s * row.A_b), target, m_axis_row.cfm, lower,
              upper);
  }
}

AxisMotion Joint::axisMotion(const Row& row, const Step& step, const BodyPair& pair) const {
  const Axis& axis = *row.axis;
  AxisMotion motion;
  motion.position = row.position;
  motion.velocity = velocity(row, pair.v_b() - pair.v_a(), pair.w_a(), pair.w_b());
  motion.max_speed = m_max_correction_speed;
  motion.incoming = m_last_incoming;
  motion.limit = row.limit;
  motion.fps = step.fps;
  motion.limit_erp = m_limit_erp.orElse(step.erp);
  motion.motor_cfm = m_motor_cfm.value;
  // As Bullet has it: the motor's unless the limit has its own.
  motion.limit_cfm = m_limit_cfm.orElse(axis.drive == Axis::Drive::off ? 0 : motion.motor_cfm);
  // Bullet's own: a motor slows down before a limit. It changes nothing in the constraint.
  if (axis.drive == Axis::Drive::velocity)
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
    const Scalar now = velocity(m_rows[i], v_ab, w_a, w_b) - residual.target, last = residual.last;
    residual.correction =
        now * last > 0 ? feed_forward * (btFabs(now) < btFabs(last) ? now : last) : Scalar(0);
    residual.last = now;
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

#include <pintle/joints/joint.h>

#include <pintle/body_pair.h>
#include <pintle/rows/axis_part.h>
#include <pintle/rows/row.h>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

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

// True if a spring is a row (axis_part.h).
bool isStiff(const Spring& spring, Scalar dt, Scalar K) {
  return softnessOf(spring, dt, K).gamma <= max_yield_cfm * dt;
}

}  // namespace

Joint::Joint(btTypedConstraint& constraint, RowCount max_rows)
    : m_erp_cfm_differs(false),
      m_foresees_curvature(false),
      m_turns_shafts(false),
      m_block_rows(true),
      m_formulation(Formulation::conditioned),
      m_step_begins(true),
      m_constraint(constraint),
      m_rows(makeRows(max_rows)),
      m_bullet_rows(*this) {}

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
  m_bullet_rows.startAnew();
  for (int i = 0; i < m_rows.axisCount(); ++i) m_rows.axis(i).seen = false;
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
  m_bullet_rows.beginStep();
}

StepMotion Joint::motion(const BodyPair& pair) const {
  return {pair, m_time_step, angularSpeed() * m_time_step, curvedPart(), m_bullet_rows.arePlain()};
}

// Without its velocity and gain.
AxisMotion Joint::axisMotion(const Row& row, const AxisState& state, const BodyPair& pair,
                             Scalar fps, Scalar default_limit_erp) const {
  const Axis& axis = *state.axis;
  AxisMotion motion;
  motion.position = row.position;
  motion.max_speed = m_bullet_rows.arePlain()
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

}  // namespace PINTLE_PRECISION
}  // namespace pintle

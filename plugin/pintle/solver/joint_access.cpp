#include <pintle/solver/joint_access.h>

#include <pintle/body_pair.h>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// Of body a about an angular row, or of b if a cannot turn; Bullet's bounds have only a's.
Scalar motorInertia(const Row& row, const BodyPair& pair) {
  const Scalar a = row.A_a.dot(pair.inv_inertia_a() * row.A_a),
               b = row.A_b.dot(pair.inv_inertia_b() * row.A_b);
  const Scalar inverse = a > 0 ? a : b;
  return inverse > 0 ? 1 / inverse : Scalar(0);
}

}  // namespace

AxisMotion JointAccess::motion(const Joint& joint, const Row& row, const AxisState& state,
                               const BodyPair& pair, Scalar velocity,
                               const btContactSolverInfo& info) {
  const Axis& axis = *state.axis;
  AxisMotion motion = {};
  motion.position = row.position;
  motion.velocity = velocity;
  motion.max_speed = btMin(row.angular ? joint.m_max_correction_speed : infinity, row.max_speed);
  motion.incoming = state.last_incoming;
  motion.limit = row.limit;
  motion.fps = 1 / info.m_timeStep;
  motion.limit_erp = joint.m_limit_erp.orElse(joint.m_erp.orElse(info.m_erp));
  motion.motor_cfm = joint.m_motor_cfm.orElse(0);
  Parameter limit_cfm = joint.m_limit_cfm;
  if (axis.own != nullptr) {
    motion.limit_erp = axis.own->limit_erp.orElse(motion.limit_erp);
    motion.motor_cfm = axis.own->motor_cfm.orElse(motion.motor_cfm);
    if (axis.own->limit_cfm.isSet()) limit_cfm = axis.own->limit_cfm;
  }
  motion.limit_cfm =
      limit_cfm.orElse(axis.drive == Axis::Drive::off ? Scalar(0) : motion.motor_cfm);
  motion.motor_factor = 1;
  if (axis.drive == Axis::Drive::velocity)
    motion.motor_factor = const_cast<Joint&>(joint).getMotorFactor(
        row.position, axis.low, axis.high, axis.motor_velocity, motion.fps * motion.limit_erp);
  motion.motor_inertia = axis.normalized_motor ? motorInertia(row, pair) : Scalar(1);
  return motion;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

#include <pintle/joints/driven_joint.h>

#include <pintle/finite.h>
#include <pintle/joints/pose_drive_rows.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

DrivenJoint::DrivenJoint(btTypedConstraint& constraint, RowCount max_rows)
    : Joint(constraint, max_rows) {}

DrivenJoint::~DrivenJoint() = default;

void DrivenJoint::setPoseDrive(const btQuaternion& target, const PoseDrive& settings) {
  for (int i = 0; i < 4; ++i) finite("pose target", target[i]);
  const Scalar length = target.length();
  if (!(length > SIMD_EPSILON && length < infinity))
    reject("pose target", length, "must have a length");
  const Spring& spring = settings.spring;
  notNegative("pose drive stiffness", spring.stiffness);
  notNegative("pose drive damping", spring.damping);
  notNegative("pose drive damping ratio", spring.damping_ratio);
  if (!spring.hasUnits()) positive("pose drive frequency", spring.angular_frequency);
  point("pose drive target velocity", settings.target_velocity);
  PoseDrive checked = settings;
  checked.max_torque = bound("pose drive max torque", settings.max_torque);
  if (!m_pose_drive) {
    setRowCount(driveRoom().count);
    m_pose_drive = std::make_unique<PoseDriveRows>();
  }
  m_pose_drive->set(target / length, checked);
}

void DrivenJoint::clearPoseDrive() {
  if (m_pose_drive) m_pose_drive->clear();
}

bool DrivenJoint::isDriveOn() const { return m_pose_drive->isOn(); }

btQuaternion DrivenJoint::getPoseTarget() const {
  return hasPoseDrive() ? m_pose_drive->target() : btQuaternion::getIdentity();
}

PoseDrive DrivenJoint::getPoseDrive() const {
  return hasPoseDrive() ? m_pose_drive->settings() : PoseDrive();
}

btVector3 DrivenJoint::getPoseDriveImpulse() const {
  if (!hasPoseDrive()) return {0, 0, 0};
  const int first = driveRoom().first_axis;
  Vec3 each;
  for (int i = 0; i < PoseDriveRows::count; ++i)
    each[i] =
        axisImpulse(first + i, Axis::spring_pull) + axisImpulse(first + i, Axis::spring_yield);
  const Vec3 sum = m_pose_drive->sum(each);
  return {sum.x(), sum.y(), sum.z()};
}

void DrivenJoint::beginDrive() { m_pose_drive->begin(); }

Scalar DrivenJoint::addPoseDrive(const Frame& a, const Frame& b, Rows& rows,
                                 Scalar friction) const {
  if (!hasPoseDrive()) return 0;
  return m_pose_drive->add(a, b, driveRoom().first_axis, BodyPair(bodyA(), bodyB()), timeStep(),
                           friction, rows);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

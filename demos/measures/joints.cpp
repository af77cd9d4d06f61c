// What a joint leaves of what it should hold: by the definition of its kind, from two poses.

#include "../scenes/directions.h"
#include "run.h"

namespace measures {

using engines::State;
using scenes::angle_between;
using scenes::Joint;
using scenes::Kind;
using scenes::Vector3d;

JointErrors joint_errors(const Joint& joint, const State& a, const State& b) {
  const scenes::Isometry3d in_a = a.pose * joint.in_a, in_b = b.pose * joint.in_b;
  const Eigen::Matrix3d &A = in_a.linear(), &B = in_b.linear();
  const Vector3d apart = in_b.translation() - in_a.translation();
  const auto turn = [&] { return std::abs(Eigen::AngleAxisd(A.transpose() * B).angle()); };
  switch (joint.kind) {
    case Kind::ball:
    case Kind::cone_twist:
    case Kind::wedge: return {apart.norm(), 0};
    case Kind::hinge: return {apart.norm(), angle_between(A.col(2), B.col(2))};
    case Kind::fixed: return {apart.norm(), turn()};
    case Kind::slider: return {(apart - apart.dot(A.col(0)) * A.col(0)).norm(), turn()};
    case Kind::universal:
      return {apart.norm(), std::abs(angle_between(A.col(2), B.col(1)) - scenes::pi / 2)};
    case Kind::constant_velocity:
      return {apart.norm(), std::abs(scenes::swing_twist_angles(A.transpose() * B).twist)};
    case Kind::angle:
    case Kind::distance:
    case Kind::contact:      // they only have limits
    case Kind::gear: break;  // what it holds are turns
  }
  return {};
}

double muscle_error(const Joint& joint, const State& a, const State& b) {
  if (!(joint.muscle.stiffness > 0)) return 0;
  const Eigen::Matrix3d R = ((a.pose * joint.in_a).inverse() * (b.pose * joint.in_b)).linear();
  return Eigen::AngleAxisd(joint.muscle.pose.toRotationMatrix().transpose() * R).angle();
}

double Overshoot::operator()(const State& a, const State& b) {
  const scenes::Isometry3d relative = (a.pose * joint_.in_a).inverse() * (b.pose * joint_.in_b);
  const Eigen::Matrix3d& R = relative.linear();
  const scenes::Range& range = joint_.range;
  const auto beyond = [&](double at) { return std::max(at - range.high, range.low - at); };
  if (joint_.kind == Kind::hinge || joint_.kind == Kind::angle) {
    const double angle = angle_(std::atan2(R(1, 0), R(0, 0)));
    return range.limited() ? beyond(angle) : -HUGE_VAL;
  }
  if (joint_.kind == Kind::cone_twist) {
    const scenes::SwingTwistAngles angles = scenes::swing_twist_angles(R);
    return std::max(scenes::distance_from_ellipse(angles.swing_1, angles.swing_2,
                                                  joint_.spans.about_z, joint_.spans.about_y),
                    std::abs(angles.twist) - joint_.spans.twist);
  }
  if (joint_.kind == Kind::contact) return -relative.translation().z();
  if (!range.limited()) return -HUGE_VAL;
  if (joint_.kind == Kind::distance) return beyond(relative.translation().norm());
  if (joint_.kind == Kind::slider) return beyond(relative.translation().x());
  if (joint_.kind == Kind::constant_velocity)
    return angle_between(Vector3d::UnitX(), R.col(0)) - range.high;
  if (joint_.kind == Kind::wedge) return scenes::Wedge{range.low, range.high}.outside(R.col(0));
  return -HUGE_VAL;
}

}  // namespace measures

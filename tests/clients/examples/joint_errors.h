// Purpose: errors of Bullet's joints, from the poses of their bodies and the settings that stand in the objects.
#pragma once

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cmath>

namespace examples {

struct JointErrors {
  double gap = 0;     ///< m: pivots, across the axes along which they are free
  double passed = 0;  ///< m or rad: beyond a limit
};

/// Beyond [low, high]; low > high: free.
inline double beyond(double x, double low, double high) {
  return low > high ? 0 : std::max({0., low - x, x - high});
}

/// The same of an angle, whose limits are a range of less than a turn.
inline double angleBeyond(double angle, double low, double high) {
  const double center = (low + high) / 2;
  return beyond(center + double(btNormalizeAngle(btScalar(angle - center))), low, high);
}

/// The joint frames in the world.
struct Frames {
  btTransform a, b;
  double gap() const { return double((a.getOrigin() - b.getOrigin()).length()); }
};

inline JointErrors errorsOf(btHingeConstraint& hinge, const Frames& at) {
  JointErrors errors;
  if (!hinge.getAngularOnly()) errors.gap = at.gap();
  double low = double(hinge.getLowerLimit()), high = double(hinge.getUpperLimit());
  if (hinge.hasLimit()) {
    if (low > high) high += SIMD_2_PI;  // (90, 270) reads as (90, -90)
    errors.passed = angleBeyond(double(hinge.getHingeAngle()), low, high);
  }
  return errors;
}

inline JointErrors errorsOf(btSliderConstraint& slider, const Frames& at) {
  const btTransform &rail = slider.getUseLinearReferenceFrameA() ? at.a : at.b,
                    &other = slider.getUseLinearReferenceFrameA() ? at.b : at.a;
  const btVector3 d = rail.getBasis().transpose() * (other.getOrigin() - rail.getOrigin());
  const btVector3 y = at.a.getBasis().transpose() * at.b.getBasis().getColumn(1);
  return {
      std::hypot(double(d.y()), double(d.z())),
      std::max(beyond(double(d.x()), double(slider.getLowerLinLimit()),
                      double(slider.getUpperLinLimit())),
               angleBeyond(std::atan2(double(y.z()), double(y.y())),
                           double(slider.getLowerAngLimit()), double(slider.getUpperAngLimit())))};
}

/// The swing's component of an axis beyond its span; a span below the threshold locks.
inline JointErrors errorsOf(btConeTwistConstraint& cone, const Frames& at) {
  btQuaternion q = (at.b.inverse() * at.a).getRotation();
  if (q.w() < 0) q = -q;
  const double twist = 2 * std::atan2(double(q.x()), double(q.w()));
  btQuaternion swing = q * btQuaternion(btVector3(1, 0, 0), btScalar(-twist));
  if (swing.w() < 0) swing = -swing;
  const double size = double(swing.getAngle());
  const btVector3 axis = size > 1e-9 ? swing.getAxis() : btVector3(0, 1, 0);
  const double swing_1 = size * double(axis.z()), swing_2 = size * double(axis.y());
  const double span_1 = double(cone.getSwingSpan1()), span_2 = double(cone.getSwingSpan2()),
               span = double(cone.getTwistSpan()), threshold = double(cone.getFixThresh());
  JointErrors errors;
  errors.gap = at.gap();
  if (span >= 0) errors.passed = beyond(twist, -span, span);
  if (span_1 >= threshold && span_2 >= threshold) {
    const double radius = std::hypot(swing_1 / span_1, swing_2 / span_2);
    if (radius > 1) errors.passed = std::max(errors.passed, size * (1 - 1 / radius));
  } else {
    if (span_1 < threshold) errors.passed = std::max(errors.passed, std::abs(swing_1));
    if (span_2 < threshold) errors.passed = std::max(errors.passed, std::abs(swing_2));
  }
  return errors;
}

/// Joints of six degrees of freedom; fixed and universal joints and hinges of two axes are such.
template <class SixDof>
JointErrors errorsOfSixDof(SixDof& joint, btTypedConstraint& constraint) {
  joint.calculateTransforms(constraint.getRigidBodyA().getCenterOfMassTransform(),
                            constraint.getRigidBodyB().getCenterOfMassTransform());
  btVector3 low, high, low_angle, high_angle;
  joint.getLinearLowerLimit(low);
  joint.getLinearUpperLimit(high);
  joint.getAngularLowerLimit(low_angle);
  joint.getAngularUpperLimit(high_angle);
  const btTransform& A = joint.getCalculatedTransformA();
  const btVector3 d =
      A.getBasis().transpose() * (joint.getCalculatedTransformB().getOrigin() - A.getOrigin());
  JointErrors errors;
  double gap2 = 0;
  for (int i = 0; i < 3; ++i) {
    const double off = beyond(double(d[i]), double(low[i]), double(high[i]));
    if (low[i] == high[i])
      gap2 += off * off;
    else
      errors.passed = std::max(errors.passed, off);
    errors.passed = std::max(
        errors.passed,
        angleBeyond(double(joint.getAngle(i)), double(low_angle[i]), double(high_angle[i])));
  }
  errors.gap = std::sqrt(gap2);
  return errors;
}

inline JointErrors errorsOf(btTypedConstraint& joint) {
  const btTransform &A = joint.getRigidBodyA().getCenterOfMassTransform(),
                    &B = joint.getRigidBodyB().getCenterOfMassTransform();
  if (const auto* ball = dynamic_cast<btPoint2PointConstraint*>(&joint))
    return {double((A * ball->getPivotInA() - B * ball->getPivotInB()).length()), 0};
  if (auto* hinge = dynamic_cast<btHingeConstraint*>(&joint))
    return errorsOf(*hinge, {A * hinge->getAFrame(), B * hinge->getBFrame()});
  if (auto* slider = dynamic_cast<btSliderConstraint*>(&joint))
    return errorsOf(*slider, {A * slider->getFrameOffsetA(), B * slider->getFrameOffsetB()});
  if (auto* cone = dynamic_cast<btConeTwistConstraint*>(&joint))
    return errorsOf(*cone, {A * cone->getAFrame(), B * cone->getBFrame()});
  if (auto* six = dynamic_cast<btGeneric6DofConstraint*>(&joint))
    return errorsOfSixDof(*six, joint);
  if (auto* six = dynamic_cast<btGeneric6DofSpring2Constraint*>(&joint))
    return errorsOfSixDof(*six, joint);
  return {};
}

}  // namespace examples

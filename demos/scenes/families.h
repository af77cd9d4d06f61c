// Bullet's joints and Pintle's under the same names, so that a scene is written once for both.
//
// `make_joint` makes one of a kind from its two frames. Where Bullet has no such joint, its side gets a
// stand-in: the one of its joints that holds about the same.

#pragma once

#include <BulletDynamics/ConstraintSolver/btConeTwistConstraint.h>
#include <BulletDynamics/ConstraintSolver/btFixedConstraint.h>
#include <BulletDynamics/ConstraintSolver/btGeneric6DofSpring2Constraint.h>
#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>
#include <BulletDynamics/ConstraintSolver/btSliderConstraint.h>
#include <BulletDynamics/ConstraintSolver/btUniversalConstraint.h>
#include <pintle/joints/angular_limit.h>
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/cone_twist_joint.h>
#include <pintle/joints/constant_velocity_joint.h>
#include <pintle/joints/contact_joint.h>
#include <pintle/joints/distance_joint.h>
#include <pintle/joints/fixed_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/slider_joint.h>
#include <pintle/joints/universal_joint.h>
#include <pintle/joints/wedge_joint.h>

#include <memory>

#include "scene.h"

namespace scenes {

// What a joint of any kind is made of.
struct JointParts {
  Kind kind;
  btRigidBody &a, &b;
  btTransform in_a, in_b;
  double limit = 0;  // rad or m, to both sides of what can be limited; 0: none
};

struct StockJoints {
  using Ball = btPoint2PointConstraint;
  using Hinge = btHingeConstraint;
  using Slider = btSliderConstraint;
  using Fixed = btFixedConstraint;
  using ConeTwist = btConeTwistConstraint;
  static constexpr const char* name = "stock";

  static std::unique_ptr<btTypedConstraint> universal(const JointParts& parts) {
    auto joint = std::make_unique<btUniversalConstraint>(parts.a, parts.b, btVector3(0, 0, 0),
                                                         btVector3(0, 0, 1), btVector3(0, 1, 0));
    joint->setFrames(parts.in_a, parts.in_b);
    if (parts.limit > 0) {
      const btScalar limit = btScalar(parts.limit);
      joint->setLowerLimit(-limit, -limit);
      joint->setUpperLimit(limit, limit);
    }
    return joint;
  }
  // Bullet's 6-dof joint, all free but what is set then.
  static std::unique_ptr<btGeneric6DofSpring2Constraint> loose(const JointParts& parts) {
    auto joint = std::make_unique<btGeneric6DofSpring2Constraint>(parts.a, parts.b, parts.in_a,
                                                                  parts.in_b, RO_ZYX);
    for (int axis = 0; axis < 6; ++axis) joint->setLimit(axis, 1, -1);
    return joint;
  }
  static std::unique_ptr<btTypedConstraint> without_counterpart(const JointParts& parts) {
    const btScalar limit = btScalar(parts.limit);
    switch (parts.kind) {
      case Kind::constant_velocity: return universal(parts);
      case Kind::wedge: {
        auto joint = loose(parts);
        for (int axis = 0; axis < 3; ++axis) joint->setLimit(axis, 0, 0);
        if (limit > 0) joint->setLimit(5, -limit, limit);
        return joint;
      }
      case Kind::angle: {
        auto joint = loose(parts);
        joint->setLimit(5, -limit, limit);
        return joint;
      }
      case Kind::contact: {
        auto joint = loose(parts);
        joint->setLimit(2, 0, btScalar(1e6));
        return joint;
      }
      default:  // a rod
        return std::make_unique<Ball>(parts.a, parts.b, parts.in_a.getOrigin(),
                                      parts.in_b.getOrigin());
    }
  }
};

struct PintleJoints {
  using Ball = pintle::BallJoint;
  using Hinge = pintle::QuaternionHinge;
  using Slider = pintle::SliderJoint;
  using Fixed = pintle::FixedJoint;
  using ConeTwist = pintle::ConeTwistJoint;
  static constexpr const char* name = "Pintle";

  static std::unique_ptr<btTypedConstraint> universal(const JointParts& parts) {
    auto joint = std::make_unique<pintle::UniversalJoint>(parts.a, parts.b, parts.in_a, parts.in_b);
    if (parts.limit > 0) {
      const btScalar limit = btScalar(parts.limit);
      joint->setLowerLimit(-limit, -limit);
      joint->setUpperLimit(limit, limit);
    }
    return joint;
  }
  static std::unique_ptr<btTypedConstraint> without_counterpart(const JointParts& parts) {
    const btScalar limit = btScalar(parts.limit);
    const auto make = [&](auto* type) {
      using Type = std::remove_pointer_t<decltype(type)>;
      return std::make_unique<Type>(parts.a, parts.b, parts.in_a, parts.in_b);
    };
    switch (parts.kind) {
      case Kind::constant_velocity: {
        auto joint = make(static_cast<pintle::ConstantVelocityJoint*>(nullptr));
        if (limit > 0) joint->setBendLimit(limit);
        return joint;
      }
      case Kind::wedge: {
        auto joint = make(static_cast<pintle::WedgeJoint*>(nullptr));
        if (limit > 0) joint->setLimit(-limit, limit);
        return joint;
      }
      case Kind::angle: {
        auto joint = make(static_cast<pintle::AngularLimit*>(nullptr));
        joint->setLimit(-limit, limit);
        return joint;
      }
      case Kind::contact: return make(static_cast<pintle::ContactJoint*>(nullptr));
      default:  // a rod of no length, as the ball joint that stands in for it
        return std::make_unique<pintle::DistanceJoint>(parts.a, parts.b, parts.in_a.getOrigin(),
                                                       parts.in_b.getOrigin(), btScalar(0));
    }
  }
};

template <class Family>
std::unique_ptr<btTypedConstraint> make_joint(const JointParts& parts) {
  const btScalar limit = btScalar(parts.limit);
  switch (parts.kind) {
    case Kind::ball:
      return std::make_unique<typename Family::Ball>(parts.a, parts.b, parts.in_a.getOrigin(),
                                                     parts.in_b.getOrigin());
    case Kind::hinge: {
      auto joint =
          std::make_unique<typename Family::Hinge>(parts.a, parts.b, parts.in_a, parts.in_b, true);
      if (limit > 0) joint->setLimit(-limit, limit);
      return joint;
    }
    case Kind::slider: {
      auto joint =
          std::make_unique<typename Family::Slider>(parts.a, parts.b, parts.in_a, parts.in_b, true);
      if (limit > 0) {
        joint->setLowerLinLimit(-limit);
        joint->setUpperLinLimit(limit);
      }
      return joint;
    }
    case Kind::fixed:
      return std::make_unique<typename Family::Fixed>(parts.a, parts.b, parts.in_a, parts.in_b);
    case Kind::cone_twist: {
      auto joint =
          std::make_unique<typename Family::ConeTwist>(parts.a, parts.b, parts.in_a, parts.in_b);
      if (limit > 0) joint->setLimit(limit, limit, limit);
      return joint;
    }
    case Kind::universal: return Family::universal(parts);
    default: return Family::without_counterpart(parts);
  }
}

inline const char* kind_name(Kind kind) {
  switch (kind) {
    case Kind::ball: return "ball";
    case Kind::hinge: return "hinge";
    case Kind::slider: return "slider";
    case Kind::fixed: return "fixed";
    case Kind::cone_twist: return "cone-twist";
    case Kind::universal: return "universal";
    case Kind::constant_velocity: return "constant velocity";
    case Kind::wedge: return "wedge";
    case Kind::angle: return "angular limit";
    case Kind::distance: return "distance";
    case Kind::contact: return "contact";
    case Kind::gear: return "gear";
  }
  return "";
}

}  // namespace scenes

// Purpose: the joints whose cost is compared, by name: stock beside ours, parts on and off.
#pragma once

#include "joint_step.h"

#include <pintle/joints/ball_joint.h>
#include <pintle/joints/dot_hinge.h>
#include <pintle/joints/fixed_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/two_point_hinge.h>

#include <BulletDynamics/ConstraintSolver/btFixedConstraint.h>
#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>

#include <functional>
#include <vector>

namespace bench {

struct Case {
  const char* name;
  const char* stock;  ///< the case to compare with; null: this is one
  size_t bytes;
  std::function<std::unique_ptr<btTypedConstraint>(JointStep&)> make;
};

template <class Hinge, class Setting>
Case hinge(const char* name, const char* stock, Setting setting) {
  return {name, stock, sizeof(Hinge), [setting](JointStep& s) {
            auto joint = std::make_unique<Hinge>(*s.a, *s.b, JointStep::frameA(),
                                                 JointStep::frameB());
            setting(*joint);
            return std::unique_ptr<btTypedConstraint>(std::move(joint));
          }};
}

template <class Ball, class Setting>
Case ball(const char* name, const char* stock, Setting setting) {
  return {name, stock, sizeof(Ball), [setting](JointStep& s) {
            auto joint = std::make_unique<Ball>(*s.a, *s.b, JointStep::frameA().getOrigin(),
                                                JointStep::frameB().getOrigin());
            setting(*joint);
            return std::unique_ptr<btTypedConstraint>(std::move(joint));
          }};
}

// With frames that coincide.
template <class Fixed, class Setting>
Case fixed(const char* name, const char* stock, Setting setting) {
  return {name, stock, sizeof(Fixed), [setting](JointStep& s) {
            const btTransform frame_b = s.b->getCenterOfMassTransform().inverse() *
                                        s.a->getCenterOfMassTransform() * JointStep::frameA();
            auto joint = std::make_unique<Fixed>(*s.a, *s.b, JointStep::frameA(), frame_b);
            setting(*joint);
            return std::unique_ptr<btTypedConstraint>(std::move(joint));
          }};
}

inline std::vector<Case> cases() {
  using Stock = btHingeConstraint;
  using Hinge = pintle::QuaternionHinge;
  const auto as_is = [](auto&) {};
  const auto plain = [](auto& joint) { joint.setBlockRows(false); };
  // The hinge stands at -0.4 rad: beyond this limit, and inside that one.
  const auto limit = [](auto& joint) { joint.setLimit(0, 1); };
  const auto inside = [](auto& joint) { joint.setLimit(-2, 2); };
  const auto motor = [](auto& joint) { joint.enableAngularMotor(true, 1, 1); };
  const auto both = [limit, motor](auto& joint) { limit(joint), motor(joint); };
  const auto with_plain = [plain](auto setting) {
    return [plain, setting](auto& joint) { plain(joint), setting(joint); };
  };
  return {
      hinge<Stock>("stock hinge", nullptr, as_is),
      hinge<Hinge>("hinge, plain rows", "stock hinge", plain),
      hinge<Hinge>("hinge", "stock hinge", as_is),
      hinge<Stock>("stock hinge, inside limit", nullptr, inside),
      hinge<Hinge>("hinge, inside limit", "stock hinge, inside limit", inside),
      hinge<Stock>("stock hinge, limit", nullptr, limit),
      hinge<Hinge>("hinge, limit, plain rows", "stock hinge, limit", with_plain(limit)),
      hinge<Hinge>("hinge, limit", "stock hinge, limit", limit),
      hinge<Stock>("stock hinge, motor", nullptr, motor),
      hinge<Hinge>("hinge, motor", "stock hinge, motor", motor),
      hinge<Stock>("stock hinge, limit + motor", nullptr, both),
      hinge<Hinge>("hinge, limit + motor", "stock hinge, limit + motor", both),
      hinge<Hinge>("hinge, limit spring", "stock hinge, limit",
                   [limit](auto& joint) { limit(joint), joint.setLimitSpring(5, 1); }),
      hinge<Hinge>("hinge, servo", "stock hinge, motor",
                   [](auto& joint) { joint.setMotorServo(1, 5, 1, 10); }),
      hinge<Hinge>("hinge, document's form", "stock hinge",
                   [](auto& joint) { joint.setFormulation(pintle::Formulation::document); }),
      ball<btPoint2PointConstraint>("stock ball", nullptr, as_is),
      ball<pintle::BallJoint>("ball, plain rows", "stock ball", plain),
      ball<pintle::BallJoint>("ball", "stock ball", as_is),
      fixed<btFixedConstraint>("stock fixed", nullptr, as_is),
      fixed<pintle::FixedJoint>("fixed, plain rows", "stock fixed", plain),
      fixed<pintle::FixedJoint>("fixed", "stock fixed", as_is),
      fixed<pintle::FixedJoint>(
          "fixed, document's form", "stock fixed",
          [](auto& joint) { joint.setFormulation(pintle::Formulation::document); }),
      hinge<pintle::DotHinge>("dot hinge, plain rows", "stock hinge", plain),
      hinge<pintle::DotHinge>("dot hinge", "stock hinge", as_is),
      hinge<pintle::DotHinge>("dot hinge, limit", "stock hinge, limit", limit),
      hinge<pintle::DotHinge>("dot hinge, motor", "stock hinge, motor", motor),
      hinge<pintle::TwoPointHinge>("two points, plain rows", "stock hinge", plain),
      hinge<pintle::TwoPointHinge>("two points", "stock hinge", as_is),
      hinge<pintle::TwoPointHinge>("two points, six plain rows", "stock hinge",
                                   [](auto& joint) { joint.setSixRows(true); }),
  };
}

}  // namespace bench

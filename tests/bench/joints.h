// Purpose: the joints whose cost is compared, by name: stock beside ours, parts on and off.
#pragma once

#include "joint_step.h"

#include <pintle/joints/angular_limit.h>
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/contact_joint.h>
#include <pintle/joints/distance_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/wedge_joint.h>

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

/// Of a joint that Bullet has none of, beside the ball.
template <class Joint, class Setting>
Case free_joint(const char* name, Setting setting) {
  return hinge<Joint>(name, "stock ball", setting);
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
      // The joint stands at 0.4 rad of z, and its points coincide.
      free_joint<pintle::DistanceJoint>("rod", as_is),
      free_joint<pintle::DistanceJoint>("rod, plain rows", plain),
      free_joint<pintle::DistanceJoint>("rope, slack", [](auto& rope) { rope.setLimit(0, 1); }),
      free_joint<pintle::DistanceJoint>("strut, pressed",
                                        [](auto& strut) { strut.setLimit(1, 2); }),
      free_joint<pintle::ContactJoint>("contact", as_is),
      free_joint<pintle::ContactJoint>("contact, two-sided",
                                       [](auto& contact) { contact.setTwoSided(true); }),
      free_joint<pintle::WedgeJoint>("wedge, free", as_is),
      free_joint<pintle::WedgeJoint>("wedge, free, plain rows", plain),
      free_joint<pintle::WedgeJoint>("wedge, inside limit", inside),
      free_joint<pintle::WedgeJoint>("wedge, limit", [](auto& wedge) { wedge.setLimit(-1, 0); }),
      free_joint<pintle::AngularLimit>("angle, inside limit", inside),
      free_joint<pintle::AngularLimit>("angle, limit", [](auto& angle) { angle.setLimit(-1, 0); }),
      free_joint<pintle::AngularLimit>("angle, motor", motor),
  };
}

}  // namespace bench

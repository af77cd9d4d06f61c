// Purpose: the joints whose cost is compared, by name: stock beside ours, parts on and off.
#pragma once

#include "joint_step.h"

#include <pintle/joints/ball_joint.h>
#include <pintle/joints/cone_twist_joint.h>
#include <pintle/joints/quaternion_hinge.h>

#include <BulletDynamics/ConstraintSolver/btConeTwistConstraint.h>
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

template <class Joint, class Setting>
Case coneTwist(const char* name, const char* stock, Setting setting) {
  return {name, stock, sizeof(Joint), [setting](JointStep& s) {
            auto joint = std::make_unique<Joint>(*s.a, *s.b, JointStep::frameA(),
                                                 JointStep::frameB());
            setting(*joint);
            return std::unique_ptr<btTypedConstraint>(std::move(joint));
          }};
}

inline void addConeTwist(std::vector<Case>& cases) {
  using Stock = btConeTwistConstraint;
  using Joint = pintle::ConeTwistJoint;
  // The joint stands at a swing of 0.4 rad about z, and no twist.
  const auto free = [](auto&) {};
  const auto inside = [](auto& joint) { joint.setLimit(1, btScalar(1.5), 1); };
  const auto near = [](auto& joint) { joint.setLimit(btScalar(0.41), btScalar(0.6), 1); };
  const auto active = [](auto& joint) { joint.setLimit(btScalar(0.3), btScalar(0.6), 1); };
  const auto both = [](auto& joint) {
    joint.setLimit(btScalar(0.3), btScalar(0.3), 1);
    joint.setFrames(joint.getAFrame(), joint.getBFrame() *
                                           btTransform(btQuaternion(btVector3(1, 0, 0), btScalar(1.2))));
  };
  const auto locked = [](auto& joint) { joint.setLimit(0, 0, 1); };
  const auto motor = [](auto& joint) {
    joint.setMotorTarget(btQuaternion(btVector3(1, 0, 0), btScalar(0.5)));
    joint.enableMotor(true);
  };
  struct Setting {
    const char *stock, *name, *plain;
    std::function<void(Stock&)> set_stock;
    std::function<void(Joint&)> set;
  };
  const Setting settings[] = {
      {"stock cone, free", "cone, free", "cone, free, plain", free, free},
      {"stock cone, inside", "cone, inside", "cone, inside, plain", inside, inside},
      {"stock cone, near edge", "cone, near edge", "cone, near edge, plain", near, near},
      {"stock cone, swing", "cone, swing", "cone, swing, plain", active, active},
      {"stock cone, swing+twist", "cone, swing+twist", "cone, swing+twist, plain", both, both},
      {"stock cone, locked", "cone, locked", "cone, locked, plain", locked, locked},
      {"stock cone, motor", "cone, motor", "cone, motor, plain", motor, motor},
  };
  for (const Setting& s : settings) {
    cases.push_back(coneTwist<Stock>(s.stock, nullptr, s.set_stock));
    cases.push_back(coneTwist<Joint>(s.plain, s.stock, [s](Joint& joint) {
      joint.setBlockRows(false);
      s.set(joint);
    }));
    cases.push_back(coneTwist<Joint>(s.name, s.stock, s.set));
  }
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
  std::vector<Case> all = {
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
  };
  addConeTwist(all);
  return all;
}

}  // namespace bench

// Purpose: the joints whose cost is compared, by name: stock beside ours, parts on and off.
#pragma once

#include "joint_step.h"

#include <pintle/joints/angular_limit.h>
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/cone_twist_joint.h>
#include <pintle/joints/constant_velocity_joint.h>
#include <pintle/joints/contact_joint.h>
#include <pintle/joints/distance_joint.h>
#include <pintle/joints/dot_hinge.h>
#include <pintle/joints/fixed_joint.h>
#include <pintle/joints/gear_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/slider_joint.h>
#include <pintle/joints/two_point_hinge.h>
#include <pintle/joints/universal_joint.h>
#include <pintle/joints/wedge_joint.h>

#include <BulletDynamics/ConstraintSolver/btConeTwistConstraint.h>
#include <BulletDynamics/ConstraintSolver/btFixedConstraint.h>
#include <BulletDynamics/ConstraintSolver/btGearConstraint.h>
#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>
#include <BulletDynamics/ConstraintSolver/btSliderConstraint.h>
#include <BulletDynamics/ConstraintSolver/btUniversalConstraint.h>

#include <functional>
#include <string>
#include <vector>

namespace bench {

struct Case {
  const char* name;
  const char* stock;  ///< the case to compare with; null: this is one
  size_t bytes;
  std::function<std::unique_ptr<btTypedConstraint>(JointStep&)> make;
  const char* without = nullptr;  ///< the case without the parts that do not act here, or null
  int parts = 0;                  ///< how many those are
};

/// Has parts that do not act: they must cost next to nothing.
inline Case inactive(Case with, const char* without, int parts = 1) {
  with.without = without;
  with.parts = parts;
  return with;
}

template <class Hinge, class Setting>
Case hinge(const char* name, const char* stock, Setting setting) {
  return {name, stock, sizeof(Hinge), [setting](JointStep& s) {
            auto joint =
                std::make_unique<Hinge>(*s.a, *s.b, JointStep::frameA(), JointStep::frameB());
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

// Stock's takes its axes in the world: those of the frame in body a.
template <class Universal, class Setting>
Case universal(const char* name, const char* stock, Setting setting) {
  return {name, stock, sizeof(Universal), [setting](JointStep& s) {
            const btTransform frame = s.a->getCenterOfMassTransform() * JointStep::frameA();
            auto joint = std::make_unique<Universal>(*s.a, *s.b, frame.getOrigin(),
                                                     frame.getBasis().getColumn(2),
                                                     frame.getBasis().getColumn(1));
            // A step turns nothing here: bent by hand.
            s.bend(frame);
            setting(*joint);
            return std::unique_ptr<btTypedConstraint>(std::move(joint));
          }};
}

/// Stands at 0.3 m, 0 rad.
template <class Slider, class Setting>
Case slider(const char* name, const char* stock, Setting setting) {
  return {name, stock, sizeof(Slider), [setting](JointStep& s) {
            const btTransform slide(btQuaternion::getIdentity(), btVector3(btScalar(0.3), 0, 0));
            s.b->setCenterOfMassTransform(s.a->getCenterOfMassTransform() * JointStep::frameA() *
                                          slide * JointStep::frameB().inverse());
            s.b->updateInertiaTensor();
            auto joint = std::make_unique<Slider>(*s.a, *s.b, JointStep::frameA(),
                                                  JointStep::frameB(), true);
            setting(*joint);
            return std::unique_ptr<btTypedConstraint>(std::move(joint));
          }};
}

inline std::vector<Case> sliders() {
  const auto as_is = [](auto&) {};
  const auto plain = [](auto& joint) { joint.setBlockRows(false); };
  const auto with_plain = [plain](auto setting) {
    return [plain, setting](auto& joint) { plain(joint), setting(joint); };
  };
  const auto lin_limit = [](auto& joint) { joint.setLowerLinLimit(1), joint.setUpperLinLimit(2); };
  const auto lin_inside = [](auto& joint) {
    joint.setLowerLinLimit(-2), joint.setUpperLinLimit(2);
  };
  const auto lin_motor = [](auto& joint) {
    joint.setPoweredLinMotor(true);
    joint.setTargetLinMotorVelocity(1);
    joint.setMaxLinMotorForce(10);
  };
  const auto turns = [](auto& joint) { joint.setLowerAngLimit(1), joint.setUpperAngLimit(-1); };
  const auto ang_inside = [](auto& joint) {
    joint.setLowerAngLimit(-1), joint.setUpperAngLimit(1);
  };
  const auto two_axes = [lin_limit](auto& joint) {
    lin_limit(joint);
    joint.setLowerAngLimit(btScalar(0.2)), joint.setUpperAngLimit(1);
  };
  return {
      slider<btSliderConstraint>("stock slider", nullptr, as_is),
      slider<pintle::SliderJoint>("slider, plain rows", "stock slider", plain),
      slider<pintle::SliderJoint>("slider", "stock slider", as_is),
      slider<btSliderConstraint>("stock slider, inside limit", nullptr, lin_inside),
      inactive(slider<pintle::SliderJoint>("slider, inside limit", "stock slider, inside limit",
                                           lin_inside),
               "slider"),
      slider<btSliderConstraint>("stock slider, limit", nullptr, lin_limit),
      slider<pintle::SliderJoint>("slider, limit, plain rows", "stock slider, limit",
                                  with_plain(lin_limit)),
      slider<pintle::SliderJoint>("slider, limit", "stock slider, limit", lin_limit),
      slider<btSliderConstraint>("stock slider, motor", nullptr, lin_motor),
      slider<pintle::SliderJoint>("slider, motor, plain rows", "stock slider, motor",
                                  with_plain(lin_motor)),
      slider<pintle::SliderJoint>("slider, motor", "stock slider, motor", lin_motor),
      slider<btSliderConstraint>("stock slider, turns", nullptr, turns),
      slider<pintle::SliderJoint>("slider, turns, plain rows", "stock slider, turns",
                                  with_plain(turns)),
      slider<pintle::SliderJoint>("slider, turns", "stock slider, turns", turns),
      slider<btSliderConstraint>("stock slider, angle inside", nullptr, ang_inside),
      inactive(slider<pintle::SliderJoint>("slider, angle inside", "stock slider, angle inside",
                                           ang_inside),
               "slider, turns"),
      slider<btSliderConstraint>("stock slider, two limits", nullptr, two_axes),
      slider<pintle::SliderJoint>("slider, two limits", "stock slider, two limits", two_axes),
  };
}

inline std::vector<Case> others() {
  using Stock = btHingeConstraint;
  using Hinge = pintle::QuaternionHinge;
  const auto as_is = [](auto&) {};
  const auto plain = [](auto& joint) { joint.setBlockRows(false); };
  // The hinge stands at -0.4 rad: beyond this limit, and inside that one.
  const auto limit = [](auto& joint) { joint.setLimit(0, 1); };
  const auto inside = [](auto& joint) { joint.setLimit(-2, 2); };
  const auto motor = [](auto& joint) { joint.enableAngularMotor(true, 1, 1); };
  const auto both = [limit, motor](auto& joint) { limit(joint), motor(joint); };
  // Set and turned off: motor, servo, friction, and the spring of a limit that is free.
  const auto off = [](auto& joint) {
    joint.enableAngularMotor(true, 1, 1);
    joint.setMotorServo(1, 5, 1, 10);
    joint.enableMotor(false);
    joint.setFriction(1), joint.setFriction(0);
    joint.setLimitSpring(5, 1);
  };
  const auto with_plain = [plain](auto setting) {
    return [plain, setting](auto& joint) { plain(joint), setting(joint); };
  };
  // Both angles stand at -0.4 rad.
  using StockUniversal = btUniversalConstraint;
  using Universal = pintle::UniversalJoint;
  using ConstantVelocity = pintle::ConstantVelocityJoint;
  const auto free = [](auto& joint) { joint.setLimit(4, 1, -1), joint.setLimit(5, 1, -1); };
  const auto universal_limit = [](auto& joint) { joint.setLimit(5, 0, 1); };
  const auto stock_motor = [](StockUniversal& joint) {
    joint.getRotationalLimitMotor(2)->m_enableMotor = true;
    joint.getRotationalLimitMotor(2)->m_targetVelocity = 1;
  };
  const auto universal_motor = [](Universal& joint) { joint.enableMotor(5, true, 1, 6); };
  return {
      hinge<Stock>("stock hinge", nullptr, as_is),
      hinge<Hinge>("hinge, plain rows", "stock hinge", plain),
      hinge<Hinge>("hinge", "stock hinge", as_is),
      hinge<Stock>("stock hinge, inside limit", nullptr, inside),
      inactive(hinge<Hinge>("hinge, inside limit", "stock hinge, inside limit", inside), "hinge"),
      inactive(hinge<Hinge>("hinge, motor etc. off", "stock hinge", off), "hinge", 4),
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
      universal<StockUniversal>("stock universal", nullptr, as_is),
      universal<StockUniversal>("stock universal, free", nullptr, free),
      universal<Universal>("universal, plain rows", "stock universal", plain),
      universal<Universal>("universal, free", "stock universal, free", free),
      inactive(universal<Universal>("universal", "stock universal", as_is), "universal, free", 2),
      universal<Universal>("universal, free, plain", "stock universal, free", with_plain(free)),
      universal<StockUniversal>("stock universal, limit", nullptr, universal_limit),
      universal<Universal>("universal, limit, plain", "stock universal, limit",
                           with_plain(universal_limit)),
      universal<Universal>("universal, limit", "stock universal, limit", universal_limit),
      universal<StockUniversal>("stock universal, motor", nullptr, stock_motor),
      universal<Universal>("universal, motor", "stock universal, motor", universal_motor),
      hinge<ConstantVelocity>("constant velocity, plain", "stock universal", plain),
      hinge<ConstantVelocity>("constant velocity", "stock universal", as_is),
      inactive(hinge<ConstantVelocity>("const. velocity, inside", "stock universal",
                                       [](auto& joint) { joint.setBendLimit(1); }),
               "constant velocity"),
      hinge<ConstantVelocity>("const. velocity, limit", "stock universal, limit",
                              [](auto& joint) { joint.setBendLimit(btScalar(0.3)); }),
  };
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

inline std::vector<Case> locksAndHinges() {
  const auto as_is = [](auto&) {};
  const auto plain = [](auto& joint) { joint.setBlockRows(false); };
  const auto limit = [](auto& joint) { joint.setLimit(0, 1); };
  const auto motor = [](auto& joint) { joint.enableAngularMotor(true, 1, 1); };
  return {
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

/// Of a joint that Bullet has none of, beside the ball.
template <class Joint, class Setting>
Case free_joint(const char* name, Setting setting) {
  return hinge<Joint>(name, "stock ball", setting);
}

inline std::vector<Case> ownJoints() {
  const auto as_is = [](auto&) {};
  const auto plain = [](auto& joint) { joint.setBlockRows(false); };
  const auto inside = [](auto& joint) { joint.setLimit(-2, 2); };
  const auto motor = [](auto& joint) { joint.enableAngularMotor(true, 1, 1); };
  return {
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
      inactive(free_joint<pintle::WedgeJoint>("wedge, inside limit", inside), "wedge, free"),
      free_joint<pintle::WedgeJoint>("wedge, limit", [](auto& wedge) { wedge.setLimit(-1, 0); }),
      free_joint<pintle::AngularLimit>("angle, inside limit", inside),
      free_joint<pintle::AngularLimit>("angle, limit", [](auto& angle) { angle.setLimit(-1, 0); }),
      free_joint<pintle::AngularLimit>("angle, motor", motor),
  };
}

template <class Joint, class Setting>
Case coneTwist(const char* name, const char* stock, Setting setting) {
  return {name, stock, sizeof(Joint), [setting](JointStep& s) {
            auto joint =
                std::make_unique<Joint>(*s.a, *s.b, JointStep::frameA(), JointStep::frameB());
            setting(*joint);
            return std::unique_ptr<btTypedConstraint>(std::move(joint));
          }};
}

inline std::vector<Case> coneTwists() {
  std::vector<Case> cases;
  using Stock = btConeTwistConstraint;
  using Joint = pintle::ConeTwistJoint;
  // The joint stands at a swing of 0.4 rad about z, and no twist.
  const auto free = [](auto&) {};
  const auto inside = [](auto& joint) { joint.setLimit(1, btScalar(1.5), 1); };
  const auto near = [](auto& joint) { joint.setLimit(btScalar(0.41), btScalar(0.6), 1); };
  const auto active = [](auto& joint) { joint.setLimit(btScalar(0.3), btScalar(0.6), 1); };
  const auto both = [](auto& joint) {
    joint.setLimit(btScalar(0.3), btScalar(0.3), 1);
    joint.setFrames(joint.getAFrame(), joint.getBFrame() * btTransform(btQuaternion(
                                                               btVector3(1, 0, 0), btScalar(1.2))));
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
    if (cases.back().name == std::string("cone, inside"))
      cases.back() = inactive(cases.back(), "cone, free", 2);
  }
  return cases;
}

template <class Gear>
Case gear(const char* name, const char* stock) {
  return {name, stock, sizeof(Gear), [](JointStep& s) {
            return std::unique_ptr<btTypedConstraint>(
                std::make_unique<Gear>(*s.a, *s.b, JointStep::frameA().getBasis().getColumn(2),
                                       JointStep::frameB().getBasis().getColumn(2), 2));
          }};
}

inline std::vector<Case> gears() {
  // It couples two hinges on the world.
  const auto of_hinges = [](JointStep& s) {
    btHingeConstraint of_a(*s.a, JointStep::frameA().getOrigin(), btVector3(0, 0, 1)),
        of_b(*s.b, JointStep::frameB().getOrigin(), btVector3(0, 0, 1));
    return std::unique_ptr<btTypedConstraint>(std::make_unique<pintle::GearJoint>(of_a, of_b, 2));
  };
  return {gear<btGearConstraint>("stock gear", nullptr),
          gear<pintle::GearJoint>("gear", "stock gear"),
          {"gear of hinges", "stock gear", sizeof(pintle::GearJoint), of_hinges}};
}

inline std::vector<Case> cases() {
  std::vector<Case> all;
  for (const auto& some :
       {others(), sliders(), locksAndHinges(), coneTwists(), ownJoints(), gears()})
    all.insert(all.end(), some.begin(), some.end());
  return all;
}

}  // namespace bench

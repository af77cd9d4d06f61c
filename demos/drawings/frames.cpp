// Purpose: the drawings of joints that hold frames together, or but for an axis.
#include <pintle/joints/fixed_joint.h>
#include <pintle/joints/generic_6dof_joint.h>
#include <pintle/joints/generic_6dof_spring_2_joint.h>
#include <pintle/joints/generic_6dof_spring_joint.h>
#include <pintle/joints/hinge_2_joint.h>
#include <pintle/joints/slider_joint.h>
#include <pintle/joints/unstable/single_row_lock.h>

#include <memory>

#include "picture.h"

namespace drawings {
namespace {

template <class Joint>
Made lock(
    const char* file, const char* title, const char* subtitle, std::vector<std::string> notes,
    void (*set)(Joint&) = [](Joint&) {}) {
  const btTransform in_a = at(-0.62, 0, 0), in_b = at(0.62, 0, 0);
  const MakeJoint make = [&](btRigidBody& a, btRigidBody& b) {
    auto joint = std::make_unique<Joint>(a, b, in_a, in_b);
    set(*joint);
    return joint;
  };
  const Poses poses{in_b * in_a.inverse(), at(0, 0, 0)};
  Pair pair(poses, make);
  auto& joint = static_cast<Joint&>(*pair.joint);
  const btTransform frame = joint.getCalculatedTransformB();

  Sketch sketch({-58, 22, 125, frame(vec(0, 0, 0.15))});
  sketch.box(Paint::b, poses.b * at(-0.1, 0, 0), vec(0.65, 0.3, 0.3));
  sketch.box(Paint::b, frame * at(-0.04, 0, 0), vec(0.04, 0.45, 0.45));
  sketch.box(Paint::a, frame * at(0.04, 0, 0), vec(0.04, 0.45, 0.45));
  sketch.box(Paint::a, poses.a * at(0.1, 0, 0), vec(0.65, 0.3, 0.3));
  sketch.layer(1);
  for (int k = 0; k < 3; ++k) {
    btVector3 way(0, 0, 0);
    way[k] = btScalar(k == 0 ? 1.35 : 0.95);
    sketch.axis(frame.getOrigin(), frame(way));
    sketch.label(frame(btScalar(1.1) * way), std::string(1, char('x' + k)), 0, 5, "big");
  }
  sketch.dot(frame.getOrigin());
  sketch.label(poses.a(vec(0.2, -0.3, -0.1)), "A", 0, 5, "big");
  sketch.label(poses.b(vec(-0.3, -0.3, -0.1)), "B", 0, 5, "big");

  Sketch::Caption text = caption(title, subtitle, kAInB, degreesOf(make, poses, true, frame));
  text.notes = std::move(notes);
  return {file, sketch.svg(text), sketch.tile(text.title)};
}

// A stretch along x, a turn about it, and a bend.
template <class Joint>
void setAxes(Joint& joint) {
  joint.setLimit(0, btScalar(-0.3), btScalar(0.3));
  joint.setLimit(4, rad(-30), rad(30));
  joint.setLimit(5, 0, 0);
}
template <class Joint>
void setSprings(Joint& joint) {
  setAxes(joint);
  for (const int axis : {0, 4}) {
    joint.enableSpring(axis, true);
    joint.setStiffness(axis, 100);
  }
}

Made slider() {
  const btTransform in_a = at(0, 0, 0), in_b = at(0, 0, 0);
  const MakeJoint make = [&](btRigidBody& a, btRigidBody& b) {
    auto joint = std::make_unique<pintle::SliderJoint>(a, b, in_a, in_b);
    joint->setLowerLinLimit(btScalar(-0.4));
    joint->setUpperLinLimit(btScalar(1));
    joint->setLowerAngLimit(rad(-30));
    joint->setUpperAngLimit(rad(60));
    return joint;
  };
  const Poses still{at(0, 0, 0), at(0, 0, 0)}, poses{still.a, at(0.4, 0, 0) * turned(kX, 25)};
  Pair pair(poses, make);
  auto& joint = static_cast<pintle::SliderJoint&>(*pair.joint);
  const btTransform rail = joint.getCalculatedTransformA(),
                    carriage = joint.getCalculatedTransformB();
  const auto on_rail = [&](btScalar position, double y, double z) {
    return rail(btVector3(position, btScalar(y), btScalar(z)));
  };

  Sketch sketch({-56, 24, 128, vec(0.05, 0, 0.0)});
  sketch.cylinder(Paint::a, alongX(rail * at(0, 0, 0)), btScalar(0.08), btScalar(1.5));
  sketch.layer(1);
  sketch.box(Paint::b, carriage, vec(0.22, 0.3, 0.2));
  sketch.layer(2);
  sketch.cylinder(Paint::a, alongX(rail * at(1.02, 0, 0)), btScalar(0.08), btScalar(0.45));
  sketch.box(Paint::a, rail * at(-1.5, 0, 0), vec(0.06, 0.3, 0.3));
  sketch.layer(4);
  sketch.box(Paint::a, rail * at(1.5, 0, 0), vec(0.06, 0.3, 0.3));
  sketch.layer(5);
  const btScalar low = joint.getLowerLinLimit(), high = joint.getUpperLinLimit(),
                 position = joint.getLinearPos();
  sketch.patch({on_rail(low, -0.5, -0.5), on_rail(high, -0.5, -0.5), on_rail(high, -0.5, -0.38),
                on_rail(low, -0.5, -0.38)});
  sketch.stop(on_rail(low, -0.5, -0.55), on_rail(low, -0.5, -0.33));
  sketch.stop(on_rail(high, -0.5, -0.55), on_rail(high, -0.5, -0.33));
  sketch.zero(on_rail(0, 0, 0), on_rail(0, -0.5, -0.5));
  sketch.layer(6);
  sketch.axis(on_rail(-1.75, 0, 0), on_rail(1.85, 0, 0));
  sketch.pointer(on_rail(0, -0.5, -0.44), on_rail(position, -0.5, -0.44));
  sketch.zero(on_rail(position, -0.3, -0.2), on_rail(position, -0.5, -0.44));
  const btScalar sign = [&] {
    Poses moved = still;
    moved.b = at(0.1, 0, 0);
    Pair other(moved, make);
    return static_cast<pintle::SliderJoint&>(*other.joint).getLinearPos() > 0 ? btScalar(1)
                                                                              : btScalar(-1);
  }();
  sketch.move(on_rail(position + sign * btScalar(0.04), -0.5, -0.44),
              on_rail(position + sign * btScalar(0.4), -0.5, -0.44));
  sketch.label(on_rail(position + sign * btScalar(0.22), -0.5, -0.6), "+", 0, 8, "big green");
  Arc range = rangeOf(joint, 0.75);
  range.centre = carriage(vec(0.23, 0, 0));
  sketch.layer(3);
  sketch.range(range);
  sketch.layer(6);
  const btScalar angle = joint.getAngularPos();
  const btScalar turn_sign = signOf<pintle::SliderJoint>(
      make, still, false, still.a, kX, [](pintle::SliderJoint& j) { return j.getAngularPos(); });
  sketch.zero(range.centre, range.at(0));
  sketch.pointer(range.centre, range.at(angle));
  sketch.turn(onwards(range, angle, turn_sign, 1.12, 40));
  sketch.label(range.at(angle + turn_sign * rad(20), btScalar(1.34)), "+", 0, 4, "big green");
  sketch.label(on_rail(low, -0.5, -0.7), metres(low), 0, 0);
  sketch.label(on_rail(high, -0.5, -0.7), metres(high), 0, 0);
  sketch.label(on_rail(1.85, 0, 0), "x", 8, 6, "big");
  sketch.label(rail(vec(-1.44, 0, -0.15)), "A", 0, 8, "big");
  sketch.label(carriage(vec(0, -0.3, 0)), "B", -4, 6, "big");

  Sketch::Caption text =
      caption("SliderJoint", "B slides along an axis of A, and turns about it if it may", kBInA,
              degreesOf(make, still, false, still.a));
  text.readings = {{"getLinearPos()", metres(position)},
                   {"linear limits", between(metres(low), metres(high))},
                   {"getAngularPos()", degrees(angle)},
                   {"angular limits",
                    between(degrees(joint.getLowerAngLimit()), degrees(joint.getUpperAngLimit()))}};
  text.notes = {
      std::string("+ : B slides along ") + (sign > 0 ? "x" : "\u2212x") + " of A, and turns",
      std::string(turn_sign > 0 ? "right" : "left") + "-handed about it",
      "By default the turn is held."};
  return {"slider_joint", sketch.svg(text), sketch.tile(text.title)};
}

}  // namespace

std::vector<Made> drawFrames() {
  return {
      slider(),
      lock<pintle::FixedJoint>("fixed_joint", "FixedJoint", "A weld: two frames coincide",
                               {"Nothing is free."}),
      lock<pintle::Generic6DofJoint>(
          "generic_6dof_joint", "Generic6DofJoint", "Each axis is locked, limited or free",
          {"Here x is limited, and so is the", "turn about y; that about x is free."}, setAxes),
      lock<pintle::Generic6DofSpringJoint>(
          "generic_6dof_spring_joint", "Generic6DofSpringJoint", "The same, with springs",
          {"Here with springs along x and about y,", "within their limits."}, setSprings),
      lock<pintle::Generic6DofSpring2Joint>(
          "generic_6dof_spring_2_joint", "Generic6DofSpring2Joint",
          "The same, with springs, servos and any order of angles",
          {"Here with springs along x and about y,", "within their limits."}, setSprings),
      lock<pintle::Hinge2Joint>("hinge_2_joint", "Hinge2Joint",
                                "A wheel: sprung along z, steered about it", {"It turns about x."}),
      lock<pintle::SingleRowLock>(
          "single_row_lock", "SingleRowLock",
          "For comparison only: one row along the error of the orientation",
          {"Where there is no error there is no", "row: nothing holds the turn."})};
}

}  // namespace drawings

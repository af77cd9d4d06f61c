// Purpose: the drawing of a gear: two wheels that mesh.
#include <pintle/joints/gear_joint.h>

#include <memory>

#include "picture.h"

namespace drawings {
namespace {

constexpr double kRadiusA = 0.9, kRadiusB = 0.45;

// A wheel about z, with a tooth along x.
void drawWheel(Sketch& sketch, Paint paint, const btTransform& pose, double radius, int teeth) {
  sketch.cylinder(paint, pose, btScalar(radius - 0.06), btScalar(0.09));
  for (int i = 0; i < teeth; ++i)
    sketch.box(paint, pose * turned(kZ, 360. * i / teeth) * at(radius - 0.03, 0, 0),
               vec(0.06, 0.06, 0.09));
}

Made gear() {
  const MakeJoint make = [](btRigidBody& a, btRigidBody& b) {
    return std::make_unique<pintle::GearJoint>(a, b, kZ, kZ, btScalar(kRadiusB / kRadiusA));
  };
  const Poses still{at(-0.72, 0, 0), at(0.68, 0, 0)};
  Pair pair(still, make);
  auto& joint = static_cast<pintle::GearJoint&>(*pair.joint);
  // Where a has turned by so much b is turned until nothing is off.
  const double turn_a = 40;
  Poses poses = still;
  poses.a = still.a * turned(kZ, turn_a);
  pair.a->setCenterOfMassTransform(poses.a);
  const double turn_b = -double(joint.getError() / joint.getRatio()) / double(SIMD_RADS_PER_DEG);
  poses.b = still.b * turned(kZ, turn_b);
  pair.b->setCenterOfMassTransform(poses.b);

  Sketch sketch({-70, 38, 132, vec(0, 0, 0)});
  drawWheel(sketch, Paint::a, poses.a * turned(kZ, 9), kRadiusA, 20);
  drawWheel(sketch, Paint::b, poses.b, kRadiusB, 10);
  sketch.layer(1);
  for (const auto& [pose, name] : {std::pair{still.a, "A"}, std::pair{still.b, "B"}}) {
    sketch.axis(pose(vec(0, 0, -0.4)), pose(vec(0, 0, 0.75)));
    sketch.label(pose(vec(0, 0, 0.8)), name, 0, 0, "big");
  }
  const auto arc = [&](const btTransform& pose, double radius, double degrees) {
    return Arc{pose(vec(0, 0, 0.1)), kZ, -kY, btScalar(radius), 0, rad(degrees)};
  };
  const Arc of_a = arc(still.a, 0.6, turn_a), of_b = arc(still.b, 0.28, turn_b);
  for (const Arc& of : {of_a, of_b}) {
    sketch.zero(of.centre, of.at(0, btScalar(1.2)));
    sketch.pointer(of.centre, of.at(of.high, btScalar(1.2)));
    sketch.turn(of);
  }
  sketch.label(of_a.at(rad(turn_a / 2), btScalar(0.75)), degrees(rad(turn_a)), 0, 4);
  sketch.label(of_b.at(rad(turn_b / 2), btScalar(0.7)), degrees(rad(turn_b)), 0, 4);

  Sketch::Caption text =
      caption("GearJoint", "Two wheels, a rack, a screw, a joint that follows another",
              "B, where A holds still, axes of B", degreesOf(make, still, false, still.b));
  text.readings = {{"getCoordinateA()", degrees(joint.getCoordinateA())},
                   {"getCoordinateB()", degrees(joint.getCoordinateB())},
                   {"getRatio()", "0.5"}};
  text.notes = {"Held: A + ratio \u00b7 B, in angles,", "over any number of turns.",
                "A hinge holds each wheel's axis."};
  return {"gear_joint", sketch.svg(text), sketch.tile(text.title)};
}

}  // namespace

std::vector<Made> drawGears() { return {gear()}; }

}  // namespace drawings

// Purpose: the drawings of joints that limit a swing or an angle.
#include <pintle/joints/angular_limit.h>
#include <pintle/joints/cone_twist_joint.h>
#include <pintle/joints/wedge_joint.h>

#include <memory>
#include <stdexcept>
#include <tuple>

#include "picture.h"

namespace drawings {
namespace {

Made coneTwist() {
  const btTransform in_a = at(-0.75, 0, 0), in_b = at(0.35, 0, 0);
  const MakeJoint make = [&](btRigidBody& a, btRigidBody& b) {
    auto joint = std::make_unique<pintle::ConeTwistJoint>(a, b, in_a, in_b);
    joint->setLimit(rad(55), rad(30), rad(45));
    return joint;
  };
  const Poses still{in_b * in_a.inverse(), at(0, 0, 0)},
      poses{in_b * turned(kZ, 28) * turned(kY, -12) * turned(kX, 20) * in_a.inverse(), at(0, 0, 0)};
  Pair pair(poses, make);
  auto& joint = static_cast<pintle::ConeTwistJoint&>(*pair.joint);
  const btTransform A = joint.getCalculatedTransformA(), B = joint.getCalculatedTransformB();

  Sketch sketch({-40, 24, 128, B(vec(0.5, 0, 0.1))});
  sketch.box(Paint::b, at(-0.15, 0, 0), vec(0.3, 0.45, 0.45));
  sketch.layer(1);
  sketch.ball(Paint::a, B.getOrigin(), btScalar(0.17));
  sketch.layer(2);
  std::vector<btVector3> rim;
  for (int i = 0; i < 48; ++i)
    rim.push_back(B(joint.GetPointForAngle(SIMD_2_PI * btScalar(i) / 48, btScalar(1.2))));
  sketch.cone(B.getOrigin(), rim);
  sketch.layer(3);
  sketch.cylinder(Paint::a, alongX(A * at(0.62, 0, 0)), btScalar(0.07), btScalar(0.5));
  sketch.layer(4);
  sketch.axis(B(vec(-0.8, 0, 0)), B(vec(1.5, 0, 0)));
  for (int i = 0; i < 4; ++i) sketch.stop(B.getOrigin(), rim[std::size_t(12 * i)]);
  const Arc about_z{
      B.getOrigin(), B.getBasis().getColumn(2), B.getBasis().getColumn(0), btScalar(1.3), 0, 0};
  const Arc about_y{
      B.getOrigin(), B.getBasis().getColumn(1), B.getBasis().getColumn(0), btScalar(1.3), 0, 0};
  const auto read = [](auto get) {
    return [get](pintle::ConeTwistJoint& j) { return (j.*get)(); };
  };
  using J = pintle::ConeTwistJoint;
  const btScalar sign_1 = signOf<J>(make, still, true, B, kZ, read(&J::getSwing1)),
                 sign_2 = signOf<J>(make, still, true, B, kY, read(&J::getSwing2));
  const btScalar sign_twist = signOf<J>(make, still, true, B, kX, read(&J::getTwist));
  for (const auto& [arc, sign, name] :
       {std::tuple{about_z, sign_1, "+ swing 1"}, {about_y, sign_2, "+ swing 2"}}) {
    Arc way = arc;
    way.low = sign * rad(4);
    way.high = sign * rad(24);
    sketch.turn(way);
    sketch.label(way.at(way.high, btScalar(1.12)), name, name[8] == '1' ? 30 : 22,
                 name[8] == '1' ? 4 : 16, "green bold");
  }
  const Arc twist{A(vec(1.12, 0, 0)), A.getBasis().getColumn(0), A.getBasis().getColumn(1),
                  btScalar(0.2),      sign_twist * rad(-110),    sign_twist * rad(130)};
  sketch.turn(twist);
  sketch.label(twist.centre, "+ twist", 22, -38, "green bold");
  sketch.label(B(vec(1.5, 0, 0)), "x", 8, 8, "big");
  sketch.label(A(vec(0.55, 0, 0)), "A", 0, 5, "big");
  sketch.label(at(-0.15, 0, 0)(vec(-0.05, -0.45, 0)), "B", 0, 5, "big");

  Sketch::Caption text =
      caption("ConeTwistJoint", "A shoulder: A swings within a cone of B, and twists", kAInB,
              degreesOf(make, still, true, B));
  text.readings = {{"getSwing1()  about z", degrees(joint.getSwing1())},
                   {"span", "\u00b1" + degrees(joint.getSwingSpan1())},
                   {"getSwing2()  about y", degrees(joint.getSwing2())},
                   {"span", "\u00b1" + degrees(joint.getSwingSpan2())},
                   {"getTwist()   about x", degrees(joint.getTwist())},
                   {"span", "\u00b1" + degrees(joint.getTwistSpan())}};
  text.notes = {"setLimit(swing 1, swing 2, twist)", "+ : right-handed about the axis"};
  if (sign_1 < 0 || sign_2 < 0 || sign_twist < 0)
    throw std::logic_error("ConeTwistJoint: the drawing has its signs wrong");
  return {"cone_twist_joint", sketch.svg(text), sketch.tile(text.title)};
}

Made wedge() {
  const btTransform in_a = at(0, 0, 0.2), in_b = at(-0.75, 0, 0);
  const MakeJoint make = [&](btRigidBody& a, btRigidBody& b) {
    auto joint = std::make_unique<pintle::WedgeJoint>(a, b, in_a, in_b);
    joint->setLimit(rad(-20), rad(70));
    return joint;
  };
  const btTransform frame = in_a;
  const Poses still{at(0, 0, 0), frame * in_b.inverse()},
      poses{still.a, frame * turned(kZ, 30) * turned(kY, -28) * in_b.inverse()};
  Pair pair(poses, make);
  auto& joint = static_cast<pintle::WedgeJoint&>(*pair.joint);
  const btTransform A = joint.getCalculatedTransformA(), B = joint.getCalculatedTransformB();

  Sketch sketch({-58, 24, 128, A(vec(0.35, 0.1, 0.02))});
  sketch.box(Paint::a, A * at(-0.35, 0, -0.1), vec(0.22, 0.32, 0.5));
  sketch.layer(1);
  sketch.ball(Paint::b, A.getOrigin(), btScalar(0.13));
  const Arc range = rangeOf(joint, 1.15);
  const auto plane = [&](btScalar angle) {
    std::vector<btVector3> corners;
    for (int i = -18; i <= 18; ++i) {
      const Arc up{A.getOrigin(),
                   (range.at(angle) - range.centre).normalized().cross(kZ),
                   (range.at(angle) - range.centre).normalized(),
                   range.radius,
                   0,
                   0};
      corners.push_back(up.at(rad(5.0 * i)));
    }
    return corners;
  };
  sketch.layer(1);
  sketch.patch(plane(joint.getUpperLimit()));
  sketch.outline(plane(joint.getUpperLimit()));
  sketch.layer(2);
  sketch.range(range);
  sketch.layer(3);
  sketch.cylinder(Paint::b, alongX(B * at(0.6, 0, 0)), btScalar(0.07), btScalar(0.5));
  sketch.layer(4);
  sketch.patch(plane(joint.getLowerLimit()));
  sketch.outline(plane(joint.getLowerLimit()));
  sketch.layer(5);
  sketch.axis(A(vec(0, 0, -1.25)), A(vec(0, 0, 1.3)));
  sketch.zero(range.centre, range.at(0));
  const btScalar sign = signOf<pintle::WedgeJoint>(
      make, still, false, A, kZ, [](pintle::WedgeJoint& j) { return j.getAngle(); });
  const btVector3 x = A.inverse().getBasis() * B.getBasis().getColumn(0);
  const btScalar angle = joint.getAngle();
  sketch.pointer(B.getOrigin(), B(vec(1.32, 0, 0)));
  sketch.zero(B(vec(1.32, 0, 0)), A(btVector3(btScalar(1.32) * x.x(), btScalar(1.32) * x.y(), 0)));
  sketch.turn(onwards(range, angle, sign, 1.12, 26));
  sketch.label(range.at(angle + sign * rad(13), btScalar(1.3)), "+", 4, 4, "big green");
  sketch.label(A(vec(0, 0, 1.3)), "z", -12, 6, "big");
  sketch.label(B(vec(1.4, 0, 0)), "x of B", 18, -2, "bold");
  sketch.label(range.at(0, btScalar(1.1)), "0\u00b0", 0, 10);
  sketch.label(range.at(range.low, btScalar(1.1)), degrees(range.low), 0, 14);
  sketch.label(range.at(range.high, btScalar(1.12)), degrees(range.high), 8, -6);
  sketch.label(A(vec(-0.35, -0.32, -0.15)), "A", 0, 5, "big");
  sketch.label(B(vec(0.6, 0, 0)), "B", 0, 5, "big");

  Sketch::Caption text =
      caption("WedgeJoint", "x of B stays between two half planes that meet in z of A", kBInA,
              degreesOf(make, still, false, A));
  text.readings = angleAndLimit("getAngle()", angle, joint);
  text.notes = {handed(sign, "B", "z of A"), "0\u00b0: x of A",
                "B may lean towards z, and turn about", "its own x."};
  return {"wedge_joint", sketch.svg(text), sketch.tile(text.title)};
}

Made angularLimit() {
  const btTransform in_a = at(0, 0, 0.45), in_b = at(0, 0, 0.3);
  const MakeJoint make = [&](btRigidBody& a, btRigidBody& b) {
    auto joint = std::make_unique<pintle::AngularLimit>(a, b, in_a, in_b);
    joint->setLimit(rad(-40), rad(75));
    return joint;
  };
  const Poses still{at(0, 0, 0), at(0, 0, 0.15)},
      poses{at(0, 0, 0), at(1.55, 0.3, 0.05) * turned(kZ, 35)};
  Pair pair(poses, make);
  auto& joint = static_cast<pintle::AngularLimit&>(*pair.joint);
  const btTransform A = joint.getCalculatedTransformA(), B = joint.getCalculatedTransformB();

  Sketch sketch({-62, 30, 118, vec(0.8, 0.2, 0.2)});
  sketch.box(Paint::a, poses.a, vec(0.4, 0.4, 0.4));
  sketch.box(Paint::b, poses.b, vec(0.35, 0.28, 0.26));
  sketch.layer(1);
  const Arc range = rangeOf(joint, 0.9);
  sketch.range(range);
  sketch.layer(2);
  const btScalar angle = joint.getAngle();
  const btScalar sign = signOf<pintle::AngularLimit>(
      make, still, false, A, kZ, [](pintle::AngularLimit& j) { return j.getAngle(); });
  sketch.axis(A(vec(0, 0, -1)), A(vec(0, 0, 0.8)));
  sketch.zero(range.centre, range.at(0));
  sketch.pointer(range.centre, range.at(angle));
  sketch.pointer(B.getOrigin(), B(vec(0.75, 0, 0)));
  sketch.turn(onwards(range, angle, sign, 1.12, 30));
  sketch.label(range.at(angle + sign * rad(15), btScalar(1.3)), "+", 2, 2, "big green");
  sketch.label(A(vec(0, 0, 0.8)), "z", -12, 6, "big");
  sketch.label(B(vec(0.82, 0, 0)), "x of B", 14, 0, "bold");
  sketch.label(range.at(0, btScalar(1.1)), "0\u00b0", 4, 8);
  sketch.label(range.at(range.low, btScalar(1.12)), degrees(range.low), 0, 10);
  sketch.label(range.at(range.high, btScalar(1.12)), degrees(range.high), 0, -4);
  sketch.label(poses.a(vec(0, -0.4, -0.05)), "A", 0, 5, "big");
  sketch.label(poses.b(vec(0.1, -0.28, -0.05)), "B", 0, 5, "big");

  Sketch::Caption text =
      caption("AngularLimit", "Limits one angle between A and B, and holds nothing", kBInA,
              degreesOf(make, still, false, A));
  text.readings = angleAndLimit("getAngle()", angle, joint);
  text.notes = {handed(sign, "B", "z of A"), "0\u00b0: x of B points along x of A",
                "Add it to a joint that leaves the", "angle free."};
  return {"angular_limit", sketch.svg(text), sketch.tile(text.title)};
}

}  // namespace

std::vector<Made> drawSwings() { return {coneTwist(), wedge(), angularLimit()}; }

}  // namespace drawings

// Purpose: the drawings of joints of two shafts.
#include <pintle/joints/constant_velocity_joint.h>
#include <pintle/joints/universal_joint.h>

#include <memory>

#include "picture.h"

namespace drawings {
namespace {

// Two arms that carry an axis of the spider, z or y of the frame.
void drawFork(Sketch& sketch, Paint paint, const btTransform& frame, double side, bool about_z) {
  const btTransform f = about_z ? frame : frame * turned(kX, 90);
  sketch.cylinder(paint, alongX(frame * at(side * 0.98, 0, 0)), btScalar(0.11), btScalar(0.48));
  sketch.box(paint, f * at(side * 0.44, 0, 0), vec(0.05, 0.12, 0.42));
  for (const double z : {-0.37, 0.37})
    sketch.box(paint, f * at(side * 0.17, 0, z), vec(0.25, 0.12, 0.05));
}

Made universal() {
  const btTransform in_a = at(0.9, 0, 0), in_b = at(-0.9, 0, 0);
  const MakeJoint make = [&](btRigidBody& a, btRigidBody& b) {
    auto joint = std::make_unique<pintle::UniversalJoint>(a, b, in_a, in_b);
    joint->setLimit(5, rad(-50), rad(50));
    joint->setLimit(4, rad(-60), rad(60));
    return joint;
  };
  const btTransform frame = at(0, 0, 0);
  const Poses still{frame * in_a.inverse(), frame * in_b.inverse()},
      poses{still.a, frame * turned(kZ, 25) * turned(kY, 20) * in_b.inverse()};
  Pair pair(poses, make);
  auto& joint = static_cast<pintle::UniversalJoint&>(*pair.joint);
  const btTransform A = joint.getCalculatedTransformA(), B = joint.getCalculatedTransformB();
  const btVector3 z = A.getBasis().getColumn(2), y = B.getBasis().getColumn(1), x = y.cross(z);

  Sketch sketch({-38, 28, 126, vec(0.12, 0, 0)});
  drawFork(sketch, Paint::a, A, -1, true);
  drawFork(sketch, Paint::b, B, 1, false);
  const btTransform spider(
      btMatrix3x3(x.x(), y.x(), z.x(), x.y(), y.y(), z.y(), x.z(), y.z(), z.z()), A.getOrigin());
  sketch.cylinder(Paint::other, spider, btScalar(0.06), btScalar(0.4));
  sketch.cylinder(Paint::other, alongY(spider), btScalar(0.06), btScalar(0.4));
  sketch.layer(1);
  using J = pintle::UniversalJoint;
  const btScalar sign_1 =
      signOf<J>(make, still, true, frame, kZ, [](J& j) { return j.getAngle1(); });
  const btScalar sign_2 =
      signOf<J>(make, still, true, frame, kY, [](J& j) { return j.getAngle2(); });
  sketch.axis(spider(vec(0, 0, -0.85)), spider(vec(0, 0, 0.95)));
  sketch.axis(spider(vec(0, -0.85, 0)), spider(vec(0, 0.95, 0)));
  const Arc first{spider(vec(0, 0, 0.62)), z, -x, btScalar(0.3), sign_1 * rad(-70),
                  sign_1 * rad(110)};
  const Arc second{spider(vec(0, -0.62, 0)), y, -x, btScalar(0.3), sign_2 * rad(-70),
                   sign_2 * rad(110)};
  sketch.turn(first);
  sketch.turn(second);
  sketch.label(spider(vec(0, 0, 0.95)), "axis 1", 0, -8, "bold");
  sketch.label(spider(vec(0, -0.95, 0)), "axis 2", 0, 18, "bold");
  sketch.label(first.at(sign_1 * rad(20), btScalar(1.5)), "+", 0, 4, "big green");
  sketch.label(second.at(sign_2 * rad(20), btScalar(1.5)), "+", 0, 6, "big green");
  sketch.label(A(vec(-1, 0, 0)), "A", 0, 5, "big");
  sketch.label(B(vec(1, 0, 0)), "B", 0, 5, "big");

  Sketch::Caption text =
      caption("UniversalJoint", "Two crossed hinges: z of A and y of B stay at right angles", kAInB,
              degreesOf(make, still, true, frame));
  text.readings = {{"getAngle1()  about z of A", degrees(joint.getAngle1())},
                   {"setLimit(5, ...)",
                    between(degrees(joint.getLowerLimit(5)), degrees(joint.getUpperLimit(5)))},
                   {"getAngle2()  about y of B", degrees(joint.getAngle2())},
                   {"setLimit(4, ...)",
                    between(degrees(joint.getLowerLimit(4)), degrees(joint.getUpperLimit(4)))}};
  text.notes = {
      std::string("+ : A turns ") + (sign_1 > 0 ? "right" : "left") + "-handed about axis 1,",
      std::string("    the cross ") + (sign_2 > 0 ? "right" : "left") + "-handed about axis 2",
      "0\u00b0: the frames coincide"};
  return {"universal_joint", sketch.svg(text), sketch.tile(text.title)};
}

Made constantVelocity() {
  const btTransform in_a = at(1, 0, 0), in_b = at(-1, 0, 0);
  const MakeJoint make = [&](btRigidBody& a, btRigidBody& b) {
    auto joint = std::make_unique<pintle::ConstantVelocityJoint>(a, b, in_a, in_b);
    joint->setBendLimit(rad(50));
    return joint;
  };
  const btTransform frame = at(0, 0, 0);
  const Poses still{frame * in_a.inverse(), frame * in_b.inverse()},
      poses{still.a, frame * turned(vec(0, -0.6, 0.8), 30) * in_b.inverse()};
  Pair pair(poses, make);
  auto& joint = static_cast<pintle::ConstantVelocityJoint&>(*pair.joint);
  const btTransform A = joint.getCalculatedTransformA(), B = joint.getCalculatedTransformB();

  Sketch sketch({-58, 20, 116, vec(0.28, 0, 0.05)});
  sketch.cylinder(Paint::a, alongX(A * at(-0.85, 0, 0)), btScalar(0.12), btScalar(0.7));
  sketch.layer(1);
  sketch.ball(Paint::a, A.getOrigin(), btScalar(0.26));
  sketch.layer(2);
  std::vector<btVector3> rim;
  const btScalar along = btCos(joint.getBendLimit()), across = btSin(joint.getBendLimit());
  for (int i = 0; i < 48; ++i) {
    const btScalar way = SIMD_2_PI * btScalar(i) / 48;
    rim.push_back(A(btScalar(1.15) * btVector3(along, across * btCos(way), across * btSin(way))));
  }
  sketch.cone(A.getOrigin(), rim);
  sketch.layer(3);
  sketch.cylinder(Paint::b, alongX(B * at(0.8, 0, 0)), btScalar(0.12), btScalar(0.55));
  sketch.layer(4);
  sketch.axis(A(vec(-1.75, 0, 0)), A(vec(1.5, 0, 0)));
  sketch.axis(B(vec(0, 0, 0)), B(vec(1.7, 0, 0)));
  const btVector3 bend_axis =
      A.getBasis().getColumn(0).cross(B.getBasis().getColumn(0)).normalized();
  const Arc bend{A.getOrigin(),  bend_axis, A.getBasis().getColumn(0),
                 btScalar(1.42), 0,         joint.getBend()};
  sketch.turn(bend);
  sketch.label(bend.at(bend.high / 2, btScalar(1.16)), "+ bend", 22, 4, "green bold");
  for (const auto& [pose, side] : {std::pair{A, -1.35}, {B, 1.05}}) {
    const Arc way{pose(vec(side, 0, 0)),
                  pose.getBasis().getColumn(0),
                  pose.getBasis().getColumn(1),
                  btScalar(0.27),
                  rad(-170),
                  rad(80)};
    sketch.turn(way);
  }
  sketch.label(A(vec(-0.75, 0, 0)), "A", 0, 5, "big");
  sketch.label(B(vec(0.7, 0, 0)), "B", 0, 5, "big");
  sketch.label(A(vec(-1.75, 0, 0)), "x of A", 4, -12, "bold");
  sketch.label(B(vec(1.7, 0, 0)), "x of B", 6, -8, "bold");

  Sketch::Caption text =
      caption("ConstantVelocityJoint", "A drive shaft that bends: both ends turn at one speed",
              kBInA, degreesOf(make, still, false, frame));
  text.readings = {{"getBend()", degrees(joint.getBend())},
                   {"setBendLimit(max)", degrees(joint.getBendLimit())},
                   {"getTwist()", degrees(joint.getTwist())}};
  text.notes = {"+ : the bend grows", "Held about x is one shaft against the",
                "other: together they turn freely."};
  return {"constant_velocity_joint", sketch.svg(text), sketch.tile(text.title)};
}

}  // namespace

std::vector<Made> drawShafts() { return {universal(), constantVelocity()}; }

}  // namespace drawings

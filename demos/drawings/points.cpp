// Purpose: the drawings of joints of one point or two.
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/contact_joint.h>
#include <pintle/joints/distance_joint.h>

#include <memory>

#include "picture.h"

namespace drawings {
namespace {

// Three short arrows, about the axes of a frame.
void drawFreeTurns(Sketch& sketch, const btTransform& frame, double radius) {
  for (int k = 0; k < 3; ++k) {
    const btVector3 axis = frame.getBasis().getColumn(k),
                    zero = frame.getBasis().getColumn((k + 1) % 3);
    const Arc arc{frame.getOrigin() + btScalar(radius) * axis,
                  axis,
                  zero,
                  btScalar(0.2),
                  rad(-150),
                  rad(110)};
    sketch.axis(frame.getOrigin(), frame.getOrigin() + btScalar(radius + 0.22) * axis);
    sketch.turn(arc);
    sketch.label(frame.getOrigin() + btScalar(radius + 0.36) * axis, std::string(1, char('x' + k)),
                 0, 5, "big");
  }
}

Made ball() {
  const btTransform in_a = at(0, 0, -0.95), in_b = at(0, 0, 0.72);
  const MakeJoint make = [&](btRigidBody& a, btRigidBody& b) {
    return std::make_unique<pintle::BallJoint>(a, b, in_a, in_b);
  };
  const Poses poses{in_b * turned(kY, 24) * in_a.inverse(), at(0, 0, 0)};
  Pair pair(poses, make);
  auto& joint = static_cast<pintle::BallJoint&>(*pair.joint);
  const btTransform frame(btQuaternion::getIdentity(), poses.b(joint.getPivotInB()));

  Sketch sketch({-50, 24, 122, frame(vec(0.1, 0, 0.12))});
  sketch.box(Paint::b, at(0, 0, -0.05), vec(0.55, 0.4, 0.12));
  sketch.layer(1);
  const btTransform cup = at(0, 0, 0.38);
  sketch.cylinder(Paint::b, cup, btScalar(0.34), btScalar(0.32));
  sketch.layer(2);
  sketch.ball(Paint::a, frame.getOrigin(), btScalar(0.27));
  sketch.layer(3);
  sketch.cylinder(Paint::b, cup, btScalar(0.34), btScalar(0.32),
                  false);  // the front of the cup, over the ball
  sketch.layer(3);
  sketch.cylinder(Paint::a, poses.a * at(0, 0, -0.25), btScalar(0.1), btScalar(0.46));
  sketch.layer(4);
  drawFreeTurns(sketch, frame, 0.85);
  sketch.dot(frame.getOrigin());
  sketch.label(poses.a(vec(0, 0, 0.02)), "A", 0, 0, "big");
  sketch.label(at(0, 0, -0.05)(vec(0.1, -0.4, 0)), "B", 0, 6, "big");

  const Poses still{in_b * in_a.inverse(), at(0, 0, 0)};
  Sketch::Caption text = caption("BallJoint", "A ball in a socket: one point in common", kAInB,
                                 degreesOf(make, still, true, frame));
  text.notes = {"The pivots of A and B coincide (the dot).", "All three turns are free."};
  return {"ball_joint", sketch.svg(text), sketch.tile(text.title)};
}

Made distance() {
  const btTransform in_a = at(0, 0, -0.3), in_b = at(-0.3, 0, 0);
  const MakeJoint make = [&](btRigidBody& a, btRigidBody& b) {
    auto joint = std::make_unique<pintle::DistanceJoint>(a, b, in_a.getOrigin(), in_b.getOrigin(),
                                                         btScalar(1.6));
    joint->setLimit(btScalar(0.8), btScalar(2.1));
    return joint;
  };
  const Poses poses{at(-1.2, 0, 0.55), at(0.7, 0, -0.25)};
  Pair pair(poses, make);
  auto& joint = static_cast<pintle::DistanceJoint&>(*pair.joint);
  const btVector3 p = joint.getCalculatedTransformA().getOrigin(),
                  q = joint.getCalculatedTransformB().getOrigin();
  const btVector3 n = (q - p).normalized(), across = btVector3(0, 0, 1) - n.z() * n;
  const btTransform frame(btMatrix3x3(n.x(), 0, -n.z(), n.y(), 1, 0, n.z(), 0, n.x()), q);

  Sketch sketch({-75, 16, 128, vec(-0.2, 0, 0.1)});
  sketch.box(Paint::a, poses.a, vec(0.35, 0.25, 0.3));
  sketch.box(Paint::b, poses.b, vec(0.3, 0.25, 0.25));
  sketch.layer(1);
  const auto along = [&](btScalar distance, double height) {
    return p + distance * n + btScalar(height) * across;
  };
  const btScalar low = joint.getLowerLimit(), high = joint.getUpperLimit();
  sketch.patch({along(low, -0.13), along(high, -0.13), along(high, 0.13), along(low, 0.13)});
  sketch.stop(along(low, -0.2), along(low, 0.2));
  sketch.stop(along(high, -0.2), along(high, 0.2));
  sketch.layer(2);
  sketch.axis(p, along(high + btScalar(0.25), 0));
  sketch.pointer(p, q);
  sketch.dot(p);
  sketch.dot(q);
  sketch.move(along(joint.getDistance() + btScalar(0.02), 0.32),
              along(joint.getDistance() + btScalar(0.36), 0.32));
  sketch.label(along(joint.getDistance() + btScalar(0.2), 0.47), "+", 0, 4, "big green");
  sketch.label(along(low, -0.36), metres(low), -6, 6);
  sketch.label(along(high, -0.36), metres(high), 0, 6);
  sketch.label(poses.a(vec(0, -0.25, 0.05)), "A", 0, 5, "big");
  sketch.label(poses.b(vec(0.05, -0.25, -0.05)), "B", 0, 5, "big");

  Sketch::Caption text =
      caption("DistanceJoint", "A rod, a rope or a strut between two points",
              "B against A, x from point to point", degreesOf(make, poses, false, frame));
  text.readings = {{"getDistance()", metres(joint.getDistance())},
                   {"setLimit(low, high)", between(metres(low), metres(high))}};
  text.notes = {"+ : the points part", "low = high: a rod, and x is held", "low = 0: a rope"};
  return {"distance_joint", sketch.svg(text), sketch.tile(text.title)};
}

Made contact() {
  const btTransform in_a = at(0, 0, 0.15), in_b = at(0, 0, -0.55);
  const MakeJoint make = [&](btRigidBody& a, btRigidBody& b) {
    return std::make_unique<pintle::ContactJoint>(a, b, in_a, in_b);
  };
  const Poses poses{at(0, 0, -0.3), at(0.4, 0.1, 0.9)};
  Pair pair(poses, make);
  auto& joint = static_cast<pintle::ContactJoint&>(*pair.joint);
  const btTransform plane = joint.getCalculatedTransformA();
  const btVector3 point = joint.getCalculatedTransformB().getOrigin(),
                  foot = point - joint.getDistance() * plane.getBasis().getColumn(2);

  Sketch sketch({-62, 22, 128, vec(0, 0, 0.3)});
  sketch.box(Paint::a, poses.a, vec(1, 0.75, 0.15));
  sketch.layer(1);
  sketch.range(rangeOf(joint, 0.7));
  sketch.layer(2);
  sketch.axis(plane.getOrigin(), plane(vec(0, 0, 0.6)));
  sketch.label(plane(vec(0, 0, 0.6)), "z", -12, 4, "big");
  sketch.zero(foot, point);
  sketch.dot(foot);
  sketch.layer(3);
  sketch.cylinder(Paint::b, poses.b * at(0, 0, 0.05), btScalar(0.3), btScalar(0.25));
  sketch.layer(4);
  sketch.cylinder(Paint::b, poses.b * at(0, 0, -0.35), btScalar(0.06), btScalar(0.2));
  sketch.dot(point);
  sketch.layer(5);
  sketch.move(point + vec(0.5, 0, 0.02), point + vec(0.5, 0, 0.42));
  sketch.label(point + vec(0.5, 0, 0.2), "+", 16, 4, "big green");
  for (const btVector3& way : {kX, kY})
    sketch.move(foot + btScalar(0.12) * way, foot + btScalar(0.42) * way);
  sketch.label(poses.a(vec(0.2, -0.75, 0)), "A", 0, 5, "big");
  sketch.label(poses.b(vec(0, -0.3, 0.05)), "B", 0, 5, "big");

  Poses down = poses;
  down.b.getOrigin() -= (joint.getDistance() - btScalar(0.5)) * kZ;
  Sketch::Caption text =
      caption("ContactJoint", "A point of B stays above a plane of A", kBInA,
              degreesOf(make, down, false, btTransform(plane.getBasis(), point)));
  text.readings = {{"getDistance()", metres(joint.getDistance())}, {"range", "\u2265 0 m"}};
  text.notes = {"+ : B's point rises along z of A", "Sliding is without friction.",
                "setTwoSided(true) holds z."};
  return {"contact_joint", sketch.svg(text), sketch.tile(text.title)};
}

}  // namespace

std::vector<Made> drawPoints() { return {ball(), distance(), contact()}; }

}  // namespace drawings

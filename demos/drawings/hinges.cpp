// Purpose: the drawings of hinges: two leaves about z.
#include <pintle/joints/dot_hinge.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/two_point_hinge.h>
#include <pintle/joints/unstable/cross_product_hinge.h>
#include <pintle/joints/unstable/cross_product_matrix_hinge.h>

#include <memory>
#include <tuple>

#include "picture.h"

namespace drawings {
namespace {

const btVector3 kLeaf = vec(0.62, 0.045, 0.5);
const btTransform kHingeInA = at(-0.72, 0, 0.62), kHingeInB = at(0.72, 0, 0.62);

void drawLeaves(Sketch& sketch, const btTransform& frame_a, const btTransform& frame_b,
                const Poses& poses) {
  sketch.box(Paint::b, poses.b, kLeaf);
  sketch.box(Paint::a, poses.a, kLeaf);
  for (const auto& [paint, z, frame] : {std::tuple{Paint::b, -1.0, frame_b},
                                        {Paint::a, -0.62, frame_a},
                                        {Paint::b, -0.24, frame_b}})
    sketch.cylinder(paint, frame * at(0, 0, z), btScalar(0.1), btScalar(0.18));
}

template <class Joint>
std::unique_ptr<Joint> makeHinge(btRigidBody& a, btRigidBody& b) {
  return std::make_unique<Joint>(a, b, kHingeInA, kHingeInB);
}

template <class Joint>
Made hinge(const char* file, const char* title, const char* subtitle,
           std::vector<std::string> notes) {
  const MakeJoint make = [](btRigidBody& a, btRigidBody& b) {
    auto joint = makeHinge<Joint>(a, b);
    joint->setLimit(rad(-30), rad(105));
    return joint;
  };
  const btTransform rest = kHingeInB;
  const Poses poses{rest * turned(kZ, 50) * kHingeInA.inverse(), at(0, 0, 0)},
      still{rest * kHingeInA.inverse(), at(0, 0, 0)};
  Pair pair(poses, make);
  auto& joint = static_cast<Joint&>(*pair.joint);
  const btTransform A = joint.getCalculatedTransformA(), B = joint.getCalculatedTransformB();

  Sketch sketch({-62, 27, 150, B(vec(0.02, 0.1, -0.42))});
  drawLeaves(sketch, A, B, poses);
  sketch.layer(1);
  const Arc range = rangeOf(joint, 0.95);
  sketch.range(range);
  sketch.layer(2);
  const btScalar angle = joint.getHingeAngle();
  const btScalar sign =
      signOf<Joint>(make, poses, true, B, kZ, [](Joint& j) { return j.getHingeAngle(); });
  sketch.zero(range.centre, range.at(0));
  sketch.axis(B(vec(0, 0, -1.35)), B(vec(0, 0, 0.55)));
  sketch.pointer(range.centre, range.at(angle));
  sketch.turn(onwards(range, angle, sign));
  for (const auto& [frame, size] : Drawn(joint).frames)  // the two points of a TwoPointHinge
    if (size < joint.getDbgDrawSize()) sketch.dot(frame.getOrigin());
  sketch.label(B(vec(0, 0, 0.55)), "z", -12, 6, "big");
  sketch.label(range.at(0, btScalar(1.12)), "0\u00b0", 0, 6);
  sketch.label(range.at(range.low, btScalar(1.16)), degrees(range.low), 0, 8);
  sketch.label(range.at(range.high, btScalar(1.13)), degrees(range.high), -4, -4);
  sketch.label(range.at(angle + sign * rad(22), btScalar(1.3)), "+", 0, 2, "big green");
  sketch.label(poses.a(vec(0.25, -0.05, -0.2)), "A", 0, 0, "big");
  sketch.label(poses.b(vec(-0.25, -0.05, -0.2)), "B", 0, 0, "big");

  Sketch::Caption text = caption(title, subtitle, kAInB, degreesOf(make, still, true, rest));
  text.readings = angleAndLimit("getHingeAngle()", angle, joint);
  text.notes = {handed(sign, "A", "z"), "0\u00b0: the frames coincide"};
  text.notes.insert(text.notes.end(), notes.begin(), notes.end());
  return {file, sketch.svg(text), sketch.tile(text.title)};
}

// Hinges that are there for comparison: no angle, no limit.
template <class Joint>
Made plainHinge(const char* file, const char* title, const char* subtitle,
                std::vector<std::string> notes) {
  const MakeJoint make = [](btRigidBody& a, btRigidBody& b) { return makeHinge<Joint>(a, b); };
  const Poses still{kHingeInB * kHingeInA.inverse(), at(0, 0, 0)},
      poses{kHingeInB * turned(kZ, 50) * kHingeInA.inverse(), still.b};
  Pair pair(poses, make);
  auto& joint = static_cast<Joint&>(*pair.joint);
  const btTransform A = joint.getCalculatedTransformA(), B = joint.getCalculatedTransformB();

  Sketch sketch({-62, 27, 150, B(vec(0.02, 0.1, -0.42))});
  drawLeaves(sketch, A, B, poses);
  sketch.layer(1);
  sketch.axis(B(vec(0, 0, -1.35)), B(vec(0, 0, 0.55)));
  sketch.label(B(vec(0, 0, 0.55)), "z", 10, 2, "big");
  sketch.label(poses.a(vec(0.1, -0.05, 0)), "A", 0, 0, "big");
  sketch.label(poses.b(vec(-0.1, -0.05, 0)), "B", 0, 0, "big");

  Sketch::Caption text = caption(title, subtitle, kAInB, degreesOf(make, still, true, kHingeInB));
  text.notes = std::move(notes);
  return {file, sketch.svg(text), sketch.tile(text.title)};
}

}  // namespace

std::vector<Made> drawHinges() {
  return {
      hinge<pintle::QuaternionHinge>(
          "quaternion_hinge", "QuaternionHinge", "A door, a wheel, a valve: one turn about an axis",
          {"Limits may span many turns; without", "them the turn is free."}),
      hinge<pintle::DotHinge>(
          "dot_hinge", "DotHinge", "A hinge whose rows are dot products",
          {"Right while the axes are close;", "stuck from 90\u00b0 between them."}),
      hinge<pintle::TwoPointHinge>("two_point_hinge", "TwoPointHinge",
                                   "A hinge that holds two points of its axis together",
                                   {"The dots are the two points", "(setPlacement)."}),
      plainHinge<pintle::CrossProductHinge>(
          "cross_product_hinge", "CrossProductHinge",
          "For comparison only: one row along the error of the axes",
          {"Where the axes are parallel there is", "no row: nothing holds them."}),
      plainHinge<pintle::CrossProductMatrixHinge>(
          "cross_product_matrix_hinge", "CrossProductMatrixHinge",
          "For comparison only: three rows in the place of two",
          {"Off its axis the third row also keeps", "both bodies from turning together."})};
}

}  // namespace drawings

#include "joints.h"

#include <LinearMath/btIDebugDraw.h>
#include <pintle/joints/unstable/cross_product_hinge.h>
#include <pintle/joints/unstable/cross_product_matrix_hinge.h>
#include <pintle/joints/unstable/single_row_lock.h>
#include <pintle/pintle.h>

#include <cmath>
#include <stdexcept>
#include <tuple>

#include "degrees.h"
#include "sketch.h"

namespace drawings {
namespace {

using std::make_unique;

struct Made {
  std::string name, svg;
  Sketch::Tile tile;
};

// In the order of the picture of all.
constexpr const char* kOverview[] = {
    "quaternion_hinge", "ball_joint",  "slider_joint",    "fixed_joint",
    "cone_twist_joint", "wedge_joint", "universal_joint", "constant_velocity_joint"};

btScalar rad(double degrees) { return btScalar(degrees) * SIMD_RADS_PER_DEG; }
btVector3 vec(double x, double y, double z) { return {btScalar(x), btScalar(y), btScalar(z)}; }
btTransform at(const btVector3& origin) { return btTransform(btQuaternion::getIdentity(), origin); }
btTransform at(double x, double y, double z) { return at(vec(x, y, z)); }
btTransform turned(const btVector3& axis, double degrees) {
  return btTransform(btQuaternion(axis, rad(degrees)));
}
const btVector3 kX(1, 0, 0), kY(0, 1, 0), kZ(0, 0, 1);
// z of a cylinder along x or y.
btTransform alongX(const btTransform& pose) { return pose * turned(kY, 90); }
btTransform alongY(const btTransform& pose) { return pose * turned(kX, -90); }

std::string rounded(double value, int digits) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", digits, value + 0.0);
  std::string s = text;
  if (s.find_first_not_of("-0.") == std::string::npos && s[0] == '-') s.erase(0, 1);
  if (s[0] == '-') s.replace(0, 1, "\u2212");
  return s;
}
std::string degrees(btScalar angle) {
  return rounded(double(angle * SIMD_DEGS_PER_RAD), 0) + "\u00b0";
}
std::string metres(btScalar length) { return rounded(double(length), 1) + " m"; }
std::string between(const std::string& low, const std::string& high) { return low + " to " + high; }

/// What a joint draws of itself: frames and the arcs of its ranges.
class Drawn : public btIDebugDraw {
 public:
  explicit Drawn(const pintle::Joint& joint) { joint.drawJoint(*this); }

  void drawTransform(const btTransform& frame, btScalar size) override {
    frames.push_back({frame, size});
  }

  void drawArc(const btVector3& centre, const btVector3& normal, const btVector3& axis,
               btScalar radius, btScalar, btScalar low, btScalar high, const btVector3&, bool,
               btScalar) override {
    arcs.push_back({centre, normal, axis, radius, low, high});
  }
  void drawLine(const btVector3&, const btVector3&, const btVector3&) override {}
  void drawContactPoint(const btVector3&, const btVector3&, btScalar, int,
                        const btVector3&) override {}
  void reportErrorWarning(const char*) override {}
  void draw3dText(const btVector3&, const char*) override {}
  void setDebugMode(int) override {}
  int getDebugMode() const override { return DBG_DrawConstraints | DBG_DrawConstraintLimits; }

  std::vector<Arc> arcs;
  std::vector<std::pair<btTransform, btScalar>> frames;
};

Arc rangeOf(const pintle::Joint& joint, double radius) {
  Arc arc = Drawn(joint).arcs.at(0);
  arc.radius = btScalar(radius);
  return arc;
}

/// +1 if a small turn of the body by the right hand about the axis makes the reading grow, else -1.
template <class Joint, class Reading>
btScalar signOf(const MakeJoint& make, const Poses& poses, bool moves_a, const btTransform& frame,
                const btVector3& axis, Reading reading) {
  const auto read = [&](double turn) {
    Poses moved = poses;
    btTransform& pose = moves_a ? moved.a : moved.b;
    pose = frame * turned(axis, turn) * frame.inverse() * pose;
    Pair pair(moved, make);
    return reading(static_cast<Joint&>(*pair.joint));
  };
  return read(2) > read(-2) ? btScalar(1) : btScalar(-1);
}

std::string handed(btScalar sign, const char* who, const char* axis) {
  return std::string("+ : ") + who + " turns " + (sign > 0 ? "right" : "left") + "-handed about " +
         axis;
}

Sketch::Caption caption(const char* title, const char* subtitle, const char* table_title,
                        const Degrees& degrees) {
  Sketch::Caption made{title, subtitle, table_title, {}, {}, {}};
  for (int k = 0; k < 3; ++k) {
    made.cells[0][k] = name(degrees.slide[k]);
    made.cells[1][k] = name(degrees.turn[k]);
  }
  return made;
}
constexpr const char* kAInB = "A against B, axes of frame B";
constexpr const char* kBInA = "B against A, axes of frame A";

// A short arrow along a range's rim, from where the reading is towards more of it.
Arc onwards(const Arc& range, btScalar from, btScalar sign, double part = 1.12,
            double degrees = 34) {
  Arc arc = range;
  arc.radius *= btScalar(part);
  arc.low = from;
  arc.high = from + sign * rad(degrees);
  return arc;
}

// --- hinges --------------------------------------------------------------------------------------

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
  return make_unique<Joint>(a, b, kHingeInA, kHingeInB);
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
  text.readings = {{"getHingeAngle()", degrees(angle)},
                   {"setLimit(low, high)",
                    between(degrees(joint.getLowerLimit()), degrees(joint.getUpperLimit()))}};
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

// --- points --------------------------------------------------------------------------------------

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
    return make_unique<pintle::BallJoint>(a, b, in_a, in_b);
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
    auto joint =
        make_unique<pintle::DistanceJoint>(a, b, in_a.getOrigin(), in_b.getOrigin(), btScalar(1.6));
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
    return make_unique<pintle::ContactJoint>(a, b, in_a, in_b);
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

// --- nothing or little is free -------------------------------------------------------------------

template <class Joint>
Made lock(const char* file, const char* title, const char* subtitle,
          std::vector<std::string> notes) {
  const btTransform in_a = at(-0.62, 0, 0), in_b = at(0.62, 0, 0);
  const MakeJoint make = [&](btRigidBody& a, btRigidBody& b) {
    return make_unique<Joint>(a, b, in_a, in_b);
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

Made slider() {
  const btTransform in_a = at(0, 0, 0), in_b = at(0, 0, 0);
  const MakeJoint make = [&](btRigidBody& a, btRigidBody& b) {
    auto joint = make_unique<pintle::SliderJoint>(a, b, in_a, in_b);
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

// --- swings --------------------------------------------------------------------------------------

Made coneTwist() {
  const btTransform in_a = at(-0.75, 0, 0), in_b = at(0.35, 0, 0);
  const MakeJoint make = [&](btRigidBody& a, btRigidBody& b) {
    auto joint = make_unique<pintle::ConeTwistJoint>(a, b, in_a, in_b);
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
    auto joint = make_unique<pintle::WedgeJoint>(a, b, in_a, in_b);
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
  text.readings = {{"getAngle()", degrees(angle)},
                   {"setLimit(low, high)",
                    between(degrees(joint.getLowerLimit()), degrees(joint.getUpperLimit()))}};
  text.notes = {handed(sign, "B", "z of A"), "0\u00b0: x of A",
                "B may lean towards z, and turn about", "its own x."};
  return {"wedge_joint", sketch.svg(text), sketch.tile(text.title)};
}

Made angularLimit() {
  const btTransform in_a = at(0, 0, 0.45), in_b = at(0, 0, 0.3);
  const MakeJoint make = [&](btRigidBody& a, btRigidBody& b) {
    auto joint = make_unique<pintle::AngularLimit>(a, b, in_a, in_b);
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
  text.readings = {{"getAngle()", degrees(angle)},
                   {"setLimit(low, high)",
                    between(degrees(joint.getLowerLimit()), degrees(joint.getUpperLimit()))}};
  text.notes = {handed(sign, "B", "z of A"), "0\u00b0: x of B points along x of A",
                "Add it to a joint that leaves the", "angle free."};
  return {"angular_limit", sketch.svg(text), sketch.tile(text.title)};
}

// --- shafts --------------------------------------------------------------------------------------

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
    auto joint = make_unique<pintle::UniversalJoint>(a, b, in_a, in_b);
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
    auto joint = make_unique<pintle::ConstantVelocityJoint>(a, b, in_a, in_b);
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

std::vector<Drawing> drawings() {
  std::vector<Made> made = {
      hinge<pintle::QuaternionHinge>(
          "quaternion_hinge", "QuaternionHinge", "A door, a wheel, a valve: one turn about an axis",
          {"Limits may span many turns; without", "them the turn is free."}),
      hinge<pintle::DotHinge>(
          "dot_hinge", "DotHinge", "A hinge whose rows are dot products",
          {"Right while the axes are close;", "stuck from 90\u00b0 between them."}),
      hinge<pintle::TwoPointHinge>("two_point_hinge", "TwoPointHinge",
                                   "A hinge that holds two points of its axis together",
                                   {"The dots are the two points", "(setPlacement)."}),
      ball(),
      distance(),
      contact(),
      slider(),
      lock<pintle::FixedJoint>("fixed_joint", "FixedJoint", "A weld: two frames coincide",
                               {"Nothing is free."}),
      coneTwist(),
      wedge(),
      angularLimit(),
      universal(),
      constantVelocity(),
      plainHinge<pintle::CrossProductHinge>(
          "cross_product_hinge", "CrossProductHinge",
          "For comparison only: one row along the error of the axes",
          {"Where the axes are parallel there is", "no row: nothing holds them."}),
      plainHinge<pintle::CrossProductMatrixHinge>(
          "cross_product_matrix_hinge", "CrossProductMatrixHinge",
          "For comparison only: three rows in the place of two",
          {"Off its axis the third row also keeps", "both bodies from turning together."}),
      lock<pintle::SingleRowLock>(
          "single_row_lock", "SingleRowLock",
          "For comparison only: one row along the error of the orientation",
          {"Where there is no error there is no", "row: nothing holds the turn."})};
  std::vector<Drawing> all;
  std::vector<Sketch::Tile> tiles;
  for (const char* name : kOverview)
    for (const Made& one : made)
      if (name == one.name) tiles.push_back(one.tile);
  for (const Made& one : made) all.push_back({one.name, one.svg});
  all.push_back({"overview", Sketch::overview("Joints of Pintle", tiles, 4)});
  return all;
}

}  // namespace drawings

// Purpose: what the drawings of the joints share: places, words, and what a joint says of itself.
#pragma once

#include <LinearMath/btIDebugDraw.h>

#include <string>
#include <utility>
#include <vector>

#include "degrees.h"
#include "sketch.h"

namespace drawings {

/// A drawing, and its picture for that of all joints.
struct Made {
  std::string name, svg;
  Sketch::Tile tile;
};

// The joints' drawings, each in the file of its kind.
std::vector<Made> drawHinges();
std::vector<Made> drawPoints();
std::vector<Made> drawFrames();
std::vector<Made> drawSwings();
std::vector<Made> drawShafts();
std::vector<Made> drawGears();

// --- places --------------------------------------------------------------------------------------

inline btScalar rad(double degrees) { return btScalar(degrees) * SIMD_RADS_PER_DEG; }
inline btVector3 vec(double x, double y, double z) {
  return {btScalar(x), btScalar(y), btScalar(z)};
}
inline btTransform at(const btVector3& origin) {
  return btTransform(btQuaternion::getIdentity(), origin);
}
inline btTransform at(double x, double y, double z) { return at(vec(x, y, z)); }
inline btTransform turned(const btVector3& axis, double degrees) {
  return btTransform(btQuaternion(axis, rad(degrees)));
}
const btVector3 kX(1, 0, 0), kY(0, 1, 0), kZ(0, 0, 1);
/// z of a cylinder along x or y of a pose.
inline btTransform alongX(const btTransform& pose) { return pose * turned(kY, 90); }
inline btTransform alongY(const btTransform& pose) { return pose * turned(kX, -90); }

// --- words ---------------------------------------------------------------------------------------

std::string degrees(btScalar angle);  ///< of rad
std::string metres(btScalar length);
std::string between(const std::string& low, const std::string& high);
/// What a joint of one limited angle reads, and how its limit is set.
template <class Joint>
std::vector<std::pair<std::string, std::string>> angleAndLimit(const char* reading, btScalar angle,
                                                               const Joint& joint) {
  return {{reading, degrees(angle)},
          {"setLimit(low, high)",
           between(degrees(joint.getLowerLimit()), degrees(joint.getUpperLimit()))}};
}
/// In which sense somebody turns about an axis as a reading grows (signOf).
std::string handed(btScalar sign, const char* who, const char* axis);

constexpr const char* kAInB = "A against B, axes of frame B";
constexpr const char* kBInA = "B against A, axes of frame A";
/// With the table filled in.
Sketch::Caption caption(const char* title, const char* subtitle, const char* table_title,
                        const Degrees& degrees);

// --- what a joint says ---------------------------------------------------------------------------

/// What a joint draws of itself: frames, and the arcs of its ranges.
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
  std::vector<std::pair<btTransform, btScalar>> frames;  ///< and sizes
};

/// The range that a joint draws, with another radius.
Arc rangeOf(const pintle::Joint& joint, double radius);

/// A short arc outside of a range's rim, from a reading on towards larger ones.
Arc onwards(const Arc& range, btScalar from, btScalar sign, double part = 1.12,
            double degrees = 34);

/// +1 if a small right-handed turn of the body about the axis makes the reading grow, else -1.
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

}  // namespace drawings

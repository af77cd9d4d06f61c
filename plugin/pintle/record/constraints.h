// Purpose: constraints of every type, in the few words that a page draws and measures them by.
#pragma once

#include <pintle/precision.h>

#include <LinearMath/btTransform.h>

#include <string>
#include <vector>

class btTypedConstraint;
struct btMultibodyLink;

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace record {

/// What a constraint holds of the frames' orientations.
enum class Align {
  nothing,
  x,      ///< the x axes together
  z,      ///< the z axes together
  all,    ///< the frames
  across  ///< z of a at right angles to y of b
};

/// A range of a free coordinate, as it is drawn and as it is passed.
struct Limit {
  enum class Kind {
    angle,     ///< of x of b against x of a, about z of a, rad
    twist,     ///< about x of b, rad
    slide,     ///< of the anchor of b along x, y or z (axis) of a, m
    distance,  ///< between the anchors, m
    cone,      ///< x of a about x of b: half angles about y (low) and z (high), rad
    wedge,     ///< x of b about z of a, rad
    bend,      ///< between the x axes, rad
    turn       ///< Bullet's angle about x, y or z (axis) of Description::order, rad
  };
  Kind kind;
  btScalar low, high;
  int axis = 0;
};

struct Description {
  std::string type;
  btTransform in_a = btTransform::getIdentity(), in_b = btTransform::getIdentity();
  bool has_anchors = true;
  bool holds[3] = {true, true, true};  ///< the anchor of b, along these axes of a
  bool one_sided = false;              ///< a contact: only z below 0 is a gap
  Align align = Align::nothing;
  /// Of turns: a takes the orientation of b by its angles about these axes of its own, left-handed, the last
  /// of the list first.
  int order[3] = {0, 1, 2};
  std::vector<Limit> limits;

  std::string json(int a, int b) const;
};

/// Not const, as Bullet's own getters are not; nothing is changed.
Description describe(btTypedConstraint& constraint);
/// Of the joint of a link with its parent.
Description describe(const btMultibodyLink& link);

/// What a constraint leaves at these poses of its bodies.
struct Errors {
  double gap = 0;        ///< m
  double angle_off = 0;  ///< rad
  double overshoot = 0;  ///< rad or m: the most beyond a limit
};
class ErrorMeter {
 public:
  explicit ErrorMeter(const Description& description)
      : m_description(description), m_turns(description.limits.size(), Turn{0, false}) {}

  /// At the next frame: angles are followed through their turns, by less than half a turn a frame.
  Errors operator()(const btTransform& a, const btTransform& b);

 private:
  struct Turn {
    double angle;
    bool known;
  };
  double follow(std::size_t limit, double angle);

  const Description& m_description;
  std::vector<Turn> m_turns;
};

}  // namespace record
}  // namespace PINTLE_PRECISION
}  // namespace pintle

// Purpose: the symbolic analysis of each island, kept from step to step, with what its next step starts from.
#pragma once

#include <pintle/solver/block_factor.h>

#include <LinearMath/btVector3.h>

#include <functional>
#include <memory>

class btTypedConstraint;

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Which bodies the joints of an island couple: of each joint its two bodies, -1 for one that does not
/// move.
struct Topology {
  struct Joint {
    int body[2];
    friend bool operator==(const Joint& a, const Joint& b) {
      return a.body[0] == b.body[0] && a.body[1] == b.body[1];
    }
  };
  std::vector<Joint> joints;
  const void* first = nullptr;  ///< of the joints, by which islands of the same shape differ
  Elimination elimination;
  /// Whether joints close a loop, which may lead through the ground. Rows may then depend on each other.
  bool loops = false;
  /// Components: bodies connected by joints, not counting the ground. The number of each joint's, in the order of
  /// elimination, and of each body's; -1: a body without joints.
  std::vector<int> component, body_component;
  int components = 0;
  /// Of each component: whether it is joined to a static or kinematic body.
  std::vector<char> grounded;
  /// Of each joint, in the order of elimination: the impulse of its point in the last step, N s in the world. It
  /// predicts the geometric stiffness of the next. Empty before the first step.
  std::vector<double> impulses;
  /// Of each row with bounds, joint_rows a joint, in the order of elimination: its impulse in the last step, if it was
  /// at a bound; else `inside`.
  std::vector<Scalar> at_bound;
  static constexpr Scalar inside = infinity;
  /// Rows of a joint, of which block_rows fit its block. Rows at a bound need no place there.
  static constexpr int joint_rows = 8;
  /// A stock joint's row that was iterated in the last step.
  struct Iterated {
    const btTypedConstraint* joint;
    int index;                  ///< among the rows of the joint
    Scalar impulse;             ///< of the warm start
    btVector3 linear, angular;  ///< of the row, for body a
    friend bool operator<(const Iterated& a, const Iterated& b) {
      return a.joint != b.joint ? std::less<>()(a.joint, b.joint) : a.index < b.index;
    }
  };
  std::vector<Iterated> iterated;  ///< sorted
  /// Of each component: the part used of the energy that end-of-step corrections may add.
  std::vector<double> gained;
  /// The energy balance of a component that turns fast, J: `given` by its joints and not yet taken back, and `taken`,
  /// which may be returned.
  struct ChordEnergy {
    double given = 0, taken = 0;
  };
  std::vector<ChordEnergy> chord_energy;
  double compensation_left = 0;  ///< how long the balance is still kept, s
  unsigned long long last_use = 0;
};

class Topologies {
 public:
  /// The analysis of these joints: the known one, or a new one.
  Topology& get(const std::vector<Topology::Joint>& joints, const void* first);
  size_t bytes() const;

 private:
  std::vector<std::unique_ptr<Topology>> m_known;
  unsigned long long m_uses = 0;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle

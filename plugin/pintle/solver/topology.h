// Purpose: the analysis of each island that is met again, so that a step makes only numbers.
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
  /// Whether some joints close a loop, which may be by the ground: then some of them may say again
  /// what the others do.
  bool loops = false;
  /// What joints connect, the ground apart: numbers of the component of each joint, in the order of
  /// elimination, and of each body; -1 for a body that has none.
  std::vector<int> component, body_component;
  int components = 0;
  /// Whether a component hangs on the ground, or on what its owner moves.
  std::vector<char> grounded;
  /// Of each joint, in the order of elimination: the impulse of its point in the last step, N s in the
  /// world, which says how stiff the bodies will be in the next. Empty before the first.
  std::vector<double> impulses;
  /// Of each row of each joint, joint_rows of each, in the order of elimination: its impulse in the last
  /// step, if it was at a bound; else `inside`.
  std::vector<Scalar> at_bound;
  static constexpr Scalar inside = infinity;
  /// Of a joint, no more than block_rows of which have a place in its block: those at a bound need none.
  static constexpr int joint_rows = 8;
  /// A row of a joint of Bullet's own that was iterated in the last step.
  struct Iterated {
    const btTypedConstraint* joint;
    int index;                  ///< among the rows of the joint
    Scalar impulse;             ///< with which it is to begin
    btVector3 linear, angular;  ///< of the row, for body a
    friend bool operator<(const Iterated& a, const Iterated& b) {
      return a.joint != b.joint ? std::less<>()(a.joint, b.joint) : a.index < b.index;
    }
  };
  std::vector<Iterated> iterated;  ///< sorted
  /// Of each component: how much of what the ends of steps may add to its energy they have.
  std::vector<double> gained;
  /// Of each component that turns fast, J: what its joints have given it, less what has been taken for that, and what
  /// has been taken, which may be given back.
  struct ChordEnergy {
    double given = 0, taken = 0;
  };
  std::vector<ChordEnergy> chord_energy;
  double compensation_left = 0;  ///< for which this is still kept, s
  unsigned long long last_use = 0;
};

class Topologies {
 public:
  /// The analysis of these joints: one that stands, or a new one.
  Topology& get(const std::vector<Topology::Joint>& joints, const void* first);
  size_t bytes() const;

 private:
  std::vector<std::unique_ptr<Topology>> m_known;
  unsigned long long m_uses = 0;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle

// Purpose: where a client has said that the bodies of a joint are (calculateTransforms), for what the joint says of itself.
#pragma once

#include <LinearMath/btScalar.h>
#include <LinearMath/btTransform.h>

#include <pintle/precision.h>

#include <memory>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// Until the next step, or new frames, what a client has said; else where the bodies are.
class SeenPoses {
 public:
  /// The poses that a client says (world).
  void set(const btTransform& a, const btTransform& b) {
    if (!m_poses) m_poses = std::make_unique<Poses>();
    m_poses->a = a;
    m_poses->b = b;
    m_given = true;
  }
  /// From here on the bodies are where they are.
  void forget() { m_given = false; }
  /// True if a client has said so.
  bool given() const { return m_given; }
  /// The pose of body a, which is at `now`.
  const btTransform& a(const btTransform& now) const { return m_given ? m_poses->a : now; }
  /// The same of body b.
  const btTransform& b(const btTransform& now) const { return m_given ? m_poses->b : now; }

 private:
  struct Poses {
    BT_DECLARE_ALIGNED_ALLOCATOR();
    btTransform a, b;
  };
  std::unique_ptr<Poses> m_poses;  ///< made when they are first given
  bool m_given = false;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle

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
  void set(const btTransform& a, const btTransform& b) {
    if (!m_poses) m_poses = std::make_unique<Poses>();
    m_poses->a = a;
    m_poses->b = b;
    m_given = true;
  }
  void forget() { m_given = false; }
  bool given() const { return m_given; }
  const btTransform& a(const btTransform& now) const { return m_given ? m_poses->a : now; }
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

// Purpose: a joint frame in the world. It is stored by component, as the product of two matrices yields it, so that
// three products of two frames' axes are one operation.
#pragma once

#include <pintle/body_pair.h>

#include <LinearMath/btTransform.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// The unit axes a, b, c (x, y, z of the frame), and r, from the body's centre to the frame's
/// origin: world space.
class Frame {
 public:
  Frame(const btTransform& body, const btTransform& local) {
    const btMatrix3x3 &R = body.getBasis(), &A = local.getBasis();
    const LanesView A_0 = lanes(A[0]), A_1 = lanes(A[1]), A_2 = lanes(A[2]);
    m_x = R[0].x() * A_0 + R[0].y() * A_1 + R[0].z() * A_2;
    m_y = R[1].x() * A_0 + R[1].y() * A_1 + R[1].z() * A_2;
    m_z = R[2].x() * A_0 + R[2].y() * A_1 + R[2].z() * A_2;
    m_r = view(R) * view(local.getOrigin());
  }

  /// This frame after a rotation of its own, given in it.
  Frame turned(const btMatrix3x3& R) const {
    const LanesView R_0 = lanes(R[0]), R_1 = lanes(R[1]), R_2 = lanes(R[2]);
    Frame f = *this;
    f.m_x = m_x[0] * R_0 + m_x[1] * R_1 + m_x[2] * R_2;
    f.m_y = m_y[0] * R_0 + m_y[1] * R_1 + m_y[2] * R_2;
    f.m_z = m_z[0] * R_0 + m_z[1] * R_1 + m_z[2] * R_2;
    return f;
  }

  Vec3 a() const { return {m_x[0], m_y[0], m_z[0]}; }
  Vec3 b() const { return {m_x[1], m_y[1], m_z[1]}; }
  Vec3 c() const { return {m_x[2], m_y[2], m_z[2]}; }
  const Vec3& r() const { return m_r; }
  /// The axes as columns: F, the rotation from the frame to the world.
  Mat3 axes() const {
    Mat3 F;
    F << a(), b(), c();
    return F;
  }

  /// As Bullet has it, of a body whose centre is at x.
  void store(btTransform& to, const btVector3& x) const {
    setLanes(to.getBasis()[0], m_x);
    setLanes(to.getBasis()[1], m_y);
    setLanes(to.getBasis()[2], m_z);
    to.getOrigin().setValue(m_r.x() + x.x(), m_r.y() + x.y(), m_r.z() + x.z());
  }

  /// a.v, b.v, c.v
  Lanes components(const Vec3& v) const { return m_x * v.x() + m_y * v.y() + m_z * v.z(); }
  /// a x a' + b x b' + c x c'
  Vec3 crossed(const Frame& f) const {
    const auto sum = [](const Lanes& l) { return l[0] + l[1] + l[2]; };
    return {sum(m_y * f.m_z - m_z * f.m_y), sum(m_z * f.m_x - m_x * f.m_z),
            sum(m_x * f.m_y - m_y * f.m_x)};
  }
  /// a.a' + b.b' + c.c': of R, the rotation from here to there.
  Scalar trace(const Frame& f) const {
    const Lanes each = dots(f);
    return each[0] + each[1] + each[2];
  }
  /// a.a', b.b', c.c'
  Lanes dots(const Frame& f) const { return m_x * f.m_x + m_y * f.m_y + m_z * f.m_z; }

 private:
  Lanes m_x, m_y, m_z;  // the fourth lane means nothing
  Vec3 m_r;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle

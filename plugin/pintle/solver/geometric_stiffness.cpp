#include <pintle/solver/geometric_stiffness.h>

#include <cmath>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// Jacobi's rotations of a 3 x 3 matrix converge within this number of passes. The axes are orthonormal in any case.
constexpr int max_passes = 6;
// Off-diagonal elements below this part of the diagonal are left.
constexpr double negligible = 1e-6;

// Jacobi's rotation of axes p and q: A(p, q) becomes 0. Left out below the threshold.
void rotate(Matrix3d& A, Matrix3d& V, int p, int q, double threshold) {
  const double off = A(p, q);
  if (!(std::abs(off) > threshold)) return;
  const double d = A(q, q) - A(p, p), root = std::sqrt(d * d + 4 * off * off);
  if (!(root < HUGE_VAL)) return;
  const double t = (d < 0 ? -2 : 2) * off / (std::abs(d) + root);
  const double c = std::sqrt((std::abs(d) + root) / (2 * root)), s = t * c;
  const int k = 3 - p - q;
  A(p, p) -= t * off;
  A(q, q) += t * off;
  A(p, q) = A(q, p) = 0;
  const double kp = A(k, p), kq = A(k, q);
  A(k, p) = A(p, k) = c * kp - s * kq;
  A(k, q) = A(q, k) = s * kp + c * kq;
  for (int i = 0; i < 3; ++i) {
    const double ip = V(i, p), iq = V(i, q);
    V(i, p) = c * ip - s * iq;
    V(i, q) = s * ip + c * iq;
  }
}

}  // namespace

Stiffening::Stiffening(const Matrix3d& stiffness) {
  Matrix3d A = stiffness;
  for (int pass = 0; pass < max_passes; ++pass) {
    const double off = std::abs(A(0, 1)) + std::abs(A(0, 2)) + std::abs(A(1, 2));
    const double threshold = negligible * A.diagonal().cwiseAbs().sum();
    if (!(off > 3 * threshold)) break;
    rotate(A, axes, 0, 1, threshold);
    rotate(A, axes, 0, 2, threshold);
    rotate(A, axes, 1, 2, threshold);
  }
  for (int k = 0; k < 3; ++k) mu[k] = A(k, k) > 0 ? A(k, k) : 0;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

#include <pintle/solver/geometric_stiffness.h>

#include <Eigen/Eigenvalues>

namespace pintle {
inline namespace PINTLE_PRECISION {

Stiffening::Stiffening(const Matrix3d& stiffness) {
  Eigen::SelfAdjointEigenSolver<Matrix3d> eigen;
  eigen.computeDirect(stiffness);
  axes = eigen.eigenvectors();
  mu = eigen.eigenvalues().cwiseMax(0);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

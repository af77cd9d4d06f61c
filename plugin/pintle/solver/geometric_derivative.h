// Purpose: how the torques of a joint's impulses change with the velocities of its bodies, since levers and directions turn in the
// step: the derivative of -G^T lambda, G the discrete gradient. Exact for points, distances and dot products.
#pragma once

#include <pintle/solver/island.h>
#include <pintle/solver/turn.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

struct BodyAtEnd;
struct RowAtEnd;

class GeometricDerivative {
 public:
  /// By the velocities of body a and of body b, each linear and angular.
  using Matrix = Eigen::Matrix<double, 12, 12>;

  void add(const IslandRow& row, const RowAtEnd& end, double lambda, const BodyAtEnd& a,
           const BodyAtEnd& b, double dt);
  /// Its symmetric part, without what pushes apart.
  void clip();
  const Matrix& matrix() const { return m_matrix; }

 private:
  void addDistance(const IslandRow& row, double lambda, const BodyAtEnd& a, const BodyAtEnd& b,
                   double dt);
  void addDot(const IslandRow& row, double lambda, const BodyAtEnd& a, const BodyAtEnd& b,
              double dt);
  void addAngle(const IslandRow& row, double lambda, const BodyAtEnd& a, const BodyAtEnd& b,
                double dt);

  Matrix m_matrix = Matrix::Zero();
};

/// The same of one body whose lever r (m, at the start) an impulse f (N s) pulls at, if it turns slowly: of its torque, by w.
Matrix3d leverDerivative(const Vector3d& f, const Vector3d& r, double dt);
/// The symmetric part, without its negative eigenvalues.
Matrix3d clipped(const Matrix3d& m);

}  // namespace PINTLE_PRECISION
}  // namespace pintle

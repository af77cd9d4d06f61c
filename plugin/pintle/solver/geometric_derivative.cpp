#include <pintle/solver/geometric_derivative.h>

#include <pintle/solver/iterate.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

enum { v_a = 0, w_a = 3, v_b = 6, w_b = 9 };

template <class Matrix>
Matrix withoutNegative(const Matrix& m) {
  const Matrix symmetric = (m + m.transpose()) / 2;
  const Eigen::SelfAdjointEigenSolver<Matrix> axes(symmetric);
  return axes.eigenvectors() * axes.eigenvalues().cwiseMax(0).asDiagonal() *
         axes.eigenvectors().transpose();
}

}  // namespace

Matrix3d leverDerivative(const Vector3d& f, const Vector3d& r, double dt) {
  return -dt / 2 * crossMatrix(f) * crossMatrix(r);
}

Matrix3d clipped(const Matrix3d& m) {
  const Matrix3d symmetric = (m + m.transpose()) / 2;
  if (Eigen::LLT<Matrix3d>(-symmetric).info() == Eigen::Success) return Matrix3d::Zero();
  Eigen::SelfAdjointEigenSolver<Matrix3d> axes;
  axes.computeDirect(symmetric);
  return axes.eigenvectors() * axes.eigenvalues().cwiseMax(0).asDiagonal() *
         axes.eigenvectors().transpose();
}

void GeometricDerivative::clip() { m_matrix = withoutNegative(m_matrix); }

void GeometricDerivative::add(const IslandRow& row, const RowAtEnd& end, double lambda,
                              const BodyAtEnd& a, const BodyAtEnd& b, double dt) {
  if (lambda == 0 || !row.has_position) return;
  switch (row.shape.kind) {
    case RowShape::point: {
      // T_b = lambda mean(r_b) x L, T_a = -lambda mean(r_a) x L
      const Matrix3d L = lambda * dt * crossMatrix(end.G.L_b);
      m_matrix.block<3, 3>(w_a, w_a) -= L * a.turn.meanSlope(inDouble(row.shape.a));
      m_matrix.block<3, 3>(w_b, w_b) += L * b.turn.meanSlope(inDouble(row.shape.b));
      return;
    }
    case RowShape::distance: return addDistance(row, lambda, a, b, dt);
    case RowShape::dot: return addDot(row, lambda, a, b, dt);
    case RowShape::angle: return addAngle(row, lambda, a, b, dt);
    case RowShape::other: return;
  }
}

// n = (d_0 + d_1) / (|d_0| + |d_1|)
void GeometricDerivative::addDistance(const IslandRow& row, double lambda, const BodyAtEnd& a,
                                      const BodyAtEnd& b, double dt) {
  const Vector3d r_a = inDouble(row.shape.a), r_b = inDouble(row.shape.b);
  const Vector3d d_0 = double(row.shape.length) * inDouble(row.start.L);
  const Vector3d end_a = a.turn.turned(r_a), end_b = b.turn.turned(r_b);
  const Vector3d d_1 = d_0 + dt * (b.v - a.v).head<3>() + end_b - r_b - end_a + r_a;
  const double sum = d_0.norm() + d_1.norm();
  if (!(sum > 0) || !(d_1.squaredNorm() > 0)) return;
  const Vector3d n = (d_0 + d_1) / sum;
  const Matrix3d N = lambda / sum * (Matrix3d::Identity() - n * d_1.normalized().transpose());
  Eigen::Matrix<double, 3, 12> turn;  // of lambda n
  turn.block<3, 3>(0, v_a) = -dt * N;
  turn.block<3, 3>(0, w_a) = dt * N * crossMatrix(end_a) * a.turn.slope;
  turn.block<3, 3>(0, v_b) = dt * N;
  turn.block<3, 3>(0, w_b) = -dt * N * crossMatrix(end_b) * b.turn.slope;
  m_matrix.middleRows<3>(v_a) += turn;
  m_matrix.middleRows<3>(v_b) -= turn;
  m_matrix.middleRows<3>(w_a) += a.turn.part * crossMatrix(a.turn.mean * r_a) * turn;
  m_matrix.middleRows<3>(w_b) -= b.turn.part * crossMatrix(b.turn.mean * r_b) * turn;
  const Matrix3d L = lambda * dt * crossMatrix(n);
  m_matrix.block<3, 3>(w_a, w_a) -= L * a.turn.meanSlope(r_a);
  m_matrix.block<3, 3>(w_b, w_b) += L * b.turn.meanSlope(r_b);
}

// T_b = lambda mean of b x (a_0 + a_1) / 2, T_a = -lambda (b_0 + b_1) / 2 x mean of a
void GeometricDerivative::addDot(const IslandRow& row, double lambda, const BodyAtEnd& a,
                                 const BodyAtEnd& b, double dt) {
  const Vector3d a_0 = inDouble(row.shape.a), b_0 = inDouble(row.shape.b);
  const Vector3d a_1 = a.turn.turned(a_0), b_1 = b.turn.turned(b_0);
  const Matrix3d along_a = a.turn.part * crossMatrix(a.turn.mean * a_0),
                 along_b = b.turn.part * crossMatrix(b.turn.mean * b_0);
  const double h = lambda * dt;
  m_matrix.block<3, 3>(w_b, w_b) += h / 2 * crossMatrix(a_0 + a_1) * b.turn.meanSlope(b_0);
  m_matrix.block<3, 3>(w_b, w_a) += h / 2 * along_b * crossMatrix(a_1) * a.turn.slope;
  m_matrix.block<3, 3>(w_a, w_a) += h / 2 * crossMatrix(b_0 + b_1) * a.turn.meanSlope(a_0);
  m_matrix.block<3, 3>(w_a, w_b) += h / 2 * along_a * crossMatrix(b_1) * b.turn.slope;
}

// The axis is taken to turn half with each body. (Only Newton's tangent depends on it.)
void GeometricDerivative::addAngle(const IslandRow& row, double lambda, const BodyAtEnd& a,
                                   const BodyAtEnd& b, double dt) {
  const Matrix3d axis = lambda * dt / 4 * row.sign * crossMatrix(inDouble(row.start.A_b));
  m_matrix.block<3, 3>(w_b, w_a) += axis * a.turn.slope;
  m_matrix.block<3, 3>(w_b, w_b) += axis * b.turn.slope;
  m_matrix.block<3, 3>(w_a, w_a) -= axis * a.turn.slope;
  m_matrix.block<3, 3>(w_a, w_b) -= axis * b.turn.slope;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

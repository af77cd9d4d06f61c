// The quaternion identities, by the document's matrices, by rotation matrices and by their effect
// on vectors; and the tangent that is picked where none is given.
#include <gtest/gtest.h>
#include <pintle/equations/quaternion.h>
#include <pintle/precision.h>

#include "autodiff.h"

namespace {

using namespace autodiff;
namespace equations = pintle::equations;
using Vector4 = Eigen::Matrix<double, 4, 1>;
using Matrix4 = Eigen::Matrix<double, 4, 4>;

template <class T>
class Quaternions : public testing::Test {
 public:
  // Products of unit quaternions: a handful of roundings of numbers up to one.
  static constexpr double kTolerance = 10 * double(std::numeric_limits<T>::epsilon());
};
using Scalars = testing::Types<double, pintle::Scalar>;
TYPED_TEST_SUITE(Quaternions, Scalars);

template <class T>
Quaternion<T> as(const Turn& q) {
  return {T(q.w), q.v.cast<T>()};
}
template <class T>
Vector4 column(const Quaternion<T>& q) {
  return {double(q.w), double(q.v.x()), double(q.v.y()), double(q.v.z())};
}

// (A.8)
Matrix3<double> skew(const Vector& a) {
  Matrix3<double> m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}
// (A.16) and (A.17)
Matrix4 left(const Turn& a) {
  Matrix4 m;
  m << a.w, -a.v.x(), -a.v.y(), -a.v.z(), a.v.x(), a.w, -a.v.z(), a.v.y(), a.v.y(), a.v.z(), a.w,
      -a.v.x(), a.v.z(), -a.v.y(), a.v.x(), a.w;
  return m;
}
Matrix4 right(const Turn& b) {
  Matrix4 m;
  m << b.w, -b.v.x(), -b.v.y(), -b.v.z(), b.v.x(), b.w, b.v.z(), -b.v.y(), b.v.y(), -b.v.z(), b.w,
      b.v.x(), b.v.z(), b.v.y(), -b.v.x(), b.w;
  return m;
}
// The rotation by an angle about an axis, without a quaternion.
Matrix3<double> rodrigues(const Vector& axis, double angle) {
  return std::cos(angle) * Matrix3<double>::Identity() + std::sin(angle) * skew(axis) +
         (1 - std::cos(angle)) * axis * axis.transpose();
}

const std::vector<double> kAngles = {0, 1e-8,   1e-4,  1,  pi / 2, 3,  pi - 1e-8, pi,     pi + 1e-8,
                                     4, 2 * pi, -1e-8, -1, -pi,    -3, -2 * pi,   -3 * pi};

TYPED_TEST(Quaternions, RotationTurnsVectorsByTheAngleAboutTheAxis) {
  using T = TypeParam;
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const Vector axis = random.unit(), x = random.vector();
    const T angle = T(kAngles[i % kAngles.size()] + (i % 2 ? 0 : random.uniform(-pi, pi)));
    const auto q = equations::rotation<T>(axis.cast<T>(), angle);
    const Vector3<T> turned = equations::rotate<T>(q, x.cast<T>());
    const Vector expected = rodrigues(axis, double(angle)) * x;
    ASSERT_LE(mismatch(turned.template cast<double>(), expected), this->kTolerance);
  }
}

TYPED_TEST(Quaternions, ProductIsThatOfTheDocumentsMatrices) {
  using T = TypeParam;
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    const Turn a = random.turn(), b = random.turn();
    const Vector4 ab = column(equations::product(as<T>(a), as<T>(b)));
    ASSERT_LE(mismatch(ab, left(a) * column(b)), this->kTolerance);
    ASSERT_LE(mismatch(ab, right(b) * column(a)), this->kTolerance);
    // It is one turn after the other, the right one first.
    const Vector x = random.vector();
    const Vector3<T> once =
        equations::rotate<T>(equations::product(as<T>(a), as<T>(b)), x.cast<T>());
    const Vector twice = equations::rotate(a, equations::rotate(b, x));
    ASSERT_LE(mismatch(once.template cast<double>(), twice), this->kTolerance);
  }
}

TYPED_TEST(Quaternions, ConjugateIsTheInverseAndTheTranspose) {
  using T = TypeParam;
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const Turn a = random.turn(), b = random.turn();
    const Vector4 one(1, 0, 0, 0);
    const auto a_ = as<T>(a), b_ = as<T>(b);
    ASSERT_LE(mismatch(column(equations::product(a_, equations::conjugate(a_))), one),
              this->kTolerance);
    ASSERT_LE(mismatch(column(equations::product(equations::conjugate(a_), a_)), one),
              this->kTolerance);
    // (A.18), (A.20) and (A.21)
    ASSERT_EQ(mismatch(left(equations::conjugate(a)), left(a).transpose()), 0);
    ASSERT_EQ(mismatch(right(equations::conjugate(a)), right(a).transpose()), 0);
    ASSERT_LE(mismatch(matrix(equations::conjugate(a_)), matrix(a_).transpose()), this->kTolerance);
    ASSERT_LE(
        mismatch(column(equations::conjugate(equations::product(a_, b_))),
                 column(equations::product(equations::conjugate(b_), equations::conjugate(a_)))),
        this->kTolerance);
    // (A.12) and (A.14)
    ASSERT_LE(std::abs(double(equations::product(a_, equations::conjugate(b_)).w) -
                       column(a).dot(column(b))),
              this->kTolerance);
  }
}

TYPED_TEST(Quaternions, RelativeIsTheTurnFromAToBAsSeenFromA) {
  using T = TypeParam;
  Random random(4);
  for (int i = 0; i < 200; ++i) {
    const Turn a = random.turn(), b = random.turn();
    const auto r = equations::relative(as<T>(a), as<T>(b));
    ASSERT_LE(mismatch(column(equations::product(as<T>(a), r)), column(b)), this->kTolerance);
    const Matrix3<double> expected = matrix(a).transpose() * matrix(b);
    ASSERT_LE(mismatch(matrix(r).template cast<double>(), expected), 2 * this->kTolerance);
    // It does not see a turn of both.
    const Turn both = random.turn();
    const auto turned =
        equations::relative(as<T>(equations::product(both, a)), as<T>(equations::product(both, b)));
    ASSERT_LE(mismatch(column(turned), column(r)), this->kTolerance);
  }
}

TYPED_TEST(Quaternions, RotateIsBlindToTheSignOfTheQuaternion) {
  using T = TypeParam;
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    const auto q = as<T>(random.turn());
    const Vector3<T> x = random.vector().cast<T>();
    ASSERT_EQ(equations::rotate<T>(q, x), equations::rotate<T>({-q.w, -q.v}, x));
  }
}

TYPED_TEST(Quaternions, OfAMatrixIsItsTurnWithAPositiveRealPart) {
  using T = TypeParam;
  Random random(6);
  // All four divisors: near no turn, and near half a turn about each axis; and exactly there.
  for (int i = 0; i < 400; ++i) {
    const int axis = i % 4;
    Vector near = axis < 3 ? Vector(Vector::Unit(axis)) : random.unit();
    if (i % 8 >= 4) near += 0.3 * random.vector();
    near /= std::sqrt(near.dot(near));
    const double angle = kAngles[i / 8 % kAngles.size()];
    const Turn q = equations::rotation(near, angle);
    const auto found = equations::quaternion(Matrix3<T>(matrix(q).cast<T>()));
    ASSERT_GE(found.w, 0);
    ASSERT_LE(std::abs(column(found).squaredNorm() - 1), this->kTolerance);
    ASSERT_LE(mismatch(matrix(found).template cast<double>(), matrix(q)), this->kTolerance);
  }
}

// The document's derivative (A.3), which the tests' own differentiation rests on.
TEST(QuaternionDerivative, OfATurnIsHalfTheVelocityTimesIt) {
  Random random(7);
  for (int i = 0; i < 200; ++i) {
    const Bodies<double> bodies{random.vector(), random.turn(), random.vector(), random.turn()};
    const Velocities v = random.velocities();
    const Turn rate = equations::product(Turn{0, Vector(0.5 * v.segment<3>(3))}, bodies.q_a);
    const Vector4 slope =
        (column(moved(bodies, v, step).q_a) - column(moved(bodies, v, -step).q_a)) / (2 * step);
    ASSERT_LE(mismatch(slope, column(rate)), difference_tolerance);
  }
}

TYPED_TEST(Quaternions, AnyTangentIsAUnitVectorNormalToItsArgument) {
  using T = TypeParam;
  Random random(8);
  std::vector<Vector> all;
  for (int i = 0; i < 3; ++i) {
    all.push_back(Vector::Unit(i));
    all.push_back(-Vector::Unit(i));
  }
  for (int i = 0; i < 500; ++i) all.push_back(random.unit());
  // Both sides of its branch.
  for (const double z : {0.69999, 0.70001, -0.69999, -0.70001}) {
    all.push_back(Vector(std::sqrt(1 - z * z), 0, z));
    all.push_back(Vector(0, -std::sqrt(1 - z * z), z));
  }
  for (const Vector& a : all) {
    const Vector3<T> t = pintle::any_tangent<T>(a.cast<T>());
    const Vector tangent = t.template cast<double>();
    ASSERT_LE(std::abs(tangent.dot(tangent) - 1), this->kTolerance);
    ASSERT_LE(std::abs(tangent.dot(a)), this->kTolerance);
    ASSERT_EQ(t, pintle::any_tangent<T>(a.cast<T>()));
  }
}

}  // namespace

#include <pintle/bullet/frames.h>

#include <pintle/finite.h>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

bool areFinite(const btVector3& v) { return isFinite(v.x()) && isFinite(v.y()) && isFinite(v.z()); }

bool areFinite(const btTransform& t) {
  return areFinite(t.getOrigin()) && areFinite(t.getBasis()[0]) && areFinite(t.getBasis()[1]) &&
         areFinite(t.getBasis()[2]);
}

}  // namespace

bool isRotation(const btMatrix3x3& R) {
  constexpr Scalar tolerance = Scalar(1e-3);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j <= i; ++j)
      if (!(btFabs(R.getColumn(i).dot(R.getColumn(j)) - Scalar(i == j)) <= tolerance)) return false;
  return R.determinant() > 0;
}

bool repairFrame(const btTransform& given, btTransform& frame) {
  if (!areFinite(given) || !isRotation(given.getBasis())) return orthonormalize(given, frame);
  frame = given;
  return true;
}

bool orthonormalize(const btTransform& given, btTransform& frame) {
  if (!areFinite(given)) return false;
  const btMatrix3x3& R = given.getBasis();
  const Scalar length = R.getColumn(2).length();
  if (!(length > SIMD_EPSILON && isFinite(length))) return false;
  const btVector3 z = R.getColumn(2) / length;
  btVector3 x = R.getColumn(0) - z * z.dot(R.getColumn(0)), y;
  // Along z there is nothing left of it but rounding.
  const Scalar across = x.length();
  if (across > Scalar(0.5) * R.getColumn(0).length() && isFinite(across) && across > 0)
    x /= across;
  else
    btPlaneSpace1(z, x, y);
  y = z.cross(x);
  frame.setOrigin(given.getOrigin());
  frame.getBasis().setValue(x.x(), y.x(), z.x(), x.y(), y.y(), z.y(), x.z(), y.z(), z.z());
  return true;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

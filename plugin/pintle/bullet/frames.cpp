#include <pintle/bullet/frames.h>

#include <pintle/bullet/complaints.h>
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

bool isSameBasis(const btMatrix3x3& a, const btMatrix3x3& b) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (a[i][j] != b[i][j]) return false;
  return true;
}

bool isRotation(const btMatrix3x3& R) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j <= i; ++j)
      if (!(btFabs(R.getColumn(i).dot(R.getColumn(j)) - Scalar(i == j)) <= frame_tolerance))
        return false;
  return R.determinant() > 0;
}

bool repairFrame(const btTransform& given, int main, int second, btTransform& frame) {
  if (!areFinite(given) || !isRotation(given.getBasis()))
    return orthonormalize(given, main, second, frame);
  frame = given;
  return true;
}

bool orthonormalize(const btTransform& given, int main, int second, btTransform& frame) {
  if (!areFinite(given)) return false;
  const int third = 3 - main - second;
  const btMatrix3x3& R = given.getBasis();
  const Scalar length = R.getColumn(main).length();
  if (!(length > SIMD_EPSILON && isFinite(length))) return false;
  btVector3 axis[3];
  axis[main] = R.getColumn(main) / length;
  axis[second] = R.getColumn(second) - axis[main] * axis[main].dot(R.getColumn(second));
  // Along the main axis there is nothing left of it but rounding.
  const Scalar across = axis[second].length();
  if (across > Scalar(0.5) * R.getColumn(second).length() && isFinite(across) && across > 0)
    axis[second] /= across;
  else
    btPlaneSpace1(axis[main], axis[second], axis[third]);
  axis[third] =
      (main + 1) % 3 == second ? axis[main].cross(axis[second]) : axis[second].cross(axis[main]);
  frame.setOrigin(given.getOrigin());
  for (int i = 0; i < 3; ++i) frame.getBasis()[i].setValue(axis[0][i], axis[1][i], axis[2][i]);
  return true;
}

// The fourth numbers of vectors are anybody's: with others there only the bits differ.
bool takeOtherFrames(btTransform& frame_a, btTransform& frame_b, const btTransform& from_a,
                     const btTransform& from_b, int main, int second, Complaints* complaints) {
  btTransform a, b;
  if (!(repairFrame(from_a, main, second, a) && repairFrame(from_b, main, second, b))) {
    if (complaints != nullptr)
      complaints->add("joint frames", "must be finite, and their main axis no null vector");
    return false;
  }
  const bool is_other = !isSameBasis(a.getBasis(), frame_a.getBasis()) ||
                        !isSameBasis(b.getBasis(), frame_b.getBasis());
  frame_a = a;
  frame_b = b;
  return is_other;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

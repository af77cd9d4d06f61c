#include <pintle/solver/discrete_gradient.h>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

Vector3d inDouble(const Vec3& v) { return v.cast<double>(); }

// Levers of points, held along L.
Gradient ofPoints(const Vector3d& L, const RowShape& start, const Displacement& a,
                  const Displacement& b) {
  const Vector3d r_a = a.mean * inDouble(start.a), r_b = b.mean * inDouble(start.b);
  return {L, cross(r_a, L), cross(r_b, L)};
}

// |d_1| - |d_0| = (d_0 + d_1) . (d_1 - d_0) / (|d_0| + |d_1|). Row::position of a rod is its length less a constant.
Gradient ofDistance(const RowOfStep& row, const Displacement& a, const Displacement& b) {
  const auto moved = [](const Displacement& by, const Vec3& start) {
    return Vector3d(by.x + cross(by.phi, Vector3d(by.mean * inDouble(start))));
  };
  const Vector3d d_0 = row.start_shape.length * inDouble(row.start.L);
  const Vector3d d_1 = d_0 + moved(b, row.start_shape.b) - moved(a, row.start_shape.a);
  const double sum = d_0.norm() + d_1.norm();
  return ofPoints(sum > 0 ? Vector3d((d_0 + d_1) / sum) : inDouble(row.start.L), row.start_shape, a,
                  b);
}

// a_1 . b_1 - a_0 . b_0 = mean of a . change of b + mean of b . change of a
Gradient ofDot(const RowOfStep& row, const Displacement& a, const Displacement& b) {
  const Vector3d a_0 = inDouble(row.start_shape.a), b_0 = inDouble(row.start_shape.b);
  const Vector3d along_a = a.mean * a_0, along_b = b.mean * b_0;
  const Vector3d mean_a = a_0 + cross(a.phi, along_a) / 2, mean_b = b_0 + cross(b.phi, along_b) / 2;
  return {Vector3d::Zero(), cross(mean_b, along_a), cross(along_b, mean_a)};
}

// The mean of both ends, and what it lacks along the displacement of b against a (Gonzalez). Of an angular row along the
// turn alone, and the same on both bodies: it then leaves angular momentum as it is.
Gradient ofAny(const RowOfStep& row, double change, const Displacement& a, const Displacement& b) {
  const auto mean = [](const Vec3& start, const Vec3& end) {
    return Vector3d((inDouble(start) + inDouble(end)) / 2);
  };
  Gradient G{mean(row.start.L, row.end.L), mean(row.start.A_a, row.end.A_a),
             mean(row.start.A_b, row.end.A_b)};
  const double missing = change - G.along(a, b);
  const Vector3d turn = b.phi - a.phi, slide = b.x - a.x;
  if (row.start.angular) {
    if (const double turn2 = turn.squaredNorm(); turn2 > 0) {
      G.A_a += missing / turn2 * turn;
      G.A_b += missing / turn2 * turn;
    }
    return G;
  }
  const double all2 = slide.squaredNorm() + a.phi.squaredNorm() + b.phi.squaredNorm();
  if (!(all2 > 0)) return G;
  G.L += missing / all2 * slide;
  G.A_a -= missing / all2 * a.phi;
  G.A_b += missing / all2 * b.phi;
  return G;
}

}  // namespace

Gradient discreteGradient(const RowOfStep& row, double change, const Displacement& a,
                          const Displacement& b) {
  switch (row.start_shape.kind) {
    case RowShape::point: return ofPoints(inDouble(row.start.L), row.start_shape, a, b);
    case RowShape::distance: return ofDistance(row, a, b);
    case RowShape::dot: return ofDot(row, a, b);
    case RowShape::angle:
    case RowShape::other: break;
  }
  return ofAny(row, change, a, b);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

#include <pintle/record/constraints.h>

#include <algorithm>
#include <cmath>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace record {
namespace {

// In double: a gap of 1e-9 m is to be seen.
double dot(const btVector3& a, const btVector3& b) {
  return double(a.x()) * double(b.x()) + double(a.y()) * double(b.y()) +
         double(a.z()) * double(b.z());
}
double length(const btVector3& v) { return std::sqrt(dot(v, v)); }
double between(const btVector3& a, const btVector3& b) {
  return std::atan2(length(a.cross(b)), dot(a, b));
}
double outside(double value, const Limit& limit) {
  return std::max({0., double(limit.low) - value, value - double(limit.high)});
}

// How far a direction is beyond an elliptic cone, by its swing's direction about the cone's axis.
double outsideCone(double swing, double about_y, double about_z, const Limit& limit) {
  const double size = std::hypot(about_y, about_z);
  if (size == 0) return 0;
  const double y = about_y / size / double(limit.low), z = about_z / size / double(limit.high);
  const double span = 1 / std::hypot(y, z);
  return std::max(0., swing - span);
}

double angleOff(Align align, const btMatrix3x3& a, const btMatrix3x3& b) {
  switch (align) {
    case Align::x: return between(a.getColumn(0), b.getColumn(0));
    case Align::z: return between(a.getColumn(2), b.getColumn(2));
    case Align::across:
      return std::abs(double(SIMD_HALF_PI) - between(a.getColumn(2), b.getColumn(1)));
    case Align::all: {
      // From the quaternion of a^T b, so that small angles keep their digits.
      const btMatrix3x3 r = a.transposeTimes(b);
      const double twice_sine =
          std::hypot(std::hypot(double(r[2][1] - r[1][2]), double(r[0][2] - r[2][0])),
                     double(r[1][0] - r[0][1]));
      return std::atan2(twice_sine, double(r[0][0] + r[1][1] + r[2][2]) - 1);
    }
    case Align::nothing: break;
  }
  return 0;
}

// Of b against a, by their relative orientation; `crossed`: they have none about the last axis.
double turnAbout(int axis, const int order[3], bool crossed, const btMatrix3x3& r) {
  const int first = order[2], second = order[1], last = order[0];
  const double sign = (last + 1) % 3 == second ? 1 : -1;
  const auto at = [&](int row, int column) { return double(r[row][column]); };
  if (crossed && axis == first) return std::atan2(sign * at(last, second), at(second, second));
  if (crossed && axis == second) return std::atan2(sign * at(first, last), at(first, first));
  if (axis == first) return std::atan2(-sign * at(second, last), at(last, last));
  if (axis == last) return std::atan2(-sign * at(first, second), at(first, first));
  return std::atan2(sign * at(first, last), std::hypot(at(last, last), at(second, last)));
}

}  // namespace

double ErrorMeter::follow(std::size_t limit, double angle) {
  Turn& turn = m_turns[limit];
  if (!turn.known) {
    // The turn is the one nearest to the range.
    const Limit& range = m_description.limits[limit];
    const double middle = (double(range.low) + double(range.high)) / 2;
    turn = {double(range.high - range.low) > double(SIMD_2_PI) ? 0 : middle, true};
  }
  turn.angle += std::remainder(angle - turn.angle, double(SIMD_2_PI));
  return turn.angle;
}

Errors ErrorMeter::operator()(const btTransform& body_a, const btTransform& body_b) {
  Errors errors;
  if (!m_description.has_anchors) return errors;
  const btTransform a = body_a * m_description.in_a, b = body_b * m_description.in_b;
  const btVector3 apart = b.getOrigin() - a.getOrigin();
  const btVector3 local = a.getBasis().transpose() * apart;
  double square = 0;
  for (int i = 0; i < 3; ++i) {
    if (m_description.holds[i] && !(m_description.one_sided && local[i] > 0))
      square += double(local[i]) * double(local[i]);
  }
  errors.gap = std::sqrt(square);
  errors.angle_off = angleOff(m_description.align, a.getBasis(), b.getBasis());

  const btMatrix3x3 turn = a.getBasis().transposeTimes(b.getBasis());  // of b, seen from a
  for (std::size_t i = 0; i < m_description.limits.size(); ++i) {
    const Limit& limit = m_description.limits[i];
    double beyond = 0;
    switch (limit.kind) {
      case Limit::Kind::angle:
      case Limit::Kind::wedge:
        beyond = outside(follow(i, std::atan2(double(turn[1][0]), double(turn[0][0]))), limit);
        break;
      case Limit::Kind::slide: beyond = outside(double(local[limit.axis]), limit); break;
      case Limit::Kind::distance: beyond = outside(length(apart), limit); break;
      case Limit::Kind::bend:
        beyond = outside(between(a.getBasis().getColumn(0), b.getBasis().getColumn(0)), limit);
        break;
      case Limit::Kind::cone: {
        // x of a in frame b, which the cone stands in.
        const double x = double(turn[0][0]), y = double(turn[0][1]), z = double(turn[0][2]);
        beyond = outsideCone(std::atan2(std::hypot(y, z), x), -z, y, limit);
        break;
      }
      case Limit::Kind::twist: {
        // Of the quaternion about x: what is left of the turn after the swing.
        btQuaternion q;
        turn.getRotation(q);
        const double twist =
            std::remainder(2 * std::atan2(double(q.x()), double(q.w())), double(SIMD_2_PI));
        beyond = outside(twist, limit);
        break;
      }
      case Limit::Kind::turn:
        beyond = outside(follow(i, turnAbout(limit.axis, m_description.order,
                                             m_description.align == Align::across, turn)),
                         limit);
        break;
    }
    // What a distance passes is a gap, too.
    if (limit.kind == Limit::Kind::distance) errors.gap = std::max(errors.gap, beyond);
    errors.overshoot = std::max(errors.overshoot, beyond);
  }
  return errors;
}

}  // namespace record
}  // namespace PINTLE_PRECISION
}  // namespace pintle

#include <pintle/rows/axis.h>

#include <pintle/rows/axis_part.h>

#include <algorithm>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

constexpr double rigid_softness = 1e-6;
// More than any impulse, and little enough to be added and multiplied.
constexpr double unbounded = 1e30;

// A part as a slope. Doubles, as a rigid one is a slope of a millionth of K.
struct Slope {
  double target, softness, lower, upper;

  Slope(const AxisPart& part, double K)
      : target(part.row.target),
        softness(std::max(double(part.row.cfm), rigid_softness) * K),
        lower(std::max(double(part.row.lower), -unbounded)),
        upper(std::min(double(part.row.upper), unbounded)) {}
  Slope() = default;
  double at(double u) const { return std::clamp((target - u) / softness, lower, upper); }
  double begin() const { return target - softness * upper; }
  double end() const { return target - softness * lower; }
};

// Where the free motion u = u_free + K Lambda meets the sum of the parts.
double meet(const Slope* slope, const AxisPart* part, double u_free, double K) {
  double ends[2 * Axis::parts];
  int n = 0;
  const auto insert = [&](double end) {
    int i = n++;
    for (; i > 0 && ends[i - 1] > end; --i) ends[i] = ends[i - 1];
    ends[i] = end;
  };
  for (const Axis::Part i : Axis::each_part) {
    if (!part[i].on) continue;
    if (slope[i].upper < unbounded) insert(slope[i].begin());
    if (slope[i].lower > -unbounded) insert(slope[i].end());
  }
  const auto excess = [&](double u) {
    double impulse = 0;
    for (const Axis::Part i : Axis::each_part)
      if (part[i].on) impulse += slope[i].at(u);
    return u - u_free - K * impulse;
  };
  // Parts only pull from u_free towards their targets. (A part of a large bound ends far beyond, where
  // nothing is left of the digits near here.)
  double lowest = u_free, highest = u_free;
  for (const Axis::Part i : Axis::each_part) {
    if (!part[i].on) continue;
    lowest = std::min(lowest, slope[i].target);
    highest = std::max(highest, slope[i].target);
  }
  // excess grows with u and is linear between the ends.
  int k = 0;
  while (k < n && excess(ends[k]) < 0) ++k;
  const double left = k > 0 ? std::clamp(ends[k - 1], lowest, highest) : lowest;
  const double right = k < n ? std::clamp(ends[k], lowest, highest) : highest;
  const double f_left = excess(left), f_right = excess(right);
  return f_right > f_left ? left - f_left * (right - left) / (f_right - f_left) : left;
}

// A stiff spring is a soft row, of which an iteration leaves the part cfm. What it comes to for the joint alone is given, and the row
// has what others change of that: of a joint alone nothing is left to iterate.
void yieldToOthers(double pull, Scalar K, AxisRow (&rows)[Axis::parts]) {
  AxisRow &given = rows[Axis::spring_pull], &rest = rows[Axis::spring_yield];
  rest = given;
  rest.target -= Scalar(double(given.cfm) * double(K) * pull);
  // Both together keep the bounds.
  if (rest.lower > -infinity) rest.lower = btMin(Scalar(0), rest.lower - Scalar(pull));
  if (rest.upper < infinity) rest.upper = btMax(Scalar(0), rest.upper - Scalar(pull));
  given = {0, 0, Scalar(pull), Scalar(pull)};
}

}  // namespace

bool solveAxis(const Axis& axis, const AxisMotion& m, AxisState& state,
               AxisRow (&rows)[Axis::parts]) {
  for (AxisRow& row : rows) row = {};
  if (!(m.K > 0)) return false;  // neither body can move

  AxisPart part[Axis::parts];
  if (axis.spring.isSet()) part[Axis::spring_pull] = ownSpringPart(axis, m);
  if (axis.drive != Axis::Drive::off) part[Axis::motor] = motorPart(axis, m);
  if (axis.max_friction > 0) part[Axis::friction] = frictionPart(axis, m);
  if (m.limit) part[Axis::limit] = limitPart(axis, m, state.incoming);
  Slope slope[Axis::parts];
  bool given = false;
  for (const Axis::Part i : Axis::each_part) {
    slope[i] = Slope(part[i], double(m.K));
    given = given || (part[i].on && !part[i].rigid);
  }
  const bool meets = given || part[Axis::spring_pull].on;
  const double u = meets ? meet(slope, part, double(m.free_velocity), double(m.K)) : 0;
  for (const Axis::Part i : Axis::each_part) {
    if (!part[i].on) continue;
    rows[i] = part[i].row;
    if (!part[i].rigid) rows[i].lower = rows[i].upper = Scalar(slope[i].at(u));
  }
  if (part[Axis::spring_pull].on && part[Axis::spring_pull].rigid)
    yieldToOthers(slope[Axis::spring_pull].at(u), m.K, rows);
  return given;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

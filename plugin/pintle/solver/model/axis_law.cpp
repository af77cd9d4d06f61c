#include <pintle/solver/model/axis_law.h>

#include <pintle/solver/constants.h>

#include <algorithm>

namespace pintle {
inline namespace PINTLE_PRECISION {

// Lambda falls with u. So u - free - K Lambda(u) rises, and has one zero: on a slope, on a level, or on the vertical piece of a
// rigid part. Its corners are the ends of all parts. (Most laws are one rigid part, or two stops.)
LawPiece AxisLaw::meetWithBounds(double free, double K) const {
  const LawPart* const all = first();
  if (m_parts == 1 && !(all[0].softness > 0)) {
    const LawPart& part = all[0];
    const double impulse = (part.target - free) / K;
    if (impulse > part.upper) return {false, 0, 0, part.upper};
    if (impulse < part.lower) return {false, 0, 0, part.lower};
    return {true, part.target, 0, 0};
  }
  if (m_parts == 2 && all[0].isLowerStop() && all[1].isUpperStop() && !(all[0].softness > 0) &&
      !(all[1].softness > 0) && all[0].target <= all[1].target) {
    if (free <= all[0].target) return {true, all[0].target, 0, 0};
    if (free >= all[1].target) return {true, all[1].target, 0, 0};
    return {false, 0, 0, 0};
  }
  double corner[2 * max_parts];
  int corners = 0;
  const auto insert = [&](double u) {
    int i = corners++;
    for (; i > 0 && corner[i - 1] > u; --i) corner[i] = corner[i - 1];
    corner[i] = u;
  };
  for (int i = 0; i < m_parts; ++i) {
    const LawPart& part = all[i];
    if (part.softness > 0) {
      if (part.upper < unbounded) insert(part.target - part.softness * part.upper);
      if (part.lower > -unbounded) insert(part.target - part.softness * part.lower);
    } else {
      insert(part.target);
    }
  }
  // The impulse just before or after u.
  const auto sum = [&](double u, bool after) {
    double total = 0;
    for (int i = 0; i < m_parts; ++i) {
      const LawPart& part = all[i];
      if (part.softness > 0)
        total += part.at(u);
      else
        total += u < part.target || (u == part.target && !after) ? part.upper : part.lower;
    }
    return total;
  };
  int k = 0;
  for (; k < corners; ++k) {
    const double u = corner[k];
    if (u - free - K * sum(u, true) < 0) continue;
    if (u - free - K * sum(u, false) <= 0) {  // on the vertical piece at u
      bool rigid = false;
      for (int i = 0; i < m_parts; ++i)
        rigid = rigid || (!(all[i].softness > 0) && all[i].target == u);
      if (rigid) return {true, u, 0, 0};
    }
    break;
  }
  // Between the corners: the impulse is level + slope * u.
  double slope = 0, level = 0;
  const double left = k > 0 ? corner[k - 1] : -infinity, right = k < corners ? corner[k] : infinity;
  const double inside = corners == 0   ? free
                        : k == 0       ? right - 1
                        : k == corners ? left + 1
                                       : (left + right) / 2;
  for (int i = 0; i < m_parts; ++i) {
    const LawPart& part = all[i];
    const double at = part.at(inside);
    if (part.softness > 0 && at > part.lower && at < part.upper) {
      slope += 1 / part.softness;
      level += part.target / part.softness;
    } else {
      level += at;
    }
  }
  if (slope > 0) return {true, level / slope, 1 / slope, 0};
  return {false, 0, 0, level};
}

AxisLaw::Parts AxisLaw::split(double u, double impulse) const {
  Parts parts = {};
  const LawPart* const all = first();
  double* const of = parts.data();
  double rest = impulse;
  bool open[max_parts];  // on its vertical piece, or beyond a stop: its impulse is not given by u
  for (int i = 0; i < m_parts; ++i) {
    const LawPart& part = all[i];
    open[i] =
        !(part.softness > 0) && (std::abs(part.target - u) <= rounding_share * (1 + std::abs(u)) ||
                                 std::abs(part.at(u)) >= unbounded);
    of[i] = open[i] ? std::clamp(0., part.lower, part.upper) : part.at(u);
    rest -= of[i];
  }
  // Those take what is left; the others what is rounded.
  for (const bool to_open : {true, false})
    for (int i = 0; i < m_parts && rest != 0; ++i) {
      if (open[i] != to_open) continue;
      const LawPart& part = all[i];
      const double before = of[i];
      of[i] = std::clamp(before + rest, part.lower, part.upper);
      rest -= of[i] - before;
    }
  return parts;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

// Purpose: where the velocities of bodies go in the next step, by what they did in the last ones: Newton's backward differences, as
// Adams' methods predict. The nearer a solve begins to where it ends, the fewer steps it takes.
#pragma once

#include <pintle/solver/bytes.h>
#include <pintle/solver/island.h>

#include <algorithm>
#include <array>
#include <vector>

namespace pintle {
inline namespace PINTLE_PRECISION {

class VelocityForecast {
 public:
  /// Of so many bodies.
  size_t size() const { return m_of.size(); }
  void clear() { m_of.clear(); }
  /// By how much the velocity of body i changes in the next step.
  Vector6d operator[](size_t i) const {
    const OfBody& of = m_of[i];
    Vector6d sum = of.difference[0];
    for (int half = 0; half < 2; ++half)
      for (int k = 1; k <= of.best[size_t(m_last)][size_t(half)]; ++k)
        sum.segment<3>(3 * half) += of.difference[k].segment<3>(3 * half);
    return sum;
  }

  /// The step ends with velocities `v`. They go on by as many differences as would have told this step best, along and about each body by
  /// itself: what is rounding has fewer. A blow is in all of them alike, and does not go on: so with one more of them half of what all
  /// miss must be gone. `was_enough`: one solve has led there. Then no more differences are found than before.
  void take(const IslandBody* bodies, const std::vector<Vector6d>& v, bool was_enough) {
    m_of.resize(v.size());
    double missed2[most] = {};  // by the first 1, 2, ... of them, J
    for (size_t i = 0; i < v.size(); ++i) {
      const Vector6d change = v[i] - bodies[i].v0;
      if (m_known == 1 && was_enough)
        m_of[i].difference[0] = change;
      else
        m_of[i].take(change, bodies[i], m_known, missed2);
    }
    m_last = 0;
    while (m_last + 1 < m_known && 4 * missed2[m_last + 1] < missed2[m_last]) ++m_last;
    if (!was_enough)
      m_known = std::min(m_known + 1, most);
    else if (m_last == 0)
      m_known = 1;
  }

  size_t bytes() const { return bytesOf(m_of); }

 private:
  static constexpr int most = 4;  ///< differences

  struct OfBody {
    Vector6d difference[most] = {Vector6d::Zero(), Vector6d::Zero(), Vector6d::Zero(),
                                 Vector6d::Zero()};
    /// Along and about, of the first 1, 2, ...: the last one of those that told the step best.
    std::array<signed char, 2> best[most] = {};

    void take(const Vector6d& change, const IslandBody& body, int known, double* missed2) {
      Vector6d left = change;
      double least2[2];
      for (int k = 0; k < known; ++k) {
        const Vector6d before = difference[k];
        difference[k] = left;
        left -= before;
        for (int half = 0; half < 2; ++half) {
          const double left2 = left.segment<3>(3 * half).squaredNorm();
          missed2[k] += body.scale[half] * body.scale[half] * left2;
          const bool is_best = k == 0 || left2 < least2[half];
          if (is_best) least2[half] = left2;
          best[k][size_t(half)] = is_best ? (signed char)(k) : best[k - 1][size_t(half)];
        }
      }
      if (known < most) difference[known] = left;
    }
  };

  std::vector<OfBody> m_of;
  int m_known = 1;  ///< differences of all bodies
  int m_last = 0;   ///< of these, the last one by which they go on
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle

// Purpose: where the velocities of bodies go in the next step, by what they did in the last ones: Newton's backward differences of
// their accelerations, as Adams' methods predict,
//   v_n+1 - v_n = dt (a_n + D a_n + D^2 a_n + ...),   D a_n = a_n - a_n-1
// The nearer a solve begins to where it ends, the fewer steps it takes.
#pragma once

#include <pintle/solver/constants.h>
#include <pintle/solver/linalg/memory.h>
#include <pintle/solver/model/island.h>

#include <algorithm>
#include <array>
#include <vector>

namespace pintle {
inline namespace PINTLE_PRECISION {

class VelocityForecast {
 public:
  /// Of so many bodies.
  size_t size() const { return m_difference[0].size(); }
  void reserve(size_t bodies) {
    for (auto& of : m_difference) of.reserve(bodies);
    m_ahead.reserve(bodies);
    m_best.reserve(bodies);
  }
  /// Velocity of body i on its way in the last step, less that with which it ended.
  const Vector6d& ahead(size_t i) const { return m_ahead[i]; }
  /// By how much the velocity of body i changes in the next step, of length dt.
  Vector6d change(size_t i, double dt) const {
    Vector6d sum = m_difference[0][i];
    if (m_last > 0)
      for (int half = 0; half < 2; ++half)
        for (int k = 1; k <= m_best[i][size_t(m_last)][size_t(half)]; ++k)
          sum.segment<3>(3 * half) += m_difference[size_t(k)][i].segment<3>(3 * half);
    return m_ahead[i] + dt * sum;
  }

  /// Bodies have gone the way of a step of length dt with velocities `way`, and end with `v`. Those of the way go on by as many differences
  /// as would have told this step best, along and about each body by itself: what is rounding has fewer. All differences tell a blow alike: it
  /// goes on by the last change, and no further. So with one more of them half of what all miss must be gone. `was_enough`: at most one solve has
  /// led to the end of the step. Then no more differences are found than before, and the last change alone where the others did not help.
  void take(const IslandBody* bodies, const std::vector<Vector6d>& way,
            const std::vector<Vector6d>& v, double dt, bool was_enough) {
    m_ahead.resize(v.size(), Vector6d::Zero());
    const int kept = was_enough ? m_known : std::min(m_known + 1, forecast_differences);
    for (int k = 0; k < kept; ++k) m_difference[size_t(k)].resize(v.size(), Vector6d::Zero());
    double missed2[forecast_differences] = {};  // by the first 1, 2, ... of them, J / s^2
    if (kept > 1) m_best.resize(v.size());
    for (size_t i = 0; i < v.size(); ++i) {
      const Vector6d acceleration = (way[i] - bodies[i].v0 - m_ahead[i]) / dt;
      m_ahead[i] = way[i] - v[i];
      if (kept > 1)
        take(i, bodies[i], acceleration, kept, missed2);
      else
        m_difference[0][i] = acceleration;
    }
    m_last = 0;
    while (m_last + 1 < m_known && 4 * missed2[m_last + 1] < missed2[m_last]) ++m_last;
    m_known = was_enough && m_last == 0 ? 1 : kept;
  }

  size_t bytes() const {
    size_t sum = bytesOf(m_best);
    for (const auto& of : m_difference) sum += bytesOf(of);
    return sum;
  }

 private:
  // Of the last of those that are kept, which may be new, it is not known what they would have told.
  void take(size_t i, const IslandBody& body, const Vector6d& acceleration, int kept,
            double* missed2) {
    Vector6d left = acceleration;
    double least2[2];
    auto& best = m_best[i];
    for (int k = 0; k < m_known; ++k) {
      Vector6d& difference = m_difference[size_t(k)][i];
      const Vector6d before = difference;
      difference = left;
      left -= before;
      for (int half = 0; half < 2; ++half) {
        const double left2 = left.segment<3>(3 * half).squaredNorm();
        missed2[k] += body.scale[half] * body.scale[half] * left2;
        const bool is_best = k == 0 || left2 < least2[half];
        if (is_best) least2[half] = left2;
        best[size_t(k)][size_t(half)] =
            is_best ? static_cast<signed char>(k) : best[size_t(k) - 1][size_t(half)];
      }
    }
    if (m_known < kept) m_difference[size_t(m_known)][i] = left;
  }

  std::vector<Vector6d> m_ahead;
  std::array<std::vector<Vector6d>, forecast_differences>
      m_difference;  ///< of each body's acceleration
  /// Of each body, by the first 1, 2, ... of them, along and about: the last one of those that told the step best.
  std::vector<std::array<std::array<signed char, 2>, forecast_differences>> m_best;
  int m_known = 1;  ///< of them, so many
  int m_last = 0;   ///< of these, the last one by which velocities go on
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle

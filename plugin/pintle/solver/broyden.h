// Purpose: Broyden's method (Kelley 1995, 7.3), all lengths in the metric of K: steps of a chord iteration with K, each of which
// corrects the following ones by what it has found.
#pragma once

#include <pintle/solver/joint_matrix.h>

#include <vector>

namespace pintle {
inline namespace PINTLE_PRECISION {

class Broyden {
 public:
  /// Nothing is known beside K. A step may be no longer than the last one, or, where it `may_wander`, than one of the last two.
  void begin(bool may_wander = false) {
    m_count = 0;
    m_may_wander = may_wander;
  }
  /// y += a step from the residual x, in the units of K. Returns false, and leaves y, where it is longer than that: this leads
  /// nowhere.
  bool step(const JointMatrix& K, const std::vector<double>& x, std::vector<double>& y);
  /// What y was changed by.
  const std::vector<double>& last() const { return m_steps[m_count - 1].s; }

  size_t bytes() const {
    size_t sum = bytesOf(m_steps);
    for (const Step& step : m_steps) sum += bytesOf(step.s, step.Ks);
    return sum;
  }

 private:
  struct Step {
    std::vector<double> s, Ks;
    double length2;  ///< s . K s
  };
  std::vector<Step> m_steps;  ///< m_count of them; the others are memory
  size_t m_count = 0;
  bool m_may_wander = false;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle

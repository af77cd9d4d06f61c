// Purpose: Broyden's method (Kelley 1995, 7.3), all lengths in the metric of K: steps of a chord iteration with K, each of which
// corrects the following ones by what it has found:
//   B_k+1 = B_k + (F_k+1 s_k^T K) / (s_k . K s_k),   s_k = -B_k^-1 F_k,   B_0 = K
#pragma once

#include <pintle/solver/system/joint_matrix.h>

#include <vector>

namespace pintle {
inline namespace PINTLE_PRECISION {

class Broyden {
 public:
  /// Nothing is known beside K. A step may be no longer than the last one, or, where it `may_wander`, than one of the last two.
  void begin(bool may_wander = false) {
    m_numbers.clear();
    m_length2.clear();
    m_may_wander = may_wander;
  }
  /// y += a step from the residual x, in the units of K. Returns false, and leaves y, where it is longer than that: this leads
  /// nowhere.
  bool step(const JointMatrix& K, const std::vector<double>& x, std::vector<double>& y);
  /// What y was changed by.
  const double* last() const {
    btAssert(count() > 0);
    return s(count() - 1);
  }
  /// For so many unknowns, and as many steps as a solve hardly ever takes.
  void reserve(size_t unknowns) {
    pintle::reserve(2 * usual_steps * unknowns, m_numbers);
    pintle::reserve(usual_steps, m_length2);
  }

  size_t bytes() const { return bytesOf(m_numbers, m_length2); }

 private:
  static constexpr size_t usual_steps = 8;

  size_t count() const { return m_length2.size(); }
  const double* s(size_t step) const { return m_numbers.data() + 2 * step * m_unknowns; }
  const double* Ks(size_t step) const { return s(step) + m_unknowns; }

  size_t m_unknowns = 0;
  std::vector<double> m_numbers;  ///< of each step: s, and K s
  std::vector<double> m_length2;  ///< of each step: s . K s
  bool m_may_wander = false;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle

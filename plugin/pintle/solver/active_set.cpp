#include <pintle/solver/active_set.h>

#include <algorithm>
#include <cmath>

namespace pintle {
inline namespace PINTLE_PRECISION {

void solveBounded(std::vector<BoundedRow>& rows, const std::vector<double>& W, double tolerance,
                  int max_sweeps) {
  const size_t n = rows.size();
  for (int sweep = 0; sweep < max_sweeps; ++sweep) {
    double largest = 0;
    for (size_t i = 0; i < n; ++i) {
      BoundedRow& row = rows[i];
      const double K = W[i * n + i];
      if (!(K > 0)) continue;
      const double free = row.u - K * row.lambda;
      const double next = row.law->meet(free, K).impulseAt(free, K);
      const double change = next - row.lambda;
      if (change == 0) continue;
      row.lambda = next;
      for (size_t j = 0; j < n; ++j) rows[j].u += W[j * n + i] * change;
      largest = std::max(largest, std::abs(K * change));
    }
    if (largest <= tolerance) return;
  }
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

// Purpose: impulses of rows with bounds, each on its law, where all depend on each other: u = u_free + W lambda. Projected
// Gauss-Seidel on the small problem that is left of a component when its equalities are solved.
#pragma once

#include <pintle/solver/axis_law.h>

#include <vector>

namespace pintle {
inline namespace PINTLE_PRECISION {

struct BoundedRow {
  const AxisLaw* law;
  double u;       ///< at the present impulse
  double lambda;  ///< the present impulse, and then the one that is found
};

/// W: row by row. Ends when a sweep changes no velocity by more than `tolerance` (m/s, rad/s).
void solveBounded(std::vector<BoundedRow>& rows, const std::vector<double>& W, double tolerance,
                  int max_sweeps);

}  // namespace PINTLE_PRECISION
}  // namespace pintle

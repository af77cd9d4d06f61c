// Purpose: what a solver did in a step.
#pragma once

#include <pintle/precision.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// What the last step of a solver did.
struct StepReport {
  int components = 0;
  int steps = 0, factors = 0;
  int second_tier = 0;    ///< times that a component was solved in velocity (block_gauss_seidel.h)
  int one_by_one = 0;     ///< times that rows were solved one by one
  int not_converged = 0;  ///< components, of which contacts or bounded rows were still changing
  double error = 0;       ///< m or rad: the largest left of a joint
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle

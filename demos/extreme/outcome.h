// What becomes of a case, in classes from best to worst.

#pragma once

#include "cases.h"

namespace extreme {

enum class Outcome {
  exact,      // in the last half the joints hold to a thousandth: of the size, or of a radian
  settles,    // to a twentieth
  bounded,    // to ten, and nothing is faster than a hundred times what accounts for it
  diverges,   // no longer
  non_finite  // a number is lost
};
const char* name(Outcome outcome);

struct Result {
  Outcome outcome = Outcome::exact;
  double error = 0;  // the largest in the last half, of the size or rad
};
Result run(const Case& one, engines::MakeJoint make_joint,
           const scenes::SolverFactory& solver = {});

}  // namespace extreme

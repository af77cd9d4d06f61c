#include <pintle/solver/solver_options.h>

#include <pintle/finite.h>
#include <pintle/solver/constants.h>

#include <sstream>
#include <stdexcept>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

void require(bool fits, const char* field, double value, const char* range) {
  if (fits) return;
  std::ostringstream message;
  message << "pintle::SolverOptions: " << field << " = " << value << ": must be " << range;
  throw std::invalid_argument(message.str());
}
void requirePositive(const char* field, double value) {
  require(value > 0 && isFinite(value), field, value, "above zero");
}
void requireCount(const char* field, int value) { require(value >= 1, field, value, "1 or more"); }
void requirePart(const char* field, double value) {
  require(value > 0 && value < 1, field, value, "above 0 and below 1");
}

}  // namespace

void check(const SolverOptions& of) {
  requirePositive("newton_tolerance", of.newton_tolerance);
  requirePositive("pose_tolerance", of.pose_tolerance);
  requirePositive("loose_pose_tolerance", of.loose_pose_tolerance);
  requireCount("max_iterations", of.max_iterations);
  require(of.max_factors >= 0, "max_factors", of.max_factors, "0 or more");
  requirePart("contraction", of.contraction);
  requirePart("least_part", of.least_part);
  requirePositive("contact_tolerance", of.contact_tolerance);
  requireCount("max_sweeps", of.max_sweeps);
  requireCount("longest_path", of.longest_path);
  requirePart("dependent_softness", of.dependent_softness);
  require(of.dependent_margin >= 1 && isFinite(of.dependent_margin), "dependent_margin",
          of.dependent_margin, "1 or more");
  requirePart("least_pivot", of.least_pivot);
  requirePart("ledger_share", of.ledger_share);
  require(of.stable_swing > 0 && of.stable_swing < unstable_swing, "stable_swing", of.stable_swing,
          "above 0 and below 4");
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

// What is left of the contenders' errors where joints leave nothing: those of Bullet's steps.

#pragma once

#include <map>
#include <ostream>
#include <string>
#include <vector>

#include "../measures/run.h"
#include "results.h"

namespace report {

// The errors of Bullet's steps with joints that leave nothing (reference/integrator.h), by scene and
// steps a second; scenes that it does not solve have none.
using StepErrors = std::map<std::string, std::map<int, measures::Errors>>;

StepErrors errors_of_steps(const Results& results, const std::vector<scenes::Scene>& all);

// Where the least error of Pintle's joints, on either solver, is that of Bullet's steps, at every length
// of the step: no joint that holds can lessen it.
bool is_of_the_steps(const Results& results, const StepErrors& steps, const scenes::Scene& scene,
                     scenes::Error error);

void write_steps(std::ostream& out, const Results& results, const StepErrors& steps,
                 const std::vector<scenes::Scene>& all);

// Scenes of published collections, against their references.
void write_published(std::ostream& out, const Results& results, const StepErrors& steps,
                     const std::vector<scenes::Scene>& all);

}  // namespace report

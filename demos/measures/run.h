// Runs a scene with a contender and takes its errors from the poses of the bodies alone.

#pragma once

#include <array>
#include <map>
#include <vector>

#include "../engines/engine.h"

namespace measures {

using scenes::Error;
using Errors = std::array<double, size_t(Error::count)>;

struct Outcome {
  Errors errors = {};  // infinity: the run was lost; what the scene does not ask for is 0
  double max_gap = 0;  // m: of the worst joint in the worst step
  bool finite = true;
  std::vector<engines::State> end;  // of every body
  int rows = 0;                     // of the joints at the end
  int steps = 0;
  double seconds = 0;  // of the steps alone, by the clock: does not repeat
  double operator[](Error error) const { return errors[size_t(error)]; }
};

// What else looks at a run: after each step, at its end's time.
using Watch = std::function<void(double time, const std::vector<engines::State>& states)>;
// Of the whole scene, in steps of dt.
Outcome run(const scenes::Scene& scene, engines::Engine& engine, double dt,
            const Watch& watch = {});
// The run times of the first steps, s.
std::vector<double> step_times(const scenes::Scene& scene, const engines::Contender& contender,
                               int iterations, double dt, int steps);

// Where the scene's probe should be: samples every sample_interval, up to the horizon.
constexpr double sample_interval = 0.05;  // s: a whole number of steps of each length
std::vector<scenes::Vector3d> reference(const scenes::Scene& scene);

// What the joint leaves, as its bodies stand.
struct JointErrors {
  double gap = 0;   // m
  double axis = 0;  // rad
};
JointErrors joint_errors(const scenes::Joint& joint, const engines::State& a,
                         const engines::State& b);
// rad: between the pose of a joint and that to which its muscle turns it; 0 if it has none.
double muscle_error(const scenes::Joint& joint, const engines::State& a, const engines::State& b);

// Of all joints, as they stand, m; infinite: a body is lost.
struct Gaps {
  double mean = 0, largest = 0;
};
Gaps gaps(const scenes::Scene& scene, const engines::Engine& engine);

// Follows a joint's coordinates through their turns, and says how far they are beyond its limits.
class Overshoot {
 public:
  Overshoot(const scenes::Joint& joint) : joint_(joint), angle_(0) {}
  double operator()(const engines::State& a, const engines::State& b);  // rad or m; below 0: inside

 private:
  const scenes::Joint& joint_;
  scenes::Unwrap angle_;
};

double kinetic_energy(const scenes::Body& body, const engines::State& state);
// With that of height.
double energy(const scenes::Scene& scene, const std::vector<engines::State>& states);
scenes::Vector3d angular_momentum(const scenes::Scene& scene,
                                  const std::vector<engines::State>& states);

}  // namespace measures

// A contender: what builds a scene with its own joints and solver, and steps it.

#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "../scenes/scene.h"

class btDynamicsWorld;

namespace engines {

struct State {
  scenes::Isometry3d pose;  // of the centre of mass
  scenes::Vector3d velocity, angular_velocity;
};

// One run of a scene.
class Engine {
 public:
  virtual ~Engine() = default;
  // Sets what drives the scene in the next step.
  virtual void drive(double time, double dt) = 0;
  // All that a run time counts.
  virtual void step(double dt) = 0;
  // What the last step took, s, of an engine with a clock of its own.
  virtual std::optional<double> step_seconds() const { return {}; }
  virtual State state(int body) const = 0;
  // Rows of all joints as they stand; 0: not known.
  virtual int rows() const { return 0; }
  // Whether a joint of the scene has broken: it holds nothing any more.
  virtual bool broken(int) const { return false; }
  // For who looks at all that is in it, and draws it; null: it is none of Bullet's.
  virtual btDynamicsWorld* bullet_world() { return nullptr; }
};

// Whether the number of iterations matters to a contender.
enum class Iterates {
  never,
  with_bounds,  // where limits, motors or contacts are (Scene::bounded)
  always
};

struct Contender {
  std::string name;
  std::string what;    // in words
  std::string colour;  // "#rrggbb": the same in every plot, and on the page
  Iterates iterates;
  // Null: it cannot express the scene.
  std::function<std::unique_ptr<Engine>(const scenes::Scene&, int iterations)> make;

  // Its joints know only as they are made.
  bool can_express(const scenes::Scene& scene) const { return make(scene, 1) != nullptr; }
  bool iterates_in(const scenes::Scene& scene) const {
    return iterates == Iterates::always || (iterates == Iterates::with_bounds && scene.bounded());
  }
};

// All that this build has, the stock joints first.
const std::vector<Contender>& contenders();
const Contender* find_contender(const std::string& name);

const char* precision();  // of Bullet's btScalar: single or double

}  // namespace engines

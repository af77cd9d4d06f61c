#include "run.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "../reference/stored.h"

namespace measures {

using engines::Engine;
using engines::State;
using scenes::Scene;
using scenes::Vector3d;

namespace {

using Clock = std::chrono::steady_clock;

double timed_step(Engine& engine, double time, double dt) {
  engine.drive(time, dt);
  const auto before = Clock::now();
  engine.step(dt);
  const std::chrono::duration<double> taken = Clock::now() - before;
  return engine.step_seconds().value_or(taken.count());
}

std::vector<State> states(const Scene& scene, const Engine& engine) {
  std::vector<State> all;
  for (size_t i = 0; i < scene.bodies.size(); ++i) all.push_back(engine.state(int(i)));
  return all;
}

// Takes the errors of a run, step by step.
class Observer {
 public:
  Observer(const Scene& scene, const std::vector<State>& start, int steps)
      : scene_(scene),
        steps_(steps),
        start_energy_(energy(scene, start)),
        start_momentum_(angular_momentum(scene, start)) {
    for (const scenes::Joint& joint : scene.joints) overshoots_.emplace_back(joint);
    if (scene.has(Error::trajectory)) wanted_ = reference(scene);
  }

  void observe(double time, const std::vector<State>& now, const Engine& engine) {
    double gap = 0, axis = 0;
    for (size_t i = 0; i < scene_.joints.size(); ++i) {
      const scenes::Joint& joint = scene_.joints[i];
      if (joint.breaks_at > 0 && engine.broken(int(i))) continue;
      const State &a = now[joint.a], &b = now[joint.b];
      const JointErrors left = joint_errors(joint, a, b);
      gap = larger(gap, left.gap);
      axis = larger(axis, larger(left.axis, muscle_error(joint, a, b)));
      if (scene_.has(Error::overshoot)) grow(Error::overshoot, overshoots_[i](a, b));
    }
    max_gap_ = larger(max_gap_, gap);
    at(Error::gap) += gap / steps_;
    at(Error::axis) += axis / steps_;
    const bool recovered = axis <= scenes::radians(1);  // not if it is NaN
    if (!recovered) at(Error::recovery) = HUGE_VAL;
    if (recovered && at(Error::recovery) == HUGE_VAL) at(Error::recovery) = time;
    if (scene_.has(Error::energy) || scene_.has(Error::gained)) {
      const double change = (energy(scene_, now) - start_energy_) / scene_.energy_scale;
      grow(Error::energy, std::abs(change));
      grow(Error::gained, change);
    }
    if (scene_.has(Error::momentum)) {
      grow(Error::momentum,
           (angular_momentum(scene_, now) - start_momentum_).norm() / start_momentum_.norm());
    }
  }

  // At the end of the sample's interval.
  void sample(size_t index, const std::vector<State>& now) {
    if (index >= wanted_.size()) return;
    const Vector3d probe = now[scene_.probe_body].pose * scene_.probe;
    at(Error::trajectory) += (probe - wanted_[index]).norm() / double(wanted_.size());
  }

  double max_gap() const { return max_gap_; }
  Errors errors(bool finite) const {
    Errors result = {};
    for (const Error error : scene_.errors) {
      const double value = errors_[size_t(error)];
      result[size_t(error)] = finite && std::isfinite(value) ? value : HUGE_VAL;
    }
    return result;
  }

 private:
  double& at(Error error) { return errors_[size_t(error)]; }
  // Unlike std::max, keeps a NaN.
  static double larger(double a, double b) { return a >= b ? a : b; }
  void grow(Error error, double value) { at(error) = larger(at(error), value); }

  const Scene& scene_;
  int steps_;
  double start_energy_;
  Vector3d start_momentum_;
  std::vector<Overshoot> overshoots_;
  std::vector<Vector3d> wanted_;
  Errors errors_ = {};
  double max_gap_ = 0;
};

}  // namespace

double kinetic_energy(const scenes::Body& body, const State& state) {
  const Vector3d w = state.pose.linear().transpose() * state.angular_velocity;
  return 0.5 * body.mass * state.velocity.squaredNorm() + 0.5 * body.inertia.dot(w.cwiseAbs2());
}

double energy(const Scene& scene, const std::vector<State>& states) {
  double sum = 0;
  for (size_t i = 0; i < states.size(); ++i) {
    const scenes::Body& body = scene.bodies[i];
    if (body.mass == 0) continue;
    sum += kinetic_energy(body, states[i]) +
           body.mass * scene.gravity * states[i].pose.translation().z();
  }
  return sum;
}

Vector3d angular_momentum(const Scene& scene, const std::vector<State>& states) {
  Vector3d sum = Vector3d::Zero();
  for (size_t i = 0; i < states.size(); ++i) {
    const scenes::Body& body = scene.bodies[i];
    const Eigen::Matrix3d& R = states[i].pose.linear();
    const Vector3d own = R * body.inertia.cwiseProduct(R.transpose() * states[i].angular_velocity);
    sum += body.mass * states[i].pose.translation().cross(states[i].velocity) + own;
  }
  return sum;
}

Gaps gaps(const Scene& scene, const Engine& engine) {
  const std::vector<State> now = states(scene, engine);
  Gaps gaps;
  for (const scenes::Joint& joint : scene.joints) {
    const double gap = joint_errors(joint, now[size_t(joint.a)], now[size_t(joint.b)]).gap;
    if (!std::isfinite(gap)) return {HUGE_VAL, HUGE_VAL};
    gaps.mean += gap / double(scene.joints.size());
    gaps.largest = std::max(gaps.largest, gap);
  }
  return gaps;
}

std::vector<Vector3d> reference(const Scene& scene) {
  const int samples = int(std::lround(scene.horizon / sample_interval));
  if (!scene.closed_form) return reference::stored(scene.name, samples);
  std::vector<Vector3d> wanted;
  for (int i = 1; i <= samples; ++i) wanted.push_back(scene.closed_form(i * sample_interval));
  return wanted;
}

Outcome run(const Scene& scene, Engine& engine, double dt, const Watch& watch) {
  Outcome outcome;
  const int steps = int(std::lround(scene.seconds / dt));
  const int interval = int(std::lround(sample_interval / dt));
  Observer observer(scene, states(scene, engine), steps);
  for (int step = 1; step <= steps && outcome.finite; ++step) {
    outcome.seconds += timed_step(engine, (step - 1) * dt, dt);
    ++outcome.steps;
    outcome.end = states(scene, engine);
    for (const State& state : outcome.end) {
      outcome.finite = outcome.finite && state.pose.matrix().allFinite() &&
                       state.velocity.allFinite() && state.angular_velocity.allFinite();
    }
    observer.observe(step * dt, outcome.end, engine);
    if (step % interval == 0) observer.sample(size_t(step / interval) - 1, outcome.end);
    if (watch) watch(step * dt, outcome.end);
  }
  outcome.errors = observer.errors(outcome.finite);
  outcome.max_gap = outcome.finite ? observer.max_gap() : HUGE_VAL;
  outcome.rows = outcome.finite ? engine.rows() : 0;
  return outcome;
}

std::vector<double> step_times(const Scene& scene, const engines::Contender& contender,
                               int iterations, double dt, int steps) {
  const auto engine = contender.make(scene, iterations);
  std::vector<double> times;
  for (int step = 0; step < steps; ++step) times.push_back(timed_step(*engine, step * dt, dt));
  return times;
}

}  // namespace measures

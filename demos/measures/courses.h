// What the demos show of single scenes beside their errors: each is fed with a run, step by step.

#pragma once

#include <algorithm>
#include <cmath>

#include "../scenes/angles.h"

namespace measures {

// The period of a swing about 0: the mean over all of its full swings.
class Period {
 public:
  explicit Period(double start_angle) : last_angle_(start_angle) {}

  void observe(double time, double angle) {
    // The pass between two steps: a straight line is good to third order there, for the angular
    // acceleration is 0 in the lowest position. The jump of the angle from pi to -pi is no pass.
    if (last_angle_ < 0 && angle >= 0 && angle - last_angle_ < scenes::pi) {
      last_pass_ = last_time_ - (time - last_time_) * last_angle_ / (angle - last_angle_);
      if (passes_++ == 0) first_pass_ = last_pass_;
    }
    last_angle_ = angle;
    last_time_ = time;
  }

  // s; 0: not one full swing.
  double value() const { return passes_ > 1 ? (last_pass_ - first_pass_) / (passes_ - 1) : 0; }

 private:
  double last_angle_, last_time_ = 0, first_pass_ = 0, last_pass_ = 0;
  int passes_ = 0;
};

// A door at its stop.
class DoorCourse {
 public:
  double overshoot = 0;   // rad: the farthest beyond the stop
  double rebound = 0;     // largest speed of the first way back, off the stop, over that there
  int bounces = 0;        // how often it turned round from backward to forward
  double rest_time = -1;  // s: when its speed fell below 0.01 rad/s for good; -1: never

  // rad and rad/s.
  void observe(double time, double beyond, double speed) {
    overshoot = std::max(overshoot, beyond);
    if (std::abs(speed) >= 0.01) {
      rest_time = -1;
    } else if (rest_time < 0) {
      rest_time = time;
    }
    // Speeds below 0.01 rad/s do not count as a way there or back.
    if (forward_ && speed < -0.01) {
      forward_ = false;
    } else if (!forward_ && speed > 0.01) {
      forward_ = true;
      ++bounces;
    }
    if (bounces > 0) return;
    if (forward_) {
      there_ = std::max(there_, speed);
    } else if (beyond <= 0) {
      back_ = std::max(back_, -speed);
    }
    rebound = there_ > 0 ? back_ / there_ : 0;
  }

 private:
  bool forward_ = true;
  double there_ = 0, back_ = 0;  // rad/s
};

// A ball that falls, touches, climbs, and falls again.
class BounceCourse {
 public:
  double rebound = 0;  // m: how high the first one goes
  double below = 0;    // m: the deepest
  double rest = 0;     // m: the height at the end

  explicit BounceCourse(double height) : last_(height) {}

  void observe(double height) {
    climbed_ = climbed_ || (touched_ && rebound > 0 && height < last_);
    touched_ = touched_ || height >= last_;
    if (touched_ && !climbed_) rebound = std::max(rebound, height);
    below = std::max(below, -height);
    last_ = rest = height;
  }

 private:
  double last_;
  bool touched_ = false, climbed_ = false;
};

}  // namespace measures

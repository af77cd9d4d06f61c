// Purpose: what a recorder remembers: raw numbers, which become poses and errors when they are written.
#pragma once

#include <pintle/record.h>
#include <pintle/record/constraints.h>

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace record {

/// Of one body in one frame.
struct State {
  btScalar basis[9], origin[3], velocity[3], angular_velocity[3];

  btTransform pose() const {
    return btTransform(btMatrix3x3(basis[0], basis[1], basis[2], basis[3], basis[4], basis[5],
                                   basis[6], basis[7], basis[8]),
                       btVector3(origin[0], origin[1], origin[2]));
  }
};

/// Frames [first, last) in which something is there, by their numbers.
struct Lifetime {
  std::vector<std::pair<int, int>> spans;
  static constexpr int open = 0x7fffffff;

  void begin(int frame) { spans.push_back({frame, open}); }
  void end(int frame) { spans.back().second = frame; }
  bool contains(int frame) const {
    for (const auto& span : spans) {
      if (frame >= span.first && frame < span.second) return true;
    }
    return false;
  }
};

struct Body {
  int shape;
  std::string kind;  ///< static, kinematic, dynamic or link
  double mass = 0;
  btVector3 inertia = {0, 0, 0}, gravity = {0, 0, 0};
  int slot = -1;  ///< among the states of a frame; < 0: it has not moved yet
  State initial;
  Lifetime lifetime;
};

struct Constraint {
  Description description;
  int a, b;  ///< bodies; -1: the world
  Lifetime lifetime;
};

struct Contact {
  float point[3], impulse;  ///< m, N s
};

struct Frame {
  int number = 0;
  double time = 0;  ///< s, simulated
  double step_seconds =
      -1;  ///< the mean of the steps since the last frame, by the clock; < 0: not known
  int states = 0, impulses = 0;
  std::unique_ptr<State[]> state;    ///< by slots
  std::unique_ptr<float[]> impulse;  ///< N s, by constraints
  std::vector<Contact> contacts;

  std::size_t bytes() const {
    return sizeof(Frame) + std::size_t(states) * sizeof(State) +
           std::size_t(impulses) * sizeof(float) + contacts.capacity() * sizeof(Contact);
  }
};

struct Figure {
  std::string name, unit;
  double value;
};

struct Recording {
  RecorderOptions options;
  btVector3 gravity;
  std::vector<std::string> shapes;
  std::vector<Body> bodies;
  std::vector<Constraint> constraints;
  std::vector<Frame> frames;
  std::vector<Figure> figures;
  int stride = 1;

  /// Null where it is not there.
  const State* state(const Body& body, const Frame& frame) const {
    if (!body.lifetime.contains(frame.number)) return nullptr;
    return body.slot >= 0 && body.slot < frame.states ? &frame.state[std::size_t(body.slot)]
                                                      : &body.initial;
  }
  std::string json() const;
};

}  // namespace record
}  // namespace PINTLE_PRECISION
}  // namespace pintle

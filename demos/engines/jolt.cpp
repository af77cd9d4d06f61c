// Jolt: its WebAssembly build in a process of node (jolt/jolt.mjs), one for all engines. It computes in single, and
// has a clock of its own, for what goes to and fro is no part of a step.

#include <spawn.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <stdexcept>

#include "peers.h"

extern char** environ;

namespace engines {
namespace {

using scenes::Isometry3d;
using scenes::Joint;
using scenes::Kind;
using scenes::Scene;
using scenes::Vector3d;

using Message = std::vector<double>;

// Answers messages: arrays of doubles behind their length, also a double.
class Server {
 public:
  Server() {
    int ends[2];
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) fail("has no socket");
    ours_ = ends[0];
    const timeval patience = {30, 0};  // s, for the longest step
    setsockopt(ours_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);

    constexpr int channel = 3;  // where jolt.mjs reads and writes
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_adddup2(&files, ends[1], channel);
    posix_spawn_file_actions_adddup2(&files, STDERR_FILENO, STDOUT_FILENO);
    // Optimised as soon as it is compiled: else the first steps take several times as long.
    const char* const arguments[] = {PINTLE_NODE, "--no-liftoff", PINTLE_JOLT_SERVER, nullptr};
    const int failed = posix_spawn(&process_, PINTLE_NODE, &files, nullptr,
                                   const_cast<char**>(arguments), environ);
    posix_spawn_file_actions_destroy(&files);
    close(ends[1]);
    if (failed != 0) {
      close(ours_);
      fail("could not be started");
    }
  }
  ~Server() {
    close(ours_);  // by which it ends
    if (process_ > 0) waitpid(process_, nullptr, 0);
  }
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  Message ask(const Message& question) {
    const double size = double(question.size());
    send_all(&size, 1);
    send_all(question.data(), question.size());
    double answer_size = 0;
    receive_all(&answer_size, 1);
    Message answer(static_cast<size_t>(answer_size));
    receive_all(answer.data(), answer.size());
    return answer;
  }

 private:
  [[noreturn]] static void fail(const std::string& what) {
    throw std::runtime_error("Jolt's process (" PINTLE_NODE " " PINTLE_JOLT_SERVER ") " + what);
  }
  void send_all(const double* numbers, size_t count) {
    const char* at = reinterpret_cast<const char*>(numbers);
    for (size_t left = count * sizeof(double); left > 0;) {
      const ssize_t sent = send(ours_, at, left, MSG_NOSIGNAL);
      if (sent < 0 && errno == EINTR) continue;
      if (sent <= 0) fail("has ended");
      at += sent;
      left -= size_t(sent);
    }
  }
  void receive_all(double* numbers, size_t count) {
    char* at = reinterpret_cast<char*>(numbers);
    for (size_t left = count * sizeof(double); left > 0;) {
      const ssize_t received = recv(ours_, at, left, 0);
      if (received < 0 && errno == EINTR) continue;
      if (received < 0 && errno == EAGAIN) {
        kill(process_, SIGKILL);
        fail("does not answer");
      }
      if (received <= 0) fail("has ended");
      at += received;
      left -= size_t(received);
    }
  }

  int ours_ = -1;
  pid_t process_ = 0;
};

// One for all engines. Who finds that it has ended says so, and the next engine has another one.
std::unique_ptr<Server>& server() {
  static std::unique_ptr<Server> only;
  return only;
}
Message ask(const Message& question) {
  if (!server()) throw std::runtime_error("Jolt's process has ended");
  try {
    return server()->ask(question);
  } catch (const std::runtime_error&) {
    server().reset();
    throw;
  }
}

// What jolt.mjs reads, in its order.
class Writer {
 public:
  explicit Writer(Message& to) : to_(to) {}

  void add(double number) { to_.push_back(number); }
  void add(const Vector3d& v) { to_.insert(to_.end(), v.data(), v.data() + 3); }

  void add(const scenes::Body& body) {
    add(body.mass);
    add(body.inertia);
    add(Vector3d(body.pose.translation()));
    const Eigen::Quaterniond turn(body.pose.linear());
    add(Vector3d(turn.vec()));
    add(turn.w());
    add(body.velocity);
    add(body.angular_velocity);
    add(body.half_extents);
    add(body.form == scenes::Form::sphere);
    add(body.collides);
    add(body.friction);
    add(body.damping);
    add(body.torque);
  }

  void add(const Scene& scene, const Joint& joint) {
    for (const int index : {int(joint.kind), joint.a, joint.b}) add(index);
    for (const Isometry3d& frame : {joint.in_a, joint.in_b}) {
      add(Vector3d(frame.translation()));
      for (int axis = 0; axis < 3; ++axis) add(Vector3d(frame.linear().col(axis)));
    }
    add(joint.range.limited());
    add(joint.range.low);
    add(joint.range.high);
    for (const double span : {joint.spans.about_z, joint.spans.about_y, joint.spans.twist})
      add(span);
    const double mass = reduced_mass(scene, joint), w = 2 * scenes::pi * joint.spring.frequency;
    add(joint.spring.frequency > 0 ? mass * w * w : 0);
    add(2 * joint.spring.damping_ratio * mass * w);
    add(bool(joint.motor.speed));
    add(joint.motor.max_torque);
  }

 private:
  void add(bool is) { add(is ? 1. : 0.); }
  void add(int number) { add(double(number)); }

  Message& to_;
};

class JoltEngine : public Engine {
 public:
  JoltEngine(const Scene& scene, int iterations) : scene_(scene), speeds_(scene.joints.size()) {
    // The iterations are Jolt's velocity steps. Its position steps, which correct joints that are apart already, are in
    // the proportion of its defaults, 10 and 2.
    const int position_steps = std::max(2, iterations / 5);
    Message message = {double(Request::make), id_, scene.gravity, double(iterations),
                       double(position_steps)};
    Writer writer(message);
    message.push_back(double(scene.bodies.size()));
    for (const scenes::Body& body : scene.bodies) {
      writer.add(body);
      states_.push_back({body.pose, body.velocity, body.angular_velocity});
    }
    message.push_back(double(scene.joints.size()));
    for (const Joint& joint : scene.joints) writer.add(scene, joint);
    if (!server()) server() = std::make_unique<Server>();
    ask(message);
  }
  ~JoltEngine() override {
    try {
      ask({double(Request::destroy), id_});
    } catch (const std::runtime_error&) {  // it has ended, and all is destroyed
    }
  }

  void drive(double time, double) override {
    for (size_t i = 0; i < speeds_.size(); ++i) {
      const scenes::Motor& motor = scene_.joints[i].motor;
      if (motor.speed) speeds_[i] = motor.speed(time);
    }
  }
  void step(double dt) override {
    Message message = {double(Request::step), id_, dt};
    message.insert(message.end(), speeds_.begin(), speeds_.end());
    const Message answer = ask(message);
    step_seconds_ = answer.front();
    const double* from = answer.data() + 1;
    for (State& state : states_) {
      state.pose.translation() = Vector3d(from);
      state.pose.linear() =
          Eigen::Quaterniond(from[6], from[3], from[4], from[5]).toRotationMatrix();
      state.velocity = Vector3d(from + 7);
      state.angular_velocity = Vector3d(from + 10);
      from += 13;
    }
  }
  std::optional<double> step_seconds() const override { return step_seconds_; }
  State state(int body) const override { return states_[size_t(body)]; }

 private:
  enum class Request { make, step, destroy };
  static double next_id() {
    static double last = 0;
    return ++last;
  }

  const Scene& scene_;
  const double id_ = next_id();
  std::vector<double> speeds_;  // of all joints; 0 without a motor
  std::vector<State> states_;
  double step_seconds_ = 0;
};

bool is_known(const Joint& joint) {
  const scenes::Range& range = joint.range;
  const bool may_give =
      joint.kind == Kind::distance || (joint.kind == Kind::slider && !range.limited());
  const bool may_drive = joint.kind == Kind::hinge || joint.kind == Kind::slider;
  if ((joint.spring.frequency > 0 && !may_give) || (joint.motor.speed && !may_drive) ||
      joint.muscle.stiffness > 0)
    return false;
  const bool has_zero = !range.limited() || (range.low <= 0 && range.high >= 0);
  const bool in_a_turn = !range.limited() || (range.low >= -scenes::pi && range.high <= scenes::pi);
  switch (joint.kind) {
    case Kind::ball:
    case Kind::fixed:
    case Kind::cone_twist:
    case Kind::distance: return true;
    case Kind::hinge: return has_zero && in_a_turn;
    case Kind::universal: return !range.limited();
    case Kind::slider: return has_zero && joint.restitution == 0;
    // Its six degrees of freedom with a fixed twist hold a constant velocity joint's angle, but not its speed.
    case Kind::constant_velocity:
    case Kind::wedge:
    case Kind::angle:
    case Kind::contact:
    case Kind::gear: break;
  }
  return false;
}

bool is_known(const scenes::Body& body) {
  return !body.collides || body.form == scenes::Form::box || body.form == scenes::Form::sphere;
}

}  // namespace

std::unique_ptr<Engine> make_jolt(const Scene& scene, int iterations) {
  for (const Joint& joint : scene.joints) {
    if (!is_known(joint) || joint.breaks_at > 0) return nullptr;
  }
  for (const scenes::Body& body : scene.bodies) {
    if (!is_known(body)) return nullptr;
  }
  return std::make_unique<JoltEngine>(scene, iterations);
}

}  // namespace engines

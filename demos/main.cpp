// Runs every scene with Bullet's hinge and with Pintle's, and prints what was measured.
//
// The ratios are Pintle's number over the stock joint's: below 1 Pintle is better, above 1 worse.
// Errors repeat exactly on one machine, and each run is repeated here to see that they do. Times do
// not: the joints take turns, the fastest turn of each counts, and only the ratio is shown.

#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>
#include <BulletDynamics/ConstraintSolver/btConeTwistConstraint.h>
#include <BulletDynamics/ConstraintSolver/btFixedConstraint.h>
#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>
#include <BulletDynamics/ConstraintSolver/btSliderConstraint.h>
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/cone_twist_joint.h>
#include <pintle/joints/dot_hinge.h>
#include <pintle/joints/fixed_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/slider_joint.h>
#include <pintle/joints/two_point_hinge.h>
#include <pintle/joints/unstable/cross_product_hinge.h>
#include <pintle/joints/unstable/cross_product_matrix_hinge.h>
#include <pintle/joints/unstable/single_row_lock.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "engines/bullet.h"
#include "measures/courses.h"
#include "measures/run.h"
#include "scenes/chain.h"
#include "scenes/drive_shaft.h"
#include "scenes/pendulum.h"
#include "scenes/recovery.h"
#include "scenes/shoulder.h"
#include "scenes/slider_crank.h"
#include "scenes/unstable.h"

namespace {

using scenes::degrees;
using scenes::radians;
using Stock = btHingeConstraint;
using StockCounting = btHingeAccumulatedAngleConstraint;
using Ours = pintle::QuaternionHinge;

// Two variants of ours, to see what the defaults are worth.
const auto plain_rows = [](Ours& hinge) { hinge.setBlockRows(false); };
const auto document = [](Ours& hinge) { hinge.setFormulation(pintle::Formulation::document); };

template <class... Arguments>
std::string text(const char* format, Arguments... arguments) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, format, arguments...);
  return buffer;
}

// What one run measured. `values` go with the table's columns; infinity: never reached, or lost;
// NaN: there is no such quantity.
struct Measurement {
  std::vector<double> values;
  double error = 0;                  // what the ratio compares
  double microseconds_per_step = 0;  // 0: no time to compare
};

struct Contender {
  std::string who;
  std::function<Measurement()> run;
};

struct Column {
  std::string quantity;
  std::string unit;
  const char* format;  // of one double, at most 9 wide
  const char* infinite = "never";
};

// Writes the long form: one line a number.
class Csv {
 public:
  // Given twice, the last file counts.
  bool open(const std::string& path) {
    if (file_.is_open()) file_.close();
    file_.open(path);
    file_.precision(9);
    file_ << "precision,scene,case,who,quantity,unit,value\n";
    return bool(file_);
  }

  void write(const std::string& scene, const std::string& name, const std::string& who,
             const std::string& quantity, const std::string& unit, double value) {
    if (!file_.is_open()) return;
    const char* precision = sizeof(btScalar) == sizeof(double) ? "double" : "single";
    file_ << precision << ',' << scene << ',' << name << ',' << who << ',' << quantity << ','
          << unit << ',' << value << '\n';
  }

  // False: something was not written.
  bool close() {
    if (!file_.is_open()) return true;
    file_.close();
    return bool(file_);
  }

 private:
  std::ofstream file_;
};

// Prints one scene's table, line by line as the runs end, 80 columns wide. The first contender
// whose name begins with "stock" is the one that all others are compared with.
class Table {
 public:
  Table(Csv& csv, const std::string& scene, const std::string& title, std::vector<Column> columns)
      : csv_(csv), scene_(scene), columns_(std::move(columns)) {
    std::printf("\n%s: %s\n%-22s%-8s", scene.c_str(), title.c_str(), "", "");
    for (const Column& column : columns_) std::printf("%9s", column.quantity.c_str());
    std::printf("%7s%7s\n%-22s%-8s", "error", "time", "case", "who");
    for (const Column& column : columns_) std::printf("%9s", column.unit.c_str());
    std::printf("%7s%7s\n", "/stock", "/stock");
  }

  void compare(const std::string& name, const std::vector<Contender>& contenders) {
    std::vector<Measurement> results;
    for (const Contender& contender : contenders) results.push_back(contender.run());
    repeat(name, contenders, results);

    const Measurement* stock = nullptr;
    for (std::size_t i = 0; i < contenders.size(); ++i) {
      const std::string& who = contenders[i].who;
      std::printf("%-22s%-8s", i == 0 ? name.c_str() : "", who.c_str());
      for (std::size_t c = 0; c < columns_.size(); ++c) {
        const double value = results[i].values[c];
        print(columns_[c], value);
        csv_.write(scene_, name, who, columns_[c].quantity, columns_[c].unit, value);
      }
      if (stock != nullptr) {
        print_ratio(results[i].error, stock->error);
        print_ratio(results[i].microseconds_per_step, stock->microseconds_per_step);
        csv_.write(scene_, name, who, "time", "stock=1",
                   results[i].microseconds_per_step / stock->microseconds_per_step);
      } else if (who.rfind("stock", 0) == 0) {
        stock = &results[i];
      }
      std::printf("\n");
      std::fflush(stdout);
    }
  }

  static bool all_repeated() { return all_repeated_; }

 private:
  // Runs all contenders again, in turns, for the best time of each.
  void repeat(const std::string& name, const std::vector<Contender>& contenders,
              std::vector<Measurement>& results) {
    using Clock = std::chrono::steady_clock;
    const auto start = Clock::now();
    for (int turn = 0; turn < 100; ++turn) {
      if (turn >= 2 && Clock::now() - start > std::chrono::milliseconds(250)) break;
      for (std::size_t i = 0; i < contenders.size(); ++i) {
        if (results[i].microseconds_per_step == 0) continue;
        const Measurement again = contenders[i].run();
        results[i].microseconds_per_step =
            std::min(results[i].microseconds_per_step, again.microseconds_per_step);
        // Bit by bit, so that NaN equals NaN.
        if (std::memcmp(again.values.data(), results[i].values.data(),
                        again.values.size() * sizeof(double)) != 0) {
          std::fprintf(stderr, "%s, %s, %s: a second run gave other numbers\n", scene_.c_str(),
                       name.c_str(), contenders[i].who.c_str());
          all_repeated_ = false;
        }
      }
    }
  }

  static void print(const Column& column, double value) {
    if (std::isinf(value)) {
      std::printf("%9s", column.infinite);
    } else if (std::isnan(value)) {
      std::printf("%9s", "none");
    } else {
      std::printf("%9s", text(column.format, value).c_str());
    }
  }

  static void print_ratio(double ours, double stock) {
    const double ratio = ours / stock;
    if (std::isnan(ratio)) {  // both 0, or both infinite
      std::printf("%7s", "-");
    } else if (ratio != 0 && (ratio < 0.01 || ratio >= 1000)) {
      std::printf("%7.0e", ratio);
    } else {
      std::printf("%7.2f", ratio);
    }
  }

  Csv& csv_;
  std::string scene_;
  std::vector<Column> columns_;
  static inline bool all_repeated_ = true;
};

double or_infinite(bool reached, double value) { return reached ? value : HUGE_VAL; }

template <class Hinge, class Configure = scenes::AsConstructed>
Measurement measure(const scenes::ChainSettings& settings, Configure configure = {}) {
  const scenes::ChainResult r = scenes::chain<Hinge>(settings, configure);
  const double mean_gap = or_infinite(r.finite, r.mean_gap);
  return {
      {mean_gap, or_infinite(r.finite, r.max_gap), or_infinite(r.finite, degrees(r.max_axis_angle)),
       or_infinite(r.finite, r.end_energy_error)},
      mean_gap,
      r.microseconds_per_step};
}

void run_chain(Csv& csv) {
  Table table(csv, "chain", "fall for 5 s (number of links x mass of the last, iterations)",
              {{"mean gap", "m", "%.2e", "lost"},
               {"max gap", "m", "%.2e", "lost"},
               {"axes", "deg", "%.2f", "lost"},
               {"energy", "mgN^2/2", "%+.1e", "lost"}});
  struct Case {
    int links;
    double ratio, hz;
    int iterations;
  };
  std::vector<Case> cases;
  for (const double ratio : {1, 10, 100}) {
    for (const int iterations : {4, 10, 20, 50, 100}) cases.push_back({10, ratio, 60, iterations});
  }
  cases.push_back({10, 1e4, 60, 10});
  cases.push_back({10, 1e4, 1000, 10});
  cases.push_back({100, 1000, 240, 10});
  for (const Case& c : cases) {
    scenes::ChainSettings settings;
    settings.links = c.links;
    settings.ratio = c.ratio;
    settings.dt = 1 / c.hz;
    settings.iterations = c.iterations;
    table.compare(text("%dx%g %gHz %dit", c.links, c.ratio, c.hz, c.iterations),
                  {{"stock", [&] { return measure<Stock>(settings); }},
                   {"pintle", [&] { return measure<Ours>(settings); }},
                   {"plain", [&] { return measure<Ours>(settings, plain_rows); }}});
  }
}

template <class Hinge, class Configure = scenes::AsConstructed>
Measurement measure(const scenes::RecoverySettings& settings, Configure configure = {}) {
  const scenes::RecoveryResult r = scenes::recovery<Hinge>(settings, configure);
  const double steps = or_infinite(r.finite && r.steps >= 0, r.steps);
  return {{steps, r.max_angular_speed, degrees(r.end_axis_angle), r.max_gap},
          steps,
          r.microseconds_per_step};
}

void run_recovery(Csv& csv) {
  Table table(csv, "recovery", "two free boxes, their axes apart at the start",
              {{"steps", "to 1 deg", "%.0f"},
               {"speed", "rad/s", "%.1f"},
               {"end", "deg", "%.1e"},
               {"max gap", "m", "%.2e"}});
  struct Direction {
    const char* name;
    Eigen::Vector3d about;
  };
  const Direction directions[] = {
      {"x", {1, 0, 0}}, {"y", {0, 1, 0}}, {"(0.6 0.8 0)", {0.6, 0.8, 0}}};
  for (const Direction& direction : directions) {
    for (const double angle : {45, 90, 120, 170, 179, 180}) {
      scenes::RecoverySettings settings;
      settings.angle = radians(angle);
      settings.about = direction.about;
      table.compare(text("%g about %s", angle, direction.name),
                    {{"stock", [&] { return measure<Stock>(settings); }},
                     {"pintle", [&] { return measure<Ours>(settings); }},
                     {"doc.", [&] { return measure<Ours>(settings, document); }}});
    }
  }
}

template <class Hinge, class Configure = scenes::AsConstructed>
Measurement measure(const scenes::PendulumSettings& settings, Configure configure = {}) {
  const scenes::PendulumResult r = scenes::pendulum<Hinge>(settings, configure);
  const double period_error = or_infinite(r.period > 0, r.period_error);
  return {{period_error, r.max_gap, degrees(r.max_axis_angle), r.max_energy_error},
          std::abs(period_error),
          r.microseconds_per_step};
}

void run_pendulum(Csv& csv) {
  Table table(csv, "pendulum", "one link swings for 20 s on an axis tilted by 30 deg",
              {{"period", "relative", "%+.2e"},
               {"max gap", "m", "%.2e"},
               {"axes", "deg", "%.1e"},
               {"energy", "relative", "%.2e"}});
  for (const double hz : {60, 240, 1000}) {
    for (const double amplitude : {10, 120, 170}) {
      scenes::PendulumSettings settings;
      settings.amplitude = radians(amplitude);
      settings.dt = 1 / hz;
      table.compare(text("from %g deg %gHz", amplitude, hz),
                    {{"stock", [&] { return measure<Stock>(settings); }},
                     {"pintle", [&] { return measure<Ours>(settings); }},
                     {"doc.", [&] { return measure<Ours>(settings, document); }}});
    }
  }
}

// One of the catalog's scenes, built with a contender's joints.
using Make = std::function<std::unique_ptr<engines::BulletEngine>(const scenes::Scene&)>;

Make with(engines::MakeJoint make_joint) {
  return [=](const scenes::Scene& scene) { return engines::make_bullet(scene, 10, make_joint); };
}

double microseconds_per_step(const measures::Outcome& outcome) {
  return 1e6 * outcome.seconds / outcome.steps;
}

// Of a hinge against the ground about z: b's x axis.
double angle_about_z(const engines::State& state) {
  return std::atan2(state.pose(1, 0), state.pose(0, 0));
}

engines::BulletJoint make_counting_hinge(const scenes::Joint& joint, btRigidBody& a,
                                         btRigidBody& b) {
  auto hinge = std::make_unique<StockCounting>(a, b, scenes::to_bullet(joint.in_a),
                                               scenes::to_bullet(joint.in_b), true);
  hinge->setLimit(btScalar(joint.range.low), btScalar(joint.range.high));
  StockCounting* const driven = hinge.get();
  return {std::move(hinge), [driven, torque = joint.motor.max_torque](double speed, double dt) {
            driven->enableAngularMotor(true, btScalar(speed), btScalar(torque * dt));
          }};
}

template <class Hinge>
Measurement measure_valve(const scenes::Scene& scene, engines::MakeJoint make_joint) {
  const auto engine = engines::make_bullet(scene, 10, make_joint);
  auto& hinge = static_cast<Hinge&>(engine->joint(0));
  const double stop = scene.joints[0].range.high;
  double top = 0, bottom = 0, miscount = NAN;
  scenes::Unwrap angle(0);
  const measures::Outcome outcome = measures::run(
      scene, *engine, 1. / 60, [&](double time, const std::vector<engines::State>& states) {
        const double now = angle(angle_about_z(states.back()));
        (time < scene.seconds / 2 + 1e-3 ? top : bottom) = now;
        if constexpr (scenes::HasAccumulatedAngle<Hinge>::value) {
          const double error = std::abs(double(hinge.getAccumulatedHingeAngle()) - now);
          miscount = std::isnan(miscount) ? error : std::max(miscount, error);
        }
      });
  return {{degrees(top), degrees(bottom), degrees(outcome[scenes::Error::overshoot]),
           degrees(miscount)},
          std::max(std::abs(top - stop), std::abs(bottom)),
          microseconds_per_step(outcome)};
}

void run_valve(Csv& csv) {
  Table table(csv, "valve", "a motor turns a wheel up to 1800 deg and back to 0",
              {{"up", "deg", "%.3f"},
               {"down", "deg", "%.3f"},
               {"beyond", "deg", "%.3f"},
               {"miscount", "deg", "%.1e"}});
  for (const double speed : {6, 12, 20}) {
    const scenes::Scene scene = scenes::valve_scene(5, speed);
    table.compare(
        text("%g rad/s 60Hz", speed),
        {{"stock", [&] { return measure_valve<Stock>(scene, engines::make_stock_joint); }},
         {"stock c.", [&] { return measure_valve<StockCounting>(scene, make_counting_hinge); }},
         {"pintle", [&] { return measure_valve<Ours>(scene, engines::make_conditioned_joint); }}});
  }
}

Measurement door_measurement(const measures::DoorCourse& course, double right_overshoot,
                             double microseconds = 0) {
  return {{degrees(course.overshoot), course.rebound, double(course.bounces),
           or_infinite(course.rest_time >= 0, course.rest_time)},
          std::abs(course.overshoot - right_overshoot),
          microseconds};
}

// As it should be: by the scene's closed form, each millisecond.
measures::DoorCourse wanted_door(const scenes::Scene& scene) {
  measures::DoorCourse course;
  constexpr double dt = 1e-3;
  double last = 0;
  for (int step = 1; step * dt <= scene.seconds; ++step) {
    const scenes::Vector3d edge = scene.closed_form(step * dt);
    const double angle = std::atan2(edge.y(), edge.x());
    course.observe(step * dt, angle - scene.joints[0].range.high, (angle - last) / dt);
    last = angle;
  }
  return course;
}

Measurement measure_door(const scenes::Scene& scene, double dt, double right_overshoot,
                         const Make& make) {
  const auto engine = make(scene);
  measures::DoorCourse course;
  scenes::Unwrap angle(0);
  const measures::Outcome outcome = measures::run(
      scene, *engine, dt, [&](double time, const std::vector<engines::State>& states) {
        const engines::State& door = states.back();
        course.observe(time, angle(angle_about_z(door)) - scene.joints[0].range.high,
                       door.angular_velocity.z());
      });
  return door_measurement(course, right_overshoot, microseconds_per_step(outcome));
}

void run_door(Csv& csv) {
  Table table(csv, "door", "thrown at a soft stop (spring of 3 Hz, damping ratio z)",
              {{"beyond", "deg", "%.2f"},
               {"rebound", "of speed", "%.3f"},
               {"bounces", "", "%.0f"},
               {"rest at", "s", "%.2f"}});
  for (const double hz : {60, 240, 1000}) {
    for (const double damping_ratio : {0.1, 0.3, 1.0}) {
      const scenes::Scene scene = scenes::door_scene(damping_ratio);
      const double dt = 1 / hz;
      // The stock joint's other way to a soft stop: the spring as ERP and CFM of the stop, with the
      // door's inertia put in by hand, and without the softening by setLimit's bias.
      const Make spring_as_cfm = [=](const scenes::Scene& of) {
        auto engine = engines::make_bullet(of, 10, engines::make_stock_joint);
        const scenes::Body& door = of.bodies.back();
        const double arm = door.pose.translation().norm();
        const double inertia = door.inertia.z() + door.mass * arm * arm;
        const double w = 2 * scenes::pi * of.joints[0].spring.frequency;
        const double k = inertia * w * w, c = 2 * damping_ratio * inertia * w;
        const double gain = dt * k + c;
        auto& hinge = static_cast<Stock&>(engine->joint(0));
        hinge.setLimit(hinge.getLowerLimit(), hinge.getUpperLimit(), btScalar(0.9), 1, 0);
        hinge.setParam(BT_CONSTRAINT_STOP_ERP, btScalar(dt * k / gain));
        hinge.setParam(BT_CONSTRAINT_STOP_CFM, btScalar(1 / (dt * gain)));
        return engine;
      };
      const measures::DoorCourse wanted = wanted_door(scene);
      const auto measure = [&](const Make& make) {
        return measure_door(scene, dt, wanted.overshoot, make);
      };
      table.compare(text("z=%g %gHz", damping_ratio, hz),
                    {{"wanted", [&] { return door_measurement(wanted, wanted.overshoot); }},
                     {"stock", [&] { return measure(with(engines::make_stock_joint)); }},
                     {"s. cfm", [&] { return measure(spring_as_cfm); }},
                     {"pintle", [&] { return measure(with(engines::make_conditioned_joint)); }}});
    }
  }
}

// Of the weight, whatever it hangs on.
Measurement measure_rope(const scenes::Scene& scene, double dt, bool slack,
                         engines::MakeJoint make_joint) {
  const auto engine = engines::make_bullet(scene, 10, make_joint);
  const scenes::Body& weight = scene.bodies[size_t(scene.probe_body)];
  const scenes::Vector3d start = weight.pose.translation();
  const double amplitude = std::atan2(start.x(), -start.z()), g = scenes::standard_gravity;
  measures::Period period(amplitude);
  double stretch = 0, energy = 0;
  const measures::Outcome outcome = measures::run(
      scene, *engine, dt, [&](double time, const std::vector<engines::State>& states) {
        const engines::State& now = states[size_t(scene.probe_body)];
        const scenes::Vector3d at = now.pose.translation();
        const scenes::Vector3d w = now.pose.linear().transpose() * now.angular_velocity;
        const double kinetic =
            weight.mass * now.velocity.squaredNorm() + weight.inertia.dot(w.cwiseAbs2());
        const double gained =
            (kinetic / 2 + weight.mass * g * (at.z() - start.z())) / scene.energy_scale;
        const double longer = at.norm() - 1;
        stretch = std::max(stretch, slack ? longer : std::abs(longer));
        energy = std::max(energy, slack ? gained : std::abs(gained));
        period.observe(time, std::atan2(at.x(), -at.z()));
      });
  const double exact = scenes::pendulum_period(weight.mass, weight.mass * g, amplitude);
  return {{slack ? NAN : or_infinite(period.value() > 0, period.value() / exact - 1),
           or_infinite(outcome.finite, stretch), or_infinite(outcome.finite, energy)},
          or_infinite(outcome.finite, stretch),
          microseconds_per_step(outcome)};
}

void run_rope(Csv& csv) {
  Table table(csv, "rope", "a weight swings on a rod, or falls until its rope is taut",
              {{"period", "relative", "%+.2e"},
               {"stretch", "m", "%.2e", "lost"},
               {"energy", "relative", "%.2e", "lost"}});
  for (const bool slack : {false, true}) {
    const scenes::Scene scene = scenes::rope_scene(slack), sticks = scenes::stick_rope_scene(slack);
    for (const double hz : {60, 240}) {
      table.compare(
          text("%s %gHz", slack ? "rope" : "rod from 60 deg", hz),
          {{"stock",
            [&] { return measure_rope(sticks, 1 / hz, slack, engines::make_stock_joint); }},
           {"pintle",
            [&] { return measure_rope(scene, 1 / hz, slack, engines::make_conditioned_joint); }}});
    }
  }
}

// The direction at psi about z and at `height` from it, rad.
scenes::Vector3d direction(double psi, double height) {
  return {std::sin(height) * std::cos(psi), std::sin(height) * std::sin(psi), std::cos(height)};
}

// Thrown from 24 directions inside, without gravity, for 2 s each: how far outside it came, and its largest
// angular speed over that of the throw; above 1 the limit has thrown it. Then hanging, with air drag, for 10 s,
// where straight down is 40 degrees off the axis and behind the edge: a wedge of less than half a turn holds it
// in the corner, along the axis; a wider one on a side. In the last 2 s: its angular speed, and how far outside.
Measurement measure_wedge(double total, engines::MakeJoint make_joint) {
  constexpr double dt = 1. / 60, speed = 6;
  double beyond = 0, fastest = 0, restless = 0, off = 0;
  bool finite = true;
  for (int n = 0; n < 24 && finite; ++n) {
    // Directions and spins that are spread out and repeat: multiples of the golden angle.
    const double turn = 2.39996 * n;
    scenes::Scene scene =
        scenes::elbow_scene(total, Eigen::Quaterniond::Identity(),
                            direction(0.45 * total * std::sin(turn), 0.15 + 2.8 * (n + 0.5) / 24));
    scene.gravity = 0;
    scene.seconds = 2;
    spin(scene.bodies.back(), speed * direction(turn, 0.3 + 2.5 * ((7 * n) % 24) / 24.), {0, 0, 0});
    const measures::Outcome outcome =
        measures::run(scene, *engines::make_bullet(scene, 10, make_joint), dt,
                      [&](double, const std::vector<engines::State>& states) {
                        fastest = std::max(fastest, states.back().angular_velocity.norm() / speed);
                      });
    finite = outcome.finite;
    beyond = std::max(beyond, outcome[scenes::Error::overshoot]);
  }
  // A little to one side, so that it is known which way a wedge of more than half a turn lets it slide.
  const scenes::Vector3d down = direction(scenes::pi - 0.1, radians(40));
  scenes::Scene scene = scenes::elbow_scene(
      total, scenes::turn_between(down, -scenes::Vector3d::UnitZ()), direction(0.1 * total, 0.4));
  scene.bodies.back().damping = 0.9;
  scene.seconds = 10;
  measures::Overshoot outside(scene.joints[0]);
  const measures::Outcome outcome =
      measures::run(scene, *engines::make_bullet(scene, 10, make_joint), dt,
                    [&](double time, const std::vector<engines::State>& states) {
                      if (time < scene.seconds - 2 + dt / 2) return;
                      restless = std::max(restless, states.back().angular_velocity.norm());
                      off = std::max(off, outside(states.front(), states.back()));
                    });
  finite = finite && outcome.finite;
  return {{or_infinite(finite, degrees(beyond)), or_infinite(finite, fastest),
           or_infinite(finite, restless), or_infinite(finite, degrees(off))},
          or_infinite(finite, degrees(beyond)),
          microseconds_per_step(outcome)};
}

void run_wedge(Csv& csv) {
  Table table(csv, "wedge", "an arm is thrown at its limits, and hangs in their corner",
              {{"beyond", "deg", "%.2f", "lost"},
               {"fastest", "of speed", "%.2f", "lost"},
               {"restless", "rad/s", "%.1e", "lost"},
               {"off", "deg", "%.1e", "lost"}});
  for (const double total : {5, 30, 90, 150, 200, 270, 350}) {
    const auto measure = [=](engines::MakeJoint make_joint) {
      return measure_wedge(radians(total), make_joint);
    };
    table.compare(text("%g deg 60Hz", total),
                  {{"stock", [=] { return measure(engines::make_stock_joint); }},
                   {"pintle", [=] { return measure(engines::make_conditioned_joint); }}});
  }
}

Measurement measure(const scenes::SliderCrankResult& r) {
  const double error = or_infinite(r.finite, r.max_piston_error);
  return {{error, or_infinite(r.finite, r.max_reading_error), or_infinite(r.finite, r.max_gap),
           or_infinite(r.finite, degrees(r.max_crank_error))},
          error,
          r.microseconds_per_step};
}

void run_slider_crank(Csv& csv) {
  Table table(csv, "slider_crank", "a motor drives a piston at 1 turn/s for 5 s",
              {{"piston", "m", "%.1e", "lost"},
               {"reading", "m", "%.1e", "lost"},
               {"max gap", "m", "%.1e", "lost"},
               {"crank", "deg", "%.1e", "lost"}});
  for (const int iterations : {10, 100}) {
    for (const double hz : {60, 120, 240, 480}) {
      scenes::SliderCrankSettings settings;
      settings.dt = 1 / hz;
      settings.iterations = iterations;
      table.compare(
          text("%gHz %dit", hz, iterations),
          {{"stock",
            [&] {
              return measure(
                  scenes::slider_crank<Stock, btPoint2PointConstraint, btSliderConstraint>(
                      settings));
            }},
           {"pintle", [&] {
              return measure(
                  scenes::slider_crank<Ours, pintle::BallJoint, pintle::SliderJoint>(settings));
            }}});
    }
  }
}

template <class Joint>
Measurement measure(const scenes::ShoulderSettings& settings) {
  const scenes::ShoulderResult r = scenes::shoulder<Joint>(settings);
  const double beyond = or_infinite(r.finite, r.swing_beyond);
  return {{degrees(beyond), degrees(or_infinite(r.finite, r.twist_beyond)),
           or_infinite(r.finite, r.top_speed), or_infinite(r.finite, r.rest_speed)},
          std::max(beyond, 0.0),
          r.microseconds_per_step};
}

void run_shoulder(Csv& csv) {
  Table table(csv, "shoulder", "a limb thrown at its cone (spans of swing 1 x 2, twist; speed)",
              {{"swing", "deg over", "%+.3f", "lost"},
               {"twist", "deg over", "%+.3f", "lost"},
               {"top", "rad/s", "%.2f", "lost"},
               {"rest", "rad/s", "%.1e", "lost"}});
  struct Spans {
    double swing_1, swing_2, twist;  // degrees
  };
  for (const Spans& spans :
       {Spans{45, 45, 30}, Spans{30, 70, 30}, Spans{6, 70, 30}, Spans{170, 170, 30}}) {
    for (const double speed : {3, 12}) {
      scenes::ShoulderSettings settings;
      settings.span_1 = radians(spans.swing_1);
      settings.span_2 = radians(spans.swing_2);
      settings.twist_span = radians(spans.twist);
      settings.spin = settings.spin.normalized() * speed;
      table.compare(text("%gx%g %g; %g", spans.swing_1, spans.swing_2, spans.twist, speed),
                    {{"stock", [&] { return measure<btConeTwistConstraint>(settings); }},
                     {"pintle", [&] { return measure<pintle::ConeTwistJoint>(settings); }}});
    }
  }
}

template <class Joint>
Measurement measure(const scenes::DriveShaftSettings& settings) {
  const scenes::DriveShaftResult r = scenes::drive_shaft<Joint>(settings);
  constexpr bool constant = std::is_same_v<Joint, pintle::ConstantVelocityJoint>;
  const double error = or_infinite(r.finite, constant ? r.velocity_error : r.universal_error);
  return {{r.min, r.max, r.ripple, degrees(error)}, error, r.microseconds_per_step};
}

void run_drive_shaft(Csv& csv) {
  Table table(csv, "drive_shaft",
              "a shaft turns another at a bend (ideal of a universal joint: ripple)",
              {{"least", "out/in", "%.5f"},
               {"most", "out/in", "%.5f"},
               {"ripple", "out/in", "%.2e"},
               {"error", "deg", "%.1e", "lost"}});
  struct Speed {
    double rpm, hz;
  };
  for (const Speed& speed : {Speed{20, 60}, {300, 60}, {1000, 240}}) {
    for (const double bend : {5, 20, 40, 60}) {
      scenes::DriveShaftSettings settings;
      settings.bend = radians(bend);
      settings.rpm = speed.rpm;
      settings.dt = 1 / speed.hz;
      table.compare(
          text("%g deg %grpm %gHz", bend, speed.rpm, speed.hz),
          {{"ideal u.",
            [&] {
              const double c = std::cos(settings.bend);
              return Measurement{{c, 1 / c, (1 / c - c) / 2, 0}};
            }},
           {"stock u.", [&] { return measure<btUniversalConstraint>(settings); }},
           {"pintle u", [&] { return measure<pintle::UniversalJoint>(settings); }},
           {"pintle c", [&] { return measure<pintle::ConstantVelocityJoint>(settings); }}});
    }
  }
}

template <class Joint>
Measurement measure(const scenes::BeamSettings& settings) {
  const scenes::BeamResult r = scenes::beam<Joint>(settings);
  const double last = or_infinite(r.finite, degrees(r.last_error));
  return {{degrees(r.first_error), last, degrees(r.max_error), r.max_angular_speed},
          last,
          r.microseconds_per_step};
}

template <class Joint>
Measurement measure(const scenes::SpinSettings& settings) {
  const scenes::SpinResult r = scenes::spin<Joint>(settings);
  const double change = or_infinite(r.finite, r.momentum_change);
  return {{change, degrees(r.end_error)}, change, r.microseconds_per_step};
}

// The joint that is measured as its settings ask, by name.
template <class Joint, class Settings>
Contender contender(const char* who, const Settings& settings) {
  return {who, [settings] { return measure<Joint>(settings); }};
}
template <class Settings>
std::vector<Contender> hinges(const Settings& settings) {
  return {contender<Stock>("stock", settings),
          contender<Ours>("pintle", settings),
          contender<pintle::DotHinge>("dot", settings),
          contender<pintle::TwoPointHinge>("2 points", settings),
          contender<pintle::CrossProductHinge>("1 row", settings),
          contender<pintle::CrossProductMatrixHinge>("3 rows", settings)};
}
template <class Settings>
std::vector<Contender> locks(Settings settings) {
  settings.lock = true;
  return {contender<btFixedConstraint>("stock", settings),
          contender<pintle::FixedJoint>("pintle", settings),
          contender<pintle::SingleRowLock>("1 row", settings)};
}

void run_unstable(Csv& csv) {
  {
    Table table(csv, "beam", "held level by its end for 10 s: error in the first and last",
                {{"first s", "deg", "%.1e"},
                 {"last s", "deg", "%.1e"},
                 {"max", "deg", "%.1e"},
                 {"speed", "rad/s", "%.2f"}});
    for (const double hz : {60, 240}) {
      scenes::BeamSettings settings;
      settings.dt = 1 / hz;
      table.compare(text("hinge %gHz", hz), hinges(settings));
      table.compare(text("lock %gHz", hz), locks(settings));
    }
  }
  {
    Table table(csv, "spin", "a free pair, violated by 40 deg, spins for 5 s",
                {{"momentum", "relative", "%.1e"}, {"end", "deg", "%.1e"}});
    for (const double hz : {60, 240}) {
      scenes::SpinSettings settings;
      settings.dt = 1 / hz;
      table.compare(text("hinge %gHz", hz), hinges(settings));
      table.compare(text("lock %gHz", hz), locks(settings));
    }
  }
  Table table(csv, "recovers", "two free boxes, their frames apart at the start",
              {{"steps", "to 1 deg", "%.0f"},
               {"speed", "rad/s", "%.1f"},
               {"end", "deg", "%.1e"},
               {"max gap", "m", "%.2e"}});
  for (const double angle : {45, 120, 179}) {
    scenes::RecoverySettings settings;
    settings.angle = radians(angle);
    settings.about = {0.6, 0.8, 0};
    table.compare(text("hinge %g deg", angle), hinges(settings));
  }
  for (const double angle : {45, 90, 120, 179, 180}) {
    scenes::RecoverySettings settings;
    settings.angle = radians(angle);
    settings.about = {0, 1, 0};
    table.compare(text("lock %g about y", angle), locks(settings));
    settings.about = Eigen::Vector3d(1, 1, 1).normalized();
    table.compare(text("lock %g about xyz", angle), locks(settings));
  }
}

// Bullet's contact is the collision of a sphere with a plane, which its centre then stays a radius above.
std::unique_ptr<engines::BulletEngine> make_collision(const scenes::Scene& scene) {
  static btSphereShape sphere(btScalar(0.1));
  static btStaticPlaneShape plane(btVector3(0, 0, 1), btScalar(-0.1));
  auto engine = std::make_unique<engines::BulletEngine>(scene, 10);
  for (const int i : {0, 1}) {
    btRigidBody& body = engine->body(i);
    engine->world().removeRigidBody(&body);
    body.setCollisionShape(i == 0 ? static_cast<btCollisionShape*>(&plane) : &sphere);
    // Bullet takes the product.
    body.setRestitution(btScalar(std::sqrt(scene.joints[0].restitution)));
    engine->world().addRigidBody(&body);
  }
  return engine;
}

Measurement measure_bounce(const scenes::Scene& scene, double dt, const Make& make) {
  const auto engine = make(scene);
  const double height = scene.bodies.back().pose.translation().z();
  measures::BounceCourse course(height);
  const measures::Outcome outcome =
      measures::run(scene, *engine, dt, [&](double, const std::vector<engines::State>& states) {
        course.observe(states.back().pose.translation().z());
      });
  const double e = scene.joints[0].restitution, wanted = e * e * height;
  const double rebound = wanted > 0 ? course.rebound / wanted : course.rebound;
  return {{or_infinite(outcome.finite, rebound), or_infinite(outcome.finite, course.below),
           or_infinite(outcome.finite, course.rest)},
          or_infinite(outcome.finite, std::abs(rebound - (wanted > 0 ? 1 : 0))),
          microseconds_per_step(outcome)};
}

void run_bounce(Csv& csv) {
  Table table(csv, "bounce", "a ball is dropped on a plane, and bounces until it rests",
              {{"rebound", "of e^2 h", "%.3f", "lost"},
               {"below", "m", "%.1e", "lost"},
               {"rest at", "m", "%.1e", "lost"}});
  for (const double restitution : {0., 0.5, 0.8}) {
    const scenes::Scene scene = scenes::bounce_scene(restitution);
    const Make ours = with(engines::make_conditioned_joint);
    for (const double hz : {60, 240}) {
      table.compare(text("e = %g %gHz", restitution, hz),
                    {{"stock", [&] { return measure_bounce(scene, 1 / hz, make_collision); }},
                     {"pintle", [&] { return measure_bounce(scene, 1 / hz, ours); }}});
    }
  }
}

Measurement measure_tilt(const scenes::Scene& scene, engines::MakeJoint make_joint) {
  const measures::Outcome outcome =
      measures::run(scene, *engines::make_bullet(scene, 10, make_joint), 1. / 60);
  const double beyond = outcome[scenes::Error::overshoot];
  return {{degrees(beyond)}, beyond, microseconds_per_step(outcome)};
}

void run_tilt(Csv& csv) {
  Table table(csv, "tilt", "a leaning cube is pushed against the limit of an angle",
              {{"beyond", "deg", "%.2e", "lost"}});
  for (const double angle : {0, 20, 60, 80}) {
    const scenes::Scene scene = scenes::tilt_scene(radians(angle));
    table.compare(
        text("%g deg 60Hz", angle),
        {{"doc.", [&] { return measure_tilt(scene, engines::make_document_joint); }},
         {"pintle", [&] { return measure_tilt(scene, engines::make_conditioned_joint); }}});
  }
}

struct Scene {
  const char* name;
  void (*run)(Csv&);
};
constexpr Scene all_scenes[] = {
    {"chain", run_chain},       {"recovery", run_recovery},
    {"pendulum", run_pendulum}, {"valve", run_valve},
    {"door", run_door},         {"rope", run_rope},
    {"wedge", run_wedge},       {"slider_crank", run_slider_crank},
    {"shoulder", run_shoulder}, {"drive_shaft", run_drive_shaft},
    {"bounce", run_bounce},     {"tilt", run_tilt},
    {"unstable", run_unstable},
};

void print_help(std::FILE* out) {
  std::fprintf(out,
               "Runs the scenes with Bullet's hinge and with Pintle's, and compares them.\n"
               "  --scene NAME   only this scene; may be given more than once\n"
               "                 ");
  for (const Scene& scene : all_scenes) std::fprintf(out, "%s ", scene.name);
  std::fprintf(out,
               "\n"
               "  --csv FILE     also write every number to FILE, one a line\n"
               "                 (inf: never reached, or lost; nan: no such quantity)\n"
               "  --help         this\n");
}

void print_legend() {
  std::printf(
      "Pintle and Bullet's hinge, %s precision. A ratio below 1: better than stock;\n"
      "above 1: worse. Times are those of the world's whole step.\n"
      "  stock   btHingeConstraint; stock c. btHingeAccumulatedAngleConstraint;\n"
      "          s. cfm btHingeConstraint with the spring as ERP and CFM of its stop\n"
      "  pintle  pintle::QuaternionHinge; plain without block rows;\n"
      "          doc. with Formulation::document\n"
      "In rope, stock: sticks on btPoint2PointConstraint, and pintle::DistanceJoint;\n"
      "in wedge, stock: btGeneric6DofSpring2Constraint, and pintle::WedgeJoint;\n"
      "in bounce, stock: a collision, and pintle::ContactJoint.\n",
      sizeof(btScalar) == sizeof(double) ? "double" : "single");
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<const Scene*> chosen;
  Csv csv;
  for (int i = 1; i < argc; i += 2) {  // an option and its value
    const std::string argument = argv[i];
    if (argument == "--help") {
      print_help(stdout);
      return EXIT_SUCCESS;
    }
    const std::string value = i + 1 < argc ? argv[i + 1] : "";
    if (argument == "--scene" && !value.empty()) {
      const auto scene = std::find_if(std::begin(all_scenes), std::end(all_scenes),
                                      [&](const Scene& s) { return s.name == value; });
      if (scene == std::end(all_scenes)) {
        std::fprintf(stderr, "no scene is called %s\n", value.c_str());
        print_help(stderr);
        return EXIT_FAILURE;
      }
      chosen.push_back(scene);
    } else if (argument == "--csv" && !value.empty()) {
      if (!csv.open(value)) {
        std::fprintf(stderr, "cannot write %s\n", value.c_str());
        return EXIT_FAILURE;
      }
    } else {
      std::fprintf(stderr, "%s is not understood\n", argument.c_str());
      print_help(stderr);
      return EXIT_FAILURE;
    }
  }
  if (chosen.empty()) {
    for (const Scene& scene : all_scenes) chosen.push_back(&scene);
  }

  print_legend();
  for (const Scene* scene : chosen) scene->run(csv);
  if (!csv.close()) {
    std::fprintf(stderr, "the CSV file could not be written to its end\n");
    return EXIT_FAILURE;
  }
  return Table::all_repeated() ? EXIT_SUCCESS : EXIT_FAILURE;
}

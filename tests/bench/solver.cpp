// The exact solver beside Bullet's, with its default settings: what joints lack, what energy does, and
// what a step takes. Times are those of whole steps, in runs that took turns, the shortest of them; read
// their ratios. Usage: solver [--page FOLDER] [chains|scaling|grid|crowd|motors|tangles]...
//   --page FOLDER   also the tables of plugin/docs/exact-solver.md, a file each (solver.sh)
//   solver steps chain|tree JOINTS stock|exact STEPS   runs one of scaling's, for an instruction counter (linear.sh)
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/cone_twist_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/slider_joint.h>
#include <pintle/joints/universal_joint.h>
#include <pintle/solver/exact_joint_solver.h>

#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>
#include <BulletDynamics/MLCPSolvers/btDantzigSolver.h>
#include <BulletDynamics/MLCPSolvers/btMLCPSolver.h>

#include <engines/bullet.h>
#include <measures/crowd.h>
#include <scenes/chain.h>
#include <scenes/crowds.h>
#include <scenes/drive_shaft.h>
#include <scenes/shoulder.h>
#include <scenes/slider_crank.h>
#include <scenes/tangle.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "page_table.h"

namespace {

using bench::cell;
using pintle::ExactJointSolver;
using scenes::SolverFactory;

std::unique_ptr<btConstraintSolver> exact() { return std::make_unique<ExactJointSolver>(); }
std::unique_ptr<btConstraintSolver> exactTo(double tolerance, int max_new_factors) {
  auto solver = std::make_unique<ExactJointSolver>();
  pintle::SolverOptions options = solver->options();
  options.newton_tolerance = options.pose_tolerance = options.loose_pose_tolerance = tolerance;
  options.max_new_factors = max_new_factors;
  solver->setOptions(options);
  return solver;
}
std::unique_ptr<btConstraintSolver> toAMicrometre() {
  return exactTo(1e-6, pintle::SolverOptions().max_new_factors);
}
std::unique_ptr<btConstraintSolver> coarse() { return exactTo(1e-4, 1); }

class Dantzig : public btMLCPSolver {
 public:
  Dantzig() : btMLCPSolver(&m_dantzig) {}

 private:
  btDantzigSolver m_dantzig;
};

// Runs all in turn and keeps the shortest time of each.
template <class Result>
std::vector<Result> inTurn(const std::vector<std::function<Result()>>& runs, int rounds = 5) {
  std::vector<Result> results(runs.size());
  for (int round = 0; round < rounds; ++round) {
    for (size_t i = 0; i < runs.size(); ++i) {
      const Result now = runs[i]();
      const double before = results[i].microseconds_per_step;
      results[i] = now;
      if (round > 0) results[i].microseconds_per_step = std::min(before, now.microseconds_per_step);
    }
  }
  return results;
}

// --- the page's tables -------------------------------------------------------------------------------

bench::PageTable holds("holds",
                       {"scene", "mean gap, Bullet", "mean gap, exact", "largest gap, Bullet",
                        "largest gap, exact", "mean gap, Bullet's joints on the exact solver",
                        "time, exact / Bullet"});
bench::PageTable moves("motors", {"scene", "error", "Pintle's joints on Bullet's solver",
                                  "Pintle's joints on the exact solver"});
bench::PageTable wild("tangles", {"joints, solver", "median", "99 % are below", "most"});
bench::PageTable nets("nets", {"bodies", "joints", "options", "time, exact / Bullet",
                               "mean gap, exact", "mean gap, Bullet", "memory of a joint"});
bench::PageTable cost("scaling", {"shape", "joints", "time, exact / Bullet",
                                  "a joint's time, exact", "a joint's time, Bullet", "memory"});

// Bullet's joints on Bullet's solver, Pintle's and Bullet's on the exact one.
template <class Result>
void addHolds(const std::string& scene, const Result& stock, const Result& exact,
              const Result& exact_stock) {
  holds.add({scene, cell(stock.mean_gap, " m"), cell(exact.mean_gap, " m"),
             cell(stock.max_gap, " m"), cell(exact.max_gap, " m"), cell(exact_stock.mean_gap, " m"),
             bench::ratio(exact.microseconds_per_step / stock.microseconds_per_step)});
}

struct Each {
  double stock, exact;  // microseconds of a step, for each joint
};

// A joint's time is given over that in the smallest world of the shape.
void addCost(const char* shape, int joints, const Each& now, const Each& smallest, double bytes) {
  cost.add({shape, std::to_string(joints), bench::ratio(now.exact / now.stock),
            bench::ratio(now.exact / smallest.exact), bench::ratio(now.stock / smallest.stock),
            cell(bytes / joints / 1000, " kB")});
}

// --- chains ------------------------------------------------------------------------------------------

void chains() {
  std::printf("%-24s %-16s %9s %9s %9s %9s %9s %9s %7s %7s  tip\n", "chain", "", "mean gap",
              "max gap", "axes rad", "energy", "in step", "gain", "us/step", "ratio");
  struct Case {
    int links;
    double ratio, hz;
    const char* load;  // in words
  };
  for (const Case& c : {Case{10, 1, 60, ""},
                        {10, 1, 120, ""},
                        {10, 100, 60, ", load 100:1"},
                        {10, 1e4, 60, ", load 10 000:1"},
                        {10, 1e6, 60, ", load 1 000 000:1"},
                        {100, 1000, 240, ", load 1000:1"},
                        {100, 1e4, 60, ", load 10 000:1"}}) {
    scenes::ChainSettings stock;
    stock.links = c.links;
    stock.ratio = c.ratio;
    stock.dt = 1 / c.hz;
    scenes::ChainSettings none = stock, hundred = stock, dantzig = stock, ours = stock;
    none.iterations = 0;  // what Bullet's step takes whatever solves it
    hundred.iterations = 100;
    dantzig.make_solver = [] { return std::make_unique<Dantzig>(); };
    ours.make_solver = exact;
    using Run = std::function<scenes::ChainResult()>;
    const char* names[] = {"stock, 10", "stock, 0", "stock, 100",
                           "Dantzig",   "exact",    "exact, stock j."};
    std::vector<Run> runs = {[&] { return scenes::chain<btHingeConstraint>(stock); },
                             [&] { return scenes::chain<btHingeConstraint>(none); },
                             [&] { return scenes::chain<btHingeConstraint>(hundred); },
                             [&] { return scenes::chain<btHingeConstraint>(dantzig); },
                             [&] { return scenes::chain<pintle::QuaternionHinge>(ours); },
                             [&] { return scenes::chain<btHingeConstraint>(ours); }};
    // Dense, and cubic in the rows: minutes.
    if (c.links > 10) runs[3] = [] { return scenes::ChainResult(); };
    const auto results = inTurn(runs);
    char title[48];
    std::snprintf(title, sizeof(title), "chain of %d%s, %g Hz", c.links, c.load, c.hz);
    addHolds(title, results[0], results[4], results[5]);
    for (size_t i = 0; i < results.size(); ++i) {
      const auto& r = results[i];
      if (c.links > 10 && i == 3) continue;
      char scene[40];
      std::snprintf(scene, sizeof(scene), "chain(%d, %g, 1/%g)", c.links, c.ratio, c.hz);
      std::printf("%-24s %-16s %9.1e %9.1e %9.1e %9.1e %9.1e %+9.4f %7.1f %7.2f  %.2f %.2f %.2f\n",
                  scene, names[i], r.mean_gap, r.max_gap, r.max_axis_angle, r.max_energy_error,
                  r.in_step_energy_error, r.energy_gain, r.microseconds_per_step,
                  r.microseconds_per_step / results[0].microseconds_per_step, r.tip.x(), r.tip.y(),
                  r.tip.z());
    }
  }
}

// --- scaling ---------------------------------------------------------------------------------------

struct Measured {
  double microseconds_per_step = 0, mean_gap = 0, max_gap = 0, bytes = 0;
};

enum class Shape { chain, tree, star };
const char* nameOf(Shape shape) {
  return shape == Shape::chain ? "chain" : shape == Shape::tree ? "tree" : "star";
}

// Where body i is. A chain goes to and fro in rows of a hundred, so that it stays where single precision knows
// positions well; a binary tree branches in x, y and z by turns, each time by less, so that its bodies are apart.
Eigen::Vector3d place(int i, Shape shape) {
  const int row = i / 100, in_row = i % 100;
  if (shape == Shape::star) {  // around the first one
    const double angle = 0.06283 * in_row;
    return i == 0 ? Eigen::Vector3d(0, 0, 0)
                  : Eigen::Vector3d(8 * std::cos(angle), 8 * std::sin(angle), 2. * row);
  }
  if (shape == Shape::chain) return {double(row), 0, -0.5 - (row % 2 == 0 ? in_row : 99 - in_row)};
  if (i == 0) return {0, 0, 0};
  const int depth = int(std::floor(std::log2(i + 1.))) - 1;
  Eigen::Vector3d branch = Eigen::Vector3d::Zero();
  branch[depth % 3] = (i % 2 == 0 ? 1 : -1) * 12. / (1 << (depth / 3));
  return place((i - 1) / 2, shape) + branch;
}

// Ball joints, each half way between two bodies, hold them to the world: without gravity, which would make the
// load of a joint depend on how many there are.
template <class Ball>
Measured hang(int joints, Shape shape, const SolverFactory& make_solver, int steps,
              int iterations = 10) {
  ExactJointSolver* solver = nullptr;
  scenes::World world(0, iterations, [&] {
    auto made =
        make_solver ? make_solver() : std::make_unique<btSequentialImpulseConstraintSolver>();
    solver = dynamic_cast<ExactJointSolver*>(made.get());
    return made;
  });
  const auto parent = [shape](int i) {
    return shape == Shape::star ? 0 : shape == Shape::tree ? (i - 1) / 2 : i - 1;
  };
  const auto lever = [&](int i) -> Eigen::Vector3d {
    return (place(i, shape) - place(parent(i), shape)) / 2;
  };
  std::vector<btRigidBody*> links;
  for (int i = 0; i < joints; ++i) {
    links.push_back(&world.add_box(1, btVector3(btScalar(0.1), btScalar(0.1), btScalar(0.5)),
                                   scenes::pose_at(scenes::to_bullet(place(i, shape)))));
    if (i == 0)
      world.add_joint<Ball>(*links[0], btVector3(0, 0, btScalar(0.5)));
    else
      world.add_joint<Ball>(*links[size_t(parent(i))], *links[size_t(i)],
                            scenes::to_bullet(lever(i)), scenes::to_bullet(-lever(i)));
    links.back()->setLinearVelocity(btVector3(btScalar(0.1 * std::sin(double(i))), 0, 0));
  }
  const int warm_up = 3;
  for (int i = 0; i < warm_up; ++i) world.step(1. / 240);
  const double before = world.microseconds_per_step() * warm_up;
  for (int i = 0; i < steps; ++i) world.step(1. / 240);
  Measured result;
  result.microseconds_per_step =
      (world.microseconds_per_step() * (warm_up + steps) - before) / steps;
  result.bytes = solver ? double(solver->getMemory()) : 0;
  for (int i = 1; i < joints; ++i)
    result.max_gap =
        std::max(result.max_gap, (scenes::point_in_world(*links[size_t(parent(i))], lever(i)) -
                                  scenes::point_in_world(*links[size_t(i)], -lever(i)))
                                     .norm());
  return result;
}

Measured hang(int joints, Shape shape, bool is_exact, int steps, int iterations = 10) {
  return is_exact ? hang<pintle::BallJoint>(joints, shape, exact, steps)
                  : hang<btPoint2PointConstraint>(joints, shape, {}, steps, iterations);
}

void scaling() {
  // Without iterations Bullet's step takes what it does whatever solves it.
  std::printf("\n%-8s %8s %14s %14s %14s %8s %12s %12s\n", "", "joints", "stock us/joint",
              "0 iterations", "exact us/joint", "ratio", "bytes/joint", "gap m");
  for (const Shape shape : {Shape::chain, Shape::tree, Shape::star}) {
    Each smallest = {};
    for (const int joints : {10, 100, 1000, 10000}) {
      const int steps = std::max(5, 5000 / joints);
      const auto r = inTurn<Measured>({[&] { return hang(joints, shape, false, steps); },
                                       [&] { return hang(joints, shape, false, steps, 0); },
                                       [&] { return hang(joints, shape, true, steps); }},
                                      joints <= 1000 ? 25 : 5);
      const auto each = [&](size_t i) { return r[i].microseconds_per_step / joints; };
      std::printf("%-8s %8d %14.3f %14.3f %14.3f %8.2f %12.0f %12.1e\n", nameOf(shape), joints,
                  each(0), each(1), each(2), each(2) / each(0), r[2].bytes / joints, r[2].max_gap);
      const Each now = {each(0), each(2)};
      if (joints == 10) smallest = now;
      addCost(nameOf(shape), joints, now, smallest, r[2].bytes);
    }
  }
}

// --- a net -----------------------------------------------------------------------------------------

// size x size bodies, each tied to its neighbours by a ball joint, held at two corners.
template <class Ball>
Measured net(int size, const SolverFactory& make_solver, int& joints) {
  ExactJointSolver* solver = nullptr;
  scenes::World world(scenes::standard_gravity, 10, [&] {
    auto made =
        make_solver ? make_solver() : std::make_unique<btSequentialImpulseConstraintSolver>();
    solver = dynamic_cast<ExactJointSolver*>(made.get());
    return made;
  });
  std::vector<btRigidBody*> bodies;
  const btScalar half = btScalar(0.5);
  joints = 0;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      btRigidBody& body = world.add_box(1, btVector3(btScalar(0.4), btScalar(0.4), btScalar(0.1)),
                                        scenes::pose_at(btVector3(btScalar(x), btScalar(y), 0)));
      bodies.push_back(&body);
      if (x > 0) {
        world.add_joint<Ball>(*bodies[bodies.size() - 2], body, btVector3(half, 0, 0),
                              btVector3(-half, 0, 0));
        ++joints;
      }
      if (y > 0) {
        world.add_joint<Ball>(*bodies[bodies.size() - 1 - size_t(size)], body,
                              btVector3(0, half, 0), btVector3(0, -half, 0));
        ++joints;
      }
    }
  }
  world.add_joint<Ball>(*bodies.front(), btVector3(-half, -half, 0));
  world.add_joint<Ball>(*bodies[size_t(size) - 1], btVector3(half, -half, 0));
  joints += 2;
  Measured result;
  const int steps = 60;
  for (int i = 0; i < steps; ++i) {
    world.step(1. / 60);
    double most = 0;
    for (size_t k = 0; k < bodies.size(); ++k) {
      if (k % size_t(size) > 0)
        most = std::max(most, (scenes::point_in_world(*bodies[k - 1], {0.5, 0, 0}) -
                               scenes::point_in_world(*bodies[k], {-0.5, 0, 0}))
                                  .norm());
      if (k >= size_t(size))
        most = std::max(most, (scenes::point_in_world(*bodies[k - size_t(size)], {0, 0.5, 0}) -
                               scenes::point_in_world(*bodies[k], {0, -0.5, 0}))
                                  .norm());
    }
    result.mean_gap += most / steps;
    result.max_gap = std::max(result.max_gap, most);
  }
  result.microseconds_per_step = world.microseconds_per_step();
  result.bytes = solver ? double(solver->getMemory()) : 0;
  return result;
}

// The coarser, the cheaper: a net's joints are in loops, whose factor is what a step takes.
struct NetSetting {
  const char* name;
  SolverFactory make;
};

void grid() {
  const std::vector<NetSetting> settings = {{"default", exact},
                                            {"tolerances of 1e-6 m", toAMicrometre},
                                            {"tolerances of 1e-4 m, `max_new_factors` 1", coarse}};
  std::printf("\n%-10s %8s %-44s %14s %14s %8s %12s %12s %12s\n", "net", "joints", "",
              "stock us/joint", "exact us/joint", "ratio", "bytes/joint", "stock gap m",
              "exact gap m");
  for (const int size : {5, 10, 20, 30, 100}) {
    int joints = 0;
    std::vector<std::function<Measured()>> runs = {
        [&] { return net<btPoint2PointConstraint>(size, {}, joints); }};
    for (const NetSetting& setting : settings)
      runs.push_back([&] { return net<pintle::BallJoint>(size, setting.make, joints); });
    if (size == 30)
      runs.push_back([&] { return net<btPoint2PointConstraint>(size, exact, joints); });
    const auto r = inTurn<Measured>(runs, size < 100 ? 5 : 1);
    const Measured& stock = r[0];
    for (size_t i = 0; i < settings.size(); ++i) {
      const Measured& of = r[1 + i];
      const double ratio = of.microseconds_per_step / stock.microseconds_per_step;
      nets.add({std::to_string(size) + " x " + std::to_string(size), std::to_string(joints),
                settings[i].name, bench::ratio(ratio), cell(of.mean_gap, " m"),
                cell(stock.mean_gap, " m"), cell(of.bytes / joints / 1000, " kB")});
      std::printf("%3d x %-4d %8d %-44s %14.3f %14.3f %8.2f %12.0f %12.1e %12.1e\n", size, size,
                  joints, settings[i].name, stock.microseconds_per_step / joints,
                  of.microseconds_per_step / joints, ratio, of.bytes / joints, stock.mean_gap,
                  of.mean_gap);
    }
    if (size == 30)
      addHolds("net of 30 x 30 bodies, " + std::to_string(joints) + " ball joints", stock, r[1],
               r.back());
  }
}

// --- among contacts --------------------------------------------------------------------------------

void print(const char* scene, const char* who, const measures::CrowdResult& r,
           const measures::CrowdResult& stock) {
  std::printf("%-10s %-16s %7d %9.1e %9.1e %10.1e %9.1e %8.2f %8.2f %9.0f %6.2f\n", scene, who,
              r.joints, r.mean_gap, r.max_gap, r.mean_penetration, r.end_kinetic, r.lowest,
              r.travel, r.microseconds_per_step,
              r.microseconds_per_step / stock.microseconds_per_step);
}

void crowd() {
  std::printf("\n%-10s %-16s %7s %9s %9s %10s %9s %8s %8s %9s %6s\n", "", "", "joints", "mean gap",
              "max gap", "deepest", "end J", "lowest", "travel", "us/step", "ratio");
  const struct {
    const char *name, *title;
    scenes::Scene scene;
  } all[] = {{"ragdolls", "pile of 50 ragdolls", scenes::ragdoll_pile_scene()},
             {"bridge", "bridge of 100 planks, a load of 100 planks dropped on it",
              scenes::loaded_bridge_scene()},
             {"track", "closed track of 200 links around two wheels", scenes::track_scene()}};
  for (const auto& [name, title, scene] : all) {
    const auto with = [&scene = scene](engines::MakeJoint make_joint, const SolverFactory& solver) {
      return [&scene, make_joint, solver] {
        return measures::run_crowd(scene, *engines::make_bullet(scene, 10, make_joint, solver));
      };
    };
    const auto results = inTurn<measures::CrowdResult>(
        {with(engines::make_stock_joint, {}), with(engines::make_conditioned_joint, exact),
         with(engines::make_stock_joint, exact)});
    addHolds(title, results[0], results[1], results[2]);
    const char* names[] = {"stock, 10", "exact", "exact, stock j."};
    for (size_t i = 0; i < results.size(); ++i) print(name, names[i], results[i], results[0]);
  }
}

// --- motors and limits -------------------------------------------------------------------------------

// Where nothing touches.
void motors() {
  std::printf("\n%-44s %-36s %12s %12s\n", "", "", "pintle, 10", "exact");
  const auto compare = [](const char* scene, const char* error, const char* unit, double bullets,
                          double ours) {
    std::printf("%-44s %-36s %12.1e %12.1e\n", scene, error, bullets, ours);
    moves.add({scene, error, cell(bullets, unit), cell(ours, unit)});
  };
  const auto both = [](auto run, auto settings) {
    const auto bullets = run(settings);
    settings.make_solver = exact;
    return std::make_pair(bullets, run(settings));
  };
  const auto crank = both(
      [](const scenes::SliderCrankSettings& settings) {
        return scenes::slider_crank<pintle::QuaternionHinge, pintle::BallJoint,
                                    pintle::SliderJoint>(settings);
      },
      scenes::SliderCrankSettings());
  compare("slider-crank", "the piston from its closed form", " m", crank.first.max_piston_error,
          crank.second.max_piston_error);
  compare("slider-crank", "the crank from its motor's speed", " rad", crank.first.max_crank_error,
          crank.second.max_crank_error);
  const auto shaft =
      both(scenes::drive_shaft<pintle::UniversalJoint>, scenes::DriveShaftSettings());
  compare("shafts at 30°, 300 rpm, a universal joint", "the second shaft from its closed form",
          " rad", shaft.first.universal_error, shaft.second.universal_error);
  const auto arm = both(
      [](const scenes::ShoulderSettings& settings) {
        return scenes::shoulder<pintle::ConeTwistJoint>(settings);
      },
      scenes::ShoulderSettings());
  compare("an arm thrown at its cone", "how far beyond it", " rad",
          std::max(arm.first.swing_beyond, 0.), std::max(arm.second.swing_beyond, 0.));
}

// --- tangles -----------------------------------------------------------------------------------------

// Largest speed (m/s) or spin (5 rad/s) of each tangle over what is no matter there: stock's, or 20.
void tangles() {
  constexpr unsigned count = 1000;
  using scenes::PintleJoints;
  using scenes::StockJoints;
  const char* names[] = {"pintle, 10", "exact, stock j.", "exact"};
  const char* titles[] = {"Pintle's joints on Bullet's solver",
                          "Bullet's joints on the exact solver",
                          "Pintle's joints on the exact solver"};
  std::vector<double> wildness[3];
  for (unsigned seed = 0; seed < count; ++seed) {
    const auto speed = [](const scenes::TangleResult& result) {
      return result.finite ? std::max(result.speed, result.spin / 5) : HUGE_VAL;
    };
    const double usual = std::max(speed(scenes::tangle<StockJoints>(seed)), 20.);
    wildness[0].push_back(speed(scenes::tangle<PintleJoints>(seed)) / usual);
    wildness[1].push_back(speed(scenes::tangle<StockJoints>(seed, exact)) / usual);
    wildness[2].push_back(speed(scenes::tangle<PintleJoints>(seed, exact)) / usual);
  }
  std::printf("\n%-16s %8s  %8s  %8s  (of %u tangles, fastest body over stock's)\n", "", "median",
              "99 %", "largest", count);
  for (size_t i = 0; i < 3; ++i) {
    std::sort(wildness[i].begin(), wildness[i].end());
    std::printf("%-16s %8.2f  %8.2f  %8.2f\n", names[i], wildness[i][count / 2],
                wildness[i][count * 99 / 100], wildness[i].back());
    wild.add({titles[i], cell(wildness[i][count / 2]), cell(wildness[i][count * 99 / 100]),
              cell(wildness[i].back())});
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 6 && std::strcmp(argv[1], "steps") == 0) {
    hang(std::atoi(argv[3]), std::strcmp(argv[2], "tree") == 0 ? Shape::tree : Shape::chain,
         std::strcmp(argv[4], "exact") == 0, std::atoi(argv[5]));
    return 0;
  }
  const struct {
    const char* name;
    void (*run)();
  } parts[] = {{"chains", chains}, {"scaling", scaling}, {"grid", grid},
               {"crowd", crowd},   {"motors", motors},   {"tangles", tangles}};
  const bool has_page = argc > 2 && std::strcmp(argv[1], "--page") == 0;
  const int first = has_page ? 3 : 1;
  std::printf("%s precision\n", sizeof(btScalar) == sizeof(double) ? "double" : "single");
  for (const auto& part : parts) {
    bool wanted = argc == first;
    for (int i = first; i < argc; ++i) wanted = wanted || std::strcmp(argv[i], part.name) == 0;
    if (wanted) part.run();
  }
  if (!has_page) return 0;
  for (const bench::PageTable* table : {&holds, &moves, &wild, &cost, &nets})
    if (!table->write(argv[2])) {
      std::fprintf(stderr, "solver: cannot write to %s\n", argv[2]);
      return 1;
    }
  return 0;
}

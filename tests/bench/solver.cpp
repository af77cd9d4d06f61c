// The exact solver beside Bullet's, with its default settings: what joints lack, what energy does, and
// what a step takes. Times are those of whole steps, in runs that took turns, the shortest of them; read
// their ratios. Usage: solver [chains|scaling|grid|crowd|tangles]...
//   solver steps chain|tree JOINTS stock|exact STEPS   runs one of scaling's, for an instruction counter (linear.sh)
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/cone_twist_joint.h>
#include <pintle/joints/fixed_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/slider_joint.h>
#include <pintle/solver/exact_joint_solver.h>

#include <BulletDynamics/ConstraintSolver/btConeTwistConstraint.h>
#include <BulletDynamics/ConstraintSolver/btFixedConstraint.h>
#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>
#include <BulletDynamics/ConstraintSolver/btSliderConstraint.h>
#include <BulletDynamics/MLCPSolvers/btDantzigSolver.h>
#include <BulletDynamics/MLCPSolvers/btMLCPSolver.h>

#include <scenes/chain.h>
#include <scenes/crowd.h>
#include <scenes/tangle.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

namespace {

using pintle::ExactJointSolver;
using scenes::SolverFactory;

constexpr int rounds = 5;

std::unique_ptr<btConstraintSolver> exact() { return std::make_unique<ExactJointSolver>(); }

class Dantzig : public btMLCPSolver {
 public:
  Dantzig() : btMLCPSolver(&m_dantzig) {}

 private:
  btDantzigSolver m_dantzig;
};

// Runs all in turn and keeps the shortest time of each.
template <class Result>
std::vector<Result> inTurn(const std::vector<std::function<Result()>>& runs) {
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

void chains() {
  std::printf("%-24s %-16s %9s %9s %9s %9s %9s %9s %7s %7s  tip\n", "chain", "", "mean gap",
              "max gap", "axes rad", "energy", "in step", "gain", "us/step", "ratio");
  struct Case {
    int links;
    double ratio, hz;
  };
  for (const Case& c : {Case{10, 1, 60},
                        {10, 1, 120},
                        {10, 100, 60},
                        {10, 1e4, 60},
                        {10, 1e6, 60},
                        {100, 1000, 240},
                        {100, 1e4, 60}}) {
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
  double microseconds_per_step = 0, gap = 0, bytes = 0;
};

// Where body i of a chain or of a binary tree is. A chain goes to and fro in rows of a hundred, so that it stays
// where single precision knows positions well; a tree branches in x, y and z by turns, each time by less, so that
// its bodies are apart.
Eigen::Vector3d place(int i, bool tree) {
  const int row = i / 100, in_row = i % 100;
  if (!tree) return {double(row), 0, -0.5 - (row % 2 == 0 ? in_row : 99 - in_row)};
  if (i == 0) return {0, 0, 0};
  const int depth = int(std::floor(std::log2(i + 1.))) - 1;
  Eigen::Vector3d branch = Eigen::Vector3d::Zero();
  branch[depth % 3] = (i % 2 == 0 ? 1 : -1) * 12. / (1 << (depth / 3));
  return place((i - 1) / 2, tree) + branch;
}

// Ball joints, each half way between two bodies, hold them to the world: without gravity, which would make the
// load of a joint depend on how many there are.
template <class Ball>
Measured hang(int joints, bool tree, const SolverFactory& make_solver, int steps,
              int iterations = 10) {
  ExactJointSolver* solver = nullptr;
  scenes::World world(0, iterations, [&] {
    auto made =
        make_solver ? make_solver() : std::make_unique<btSequentialImpulseConstraintSolver>();
    solver = dynamic_cast<ExactJointSolver*>(made.get());
    return made;
  });
  const auto parent = [tree](int i) { return tree ? (i - 1) / 2 : i - 1; };
  const auto lever = [&](int i) -> Eigen::Vector3d {
    return (place(i, tree) - place(parent(i), tree)) / 2;
  };
  std::vector<btRigidBody*> links;
  for (int i = 0; i < joints; ++i) {
    links.push_back(&world.add_box(1, btVector3(btScalar(0.1), btScalar(0.1), btScalar(0.5)),
                                   scenes::pose_at(scenes::to_bullet(place(i, tree)))));
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
    result.gap = std::max(result.gap, (scenes::point_in_world(*links[size_t(parent(i))], lever(i)) -
                                       scenes::point_in_world(*links[size_t(i)], -lever(i)))
                                          .norm());
  return result;
}

Measured hang(int joints, bool tree, bool is_exact, int steps, int iterations = 10) {
  return is_exact ? hang<pintle::BallJoint>(joints, tree, exact, steps)
                  : hang<btPoint2PointConstraint>(joints, tree, {}, steps, iterations);
}

void scaling() {
  // Without iterations Bullet's step takes what it does whatever solves it.
  std::printf("\n%-8s %8s %14s %14s %14s %8s %12s %12s\n", "", "joints", "stock us/joint",
              "0 iterations", "exact us/joint", "ratio", "bytes/joint", "gap m");
  for (const bool tree : {false, true}) {
    for (const int joints : {10, 100, 1000, 10000}) {
      const int steps = std::max(5, 5000 / joints);
      const auto r = inTurn<Measured>({[&] { return hang(joints, tree, false, steps); },
                                       [&] { return hang(joints, tree, false, steps, 0); },
                                       [&] { return hang(joints, tree, true, steps); }});
      const auto each = [&](size_t i) { return r[i].microseconds_per_step / joints; };
      std::printf("%-8s %8d %14.3f %14.3f %14.3f %8.2f %12.0f %12.1e\n", tree ? "tree" : "chain",
                  joints, each(0), each(1), each(2), each(2) / each(0), r[2].bytes / joints,
                  r[2].gap);
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
    result.gap += most / steps;
  }
  result.microseconds_per_step = world.microseconds_per_step();
  result.bytes = solver ? double(solver->getMemory()) : 0;
  return result;
}

void grid() {
  std::printf("\n%-14s %8s %14s %14s %8s %12s %12s %12s\n", "net", "joints", "stock us/joint",
              "exact us/joint", "ratio", "bytes/joint", "stock gap m", "exact gap m");
  for (const int size : {5, 10, 20, 30}) {
    int joints = 0;
    const auto r = inTurn<Measured>({[&] { return net<btPoint2PointConstraint>(size, {}, joints); },
                                     [&] { return net<pintle::BallJoint>(size, exact, joints); }});
    std::printf("%3d x %-8d %8d %14.3f %14.3f %8.2f %12.0f %12.1e %12.1e\n", size, size, joints,
                r[0].microseconds_per_step / joints, r[1].microseconds_per_step / joints,
                r[1].microseconds_per_step / r[0].microseconds_per_step, r[1].bytes / joints,
                r[0].gap, r[1].gap);
  }
}

// --- among contacts --------------------------------------------------------------------------------

void print(const char* scene, const char* who, const scenes::CrowdResult& r,
           const scenes::CrowdResult& stock) {
  std::printf("%-10s %-16s %7d %9.1e %9.1e %10.1e %9.1e %8.2f %8.2f %9.0f %6.2f\n", scene, who,
              r.joints, r.mean_gap, r.max_gap, r.mean_penetration, r.end_kinetic, r.lowest,
              r.travel, r.microseconds_per_step,
              r.microseconds_per_step / stock.microseconds_per_step);
}

void crowd() {
  std::printf("\n%-10s %-16s %7s %9s %9s %10s %9s %8s %8s %9s %6s\n", "", "", "joints", "mean gap",
              "max gap", "deepest", "end J", "lowest", "travel", "us/step", "ratio");
  scenes::CrowdSettings stock, ours;
  ours.make_solver = exact;
  using Run = std::function<scenes::CrowdResult()>;
  using scenes::bridge;
  using scenes::ragdolls;
  using scenes::track;
  struct Scene {
    const char* name;
    std::vector<Run> runs;
  };
  const Scene all[] = {
      {"ragdolls",
       {[&] { return ragdolls<btHingeConstraint, btConeTwistConstraint>(stock); },
        [&] { return ragdolls<pintle::QuaternionHinge, pintle::ConeTwistJoint>(ours); },
        [&] { return ragdolls<btHingeConstraint, btConeTwistConstraint>(ours); }}},
      {"bridge",
       {[&] { return bridge<btHingeConstraint>(stock); },
        [&] { return bridge<pintle::QuaternionHinge>(ours); },
        [&] { return bridge<btHingeConstraint>(ours); }}},
      {"track",
       {[&] { return track<btHingeConstraint>(stock); },
        [&] { return track<pintle::QuaternionHinge>(ours); },
        [&] { return track<btHingeConstraint>(ours); }}}};
  for (const Scene& scene : all) {
    const auto results = inTurn(scene.runs);
    const char* names[] = {"stock, 10", "exact", "exact, stock j."};
    for (size_t i = 0; i < results.size(); ++i) print(scene.name, names[i], results[i], results[0]);
  }
}

// Largest speed (m/s) or spin (5 rad/s) of each tangle over what is no matter there: stock's, or 20.
void tangles() {
  constexpr unsigned count = 1000;
  scenes::CrowdSettings stock, ours;
  ours.make_solver = exact;
  const auto ofStock = [](const scenes::CrowdSettings& settings, unsigned seed) {
    return scenes::tangle<btHingeConstraint, btConeTwistConstraint, btSliderConstraint,
                          btFixedConstraint>(settings, seed);
  };
  const auto ofPintle = [](const scenes::CrowdSettings& settings, unsigned seed) {
    return scenes::tangle<pintle::QuaternionHinge, pintle::ConeTwistJoint, pintle::SliderJoint,
                          pintle::FixedJoint>(settings, seed);
  };
  const char* names[] = {"pintle, 10", "exact, stock j.", "exact"};
  std::vector<double> wildness[3];
  for (unsigned seed = 0; seed < count; ++seed) {
    const auto speed = [](const scenes::TangleResult& result) {
      return result.finite ? std::max(result.speed, result.spin / 5) : HUGE_VAL;
    };
    const double usual = std::max(speed(ofStock(stock, seed)), 20.);
    wildness[0].push_back(speed(ofPintle(stock, seed)) / usual);
    wildness[1].push_back(speed(ofStock(ours, seed)) / usual);
    wildness[2].push_back(speed(ofPintle(ours, seed)) / usual);
  }
  std::printf("\n%-16s %8s  %8s  %8s  (of %u tangles, fastest body over stock's)\n", "", "median",
              "99 %", "largest", count);
  for (size_t i = 0; i < 3; ++i) {
    std::sort(wildness[i].begin(), wildness[i].end());
    std::printf("%-16s %8.2f  %8.2f  %8.2f\n", names[i], wildness[i][count / 2],
                wildness[i][count * 99 / 100], wildness[i].back());
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 6 && std::strcmp(argv[1], "steps") == 0) {
    hang(std::atoi(argv[3]), std::strcmp(argv[2], "tree") == 0, std::strcmp(argv[4], "exact") == 0,
         std::atoi(argv[5]));
    return 0;
  }
  const struct {
    const char* name;
    void (*run)();
  } parts[] = {{"chains", chains},
               {"scaling", scaling},
               {"grid", grid},
               {"crowd", crowd},
               {"tangles", tangles}};
  std::printf("%s precision\n", sizeof(btScalar) == sizeof(double) ? "double" : "single");
  for (const auto& part : parts) {
    bool wanted = argc == 1;
    for (int i = 1; i < argc; ++i) wanted = wanted || std::strcmp(argv[i], part.name) == 0;
    if (wanted) part.run();
  }
}

// How a step grows with its joints: chains, trees, stars, and nets.
#include <pintle/joints/ball_joint.h>

#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>

#include <cmath>
#include <cstdio>

#include "solver_bench.h"

namespace solver_bench {
namespace {

using bench::cell;
using pintle::ExactJointSolver;
using scenes::SolverFactory;

std::unique_ptr<btConstraintSolver> coarse() { return exactTo(1e-4, 1); }

struct Each {
  double stock, exact;  // microseconds of a step, for each joint
};

// A joint's time is given over that in the smallest world of the shape.
void addCost(const char* shape, int joints, const Each& now, const Each& smallest, double bytes) {
  cost.add({shape, std::to_string(joints), bench::ratio(now.exact / now.stock),
            bench::ratio(now.exact / smallest.exact), bench::ratio(now.stock / smallest.stock),
            cell(bytes / joints / 1000, " kB")});
}

enum class Shape { chain, tree, star };
const char* nameOf(Shape shape) {
  return shape == Shape::chain ? "chain" : shape == Shape::tree ? "tree" : "star";
}

// Where body i is. A chain goes to and fro in rows of a hundred, and 32 rows are a layer: so it stays where single precision knows
// positions well, and Bullet's tree of boxes does not become a list. A binary tree branches in x, y and z by turns, each time by
// less, so that its bodies are apart.
Eigen::Vector3d place(int i, Shape shape) {
  const int row = i / 100, in_row = i % 100;
  if (shape == Shape::star) {  // around the first one
    const double angle = 0.06283 * in_row;
    return i == 0 ? Eigen::Vector3d(0, 0, 0)
                  : Eigen::Vector3d(8 * std::cos(angle), 8 * std::sin(angle), 2. * row);
  }
  if (shape == Shape::chain) {
    const int layer = row / 32, in_layer = row % 32;
    return {double(layer % 2 == 0 ? in_layer : 31 - in_layer), double(layer),
            -0.5 - (row % 2 == 0 ? in_row : 99 - in_row)};
  }
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
  Measured result;
  result.joints = joints;
  for (int i = 0; i < steps; ++i) timedStep([&] { world.step(1. / 240); }, result);
  result.bytes = solver ? double(solver->getMemory()) : 0;
  for (int i = 1; i < joints; ++i)
    result.max_gap =
        std::max(result.max_gap, (scenes::point_in_world(*links[size_t(parent(i))], lever(i)) -
                                  scenes::point_in_world(*links[size_t(i)], -lever(i)))
                                     .norm());
  result.mean_gap = result.max_gap;  // of the end alone
  return result;
}

Measured hang(int joints, Shape shape, bool is_exact, int steps, int iterations = 10) {
  return is_exact ? hang<pintle::BallJoint>(joints, shape, exact, steps)
                  : hang<btPoint2PointConstraint>(joints, shape, {}, steps, iterations);
}

std::vector<int> sizes(Shape shape) {
  if (shape == Shape::star) return {10, 100, 300, 1000, 10000};
  return {10, 100, 1000, 10000, 100000};
}

}  // namespace

void scaling() {
  // Without iterations Bullet's step takes what it does whatever solves it.
  std::printf("\n%-8s %8s %14s %14s %14s %8s %12s %12s\n", "", "joints", "stock us/joint",
              "0 iterations", "exact us/joint", "ratio", "bytes/joint", "gap m");
  for (const Shape shape : {Shape::chain, Shape::tree, Shape::star}) {
    Each smallest = {};
    for (const int joints : sizes(shape)) {
      const int steps = std::max(5, 5000 / joints);
      const auto r = inTurn<Measured>({[&] { return hang(joints, shape, false, steps); },
                                       [&] { return hang(joints, shape, false, steps, 0); },
                                       [&] { return hang(joints, shape, true, steps); }},
                                      joints <= 1000    ? 25
                                      : joints <= 10000 ? 5
                                                        : 2);
      const auto each = [&](size_t i) { return r[i].microseconds_per_step / joints; };
      std::printf("%-8s %8d %14.3f %14.3f %14.3f %8.2f %12.0f %12.1e\n", nameOf(shape), joints,
                  each(0), each(1), each(2), each(2) / each(0), r[2].bytes / joints, r[2].max_gap);
      const Each now = {each(0), each(2)};
      if (joints == 10) smallest = now;
      addCost(nameOf(shape), joints, now, smallest, r[2].bytes);
    }
  }
}

Measured hang(const std::string& shape, int joints, bool is_exact, int steps) {
  for (const Shape of : {Shape::chain, Shape::tree, Shape::star})
    if (shape == nameOf(of)) return hang(joints, of, is_exact, steps);
  return {};
}

namespace {

// --- a net -----------------------------------------------------------------------------------------

// size x size bodies, each tied to its neighbours by a ball joint, held at two corners.
template <class Ball>
Measured net(int size, const SolverFactory& make_solver, int steps = 60) {
  ExactJointSolver* solver = nullptr;
  scenes::World world(scenes::standard_gravity, 10, [&] {
    auto made =
        make_solver ? make_solver() : std::make_unique<btSequentialImpulseConstraintSolver>();
    solver = dynamic_cast<ExactJointSolver*>(made.get());
    return made;
  });
  std::vector<btRigidBody*> bodies;
  const btScalar half = btScalar(0.5);
  Measured result;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      btRigidBody& body = world.add_box(1, btVector3(btScalar(0.4), btScalar(0.4), btScalar(0.1)),
                                        scenes::pose_at(btVector3(btScalar(x), btScalar(y), 0)));
      bodies.push_back(&body);
      if (x > 0) {
        world.add_joint<Ball>(*bodies[bodies.size() - 2], body, btVector3(half, 0, 0),
                              btVector3(-half, 0, 0));
        ++result.joints;
      }
      if (y > 0) {
        world.add_joint<Ball>(*bodies[bodies.size() - 1 - size_t(size)], body,
                              btVector3(0, half, 0), btVector3(0, -half, 0));
        ++result.joints;
      }
    }
  }
  world.add_joint<Ball>(*bodies.front(), btVector3(-half, -half, 0));
  world.add_joint<Ball>(*bodies[size_t(size) - 1], btVector3(half, -half, 0));
  result.joints += 2;
  for (int i = 0; i < steps; ++i) {
    timedStep([&] { world.step(1. / 60); }, result);
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
  result.bytes = solver ? double(solver->getMemory()) : 0;
  return result;
}

// The coarser, the cheaper: a net's joints are in loops, whose factor is what a step takes.
struct NetSetting {
  const char* name;
  SolverFactory make;
};

}  // namespace

Measured net(int size, NetBy by, int steps) {
  switch (by) {
    case NetBy::stock: return net<btPoint2PointConstraint>(size, {}, steps);
    case NetBy::default_options: return net<pintle::BallJoint>(size, exact, steps);
    case NetBy::to_a_micrometre: return net<pintle::BallJoint>(size, toAMicrometre, steps);
    case NetBy::one_factor: break;
  }
  return net<pintle::BallJoint>(size, coarse, steps);
}

void grid() {
  const std::vector<NetSetting> settings = {{"default", exact},
                                            {"tolerances of 1e-6 m", toAMicrometre},
                                            {"tolerances of 1e-4 m, `max_factors` 1", coarse}};
  std::printf("\n%-10s %8s %-44s %14s %14s %8s %12s %12s %12s\n", "net", "joints", "",
              "stock us/joint", "exact us/joint", "ratio", "bytes/joint", "stock gap m",
              "exact gap m");
  for (const int size : {5, 10, 20, 30, 100}) {
    std::vector<std::function<Measured()>> runs = {
        [&] { return net<btPoint2PointConstraint>(size, {}); }};
    for (const NetSetting& setting : settings)
      runs.push_back([&] { return net<pintle::BallJoint>(size, setting.make); });
    if (size == 30) runs.push_back([&] { return net<btPoint2PointConstraint>(size, exact); });
    const auto r = inTurn<Measured>(runs, size < 100 ? 5 : 1);
    const Measured& stock = r[0];
    const int joints = stock.joints;
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

}  // namespace solver_bench

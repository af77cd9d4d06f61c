// Who is joined to whom: graphs of bodies and joints for tests of the solvers' equations.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "support.h"

namespace joint_graphs {

using support::Random;
/// The bodies of a joint; -1: the ground.
using Joint = std::array<int, 2>;

struct Graph {
  std::string name;
  int bodies;
  std::vector<Joint> joints;
};

/// From -1 to 1.
inline Eigen::MatrixXd numbers(int rows, int columns, Random& random) {
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return random.uniform(-1, 1); });
}
inline int below(Random& random, int n) { return std::min(int(random.uniform(0, n)), n - 1); }

inline Graph chain(int bodies) {
  Graph graph{"chain of " + std::to_string(bodies), bodies, {}};
  for (int i = 0; i + 1 < bodies; ++i) graph.joints.push_back({i, i + 1});
  return graph;
}

inline Graph ring(int bodies) {
  Graph graph = chain(bodies);
  graph.name = "ring of " + std::to_string(bodies);
  graph.joints.push_back({bodies - 1, 0});
  return graph;
}

// Its hub is neither the first body nor the last one.
inline Graph star(int leaves) {
  Graph graph{"star of " + std::to_string(leaves), leaves + 1, {}};
  const int hub = leaves / 2;
  for (int i = 0; i <= leaves; ++i)
    if (i < hub)
      graph.joints.push_back({i, hub});
    else if (i > hub)
      graph.joints.push_back({hub, i});
  return graph;
}

inline Graph tree(int bodies, Random& random) {
  Graph graph{"tree of " + std::to_string(bodies), bodies, {}};
  for (int i = 1; i < bodies; ++i) {
    const int parent = below(random, i);
    graph.joints.push_back(below(random, 2) ? Joint{i, parent} : Joint{parent, i});
  }
  return graph;
}

inline Graph net(int side) {
  Graph graph{"net of " + std::to_string(side), side * side, {}};
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      if (j + 1 < side) graph.joints.push_back({i * side + j, i * side + j + 1});
      if (i + 1 < side) graph.joints.push_back({(i + 1) * side + j, i * side + j});
    }
  return graph;
}

// A sixth of the joints is to the ground, on either side.
inline Graph anyGraph(int bodies, int joints, Random& random) {
  Graph graph{"any of " + std::to_string(bodies) + " with " + std::to_string(joints), bodies, {}};
  for (int c = 0; c < joints; ++c) {
    const int a = below(random, bodies), b = (a + 1 + below(random, bodies - 1)) % bodies;
    switch (below(random, 12)) {
      case 0: graph.joints.push_back({-1, a}); break;
      case 1: graph.joints.push_back({a, -1}); break;
      default: graph.joints.push_back({a, b});
    }
  }
  return graph;
}

inline Graph with(Graph graph, const std::string& what, const std::vector<Joint>& joints) {
  graph.name += ", " + what;
  graph.joints.insert(graph.joints.end(), joints.begin(), joints.end());
  return graph;
}

// Two that have nothing to do with each other, and three bodies without joints: between, before, and behind.
inline Graph apart(const Graph& one, const Graph& other) {
  Graph graph{one.name + " and " + other.name, one.bodies + other.bodies + 3, {}};
  const auto add = [&](const Graph& part, int first) {
    for (Joint joint : part.joints) {
      for (int& body : joint)
        if (body >= 0) body += first;
      graph.joints.push_back(joint);
    }
  };
  add(one, 1);
  add(other, one.bodies + 2);
  return graph;
}

// What eliminates without loops.
inline std::vector<Graph> trees() {
  Random random(1);
  std::vector<Graph> all = {chain(1), chain(2), chain(9), star(3), star(17)};
  for (const int bodies : {5, 12, 30}) all.push_back(tree(bodies, random));
  all.push_back(with(chain(5), "hung at an end", {{-1, 0}}));
  all.push_back(with(chain(5), "hung in the middle", {{2, -1}}));
  all.push_back(apart(star(4), with(chain(4), "hung", {{3, -1}})));
  return all;
}

inline std::vector<Graph> loops() {
  Random random(2);
  std::vector<Graph> all = {ring(3), ring(10)};
  for (int side = 3; side <= 6; ++side) all.push_back(net(side));
  all.push_back(with(net(4), "hung at corners", {{-1, 0}, {15, -1}}));
  all.push_back(with(chain(6), "held at both ends", {{-1, 0}, {5, -1}}));
  all.push_back(with(chain(4), "one joint doubled", {{2, 1}}));
  all.push_back(with(chain(1), "held twice", {{-1, 0}, {0, -1}}));
  all.push_back(with(ring(5), "with a branch", {{2, -1}}));
  all.push_back(apart(ring(4), net(3)));
  all.push_back(apart(tree(6, random), ring(3)));
  for (int i = 0; i < 10; ++i) all.push_back(anyGraph(8 + i, 8 + 2 * i, random));
  return all;
}

}  // namespace joint_graphs

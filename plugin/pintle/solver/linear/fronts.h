// Purpose: a direct solver for the equations of bodies and joints. It knows neither: the unknowns are those of `bodies`, six
// each, and of `joints`, which each couple one body or two. Multifrontal LU (Duff and Reid 1983): a front is a small dense
// matrix of the unknowns that it eliminates, and of those that they are coupled to, its boundary.
//
// Trees go from the leaves to the root, a body together with the joint that holds it (Baraff 1996): no fill-in, however many
// joints a body has. What is left are loops. There all bodies go first, so that what remains is J H^-1 G^T of the joints, which
// has no zero pivots, in the order of minimum degree.
#pragma once

#include <pintle/precision.h>

#include <array>
#include <vector>

namespace pintle {
inline namespace PINTLE_PRECISION {

class Fronts {
 public:
  static constexpr int body_size = 6;

  /// The bodies of a joint; -1: one that is no unknown. Not both.
  using Joint = std::array<int, 2>;

  /// Symbolic: depends on who is coupled to whom alone. Allocates.
  void analyse(int bodies, const std::vector<Joint>& joints);
  /// The number of unknowns of each joint, which may change from step to step. Must be called after analyse.
  void setSizes(const std::vector<int>& joint_sizes);

  int bodies() const { return int(m_body_front.size()); }
  int size() const { return m_unknowns; }
  /// Where the unknowns of a body and of a joint begin in a vector of all.
  int body(int i) const { return m_first[size_t(i)]; }
  int joint(int c) const { return m_first[size_t(bodies() + c)]; }

  /// A block of the matrix: element (i, j) is at[i * stride + j].
  struct Block {
    double* at;
    int stride;
  };
  /// Sets the matrix to zero. Then add to its blocks, and factorise.
  void clear();
  Block bodyBlock(int i);
  Block jointBlock(int c);
  /// Joint c, and body `side` (0 or 1) of it: rows of the joint, columns of the body; and the other way round.
  Block jointBodyBlock(int c, int side);
  Block bodyJointBlock(int c, int side);
  /// Whether the joint was not eliminated together with a body.
  bool isInLoop(int c) const { return m_fronts[size_t(m_joint_front[size_t(c)])].is_of_loop; }
  /// Whether there is a place where the two bodies of the joint meet: not in a loop.
  bool couplesBodies(int c) const;
  /// Rows of body `side`, columns of the other one.
  Block bodyBodyBlock(int c, int side);

  /// Pivots are sought within a front. A smaller one than `least_pivot` becomes that: of an unknown that others determine
  /// (Li and Demmel 1998). Returns false if one is zero or not finite.
  bool factorise(double least_pivot);
  /// x = A^-1 x.
  void solve(double* x) const;

  /// What a factor costs, in solves.
  double solvesOfFactor() const { return m_solves_of_factor; }
  size_t bytes() const;

 private:
  struct Front {
    int own_nodes, nodes;    ///< numbers of nodes: eliminated here, and all
    int first_node;          ///< of its nodes in m_nodes
    bool is_of_loop;         ///< its own nodes are joints
    int parent;              ///< -1: none
    int own, all;            ///< unknowns
    size_t first_unknown;    ///< of its list in m_unknown
    size_t first_in_parent;  ///< of its boundary's places in the parent, in m_in_parent
    size_t matrix;           ///< row by row
    int pivots;              ///< of its own unknowns, in m_pivot
  };
  struct Place {
    int front, body, joint;  ///< where the nodes begin in the front
  };

  int nodeSize(int node) const { return m_size[size_t(node)]; }
  void peelTrees(const std::vector<Joint>& joints, std::vector<std::vector<int>>& incident,
                 std::vector<char>& done);
  void orderLoops(const std::vector<Joint>& joints, const std::vector<std::vector<int>>& incident,
                  const std::vector<char>& done);
  void addFront(const std::vector<int>& own, const std::vector<int>& boundary);
  void linkFronts();
  Place find(int front, int body, int joint) const;
  double* matrix(const Front& front) { return m_numbers.data() + front.matrix; }
  const double* matrix(const Front& front) const { return m_numbers.data() + front.matrix; }
  void addToParent(const Front& front);
  bool eliminate(const Front& front, double least_pivot);

  std::vector<Joint> m_joints;
  std::vector<Front> m_fronts;  ///< in the order of elimination
  std::vector<int> m_nodes;     ///< of all fronts; a node: a body, or bodies() + a joint
  std::vector<int> m_body_front, m_joint_front;  ///< by which each is eliminated
  std::vector<int> m_size, m_first;              ///< of each node: unknowns, and where they begin
  std::vector<std::array<Place, 2>> m_places;    ///< of each joint with its bodies
  std::vector<int> m_body_at, m_joint_at;        ///< where each begins in its own front
  std::vector<std::array<int, 3>>
      m_pairs;  ///< of each joint: front where its bodies meet (-1: none), and where they begin
  std::vector<int> m_unknown, m_in_parent, m_pivot;
  int m_unknowns = 0;
  double m_solves_of_factor = 1;
  std::vector<double> m_numbers;
  mutable std::vector<double> m_work;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle

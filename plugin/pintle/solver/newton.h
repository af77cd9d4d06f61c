// Purpose: Newton's iteration for the velocities v with which a component of joints ends the step, and the impulses lambda:
//   M (v - v*) = G(v)^T lambda,   u(v) and lambda of each row on its law (axis_law.h)
// u the mean velocity of a row over the step, G its discrete gradient: joints never gain (discrete_gradient.h).
#pragma once

#include <pintle/solver/iterate.h>
#include <pintle/solver/joint_matrix.h>
#include <pintle/solver/linear/fronts.h>
#include <pintle/solver/solver_options.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

struct NewtonReport {
  bool converged = false;
  int steps = 0, factors = 0;
  double error = 0;  ///< the largest, m or rad
};

/// Of the solve by impulses alone (chord.h).
struct BroydenStep {
  std::vector<double> s, Ks;
  double length2;  ///< s . K s
};
struct ChordMemory {
  struct Bounded {
    const IslandRow* row;
    size_t r, at;  ///< among the component's rows, and the unknowns of K
  };
  std::vector<Vector6d> base, v;
  std::vector<MovedBody> moved;
  std::vector<double> u, softness;  ///< of each row
  std::vector<double> y, x;         ///< impulses, and residual, in the units of K
  std::vector<Bounded> bounded;
  std::vector<BroydenStep> steps;
};

/// What the iteration works with. `now` is where it begins, and where it has come to.
struct Workspace {
  Iterate now, next;
  std::vector<LawPiece> pieces, next_pieces;
  std::vector<Matrix3d> stiffness;  ///< of each body: added to its inertia (chord.h)
  std::vector<Vector6d> external;   ///< of each body: impulses of contacts, N s and N m s
  std::vector<double> correction, simplified, residual;
  std::vector<double> softness;  ///< of each joint, relative to K
  std::vector<int> sizes;
  ChordMemory chord;
};

class Newton {
 public:
  Newton(const Island& island, const Component& component, const SolverOptions& options,
         Fronts& fronts, Workspace& work)
      : m_island(island),
        m_component(component),
        m_options(options),
        m_fronts(fronts),
        m_work(work) {
    m_work.pieces.resize(size_t(component.rows));
  }

  /// Solves the component from `work.now` (velocities and impulses) to there.
  NewtonReport run();
  // One step after the other, for who solves others beside it (contacts.h).
  void begin();
  /// From now on without what lets bodies gain by pushing each other.
  void clipTangent() { m_exact = false; }
  /// The factor at `work.now`. Returns false where there is none.
  bool factorise();
  /// work.correction: how `work.now` is to change.
  void findCorrection();
  /// Changes it by work.correction, or a part of it. Returns how much of the correction is left: one that contracts is less than 1.
  double advance();
  /// With every row on the piece of its law that it is nearest to. `momentum`: the part of it that may be left.
  bool isConverged(double tolerance, double momentum);
  double error() const { return m_error; }
  /// A factor is kept while a correction is at most this part of the one before it: while that gains digits for less than a new one.
  double contraction() const;
  /// Whether the last step has changed which rows act.
  bool hasChangedSet() const;

 private:
  const IslandBody& body(int i) const {
    return m_island.bodies[size_t(m_component.first_body + i)];
  }
  const IslandJoint& joint(int c) const {
    return m_island.joints[size_t(m_component.first_joint + c)];
  }

  const IslandRow& row(const IslandJoint& of, int i) const {
    return m_island.rows[size_t(of.first_row + i)];
  }

  /// Of the rows of a joint, relative to K.
  double leastSoftness(int c) const { return m_work.softness[size_t(c)]; }
  void choosePieces();
  void findResidual(const Iterate& at, std::vector<double>& x);
  void assemble(const Iterate& at);
  void step(const std::vector<double>& x, double part);
  NewtonReport iterate();
  void secantStep(const std::vector<double>& last, std::vector<double>& x) const;
  double findRest(double tolerance, double momentum);
  bool isWithin(double tolerance, double momentum) const {
    return m_error <= tolerance && m_momentum2 <= momentum * momentum * m_scale2;
  }
  /// Of a correction, by its length.
  bool isRounding(double length) const {
    return length * length < m_options.rounding * m_options.rounding * m_scale2;
  }
  void findBoundedCorrection(std::vector<double>& x);
  void keepBounded(const Iterate& at);
  double along(const RowJacobian& J, int joint, const std::vector<double>& x) const;

  const Island& m_island;
  const Component& m_component;
  const SolverOptions& m_options;
  Fronts& m_fronts;
  Workspace& m_work;
  double m_momentum2 = 0, m_scale2 = 0, m_error = 0;
  bool m_exact = true;
  bool m_bounded = false;  ///< the active set is found by projected Gauss-Seidel
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle

// Purpose: the rows of a component of joints, each on a piece of its law (axis_law.h). Which ones act is found with their impulses: a row
// is on the piece that its law and its own K meet on, u = free + K Lambda with Lambda = Lambda(u) (a primal-dual active set;
// Hintermueller, Ito and Kunisch 2003). What those that act are to meet: active_set.h.
#pragma once

#include <pintle/solver/solver_options.h>
#include <pintle/solver/system/joint_matrix.h>
#include <pintle/solver/system/workspace.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

class ActiveSet {
 public:
  /// Begins with the impulses of the workspace. K has the inertia of its bodies (JointMatrix::bodies).
  ActiveSet(const Island& island, const Component& component, const SolverOptions& options,
            JointMatrix& K, Workspace& work);

  using Place = Workspace::Place;
  /// Puts these rows on the pieces that they come to at velocities work.u and impulses work.y. Returns whether others act there, or to other
  /// ends.
  bool choose(const std::vector<Place>& rows);
  /// Steps that these rows are from the pieces to which they would come.
  int countSteps(const std::vector<Place>& rows) const;
  /// All rows that would come to another piece take a step there (block pivoting; Judice and Pires 1994).
  void changeAll(const std::vector<Place>& rows);
  /// The one whose impulse changes most by it, in the units of K.
  void changeMost(const std::vector<Place>& rows);
  const std::vector<Place>& bounded() const { return m_work.bounded; }
  const std::vector<Place>& all();
  /// work.u of these, as rows of the start, where bodies move with `v` (those of the component).
  void measure(const std::vector<Place>& rows, const Vector6d* v);
  /// From those with bounds, to work.limits: laws that have only rigid stops.
  void takeLimits();
  /// From now on these rows have the impulses that they are given: they are no unknowns.
  void release(const std::vector<Place>& rows);

 private:
  /// visit(joint of the component, its row i, row, where it is among the component's, and among the unknowns of K)
  template <class Visit>
  void forEachRow(const Visit& visit) const {
    size_t first = 0;  // of the joint
    pintle::forEachRow(m_island, m_component, [&](int c, int i, const IslandRow& row, size_t r) {
      if (i == 0) first = m_K.row(c, 0);
      visit(c, i, row, r, first + JointMatrix::rowOfJoint(i));
    });
  }
  void set(const IslandRow& row, size_t r, size_t at, const LawPiece& piece);
  LawPiece pieceOf(const IslandRow& row, size_t r, size_t at) const {
    return row.law.meet(m_work.u[r] - row.root_K * m_work.y[at], row.K);
  }
  void change(const Place& of);
  int stepsTo(const Place& of, LawPiece& to) const;
  double changeOfImpulse(const Place& of, const LawPiece& to) const;

  const Island& m_island;
  const Component& m_component;
  const SolverOptions& m_options;
  JointMatrix& m_K;
  Workspace& m_work;
};

// The equations of the rows that act, of a set of them (active_set.h): what each step of an active-set method solves (Nocedal
// and Wright 2006, chapter 16),
//   J v + softness Lambda = target,   v = v* + A^-1 J^T Lambda,
// in the units of K (joint_matrix.h): K y = aim - J v*.

/// To K which rows act, and how softly.
void setActing(const Island& island, const Component& component, Workspace& work, JointMatrix& K);

/// work.aim: at which velocities of the component's bodies rows are, in the units of K.
void aimRows(const Island& island, const Component& component, const JointMatrix& K,
             Workspace& work);

/// K of the rows that act. Returns false if it has no factor.
inline bool factoriseRows(const Island& island, const Component& component,
                          const SolverOptions& options, Workspace& work, JointMatrix& K) {
  setActing(island, component, work, K);
  return K.factorise(options.least_pivot);
}

/// work.x = what work.u is off of rows that act, in the units of K. Returns the most, m or rad.
double findResidual(double dt, Workspace& work);

/// The same of rows of the start, where bodies move with `v` (those of the component): of the rows of the last factor.
double findResidual(double dt, const JointMatrix& K, const Vector6d* v, Workspace& work);

/// work.lambda from work.y, which is in the units of K.
void unscaleImpulses(Workspace& work);

}  // namespace PINTLE_PRECISION
}  // namespace pintle

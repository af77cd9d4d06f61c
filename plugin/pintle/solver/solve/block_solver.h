// Purpose: the joints of a component as one block, in velocity:
//   A (v - v*) = J^T lambda,   J v and lambda of each row on its law (axis_law.h),   K lambda = target - J v* for the active rows
// The block has the equalities, and limits that would press with the impulses of the last step: what lies on these is then as on a joint. Those that
// turn out to pull, or that hold what contacts are to move, leave it. Other rows with bounds are rows of the passes (contact_response.h). In
// the end limits that press are rows of the factor, and without contacts all rows with bounds that act: the active set is found by block
// pivoting, from what passes have found (Judice and Pires 1994).
#pragma once

#include <pintle/solver/model/contacts.h>
#include <pintle/solver/system/active_set.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

struct BlockOfJoints {
  const Component* component;
  JointMatrix* K;
  Workspace* work;
};

/// How the rows of a component are solved.
enum class Sweep {
  passes,  ///< equalities by one factor, rows with bounds by passes on its Schur complement, from the impulses of the last step
  one_by_one  ///< all by passes, from no impulse: it needs no factor
};

/// The joints of a component.
class BlockSolver {
 public:
  BlockSolver(const Island& island, const BlockOfJoints& of, const SolverOptions& options)
      : m_island(island),
        m_of(of),
        m_options(options),
        m_work(*of.work),
        m_set(island, *of.component, options, *of.K, *of.work) {}

  /// `velocities`: of all bodies of the island, without impulses of joints, and then with those of the warm start. `bounds`: gets rows
  /// with bounds that are solved by passes, each part of their laws, but limits that are not reached.
  void begin(Sweep sweep, std::vector<Vector6d>& velocities, std::vector<ContactRow>& bounds);
  /// Dual function of its equalities along the warm start (DualFunction).
  void addTo(DualFunction& of) const;
  /// That fraction of its impulses.
  void scaleImpulses(double fraction);
  /// One pass over its own rows. Returns the largest change of a row, m/s or rad/s.
  double sweep(std::vector<Vector6d>& velocities);
  /// To the last digits: rows of the factor. `bounds`: the rows of the passes. `is_alone`: there are no contacts. Returns whether it has made
  /// its factor anew, for limits that press.
  bool finish(std::vector<Vector6d>& velocities, const std::vector<ContactRow>& bounds,
              bool is_alone);
  /// True where all its rows with bounds are met to the last digits.
  bool isMet() const { return m_is_met; }
  /// Adds limits that are reached to the rows of the passes. Returns whether any is.
  bool addLimits(std::vector<ContactRow>& to, std::vector<Vector6d>& velocities);
  /// True where some are not reached.
  bool hasLimits() const { return !m_work.limits.empty(); }
  /// True where some are rows of the factor.
  bool hasPressingLimits() const { return !m_work.pressing.empty(); }
  /// Those that pull leave the factor, for the rows of the passes. Returns whether any does.
  bool releaseLimits(std::vector<ContactRow>& to, std::vector<Vector6d>& velocities);
  /// Whether there is a factor where one is needed.
  bool isSolvable() const { return m_solvable; }

 private:
  void goOnAsContact(const ActiveSet::Place& of, std::vector<ContactRow>& to);
  /// Adds those to the rows of the passes for which are(place).
  template <class Are>
  void addLimitsThat(const Are& are, std::vector<ContactRow>& to);
  bool isReached(const ActiveSet::Place& of) const;
  AxisLaw::Parts partsOf(const ActiveSet::Place& of) const;
  /// Limits that would press begin as rows of the factor.
  void takePressing();
  /// A limit of the factor pulls, by more than the tolerance.
  bool pulls(const ActiveSet::Place& of) const;
  void takeBounds(const std::vector<ContactRow>& from);
  void splitHeld();
  bool hold(bool limits_alone, std::vector<Vector6d>& velocities);
  bool solveToTheEnd(std::vector<Vector6d>& velocities);
  bool findWhichAct(const std::vector<ActiveSet::Place>& rows, std::vector<Vector6d>& velocities);
  template <class Change>
  void changeImpulses(std::vector<Vector6d>& velocities, const Change& change);
  double solveOnce(std::vector<Vector6d>& velocities, double tolerance);
  double sweepRows(std::vector<Vector6d>& velocities);
  void respond(const std::vector<double>& y, std::vector<Vector6d>& velocities) const {
    m_of.K->addResponse(y.data(), velocities.data() + m_of.component->first_body);
  }
  void factorise();
  const Vector6d* own(const std::vector<Vector6d>& velocities) const {
    return velocities.data() + m_of.component->first_body;
  }
  void measure(const std::vector<Vector6d>& velocities);

  const Island& m_island;
  const BlockOfJoints& m_of;
  const SolverOptions& m_options;
  Workspace& m_work;
  ActiveSet m_set;
  const std::vector<ActiveSet::Place>* m_swept = nullptr;  ///< rows that are solved one by one
  int m_factors = 0;
  bool m_has_factor = false, m_solvable = true, m_is_alone = false, m_is_met = false;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle

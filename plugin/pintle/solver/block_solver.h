// Purpose: the joints of a component as one block, in velocity: all its rows at once by the factor of their K, or those with bounds, or
// all, one by one. Among contacts rows with bounds may go on as contacts do.
//   A (v - v*) = J^T lambda,   J v and lambda of each row on its law (axis_law.h),   K lambda = target - J v* for the rows that act
// Which ones act is found by block pivoting (Judice and Pires 1994), and where that no longer gets nearer, by one row at a time.
#pragma once

#include <pintle/solver/active_set.h>
#include <pintle/solver/contacts.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

struct BlockOfJoints {
  const Component* component;
  JointMatrix* K;
  Workspace* work;
};

/// How the rows of a component are solved.
enum class Sweep {
  /// From the impulses of the last step, with those that act: which may not be found. Among contacts limits go on as contacts do, and
  /// other rows with bounds, too, where contacts change which of them act.
  all_at_once,
  all_at_once_from_less,  ///< the same, from that part of what contacts have by now that leaves least energy
  bounds_one_by_one,  ///< from none. Those with bounds as contacts are, the others at once
  one_by_one          ///< from none, as contacts are: this needs no factor
};

inline bool isAtOnce(Sweep sweep) {
  return sweep == Sweep::all_at_once || sweep == Sweep::all_at_once_from_less;
}

/// The joints of a component.
class BlockSolver {
 public:
  /// `alone`: no contacts change what its impulses lead to.
  BlockSolver(const Island& island, const BlockOfJoints& of, const SolverOptions& options,
              bool alone)
      : m_alone(alone),
        m_island(island),
        m_of(of),
        m_options(options),
        m_work(*of.work),
        m_set(island, *of.component, options, *of.K, *of.work) {}

  /// `velocities`: of all bodies of the island, without impulses of joints, and then with those that it begins with.
  void begin(Sweep sweep, std::vector<Vector6d>& velocities);
  /// One pass over its rows. The first one finds which of those act that are solved at once. Returns the largest change of a row, m/s
  /// or rad/s.
  double sweep(std::vector<Vector6d>& velocities);
  /// To the last digits: those that are solved at once. `bounds`: where those are that are solved as contacts are. Returns whether it has
  /// made its factor anew, for limits that press and rows that change with them.
  bool finish(std::vector<Vector6d>& velocities, const std::vector<ContactRow>& bounds);
  /// Whether rows are solved one by one.
  bool isSwept() const { return m_swept != nullptr; }
  /// Its rows with bounds go on as contacts do: each part of their laws is added to them.
  void addBounds(std::vector<ContactRow>& to, std::vector<Vector6d>& velocities);
  /// The same of limits among contacts, when they are met. Returns whether any is.
  bool addLimits(std::vector<ContactRow>& to, std::vector<Vector6d>& velocities);
  /// Whether there are any that are not met.
  bool hasLimits() const { return !m_work.limits.empty(); }
  /// Whether contacts change which of its rows act.
  bool isUnsettled() const { return m_is_unsettled; }
  /// Whether there is a factor where one is needed.
  bool isSolvable() const { return m_solvable; }
  /// Whether a pass over contacts may.
  bool mayChangeSet() const {
    return m_swept == nullptr && !m_has_bounds && !m_set.bounded().empty();
  }

 private:
  void goOnAsContact(const ActiveSet::Place& of, std::vector<ContactRow>& to);
  void beginLimits();
  AxisLaw::Parts partsOf(const ActiveSet::Place& of) const;
  void takeBounds(const std::vector<ContactRow>& from);
  void splitBounds();
  bool holdLimits(std::vector<Vector6d>& velocities);
  void releaseLimits(std::vector<Vector6d>& velocities);
  bool solveToTheEnd(std::vector<Vector6d>& velocities);
  bool findWhichAct(const std::vector<ActiveSet::Place>& rows, bool or_one,
                    std::vector<Vector6d>& velocities);
  bool findOrCheckSet(std::vector<Vector6d>& velocities);
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

  const bool m_alone;
  const Island& m_island;
  const BlockOfJoints& m_of;
  const SolverOptions& m_options;
  Workspace& m_work;
  ActiveSet m_set;
  const std::vector<ActiveSet::Place>* m_swept = nullptr;  ///< rows that are solved one by one
  int m_factors = 0;
  bool m_has_factor = false, m_solvable = true;
  bool m_is_settled = false, m_is_unsettled = false, m_has_bounds = false;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle

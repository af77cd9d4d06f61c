#include <pintle/solver/solve/projection.h>

#include <pintle/solver/constants.h>
#include <pintle/solver/model/row_velocities.h>
#include <pintle/solver/model/stops.h>
#include <pintle/solver/system/load_stiffness.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

class Projection {
 public:
  Projection(const Island& island, const Component& component, const SolverOptions& options,
             Workspace& work, JointMatrix& K, ProjectionMemory& memory)
      : m_island(island),
        m_component(component),
        m_options(options),
        m_tolerance(options.pose_tolerance),
        m_work(work),
        m_memory(memory),
        m_K(K) {}

  PosesReport run(bool has_factor);

 private:
  void begin();
  bool findGoals();
  bool addPassed();
  /// Its directions turn with the bodies while it closes what is far open.
  bool mayStraighten(const IslandRow& row, size_t r) const {
    return m_bends[r] && row.open != 0 && row.law.isEquality() && !row.isOfArms();
  }
  bool mayStraighten() const;
  bool rebounds(const IslandRow& row, size_t r) const {
    const LawPiece& piece = m_work.pieces[r];
    return piece.acts && pintle::rebounds(row.law, piece.target);
  }
  /// A quarter of the factors is for equalities alone, where limits may be in their way.
  bool mayFactorise() const {
    const bool leaves = m_has_equalities && m_may_leave;
    return m_factors < m_options.max_factors - (leaves ? m_options.max_factors / 4 : 0);
  }
  /// The row pulls as a spring, and is not at a stop.
  bool isSpring(const IslandRow& row, size_t r) const {
    const LawPiece& piece = m_work.pieces[r];
    return piece.acts && piece.softness > 0 && row.open == 0 && !row.law.isEquality() &&
           !row.hasSoftStop();
  }
  /// Limits that do not press: they may go back in later steps.
  bool mayLeave(const IslandRow& row, size_t r) const {
    return m_closes[r] && !row.law.isEquality() && (!m_work.pieces[r].acts || isSpring(row, r));
  }
  bool factorise(bool at_end);
  bool regularise();
  void giveLittle() {
    m_softness = m_options.dependent_softness;
    m_halves = !m_is_net;
  }
  bool leaveLimits();
  bool straighten();
  bool askLess();
  double measure();
  double findResidual();
  double step(double open, bool is_fresh);
  double leftBySoftness() const;
  double iterate(double open, bool goes_on_anyhow);
  double closePassed(double left);
  bool opensArms(double open) const;
  bool getsThere(double left);
  double follow(double left);
  bool closePart();

  const Island& m_island;
  const Component& m_component;
  const SolverOptions& m_options;
  const double m_tolerance;
  Workspace& m_work;
  ProjectionMemory& m_memory;
  JointMatrix& m_K;
  int m_factors = 0;
  bool m_has_equalities = false;
  bool m_may_leave = false;  ///< limits
  bool m_is_at_end = false;  ///< the factor is of where bodies have come to
  bool m_arrives = true;
  /// K may be singular, or nearly so, and what closes is measured by rows that tell how it does.
  bool m_is_net = false;
  double m_softness = m_options.dependent_softness;
  bool m_halves = true;  ///< a step of a new factor is shortened until it closes something
  double m_passed = 0;  ///< m or rad: the most that limits are passed by which are not to be closed
  double m_part = 1;    ///< of the way of the step, at the end of which rows are to be met
  double m_asked = 1;   ///< of what Bullet's rows are to close
  double m_most_bend = infinity;  ///< m or rad: a larger bend is by what other rows ask for
  std::vector<double>&m_u = m_memory.u, &m_goal = m_memory.goal;
  std::vector<char>& m_closes = m_memory.closes;
  std::vector<char>& m_bends =
      m_memory.bends;  ///< of each row that closes: whether it is measured at the end
  std::vector<double>& m_open = m_memory.open;  ///< what was open at first, in the units of K
  std::vector<MovedBody>& m_nearest = m_memory.nearest;  ///< where least is open
};

// What each row is to measure over the step. Returns whether K has all rows that are to be moved.
bool Projection::findGoals() {
  bool all_act = true;
  forEachRow(m_island, m_component, [&](int, int, const IslandRow& row, size_t r) {
    const LawPiece& piece = m_work.pieces[r];
    double open = row.open / m_island.dt;
    // What comes back from beyond a stop by itself needs no closing.
    const double* const stop = passedStop(row, m_u[r] + open);
    const bool beyond = stop != nullptr;
    // What rebounds has a velocity to end with, and no pose.
    const bool rebounds = this->rebounds(row, r);
    if (hasStops(row) && (rebounds ? std::abs(m_u[r]) >= std::abs(open) : !beyond)) open = 0;
    // Nor is anything pulled to a stop that it meets and does not pass.
    const bool is_spring = isSpring(row, r);
    const bool holds = piece.acts && !is_spring && (row.has_position || row.law.isEquality()) &&
                       !rebounds && (beyond || !isLimit(row.law));
    const bool comes_back = beyond && (!piece.acts || is_spring);
    m_closes[r] = holds || comes_back || open != 0;
    m_has_equalities = m_has_equalities || row.law.isEquality();
    m_may_leave = m_may_leave || mayLeave(row, r);
    if (!m_closes[r]) return;
    const double end = !(holds && row.has_position) ? m_u[r]
                       : piece.softness > 0         ? m_work.u[r]
                                                    : piece.target;
    m_goal[r] = (comes_back ? *stop : end) - open;
    all_act = all_act && piece.acts && !is_spring;
  });
  return all_act;
}

// A stop that was met by nothing else but where poses have been moved to: it closes, too. Returns whether there is any.
bool Projection::addPassed() {
  std::vector<char>& may_pass = m_memory.may_pass;
  may_pass.assign(m_closes.size(), false);
  bool any = false;
  forEachRow(m_island, m_component, [&](int, int, const IslandRow& row, size_t r) {
    may_pass[r] = !m_closes[r] && row.has_position && !rebounds(row, r);
    any = any || may_pass[r];
  });
  if (!any) return false;
  any = false;
  measureAtEnd(m_island, m_component, m_nearest, may_pass, m_u);
  forEachRow(m_island, m_component, [&](int, int, const IslandRow& row, size_t r) {
    if (!may_pass[r]) return;
    const double* const stop = passedRigidStop(row.law, m_u[r]);
    if (stop == nullptr || !(std::abs(m_u[r] - *stop) * m_island.dt > m_tolerance)) return;
    m_closes[r] = m_bends[r] = any = true;
    m_may_leave = m_may_leave || mayLeave(row, r);
    m_goal[r] = *stop;
  });
  return any;
}

// By the rows of the start, or of where bodies are now.
bool Projection::factorise(bool at_end) {
  if (!mayFactorise()) return false;
  ++m_factors;
  m_is_at_end = at_end;
  stiffen(m_island, m_component, m_work, m_K);
  if (at_end) differentiateAtEnd(m_island, m_component, m_work.moved, m_bends, m_memory.J);
  forEachRow(m_island, m_component, [&](int c, int i, const IslandRow& row, size_t r) {
    m_K.setRow(c, i, at_end ? m_memory.J[r] : row.J, row.root_K, row.by_root_K);
    m_K.setActing(m_K.row(c, i), m_closes[r], m_softness);
  });
  m_memory.broyden.begin();
  return m_K.factorise(m_options.least_pivot);
}

// A net has ways to move that close next to nothing (of plates that hang level, say): Newton's step for what is open goes far along those,
// closes it, and leaves limits far behind. Rows that give (Levenberg 1944) leave these ways alone. Returns false if they give enough
// already; the last step is then along those that do not, shortened.
bool Projection::regularise() {
  if (m_halves) return false;
  m_halves = m_softness >= most_softness;
  m_softness = m_halves ? m_options.dependent_softness
                        : std::min(softness_growth * m_softness, most_softness);
  return true;
}

// Where limits are too far passed, or leave no way to close all, equalities come first. Returns whether any limit was to be closed.
bool Projection::leaveLimits() {
  if (!m_has_equalities) return false;
  forEachRow(m_island, m_component, [&](int, int, const IslandRow& row, size_t r) {
    if (mayLeave(row, r)) m_closes[r] = false;
  });
  return std::exchange(m_may_leave, false);
}

// Of what is far open, the directions turn with the bodies: there the rows that it has are not how it changes. It closes along those of
// the start. Returns whether any does.
bool Projection::straighten() {
  bool any = false;
  forEachRow(m_island, m_component, [&](int, int, const IslandRow& row, size_t r) {
    if (!mayStraighten(row, r)) return;
    m_bends[r] = false;
    any = true;
  });
  return any;
}

// True if there is a row to straighten.
bool Projection::mayStraighten() const {
  bool any = false;
  forEachRow(m_island, m_component,
             [&](int, int, const IslandRow& row, size_t r) { any = any || mayStraighten(row, r); });
  return any;
}

// Rows of Bullet's say what they measure near the start of the step alone. A part s of the way that is to close C of them closes s C, and as
// bodies turn opens up to s^2 B: where B > C the whole way leads nowhere, and s = C / 2B leaves least open. Returns whether so much is to be
// closed instead; the next steps ask for the rest. Where bodies turn by what other rows ask for, those of Bullet's ask for nothing.
bool Projection::askLess() {
  double open = 0;
  const auto forEachAsked = [&](const auto& visit) {
    forEachRow(m_island, m_component, [&](int c, int i, const IslandRow& row, size_t r) {
      if (m_closes[r] && !row.has_position) visit(m_open[m_K.row(c, i)] * row.root_K, r);
    });
  };
  forEachAsked([&](double left, size_t) { open = larger(open, m_asked * m_island.dt * left); });
  if (!(open > m_tolerance)) return false;
  const double bend = bendOfRows(m_island, m_component, m_closes, m_memory.start, m_nearest);
  if (!(bend > open)) return false;
  m_asked *= bend <= m_most_bend ? open / (2 * bend) : 0;
  m_most_bend = open / 2;
  m_work.moved = m_nearest = m_memory.start;
  measure();
  forEachAsked([&](double left, size_t r) { m_goal[r] = m_u[r] + m_asked * left; });
  m_memory.broyden.begin();
  return true;
}

// work.x: what is still open, in the units of K. Returns the most, m or rad.
double Projection::measure() {
  measureAtEnd(m_island, m_component, m_work.moved, m_bends, m_u);
  return findResidual();
}

// Of m_u.
double Projection::findResidual() {
  double largest = 0, passed = 0;
  std::fill(m_work.x.begin(), m_work.x.end(), 0.);
  forEachRow(m_island, m_component, [&](int c, int i, const IslandRow& row, size_t r) {
    if (!m_closes[r]) {
      const double* const stop = m_is_net && row.has_position && !rebounds(row, r)
                                     ? passedRigidStop(row.law, m_u[r])
                                     : nullptr;
      if (stop != nullptr) passed = larger(passed, m_u[r] - *stop);
      return;
    }
    const double left = m_u[r] - m_part * m_goal[r];
    m_work.x[m_K.row(c, i)] = -left * row.by_root_K;
    largest = larger(largest, left);
  });
  m_passed = passed * m_island.dt;
  return largest * m_island.dt;
}

// With the factor at hand from where bodies are. Returns what is open then. A step of a new factor may be shortened until it closes
// something (the monotonicity test of Deuflhard 2004, 3.1).
double Projection::step(double open, bool is_fresh) {
  if (!m_memory.broyden.step(m_K, m_work.x, m_work.y)) return infinity;
  std::vector<Vector6d>& w = m_memory.way;
  w.assign(size_t(m_component.bodies), Vector6d::Zero());
  m_K.addResponse(m_memory.broyden.last(), w.data());
  for (double part = 1;; part /= 2) {
    for (size_t b = 0; b < w.size(); ++b) m_work.moved[b].goOn(part * w[b], m_island.dt);
    const double now = measure();
    if (now <= (1 - part / 4) * open || !is_fresh || !m_halves || part < m_options.least_part)
      return now;
    m_work.moved = m_nearest;
  }
}

// What the softness of rows has left of the last step, m or rad: no other factor closes more of it.
double Projection::leftBySoftness() const {
  double largest = 0;
  forEachRow(m_island, m_component, [&](int c, int i, const IslandRow& row, size_t r) {
    if (m_closes[r]) largest = larger(largest, row.root_K * m_memory.broyden.last()[m_K.row(c, i)]);
  });
  return m_softness * largest * m_island.dt;
}

// Whether a row that is measured as it is, and not by an angle that folds, has more open than all had.
bool Projection::opensArms(double open) const {
  bool any = false;
  forEachRow(m_island, m_component, [&](int, int, const IslandRow& row, size_t r) {
    any = any || (m_closes[r] && row.isOfArms() &&
                  std::abs(m_u[r] - m_part * m_goal[r]) * m_island.dt > open);
  });
  return any;
}

// Whether bodies get to the end of the step. What an angle has open there that folds tells nothing.
bool Projection::getsThere(double left) {
  if (left <= m_options.contact_tolerance || countsTurns(m_island, m_component, m_work.way))
    return true;
  m_work.moved = m_nearest;
  measure();
  return !opensArms(m_options.contact_tolerance);
}

// Returns what is left open. `goes_on_anyhow`: where an angle is far from what its row says, so that nothing closes it, the first step is
// what can be had.
double Projection::iterate(double open, bool goes_on_anyhow) {
  std::vector<MovedBody>& first = m_memory.first;
  first.clear();
  double passed = m_passed;
  bool is_fresh = false, is_of_softness = false, closes_any = false;
  for (int steps = 0; steps < m_options.max_iterations; ++steps) {
    const double now = step(open, is_fresh);
    // A step that passes limits by more than was open is no way to close it.
    const bool closes = now < open && m_passed <= std::fmax(open, passed),
               is_fast = closes && now < m_options.contraction * open;
    closes_any = closes_any || closes;
    if (closes) {
      m_nearest = m_work.moved;
      open = now;
      passed = m_passed;
    } else if (goes_on_anyhow && !m_is_net && steps == 0 && now < infinity && !opensArms(open)) {
      first = m_work.moved;
    }
    if (open <= m_tolerance / 2) break;
    const bool was_fresh = std::exchange(is_fresh, false);
    if (is_fast) continue;
    // With rows that contradict each other by rounding no other factor would close the last digits.
    if (was_fresh && open <= m_options.loose_pose_tolerance) break;
    if (was_fresh) is_of_softness = now < infinity && leftBySoftness() > open / 2;
    if (closes && (is_of_softness || !mayFactorise())) continue;
    if (was_fresh && !closes && !regularise()) break;
    if (!closes) m_work.moved = m_nearest;
    if (!factorise(true)) break;
    measure();
    is_fresh = true;
  }
  if (!closes_any && !first.empty()) m_nearest = first;
  return open;
}

// Closes limits that are met by where poses have been moved to. Returns what is left open.
double Projection::closePassed(double left) {
  while (mayFactorise() && addPassed()) {
    m_work.moved = m_nearest;
    left = measure();
    giveLittle();
    if (factorise(true)) left = iterate(left, false);
  }
  return left;
}

// Where the end of the step is too far, as where a light body whirls between taut ropes, bodies go there from its start part by part.
// Each one is closed before the next one, and halved where it is too long. Where none is short enough they stay: there their joints hold.
// What starts open has no such way. Returns what is left open.
double Projection::follow(double left) {
  std::vector<MovedBody>& reached = m_memory.first;
  reached.assign(size_t(m_component.bodies), MovedBody(Vector6d::Zero(), m_island.dt));
  double gone = 0;
  for (double part = 0.5; gone < 1 && part >= m_options.least_part;) {
    m_work.moved = reached;
    goOn(m_island, m_component, m_work.way, part, m_work.moved);
    m_part = gone + part;
    if (closePart()) {
      gone = m_part;
      reached = m_work.moved;
    } else {
      part /= 2;
    }
  }
  m_work.moved = reached;
  m_part = gone;
  const double there = measure();
  m_part = 1;
  m_arrives = m_arrives || gone == 1;
  if (gone < 1 && (m_arrives || !(there < left))) return left;
  m_nearest = reached;
  return gone < 1 ? there : closePassed(iterate(there, false));
}

// With factors of where bodies are, each as long as it closes fast. Returns whether rows are where they are to be.
bool Projection::closePart() {
  double open = measure();
  while (!(open <= m_options.loose_pose_tolerance)) {
    if (!factorise(true)) return false;
    measure();
    for (double before = infinity;
         open > m_options.loose_pose_tolerance && open < m_options.contraction * before;) {
      before = open;
      open = step(before, false);
      if (!(open < before)) return false;
    }
  }
  return true;
}

void Projection::begin() {
  const auto rows = size_t(m_component.rows);
  m_u.resize(rows);
  setZero(rows, m_goal);
  m_closes.assign(rows, false);
  if (actsInHalves(m_island, m_component)) {  // so nothing pushes them
    moveBodies(m_island, m_component, m_work.way.data(), m_work.moved);
  } else {
    m_work.moved.assign(size_t(m_component.bodies), MovedBody(Vector6d::Zero(), m_island.dt));
    goOn(m_island, m_component, m_work.way, 1, m_work.moved);
  }
  measureAtEnd(m_island, m_component, m_work.moved, m_u);
}

PosesReport Projection::run(bool has_factor) {
  begin();
  has_factor = findGoals() && has_factor;
  m_bends = m_closes;
  m_is_net = m_work.has_loops && !mayStraighten();
  giveLittle();
  double open = findResidual();
  if (open <= m_tolerance) return {open};
  m_open = m_work.x;
  m_memory.start = m_nearest = m_work.moved;
  m_memory.broyden.begin();
  const auto stay = [&]() -> PosesReport {
    m_work.moved = m_memory.start;
    return {open, m_arrives};
  };
  // (Nothing is done where K has its factor.)
  has_factor = has_factor && m_K.factorise(m_options.least_pivot);
  if (!has_factor && !factorise(false)) return stay();
  double left = closePassed(iterate(open, true));
  while (askLess()) {
    left = measure();
    if (m_is_at_end && !factorise(false)) break;
    left = closePassed(iterate(left, true));
  }
  const double met = m_options.loose_pose_tolerance;  // but for rounding
  double passed = 0;                                  // of limits that are left
  if (!(left <= m_options.contact_tolerance) && leaveLimits()) {
    passed = left;
    m_work.moved = m_nearest;
    left = measure();
    giveLittle();
    if (factorise(true)) left = iterate(left, false);
  }
  m_may_leave = false;
  if (!(left <= met) && mayFactorise() && straighten()) {
    m_work.moved = m_nearest = m_memory.start;
    if (!factorise(false)) return stay();
    open = measure();
    left = iterate(open, true);
  }
  m_arrives = getsThere(left);
  if (!(left <= met) && m_options.max_factors > 1 && startsClosed(m_island, m_component, met))
    left = follow(left);
  m_work.moved = m_nearest;
  return {std::fmax(left, passed), m_arrives, true};
}

}  // namespace

PosesReport projectPoses(const Island& island, const Component& component,
                         const SolverOptions& options, Workspace& work, JointMatrix& K,
                         bool has_factor, ProjectionMemory& memory) {
  return Projection(island, component, options, work, K, memory).run(has_factor);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

#include <pintle/solver/system/active_set.h>

#include <pintle/solver/model/stops.h>

#include <algorithm>
#include <cmath>

namespace pintle {
inline namespace PINTLE_PRECISION {

ActiveSet::ActiveSet(const Island& island, const Component& component, const SolverOptions& options,
                     JointMatrix& K, Workspace& work)
    : m_island(island), m_component(component), m_options(options), m_K(K), m_work(work) {
  const auto rows = size_t(component.rows);
  work.pieces.resize(rows);
  work.parts.clear();
  work.u.resize(rows);
  setZero(K.vectorSize(), work.y);
  setZero(K.vectorSize(), work.x);
  work.bounded.clear();
  work.scales.resize(rows);
  forEachRow([&](int c, int, const IslandRow& row, size_t r, size_t at) {
    work.scales[r] = {row.root_K, row.by_root_K, at};
    work.y[at] = work.lambda[r] * row.root_K;
    if (row.law.isEquality())
      work.pieces[r] = row.law.meet(0, row.K);  // wherever it is
    else
      work.bounded.push_back({&row, c, r, at});
  });
  for (int c = 0; c < component.joints; ++c) {
    const IslandJoint& joint = island.joints[size_t(component.first_joint + c)];
    K.setRows(c, &island.rows[size_t(joint.first_row)], joint.rows);
  }
}

void ActiveSet::set(const IslandRow& row, size_t r, size_t at, const LawPiece& piece) {
  m_work.pieces[r] = piece;
  if (!piece.acts) m_work.y[at] = piece.impulse * row.root_K;
}

bool ActiveSet::choose(const std::vector<Place>& rows) {
  bool any = false;
  for (const Place& of : rows) {
    const LawPiece before = m_work.pieces[of.r], to = pieceOf(*of.row, of.r, of.at);
    any = any || before.acts != to.acts ||
          (to.acts && (before.target != to.target || before.softness != to.softness));
    set(*of.row, of.r, of.at, to);
  }
  return any;
}

namespace {

bool areDifferent(const LawPiece& a, const LawPiece& b) {
  return a.target != b.target || a.acts != b.acts || a.softness != b.softness ||
         a.impulse != b.impulse;
}

}  // namespace

// How many steps a row is from the piece to which it would come, and which one that is. Less than the tolerance is no change: so
// finely no velocity is known. From one stop to the other it is two steps, by what lies between: a set that is wrong leads far beyond both.
int ActiveSet::stepsTo(const Place& of, LawPiece& to) const {
  to = pieceOf(*of.row, of.r, of.at);
  const LawPiece& before = m_work.pieces[of.r];
  if (!areDifferent(before, to) ||
      !(std::abs(changeOfImpulse(of, to)) * of.row->root_K * m_island.dt >
        m_options.newton_tolerance))
    return 0;
  return before.target != to.target && before.acts && to.acts && !(before.softness > 0) &&
                 !(to.softness > 0)
             ? 2
             : 1;
}

// By how much its impulse would change, if it alone came to that piece, in the units of K.
double ActiveSet::changeOfImpulse(const Place& of, const LawPiece& to) const {
  const IslandRow& row = *of.row;
  const double y = m_work.y[of.at], free = m_work.u[of.r] - row.root_K * y;
  return to.impulseAt(free, row.K) * row.root_K - y;
}

void ActiveSet::change(const Place& of) {
  LawPiece to;
  const int steps = stepsTo(of, to);
  if (steps == 0) return;
  const double from = m_work.pieces[of.r].target;
  if (steps == 2) to = {false, 0, 0, of.row->law.at((from + to.target) / 2)};
  set(*of.row, of.r, of.at, to);
}

int ActiveSet::countSteps(const std::vector<Place>& rows) const {
  LawPiece to;
  int steps = 0;
  for (const Place& of : rows) steps += stepsTo(of, to);
  return steps;
}

void ActiveSet::changeAll(const std::vector<Place>& rows) {
  for (const Place& of : rows) change(of);
}

void ActiveSet::changeMost(const std::vector<Place>& rows) {
  const Place* found = nullptr;
  double most = -1;
  LawPiece to;
  for (const Place& of : rows) {
    if (stepsTo(of, to) == 0) continue;
    const double by = std::abs(changeOfImpulse(of, to));
    if (!(by > most)) continue;
    most = by;
    found = &of;
  }
  if (found != nullptr) change(*found);
}

void ActiveSet::takeLimits() {
  m_work.limits.clear();
  takeIf([](const Place& of) { return isLimit(of.row->law); }, m_work.bounded, m_work.limits);
}

void ActiveSet::measure(const std::vector<Place>& rows, const Vector6d* v) {
  for (const Place& of : rows) {
    const IslandJoint& joint = m_island.joints[size_t(m_component.first_joint + of.joint)];
    const int first = m_component.first_body;
    m_work.u[of.r] = of.row->J.along(m_island.velocity(joint.body[0], v, first),
                                     m_island.velocity(joint.body[1], v, first));
  }
}

const std::vector<ActiveSet::Place>& ActiveSet::all() {
  m_work.all.clear();
  forEachRow([&](int c, int, const IslandRow& row, size_t r, size_t at) {
    m_work.all.push_back({&row, c, r, at});
  });
  return m_work.all;
}

void ActiveSet::release(const std::vector<Place>& rows) {
  for (const Place& of : rows)
    m_work.pieces[of.r] = {false, 0, 0, m_work.y[of.at] * of.row->by_root_K};
}

void setActing(const Island& island, const Component& component, Workspace& work, JointMatrix& K) {
  work.softness.resize(work.scales.size());
  for (int c = 0; c < component.joints; ++c) {
    const IslandJoint& joint = island.joints[size_t(component.first_joint + c)];
    for (int i = 0; i < joint.rows; ++i) {
      const auto r = size_t(joint.row_of_component + i);
      const Workspace::Scale& scale = work.scales[r];
      const LawPiece& piece = work.pieces[r];
      double& softness = work.softness[r];
      softness = work.of_loop[size_t(c)];
      if (piece.softness > 0)
        softness = std::max(softness, piece.softness / (scale.root_K * scale.root_K));
      K.setActing(scale.at, piece.acts, softness);
    }
  }
}

void aimRows(const Island& island, const Component& component, const JointMatrix& K,
             Workspace& work) {
  setZero(K.vectorSize(), work.aim);
  for (int c = 0; c < component.joints; ++c) {
    const IslandJoint& joint = island.joints[size_t(component.first_joint + c)];
    for (int i = 0; i < joint.rows; ++i) {
      const auto r = size_t(joint.row_of_component + i);
      const RowJacobian& J = island.rows[size_t(joint.first_row + i)].J;
      work.aim[work.scales[r].at] =
          (work.pieces[r].target - island.velocityOfUnmoved(joint, J)) * work.scales[r].by_root_K;
    }
  }
}

double findResidual(double dt, Workspace& work) {
  double largest = 0;
  for (size_t r = 0; r < work.scales.size(); ++r) {
    const LawPiece& piece = work.pieces[r];
    const auto& [root_K, by_root_K, at] = work.scales[r];
    const double left =
        piece.acts ? work.u[r] - piece.target + work.softness[r] * root_K * work.y[at] : 0;
    work.x[at] = -left * by_root_K;
    largest = larger(largest, left);
  }
  return largest * dt;
}

double findResidual(double dt, const JointMatrix& K, const Vector6d* v, Workspace& work) {
  return dt * K.findResidual(work.aim.data(), work.y.data(), v, work.x.data());
}

void unscaleImpulses(Workspace& work) {
  work.lambda.resize(work.scales.size());
  for (size_t r = 0; r < work.scales.size(); ++r)
    work.lambda[r] = work.y[work.scales[r].at] * work.scales[r].by_root_K;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

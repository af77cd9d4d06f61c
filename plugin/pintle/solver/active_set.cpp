#include <pintle/solver/active_set.h>

#include <cmath>

namespace pintle {
inline namespace PINTLE_PRECISION {

ActiveSet::ActiveSet(const Island& island, const Component& component, const SolverOptions& options,
                     JointMatrix& K, Workspace& work)
    : m_island(island), m_component(component), m_options(options), m_K(K), m_work(work) {
  const auto rows = size_t(component.rows);
  work.pieces.resize(rows);
  work.u.resize(rows);
  work.softness.assign(rows, 0.);
  work.y.assign(K.unknowns(), 0.);
  work.x.assign(K.unknowns(), 0.);
  work.bounded.clear();
  forEachRow([&](int c, int, const IslandRow& row, size_t r, size_t at) {
    work.y[at] = work.lambda[r] * row.root_K;
    if (!row.law.isEquality()) work.bounded.push_back({&row, c, r, at});
  });
}

void ActiveSet::choose(const IslandRow& row, size_t r, size_t at) {
  const double lambda = m_work.y[at] / row.root_K;
  set(row, r, at, row.law.meet(m_work.u[r] - row.K * lambda, row.K));
}

void ActiveSet::set(const IslandRow& row, size_t r, size_t at, const LawPiece& piece) {
  m_work.pieces[r] = piece;
  if (!piece.acts) m_work.y[at] = piece.impulse * row.root_K;
}

void ActiveSet::choose() {
  forEachRow([&](int, int, const IslandRow& row, size_t r, size_t at) { choose(row, r, at); });
}

// From one stop to the other by what lies between: a set that is wrong leads far beyond both.
bool ActiveSet::change(const Place& of) {
  const LawPiece before = m_work.pieces[of.r];
  choose(*of.row, of.r, of.at);
  const LawPiece& now = m_work.pieces[of.r];
  const bool moves = before.target != now.target;
  if (moves && before.acts && now.acts && !(before.softness > 0) && !(now.softness > 0))
    set(*of.row, of.r, of.at, {false, 0, 0, of.row->law.at((before.target + now.target) / 2)});
  return moves || before.acts != now.acts || before.softness != now.softness ||
         before.impulse != now.impulse;
}

bool ActiveSet::chooseAgain(bool one) {
  bool changed = false;
  for (const Place& of : m_work.bounded) {
    changed = change(of) || changed;
    if (changed && one) break;
  }
  return changed;
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
    m_work.pieces[of.r] = {false, 0, 0, m_work.y[of.at] / of.row->root_K};
}

void ActiveSet::setRows() {
  forEachRow([&](int c, int i, const IslandRow& row, size_t r, size_t) {
    const LawPiece& piece = m_work.pieces[r];
    m_work.softness[r] = std::fmax(piece.softness / row.K, m_work.of_loop[size_t(c)]);
    m_K.setRow(c, i, row.J, row.root_K, m_work.softness[r], piece.acts);
  });
}

bool ActiveSet::factorise(int most) {
  if (m_factors >= most) return false;
  ++m_factors;
  setRows();
  return m_K.factorise(m_options.least_pivot);
}

double ActiveSet::findResidual() {
  double largest = 0;
  forEachRow([&](int, int, const IslandRow& row, size_t r, size_t at) {
    const LawPiece& piece = m_work.pieces[r];
    const double left =
        piece.acts ? m_work.u[r] - piece.target + m_work.softness[r] * row.root_K * m_work.y[at]
                   : 0;
    m_work.x[at] = -left / row.root_K;
    largest = std::abs(left) <= largest ? largest : std::abs(left);  // and not finite if one is
  });
  return largest * m_island.dt;
}

void ActiveSet::keepImpulses() {
  m_work.lambda.resize(m_work.pieces.size());
  forEachRow([&](int, int, const IslandRow& row, size_t r, size_t at) {
    m_work.lambda[r] = m_work.y[at] / row.root_K;
  });
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

#include <pintle/solver/chord.h>

#include <pintle/solver/softness.h>

#include <algorithm>
#include <cmath>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

using Vector = Eigen::Map<Eigen::VectorXd>;

class Chord {
 public:
  Chord(const Island& island, const Component& component, const SolverOptions& options,
        JointMatrix& K, Workspace& work)
      : m_island(island), m_component(component), m_options(options), m_K(K), m_work(work) {}

  NewtonReport run();

 private:
  template <class Visit>
  void forEachRow(const Visit& visit) const;
  void begin();
  double straight(int c, const IslandRow& row) const;
  void startFromForeseen();
  void choosePiece(const IslandRow& row, size_t r, size_t at);
  bool choosePieces();
  bool factorise();
  void findStep(size_t count);
  double findResidual();
  void measureEnd();
  bool end();
  Vector map(std::vector<double>& of) const { return {of.data(), Eigen::Index(of.size())}; }

  const Island& m_island;
  const Component& m_component;
  const SolverOptions& m_options;
  JointMatrix& m_K;
  Workspace& m_work;
  ChordMemory& m_memory = m_work.chord;
  NewtonReport m_report;
};

// visit(joint, its row i, row, where it is among the component's, and among the unknowns of K)
template <class Visit>
void Chord::forEachRow(const Visit& visit) const {
  pintle::forEachRow(m_island, m_component, [&](int c, int i, const IslandRow& row, size_t r) {
    visit(c, i, row, r, m_K.row(c) + size_t(i));
  });
}

// A, and the velocities without impulses of joints: M (v - v*) + S (v - v_0) = 0, S the stiffness.
void Chord::begin() {
  const auto rows = size_t(m_component.rows);
  m_work.pieces.resize(rows);
  std::vector<InverseInertia>& bodies = m_K.bodies();
  bodies.clear();
  m_memory.base.clear();
  m_memory.v.clear();
  for (int i = 0; i < m_component.bodies; ++i) {
    const IslandBody& body = m_island.bodies[size_t(m_component.first_body + i)];
    const Matrix3d& S = m_work.stiffness[size_t(i)];
    bodies.emplace_back(body, S);
    Vector6d base = body.v_free;
    base.tail<3>() -= bodies.back().angular * (S * (body.v_free - body.v0).tail<3>());
    m_memory.base.push_back(base);
    m_memory.v.push_back(m_work.now.bodies[size_t(i)].v);
  }
  m_memory.u.resize(rows);
  m_memory.softness.assign(rows, 0.);
  m_memory.y.assign(m_K.unknowns(), 0.);
  m_memory.x.assign(m_K.unknowns(), 0.);
  m_memory.bounded.clear();
  forEachRow([&](int, int, const IslandRow& row, size_t r, size_t at) {
    m_memory.y[at] = m_work.now.lambda[r] * row.root_K;
    if (!row.law.isEquality()) m_memory.bounded.push_back({&row, r, at});
  });
}

void Chord::choosePiece(const IslandRow& row, size_t r, size_t at) {
  const double lambda = m_memory.y[at] / row.root_K;
  m_work.pieces[r] = row.law.meet(m_memory.u[r] - row.K * lambda, row.K);
  if (!m_work.pieces[r].acts) m_memory.y[at] = m_work.pieces[r].impulse * row.root_K;
}

// Of the rows with bounds. Returns whether one is on another piece.
bool Chord::choosePieces() {
  bool changed = false;
  for (const auto& of : m_memory.bounded) {
    const LawPiece before = m_work.pieces[of.r];
    choosePiece(*of.row, of.r, of.at);
    const LawPiece& now = m_work.pieces[of.r];
    changed = changed || before.acts != now.acts || before.softness != now.softness ||
              before.impulse != now.impulse || before.target != now.target;
  }
  return changed;
}

bool Chord::factorise() {
  if (m_report.factors >= m_options.max_first_tier_factors) return false;
  ++m_report.factors;
  m_K.begin();
  forEachRow([&](int c, int i, const IslandRow& row, size_t r, size_t) {
    const LawPiece& piece = m_work.pieces[r];
    m_memory.softness[r] = std::fmax(piece.softness / row.K, m_work.softness[size_t(c)]);
    m_K.setRow(c, i, row.J, row.root_K, m_memory.softness[r], piece.acts);
  });
  return m_K.factorise(m_options.least_pivot);
}

// x = -F, in the units of K. Returns the largest part of it, m or rad.
double Chord::findResidual() {
  double largest = 0;
  forEachRow([&](int, int, const IslandRow& row, size_t r, size_t at) {
    const LawPiece& piece = m_work.pieces[r];
    const double y = m_memory.y[at];
    const double left =
        piece.acts ? m_memory.u[r] - piece.target + m_memory.softness[r] * row.root_K * y : 0;
    m_memory.x[at] = -left / row.root_K;
    largest = std::abs(left) <= largest ? largest : std::abs(left);  // and not finite if one is
  });
  return largest * m_island.dt;
}

double Chord::straight(int c, const IslandRow& row) const {
  const auto& bodies = m_island.joints[size_t(m_component.first_joint + c)].body;
  const auto of = [&](int side) -> Vector6d {
    const int body = bodies[size_t(side)];
    if (body < 0) return m_island.unmovedBody(body).v;
    return m_memory.v[size_t(body - m_component.first_body)];
  };
  return row.J.along(of(0), of(1));
}

// At the velocities that are foreseen rows bend as they will. From there to those of the impulses they are taken to be straight.
void Chord::startFromForeseen() {
  forEachRow([&](int c, int, const IslandRow& row, size_t r, size_t) {
    m_memory.u[r] -= straight(c, row);
  });
  m_memory.v = m_memory.base;
  m_K.addResponse(m_memory.y.data(), m_memory.v);
  forEachRow([&](int c, int, const IslandRow& row, size_t r, size_t) {
    m_memory.u[r] += straight(c, row);
  });
  findResidual();
  findStep(0);
  map(m_memory.y) += map(m_memory.steps[0].s);
}

// What the impulses lead to.
void Chord::measureEnd() {
  m_memory.v = m_memory.base;
  m_K.addResponse(m_memory.y.data(), m_memory.v);
  measure(m_island, m_component, m_island.dt, m_memory.v, m_memory.moved, m_memory.u);
}

// Returns whether rows have come to another piece of their laws.
bool Chord::end() {
  ++m_report.steps;
  measureEnd();
  const bool changed = choosePieces();
  m_report.error = findResidual();
  m_report.converged = !changed && m_report.error <= m_options.newton_tolerance;
  return changed;
}

// Step `count` is K^-1 x, corrected by those before it: in the metric of K.
void Chord::findStep(size_t count) {
  auto& steps = m_memory.steps;
  if (steps.size() <= count) steps.emplace_back();
  BroydenStep& now = steps[count];
  now.s = now.Ks = m_memory.x;
  m_K.solve(now.s.data());
  for (size_t j = 0; j < count; ++j) {
    const double part = map(steps[j].Ks).dot(map(now.s)) / steps[j].length2;
    if (j + 1 < count) {
      map(now.s) += part * map(steps[j + 1].s);
      map(now.Ks) += part * map(steps[j + 1].Ks);
    } else {
      map(now.s) /= 1 - part;
      map(now.Ks) /= 1 - part;
    }
  }
  now.length2 = map(now.s).dot(map(now.Ks));
}

NewtonReport Chord::run() {
  m_work.now.horizon = m_island.dt;
  begin();
  measure(m_island, m_component, m_island.dt, m_memory.v, m_memory.moved, m_memory.u);
  forEachRow([&](int, int, const IslandRow& row, size_t r, size_t at) { choosePiece(row, r, at); });
  if (!factorise()) return m_report;
  startFromForeseen();
  size_t count = 0;
  for (bool changed = end(); !m_report.converged; changed = end()) {
    if (m_report.steps >= m_options.max_newton_iterations) return m_report;
    if (changed) {
      if (!factorise()) return m_report;
      measureEnd();
      findResidual();
      count = 0;
    }
    findStep(count);
    const BroydenStep& step = m_memory.steps[count];
    // Each is shorter than the one before, or this leads nowhere.
    if (!(step.length2 >= 0) || (count > 0 && !(step.length2 <= m_memory.steps[count - 1].length2)))
      return m_report;
    map(m_memory.y) += map(m_memory.steps[count++].s);
  }
  m_work.now.rows.resize(m_work.pieces.size());
  forEachRow([&](int, int, const IslandRow& row, size_t r, size_t at) {
    RowAtEnd& end = m_work.now.rows[r];
    end.u = m_memory.u[r];
    end.J = end.G = row.J;
    m_work.now.lambda[r] = m_memory.y[at] / row.root_K;
  });
  for (size_t i = 0; i < m_memory.v.size(); ++i) m_work.now.bodies[i].v = m_memory.v[i];
  return m_report;
}

}  // namespace

NewtonReport solveByChord(const Island& island, const Component& component,
                          const SolverOptions& options, const Fronts& fronts, JointMatrix& K,
                          Workspace& work) {
  findSoftness(island, component, options, fronts, work);
  return Chord(island, component, options, K, work).run();
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

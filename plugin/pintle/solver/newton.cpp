#include <pintle/solver/newton.h>

#include <pintle/solver/active_set.h>
#include <pintle/solver/geometric_derivative.h>
#include <pintle/solver/softness.h>

#include <algorithm>
#include <cmath>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// Steps of Newton are halved down to the least part. Short ones show a tangent that is of no use: the other one is tried.
constexpr double short_step = 0.1, min_part = 1e-3;

// Sizes of a correction: of the velocities, in the metric of the masses.
double velocityNorm(const Fronts& fronts, const std::vector<double>& x) {
  double sum = 0;
  for (int i = 0; i < fronts.bodies(); ++i)
    for (int k = 0; k < 6; ++k)
      sum += x[size_t(fronts.body(i) + k)] * x[size_t(fronts.body(i) + k)];
  return std::sqrt(sum);
}

}  // namespace

// Broyden's update of the kept factor by the last step (Kelley 1995, 7.3): what is left of it along itself will be left again.
void Newton::secantStep(const std::vector<double>& last, std::vector<double>& x) const {
  double along = 0, last2 = 0;
  for (int i = 0; i < m_fronts.bodies(); ++i)
    for (int k = 0; k < 6; ++k) {
      const auto at = size_t(m_fronts.body(i) + k);
      along += x[at] * last[at];
      last2 += last[at] * last[at];
    }
  const double part = 1 / (1 - along / last2);
  for (double& of : x) of *= part;
}

// Of `now`: the piece of its law that each row is nearest to.
void Newton::choosePieces() {
  const Iterate& now = m_work.now;
  for (int c = 0; c < m_component.joints; ++c) {
    const IslandJoint& of = joint(c);
    for (int i = 0; i < of.rows; ++i) {
      const auto r = size_t(of.row_of_component + i);
      const double K = row(of, i).K;
      m_work.pieces[r] = row(of, i).law.meet(now.rows[r].u - K * now.lambda[r], K);
    }
  }
}

// x = -F, scaled, with the present pieces.
void Newton::findResidual(const Iterate& at, std::vector<double>& x) {
  x.assign(size_t(m_fronts.size()), 0.);
  m_momentum2 = m_error = 0;
  for (int i = 0; i < m_component.bodies; ++i) {
    const IslandBody& of = body(i);
    const Vector6d change = at.bodies[size_t(i)].v - of.v_free;
    double* const to = &x[size_t(m_fronts.body(i))];
    Eigen::Map<Vector3d> linear(to), angular(to + 3);
    linear = -of.mass * change.head<3>();
    angular = -of.inertia * change.tail<3>();
    if (!m_work.external.empty()) {
      linear += m_work.external[size_t(i)].head<3>();
      angular += m_work.external[size_t(i)].tail<3>();
    }
  }
  for (int c = 0; c < m_component.joints; ++c) {
    const IslandJoint& of = joint(c);
    for (int i = 0; i < of.rows; ++i) {
      const auto r = size_t(of.row_of_component + i);
      const RowAtEnd& end = at.rows[r];
      const double lambda = at.lambda[r];
      for (int side = 0; side < 2; ++side) {
        if (of.body[size_t(side)] < 0) continue;
        double* const to =
            &x[size_t(m_fronts.body(of.body[size_t(side)] - m_component.first_body))];
        Eigen::Map<Vector3d> linear(to), angular(to + 3);
        linear += lambda * end.G.L(side);
        angular += lambda * end.G.A(side);
      }
      const LawPiece& piece = m_work.pieces[r];
      const double K = row(of, i).K, root = row(of, i).root_K;
      const double softness = std::max(piece.softness, leastSoftness(c) * K);
      const double left =
          piece.acts ? end.u + softness * lambda - piece.target : K * (lambda - piece.impulse);
      x[size_t(m_fronts.joint(c) + i)] = -left / root;
      m_error = std::max(m_error, std::abs(left) * m_island.dt);
    }
  }
  for (int i = 0; i < m_component.bodies; ++i) {
    const IslandBody& of = body(i);
    double* const to = &x[size_t(m_fronts.body(i))];
    for (int k = 0; k < 6; ++k) {
      to[k] = of.locked[size_t(k)] ? 0 : to[k] / of.scale[k / 3];
      m_momentum2 += to[k] * to[k];
    }
  }
}

// [H -G^T; J softness], scaled: bodies by the roots of their masses, rows by that of K.
void Newton::assemble(const Iterate& at) {
  m_fronts.clear();
  const double dt = at.horizon;
  for (int i = 0; i < m_component.bodies; ++i) {
    const IslandBody& of = body(i);
    const Fronts::Block to = m_fronts.bodyBlock(i);
    const Matrix3d& inertia = of.inertia;
    for (int k = 0; k < 3; ++k) {
      to.at[k * to.stride + k] += 1;
      for (int j = 0; j < 3; ++j)
        to.at[(3 + k) * to.stride + 3 + j] += inertia(k, j) / (of.scale[1] * of.scale[1]);
    }
  }
  for (int c = 0; c < m_component.joints; ++c) {
    const IslandJoint& of = joint(c);
    const Fronts::Block own = m_fronts.jointBlock(c);
    for (int i = 0; i < of.rows; ++i) {
      const auto r = size_t(of.row_of_component + i);
      const LawPiece& piece = m_work.pieces[r];
      double& diagonal = own.at[i * own.stride + i];
      if (!piece.acts)
        diagonal = 1;
      else
        diagonal = std::max(piece.softness / row(of, i).K, leastSoftness(c));
    }
    for (int side = 0; side < 2; ++side) {
      if (of.body[size_t(side)] < 0) continue;
      const IslandBody& with = m_island.bodies[size_t(of.body[size_t(side)])];
      const Fronts::Block J = m_fronts.jointBodyBlock(c, side),
                          G = m_fronts.bodyJointBlock(c, side);
      for (int i = 0; i < of.rows; ++i) {
        const auto r = size_t(of.row_of_component + i);
        const RowAtEnd& end = at.rows[r];
        const double root = row(of, i).root_K;
        const bool acts = m_work.pieces[r].acts;
        for (int k = 0; k < 6; ++k) {
          if (with.locked[size_t(k)]) continue;
          const double scale = 1 / (root * with.scale[k / 3]);
          if (acts)
            J.at[i * J.stride + k] += scale * (k < 3 ? end.J.L(side) : end.J.A(side))[k % 3];
          G.at[k * G.stride + i] -= scale * (k < 3 ? end.G.L(side) : end.G.A(side))[k % 3];
        }
      }
    }
    GeometricDerivative H;
    const BodyAtEnd &a = bodyOf(m_island, of, 0, m_component, at),
                    &b = bodyOf(m_island, of, 1, m_component, at);
    for (int i = 0; i < of.rows; ++i) {
      const auto r = size_t(of.row_of_component + i);
      H.add(row(of, i), at.rows[r], at.lambda[r], a, b, dt);
    }
    if (!m_exact) H.clip();
    for (int side = 0; side < 2; ++side) {
      if (of.body[size_t(side)] < 0) continue;
      const IslandBody& mine = m_island.bodies[size_t(of.body[size_t(side)])];
      const auto add = [&](const Fronts::Block& to, const IslandBody& by, int column) {
        for (int k = 0; k < 6; ++k)
          for (int j = 0; j < 6; ++j)
            if (!mine.locked[size_t(k)] && !by.locked[size_t(j)])
              to.at[k * to.stride + j] +=
                  H.matrix()(6 * side + k, 6 * column + j) / (mine.scale[k / 3] * by.scale[j / 3]);
      };
      add(m_fronts.bodyBlock(of.body[size_t(side)] - m_component.first_body), mine, side);
      if (of.body[size_t(1 - side)] >= 0 && m_fronts.couplesBodies(c))
        add(m_fronts.bodyBodyBlock(c, side), m_island.bodies[size_t(of.body[size_t(1 - side)])],
            1 - side);
    }
  }
  // What its factors hold does not change.
  for (int i = 0; i < m_component.bodies; ++i) {
    const IslandBody& of = body(i);
    const Fronts::Block to = m_fronts.bodyBlock(i);
    for (int k = 3; k < 6; ++k)
      if (of.locked[size_t(k)])
        for (int j = 3; j < 6; ++j) {
          to.at[k * to.stride + j] = k == j;
          to.at[j * to.stride + k] = k == j;
        }
  }
}

// next = now + part x
void Newton::step(const std::vector<double>& x, double part) {
  const Iterate& from = m_work.now;
  Iterate& to = m_work.next;
  for (int i = 0; i < m_component.bodies; ++i)
    to.bodies[size_t(i)].v =
        from.bodies[size_t(i)].v + part * body(i).unscaled(&x[size_t(m_fronts.body(i))]);
  for (int c = 0; c < m_component.joints; ++c) {
    const IslandJoint& of = joint(c);
    for (int i = 0; i < of.rows; ++i) {
      const auto r = size_t(of.row_of_component + i);
      to.lambda[r] =
          from.lambda[r] + part * x[size_t(m_fronts.joint(c) + i)] / std::sqrt(row(of, i).K);
    }
  }
  moveTo(m_island, m_component, to);
}

// J times the change of velocities that is in x.
double Newton::along(const RowJacobian& J, int c, const std::vector<double>& x) const {
  const auto change = [&](int side) -> Vector6d {
    const int number = joint(c).body[size_t(side)];
    if (number < 0) return Vector6d::Zero();
    return m_island.bodies[size_t(number)].unscaled(
        &x[size_t(m_fronts.body(number - m_component.first_body))]);
  };
  return J.along(change(0), change(1));
}

// Rows with bounds keep their impulses.
void Newton::keepBounded(const Iterate& at) {
  for (int c = 0; c < m_component.joints; ++c) {
    const IslandJoint& of = joint(c);
    for (int i = 0; i < of.rows; ++i) {
      const auto r = size_t(of.row_of_component + i);
      if (!row(of, i).law.isEquality()) m_work.pieces[r] = {false, 0, 0, at.lambda[r]};
    }
  }
}

// x: the correction by equalities alone, with the last factor, becomes that with all rows with bounds on their laws.
void Newton::findBoundedCorrection(std::vector<double>& x) {
  struct Place {
    int joint, index;
    const RowAtEnd& end;
  };
  std::vector<BoundedRow> rows;
  std::vector<Place> place;
  std::vector<double> before;
  for (int c = 0; c < m_component.joints; ++c) {
    const IslandJoint& of = joint(c);
    for (int i = 0; i < of.rows; ++i) {
      const AxisLaw& law = row(of, i).law;
      if (law.isEquality()) continue;
      const auto r = size_t(of.row_of_component + i);
      const RowAtEnd& end = m_work.now.rows[r];
      before.push_back(m_work.now.lambda[r]);
      rows.push_back({&law, end.u + along(end.J, c, x), before.back()});
      place.push_back({c, i, end});
    }
  }
  const size_t n = rows.size();
  std::vector<std::vector<double>> response(n);
  std::vector<double> W(n * n);
  for (size_t k = 0; k < n; ++k) {
    const int c = place[k].joint, i = place[k].index;
    response[k].assign(x.size(), 0.);
    response[k][size_t(m_fronts.joint(c) + i)] = row(joint(c), i).root_K;
    m_fronts.solve(response[k].data());
    for (size_t j = 0; j < n; ++j)
      W[j * n + k] = along(place[j].end.J, place[j].joint, response[k]);
  }
  solveBounded(rows, W, m_options.newton_tolerance / m_island.dt / 10, m_options.max_sweeps);
  for (size_t k = 0; k < n; ++k)
    for (size_t i = 0; i < x.size(); ++i) x[i] += (rows[k].lambda - before[k]) * response[k][i];
}

bool Newton::isConverged(double tolerance, double momentum) {
  m_work.next_pieces = m_work.pieces;
  choosePieces();
  if (hasChangedSet())
    findResidual(m_work.now, m_work.residual);  // else it is that of the last step
  return isWithin(tolerance, momentum);
}

// work.simplified: the correction that is left at work.next, by the last factor. Returns its size; 0 if it is within the
// tolerance.
double Newton::findRest(double tolerance, double momentum) {
  findResidual(m_work.next, m_work.simplified);
  if (isWithin(tolerance, momentum)) return 0;
  m_fronts.solve(m_work.simplified.data());
  return velocityNorm(m_fronts, m_work.simplified);
}

bool Newton::hasChangedSet() const {
  for (size_t i = 0; i < m_work.pieces.size(); ++i) {
    const LawPiece &before = m_work.next_pieces[i], &after = m_work.pieces[i];
    if (before.acts != after.acts || before.target != after.target ||
        before.softness != after.softness || before.impulse != after.impulse)
      return true;
  }
  return false;
}

void Newton::begin() {
  Iterate& now = m_work.now;
  m_work.next.horizon = now.horizon;
  m_work.next.bodies.resize(now.bodies.size());
  m_work.next.lambda.resize(m_work.pieces.size());
  m_work.next.rows.resize(m_work.pieces.size());
  now.rows.resize(m_work.pieces.size());
  m_scale2 = 1e-18;
  for (int i = 0; i < m_component.bodies; ++i) {
    const IslandBody& of = body(i);
    m_scale2 += of.mass * of.v_free.head<3>().squaredNorm() +
                of.v_free.tail<3>().dot(of.inertia * of.v_free.tail<3>());
  }
  findSoftness(m_island, m_component, m_options, m_fronts, m_work);
  moveTo(m_island, m_component, now);
  choosePieces();
}

double Newton::contraction() const {
  return std::pow(10, -m_options.digits_of_factor / m_fronts.solvesOfFactor());
}

bool Newton::factorise() {
  assemble(m_work.now);
  return m_fronts.factorise(m_options.least_pivot);
}

void Newton::findCorrection() {
  findResidual(m_work.now, m_work.correction);
  m_fronts.solve(m_work.correction.data());
}

double Newton::advance() {
  const double length = velocityNorm(m_fronts, m_work.correction);
  double left = 0;
  for (double part = 1; part > short_step; part /= 2) {
    step(m_work.correction, part);
    left = findRest(m_options.contact_tolerance, m_options.contact_momentum_tolerance);
    if (left <= length || isRounding(length)) break;
  }
  std::swap(m_work.now, m_work.next);
  return isRounding(length) ? 0 : left / length;
}

NewtonReport Newton::run() {
  NewtonReport report = iterate();
  if (report.converged || report.steps == 0) return report;
  choosePieces();
  findResidual(m_work.now, m_work.residual);
  report.converged = isWithin(m_options.newton_tolerance, m_options.stalled_momentum_tolerance);
  return report;
}

NewtonReport Newton::iterate() {
  NewtonReport report;
  Iterate& now = m_work.now;
  std::vector<double>& x = m_work.correction;
  bool fresh = false;  // the correction is known, by the last factor
  double length = 0;
  int tangents = 0, changes = 0;
  begin();
  for (;;) {
    if (m_bounded) keepBounded(now);
    if (!fresh) {
      if (report.factors >= m_options.max_second_tier_factors) return report;
      ++report.factors;
      if (!factorise()) return report;
      findCorrection();
    }
    if (m_bounded) findBoundedCorrection(x);
    length = velocityNorm(m_fronts, x);
    double part = 1, left = 0;
    bool accepted = false;
    for (; part > min_part; part /= 2) {
      step(x, part);
      if (m_bounded) keepBounded(m_work.next);
      left = findRest(m_options.newton_tolerance, m_options.momentum_tolerance);
      accepted = left <= (1 - part / 4) * length || isRounding(length);
      if (accepted) break;
    }
    if (!accepted || part < short_step) {
      if (fresh) {  // a factor that is too old
        fresh = false;
        continue;
      }
      // The other tangent; if that gets no further, as far as it goes.
      m_exact = !m_exact;
      if (++tangents < 2) continue;
      if (!accepted) return report;
    }
    tangents = 0;
    std::swap(m_work.now, m_work.next);
    ++report.steps;
    report.converged = isConverged(m_options.newton_tolerance,
                                   isRounding(length) ? infinity : m_options.momentum_tolerance);
    report.error = m_error;
    if (report.converged || report.steps >= m_options.max_newton_iterations) return report;
    const bool same = !hasChangedSet();
    changes = same ? 0 : changes + 1;
    fresh = (same || m_bounded) && part == 1 && left > 0 && left <= contraction() * length;
    if (changes > m_options.max_set_changes && !m_bounded) {
      m_bounded = true;
      fresh = false;
    }
    if (!fresh) continue;
    x.swap(m_work.simplified);
    secantStep(m_work.simplified, x);
  }
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

#include <pintle/solver/contacts.h>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

using MatrixX = Eigen::MatrixXd;
using VectorX = Eigen::VectorXd;

Vector6d sideOf(const RowJacobian& J, int side) {
  Vector6d x;
  x << (side ? J.L_b : J.L_a), (side ? J.A_b : J.A_a);
  return x;
}

// Without what the factors of the body hold.
Vector6d unlocked(const IslandBody& body, Vector6d x) {
  for (int k = 0; k < 6; ++k)
    if (body.locked[size_t(k)]) x[k] = 0;
  return x;
}

// The bodies of a part that contacts touch, or one body without joints; and how they answer impulses.
struct Group {
  ContactPart* part = nullptr;
  std::vector<int> bodies;                   ///< of the island
  MatrixX response;                          ///< of their velocities, six each
  std::vector<std::vector<double>> columns;  ///< of all unknowns of the part
  VectorX change;                            ///< of their velocities, by the contacts in this step
  VectorX impulse;                           ///< on them, in this step
};

// How a row moves a group.
struct Touch {
  int group = -1, at = 0;  ///< `at`: of the body, among the group's
  Vector6d J = Vector6d::Zero();
  VectorX answer;  ///< of the group's velocities, to an impulse of 1
};

class Solve {
 public:
  Solve(const Island& island, std::vector<ContactPart>& parts, std::vector<ContactRow>& rows,
        const SolverOptions& options, std::vector<Vector6d>& velocities)
      : m_island(island),
        m_parts(parts),
        m_rows(rows),
        m_options(options),
        m_velocities(velocities) {}

  ContactReport run();

 private:
  void group();
  void respond(Group& group);
  void answer(const Group& group, int number);
  double sweep();
  void bound(ContactRow& row) const;
  Vector6d velocityOf(int body, size_t part) const;

  const Island& m_island;
  std::vector<ContactPart>& m_parts;
  std::vector<ContactRow>& m_rows;
  const SolverOptions& m_options;
  std::vector<Vector6d>& m_velocities;
  std::vector<Group> m_groups;        ///< the parts first
  std::vector<int> m_group_of, m_at;  ///< of each body
  std::vector<std::array<Touch, 2>> m_touch;
  std::vector<double> m_K, m_u;  ///< of each row
};

void Solve::group() {
  m_groups.assign(m_parts.size(), {});
  m_group_of.assign(m_island.bodies.size(), -1);
  m_at.assign(m_island.bodies.size(), -1);
  for (size_t p = 0; p < m_parts.size(); ++p) {
    m_groups[p].part = &m_parts[p];
    const Component& of = *m_parts[p].component;
    for (int i = of.first_body; i < of.first_body + of.bodies; ++i) m_group_of[size_t(i)] = int(p);
  }
  m_touch.resize(m_rows.size());
  m_K.assign(m_rows.size(), 0);
  m_u.assign(m_rows.size(), 0);
  for (size_t r = 0; r < m_rows.size(); ++r)
    for (int side = 0; side < 2; ++side) {
      const int number = m_rows[r].body[size_t(side)];
      m_touch[r][size_t(side)] = {};
      if (number < 0) continue;
      int& group = m_group_of[size_t(number)];
      if (group < 0) {
        group = int(m_groups.size());
        m_groups.emplace_back();
      }
      int& at = m_at[size_t(number)];
      Group& to = m_groups[size_t(group)];
      if (at < 0) {
        at = int(to.bodies.size());
        to.bodies.push_back(number);
      }
      Touch& touch = m_touch[r][size_t(side)];
      touch.group = group;
      touch.at = 6 * at;
      touch.J = unlocked(m_island.bodies[size_t(number)], sideOf(m_rows[r].J, side));
    }
  for (Group& of : m_groups) {
    of.change = of.impulse = VectorX::Zero(6 * Eigen::Index(of.bodies.size()));
    if (of.part == nullptr) respond(of);
  }
}

// The velocities of its bodies, per impulse on each.
void Solve::respond(Group& of) {
  const auto n = Eigen::Index(of.bodies.size());
  of.response = MatrixX::Zero(6 * n, 6 * n);
  if (of.part == nullptr) {
    const IslandBody& body = m_island.bodies[size_t(of.bodies[0])];
    Matrix3d inertia = body.inertia;
    for (int k = 0; k < 3; ++k)
      if (body.locked[size_t(3 + k)]) {
        inertia.row(k).setZero();
        inertia.col(k).setZero();
        inertia(k, k) = 1;
      }
    for (int k = 0; k < 3; ++k) of.response(k, k) = 1 / body.mass;
    of.response.bottomRightCorner<3, 3>() = inertia.inverse();
    for (int k = 0; k < 6; ++k)
      if (body.locked[size_t(k)]) of.response.row(k).setZero(), of.response.col(k).setZero();
    return;
  }
  const Fronts& fronts = *of.part->fronts;
  const int first = of.part->component->first_body;
  of.columns.resize(size_t(6 * n));
  for (Eigen::Index i = 0; i < n; ++i)
    for (int k = 0; k < 6; ++k) {
      const IslandBody& body = m_island.bodies[size_t(of.bodies[size_t(i)])];
      std::vector<double>& column = of.columns[size_t(6 * i + k)];
      column.assign(size_t(fronts.size()), 0.);
      if (body.locked[size_t(k)]) continue;
      column[size_t(fronts.body(of.bodies[size_t(i)] - first) + k)] = 1 / body.scale[k / 3];
      fronts.solve(column.data());
      for (Eigen::Index j = 0; j < n; ++j) {
        const IslandBody& other = m_island.bodies[size_t(of.bodies[size_t(j)])];
        for (int l = 0; l < 6; ++l)
          if (!other.locked[size_t(l)])
            of.response(6 * j + l, 6 * i + k) =
                column[size_t(fronts.body(of.bodies[size_t(j)] - first) + l)] / other.scale[l / 3];
      }
    }
}

void Solve::answer(const Group& of, int number) {
  for (std::array<Touch, 2>& sides : m_touch)
    for (Touch& touch : sides)
      if (touch.group == number) touch.answer = of.response.middleCols<6>(touch.at) * touch.J;
}

void Solve::bound(ContactRow& row) const {
  if (row.normal < 0) return;
  row.upper = row.friction * m_rows[size_t(row.normal)].impulse;
  row.lower = -row.upper;
}

// One pass over all rows. Returns the largest change, m/s.
double Solve::sweep() {
  double largest = 0;
  for (size_t r = 0; r < m_rows.size(); ++r) {
    ContactRow& row = m_rows[r];
    const double K = m_K[r];
    if (!(K > 0)) continue;
    bound(row);
    double u = m_u[r];
    for (const Touch& touch : m_touch[r])
      if (touch.group >= 0)
        u += touch.J.dot(m_groups[size_t(touch.group)].change.segment<6>(touch.at));
    const double next = std::min(
        std::max(row.impulse - (u + row.softness * row.impulse - row.target) / (K + row.softness),
                 row.lower),
        row.upper);
    const double change = next - row.impulse;
    if (change == 0) continue;
    row.impulse = next;
    for (const Touch& touch : m_touch[r]) {
      if (touch.group < 0) continue;
      Group& of = m_groups[size_t(touch.group)];
      of.change += change * touch.answer;
      of.impulse.segment<6>(touch.at) += change * touch.J;
    }
    largest = std::max(largest, std::abs(K * change));
  }
  return largest;
}

ContactReport Solve::run() {
  ContactReport report;
  group();
  std::vector<Newton> newtons;
  newtons.reserve(m_parts.size());
  std::vector<char> stale(m_parts.size(), true);
  // What the last step's impulses, with which contacts begin, do.
  for (ContactPart& part : m_parts)
    part.work->external.assign(size_t(part.component->bodies), Vector6d::Zero());
  const auto addExternal = [&](int number, const Vector6d& impulse) {
    const int p = m_group_of[size_t(number)];
    if (p < int(m_parts.size()))
      m_parts[size_t(p)]
          .work->external[size_t(number - m_parts[size_t(p)].component->first_body)] += impulse;
    else
      m_velocities[size_t(number)] += m_groups[size_t(p)].response * impulse;
  };
  for (size_t r = 0; r < m_rows.size(); ++r)
    for (int side = 0; side < 2; ++side)
      if (m_rows[r].body[size_t(side)] >= 0)
        addExternal(m_rows[r].body[size_t(side)], m_rows[r].impulse * m_touch[r][size_t(side)].J);
  for (ContactPart& part : m_parts) {
    part.work->now.horizon = m_island.dt;
    newtons.emplace_back(m_island, *part.component, Tier::gradient, m_options, *part.fronts,
                         *part.work);
    newtons.back().begin();
  }
  const double tolerance = m_options.contact_tolerance;
  for (; report.steps < m_options.max_newton_iterations; ++report.steps) {
    for (size_t p = 0; p < m_parts.size(); ++p) {
      if (stale[p]) {
        ++report.factors;
        if (!newtons[p].factorise()) return report;
        respond(m_groups[p]);
        answer(m_groups[p], int(p));
      }
      newtons[p].findCorrection();
    }
    if (report.steps == 0)
      for (size_t g = m_parts.size(); g < m_groups.size(); ++g) answer(m_groups[g], int(g));
    // Velocities of the rows, if the contacts' impulses stay.
    for (Group& of : m_groups) of.change.setZero(), of.impulse.setZero();
    for (size_t r = 0; r < m_rows.size(); ++r) {
      m_u[r] = m_K[r] = 0;
      for (const Touch& touch : m_touch[r]) {
        if (touch.group < 0) continue;
        const Group& of = m_groups[size_t(touch.group)];
        const int number = of.bodies[size_t(touch.at / 6)];
        Vector6d v = of.part == nullptr ? m_velocities[size_t(number)] : Vector6d::Zero();
        if (of.part != nullptr) {
          const int local = number - of.part->component->first_body;
          v = of.part->work->now.bodies[size_t(local)].v;
          const double* const d = &of.part->work->correction[size_t(of.part->fronts->body(local))];
          const IslandBody& body = m_island.bodies[size_t(number)];
          for (int k = 0; k < 6; ++k)
            if (!body.locked[size_t(k)]) v[k] += d[k] / body.scale[k / 3];
        }
        m_u[r] += touch.J.dot(v);
        m_K[r] += touch.J.dot(touch.answer.segment<6>(touch.at));
      }
      const auto& touch = m_touch[r];
      if (touch[0].group >= 0 && touch[0].group == touch[1].group)
        m_K[r] += touch[0].J.dot(touch[1].answer.segment<6>(touch[0].at)) +
                  touch[1].J.dot(touch[0].answer.segment<6>(touch[1].at));
    }
    double moved = 0;
    for (int i = 0; i < m_options.max_contact_sweeps; ++i) {
      const double largest = sweep();
      if (i == 0) moved = largest;
      if (largest * m_island.dt <= tolerance / 10) break;
    }
    bool done = moved * m_island.dt <= tolerance;
    report.error = 0;
    for (size_t p = 0; p < m_parts.size(); ++p) {
      Group& of = m_groups[p];
      std::vector<double>& x = m_parts[p].work->correction;
      for (Eigen::Index k = 0; k < of.impulse.size(); ++k) {
        if (of.impulse[k] == 0) continue;
        const std::vector<double>& column = of.columns[size_t(k)];
        for (size_t i = 0; i < x.size(); ++i) x[i] += of.impulse[k] * column[i];
      }
      for (size_t i = 0; i < of.bodies.size(); ++i)
        addExternal(of.bodies[i], of.impulse.segment<6>(6 * Eigen::Index(i)));
      const double left = newtons[p].advance();
      const bool converged =
          newtons[p].isConverged(tolerance, m_options.contact_momentum_tolerance);
      stale[p] = !(left <= m_options.contraction) || newtons[p].hasChangedSet();
      report.error = std::max(report.error, newtons[p].error());
      done = done && converged;
    }
    for (size_t g = m_parts.size(); g < m_groups.size(); ++g)
      addExternal(m_groups[g].bodies[0], m_groups[g].impulse);
    if (done) {
      ++report.steps;
      report.converged = true;
      break;
    }
  }
  for (const ContactPart& part : m_parts)
    for (int i = 0; i < part.component->bodies; ++i)
      m_velocities[size_t(part.component->first_body + i)] = part.work->now.bodies[size_t(i)].v;
  return report;
}

}  // namespace

ContactReport solveAmongContacts(const Island& island, std::vector<ContactPart>& parts,
                                 std::vector<ContactRow>& rows, const SolverOptions& options,
                                 std::vector<Vector6d>& velocities) {
  return Solve(island, parts, rows, options, velocities).run();
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

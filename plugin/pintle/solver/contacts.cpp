#include <pintle/solver/contacts.h>

#include <algorithm>
#include <cmath>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

using MatrixX = Eigen::MatrixXd;
using VectorX = Eigen::VectorXd;

Vector6d sideOf(const RowJacobian& J, int side) {
  Vector6d x;
  x << J.L(side), J.A(side);
  return x;
}

// Without what the factors of the body hold.
Vector6d unlocked(const IslandBody& body, Vector6d x) {
  for (int k = 0; k < 6; ++k)
    if (body.locked[size_t(k)]) x[k] = 0;
  return x;
}

// How a row moves a group.
struct Touch {
  int group = -1;
  int at = 0;  ///< where the velocity of its body is among the group's
  Vector6d J = Vector6d::Zero();
  VectorX answer;  ///< of the group's velocities, to an impulse of 1
};

// The bodies of a part that contacts touch, or one body without joints; and how they answer impulses.
struct Group {
  ContactPart* part = nullptr;
  std::vector<int> bodies;  ///< of the island
  std::vector<Touch*> touches;
  MatrixX response;                          ///< of their velocities, six each
  std::vector<std::vector<double>> columns;  ///< of all unknowns of the part
  VectorX velocity;                          ///< of their bodies at the end of this Newton step
  VectorX impulse;                           ///< of contacts on them in it
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

  NewtonReport run();

 private:
  void group();
  void respond(Group& group);
  void answer(Group& group);
  void addExternal(int number, const Vector6d& impulse);
  void predict(Group& group);
  double sweep();
  double iterate();
  void correct(Group& group);
  const IslandBody& body(int number) const { return m_island.bodies[size_t(number)]; }

  const Island& m_island;
  std::vector<ContactPart>& m_parts;
  std::vector<ContactRow>& m_rows;
  const SolverOptions& m_options;
  std::vector<Vector6d>& m_velocities;
  std::vector<Group> m_groups;        ///< the parts first
  std::vector<int> m_group_of, m_at;  ///< of each body
  std::vector<std::array<Touch, 2>> m_touch;
  std::vector<double> m_K;  ///< of each row
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
  for (size_t r = 0; r < m_rows.size(); ++r)
    for (int side = 0; side < 2; ++side) {
      const int number = m_rows[r].body[size_t(side)];
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
      touch.J = unlocked(body(number), sideOf(m_rows[r].J, side));
      to.touches.push_back(&touch);
    }
  for (Group& of : m_groups) {
    of.velocity.resize(6 * Eigen::Index(of.bodies.size()));
    of.impulse.resize(of.velocity.size());
    if (of.part != nullptr) continue;
    respond(of);
    answer(of);
  }
}

// The velocities of its bodies, per impulse on each.
void Solve::respond(Group& of) {
  const auto n = Eigen::Index(of.bodies.size());
  of.response = MatrixX::Zero(6 * n, 6 * n);
  if (of.part == nullptr) {
    const IslandBody& free = body(of.bodies[0]);
    for (int k = 0; k < 3; ++k) of.response(k, k) = free.locked[size_t(k)] ? 0 : 1 / free.mass;
    of.response.bottomRightCorner<3, 3>() = free.inverse_inertia;
    return;
  }
  const Fronts& fronts = *of.part->fronts;
  const int first = of.part->component->first_body;
  of.columns.resize(size_t(6 * n));
  for (Eigen::Index i = 0; i < n; ++i)
    for (int k = 0; k < 6; ++k) {
      const int number = of.bodies[size_t(i)];
      std::vector<double>& column = of.columns[size_t(6 * i + k)];
      column.assign(size_t(fronts.size()), 0.);
      if (body(number).locked[size_t(k)]) continue;
      column[size_t(fronts.body(number - first) + k)] = 1 / body(number).scale[k / 3];
      fronts.solve(column.data());
      for (Eigen::Index j = 0; j < n; ++j) {
        const int other = of.bodies[size_t(j)];
        of.response.block<6, 1>(6 * j, 6 * i + k) =
            body(other).unscaled(&column[size_t(fronts.body(other - first))]);
      }
    }
}

void Solve::answer(Group& of) {
  for (Touch* const touch : of.touches)
    touch->answer = of.response.middleCols<6>(touch->at) * touch->J;
}

// An impulse of contacts on a body: of a part for Newton's iteration, of one without joints at once.
void Solve::addExternal(int number, const Vector6d& impulse) {
  Group& of = m_groups[size_t(m_group_of[size_t(number)])];
  if (of.part != nullptr)
    of.part->work->external[size_t(number - of.part->component->first_body)] += impulse;
  else
    m_velocities[size_t(number)] += of.response * impulse;
}

// Velocities after the Newton step that is found, if the contacts' impulses stay.
void Solve::predict(Group& of) {
  of.impulse.setZero();
  for (size_t i = 0; i < of.bodies.size(); ++i) {
    const int number = of.bodies[i];
    Vector6d& v = m_velocities[size_t(number)];
    if (of.part != nullptr) {
      const int local = number - of.part->component->first_body;
      const Workspace& work = *of.part->work;
      v = work.now.bodies[size_t(local)].v +
          body(number).unscaled(&work.correction[size_t(of.part->fronts->body(local))]);
    }
    of.velocity.segment<6>(6 * Eigen::Index(i)) = v;
  }
}

// One pass over all rows. Returns the largest change, m/s.
double Solve::sweep() {
  double largest = 0;
  for (size_t r = 0; r < m_rows.size(); ++r) {
    ContactRow& row = m_rows[r];
    const double K = m_K[r];
    if (!(K > 0)) continue;
    boundFriction(m_rows, row);
    double u = 0;
    for (const Touch& touch : m_touch[r])
      if (touch.group >= 0)
        u += touch.J.dot(m_groups[size_t(touch.group)].velocity.segment<6>(touch.at));
    const double next = row.meet(u, K);
    const double change = next - row.impulse;
    if (change == 0) continue;
    row.impulse = next;
    for (const Touch& touch : m_touch[r]) {
      if (touch.group < 0) continue;
      Group& of = m_groups[size_t(touch.group)];
      of.velocity += change * touch.answer;
      of.impulse.segment<6>(touch.at) += change * touch.J;
    }
    largest = std::max(largest, std::abs(K * change));
  }
  return largest;
}

// Contacts, until none changes. Returns how much the first pass changed, m/s.
double Solve::iterate() {
  for (size_t r = 0; r < m_rows.size(); ++r) {
    m_K[r] = 0;
    for (const Touch& touch : m_touch[r])
      for (const Touch& other : m_touch[r])
        if (touch.group >= 0 && touch.group == other.group)
          m_K[r] += touch.J.dot(other.answer.segment<6>(touch.at));
  }
  double first = 0;
  for (int i = 0; i < m_options.max_contact_sweeps; ++i) {
    const double largest = sweep();
    if (i == 0) first = largest;
    if (largest * m_island.dt <= m_options.contact_tolerance / 10) break;
  }
  // Bullet bounds contacts at 1e10: there they jam, and nothing is found.
  for (const ContactRow& row : m_rows)
    if (row.normal < 0 && row.impulse > 0 && row.impulse >= row.upper) return infinity;
  return first;
}

// What the contacts' impulses of this step do to its Newton step, and to the next ones.
void Solve::correct(Group& of) {
  for (size_t i = 0; i < of.bodies.size(); ++i)
    addExternal(of.bodies[i], of.impulse.segment<6>(6 * Eigen::Index(i)));
  if (of.part == nullptr) return;
  std::vector<double>& x = of.part->work->correction;
  for (Eigen::Index k = 0; k < of.impulse.size(); ++k) {
    if (of.impulse[k] == 0) continue;
    const std::vector<double>& column = of.columns[size_t(k)];
    for (size_t i = 0; i < x.size(); ++i) x[i] += of.impulse[k] * column[i];
  }
}

NewtonReport Solve::run() {
  NewtonReport report;
  group();
  for (ContactPart& part : m_parts)
    part.work->external.assign(size_t(part.component->bodies), Vector6d::Zero());
  // What the last step's impulses, with which contacts begin, do.
  for (size_t r = 0; r < m_rows.size(); ++r)
    for (size_t side = 0; side < 2; ++side)
      if (m_rows[r].body[side] >= 0)
        addExternal(m_rows[r].body[side], m_rows[r].impulse * m_touch[r][side].J);
  std::vector<Newton> newtons;
  newtons.reserve(m_parts.size());
  for (ContactPart& part : m_parts) {
    part.work->now.horizon = m_island.dt;
    newtons.emplace_back(m_island, *part.component, m_options, *part.fronts, *part.work);
    newtons.back().clipTangent();
    newtons.back().begin();
  }
  std::vector<char> stale(m_parts.size(), true);
  const double tolerance = m_options.contact_tolerance;
  while (!report.converged && report.steps < m_options.max_newton_iterations) {
    for (size_t p = 0; p < m_parts.size(); ++p) {
      if (stale[p]) {
        ++report.factors;
        if (!newtons[p].factorise()) return report;
        respond(m_groups[p]);
        answer(m_groups[p]);
      }
      newtons[p].findCorrection();
    }
    for (Group& of : m_groups) predict(of);
    report.converged = iterate() * m_island.dt <= tolerance;
    for (Group& of : m_groups) correct(of);
    report.error = 0;
    for (size_t p = 0; p < m_parts.size(); ++p) {
      const double left = newtons[p].advance();
      if (!newtons[p].isConverged(tolerance, m_options.contact_momentum_tolerance))
        report.converged = false;
      stale[p] = !(left <= newtons[p].contraction()) || newtons[p].hasChangedSet();
      report.error = std::max(report.error, newtons[p].error());
    }
    ++report.steps;
  }
  return report;
}

}  // namespace

NewtonReport solveAmongContacts(const Island& island, std::vector<ContactPart>& parts,
                                std::vector<ContactRow>& rows, const SolverOptions& options,
                                std::vector<Vector6d>& velocities) {
  return Solve(island, parts, rows, options, velocities).run();
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

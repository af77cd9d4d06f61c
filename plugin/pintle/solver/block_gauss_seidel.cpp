#include <pintle/solver/block_gauss_seidel.h>

#include <pintle/solver/active_set.h>
#include <pintle/solver/row_velocities.h>

#include <cmath>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

// Bodies that swing faster than a step resolves resist it (load_stiffness.h): (M + S) v = M v*. That takes energy, too.
void addStiffness(const Island& island, const JointBlock& of, std::vector<Vector6d>& velocities) {
  std::vector<InverseInertia>& bodies = of.K->bodies();
  bodies.clear();
  for (int i = 0; i < of.component->bodies; ++i) {
    const int number = of.component->first_body + i;
    const Matrix3d& S = of.work->stiffness[size_t(i)];
    bodies.emplace_back(island.bodies[size_t(number)], S);
    Vector6d& v = velocities[size_t(number)];
    v.tail<3>() -= bodies.back().angular * (S * v.tail<3>());
  }
}

/// The joints of a component.
class Block {
 public:
  Block(const Island& island, const JointBlock& of, const SolverOptions& options)
      : m_island(island),
        m_of(of),
        m_options(options),
        m_work(*of.work),
        m_set(island, *of.component, options, *of.K, *of.work) {}

  /// `base`: velocities without impulses of joints; of all bodies of the island, as those that follow. Returns false where the rows
  /// have no solution.
  bool begin(Sweep sweep, const std::vector<Vector6d>& base, std::vector<Vector6d>& velocities);
  /// One pass over its rows. Sets the largest change, m/s or rad/s, if it is larger. Returns false where they have no solution.
  bool sweep(const std::vector<Vector6d>& base, std::vector<Vector6d>& velocities, double& largest);
  /// Whether one pass solves them.
  bool isDirect() const { return m_swept == nullptr; }
  int factors() const { return m_set.factors(); }
  void finish(const std::vector<Vector6d>& velocities);

 private:
  bool solve(const std::vector<Vector6d>& base, std::vector<Vector6d>& velocities);
  bool changeSet();
  double sweepRows(std::vector<Vector6d>& velocities);
  void respond(const std::vector<Vector6d>& base, std::vector<Vector6d>& velocities);
  Vector6d* firstOf(std::vector<Vector6d>& v) const {
    return v.data() + m_of.component->first_body;
  }
  void measure(std::vector<Vector6d>& velocities) {
    measureAtStart(m_island, *m_of.component, firstOf(velocities), m_work.u);
  }

  const Island& m_island;
  const JointBlock& m_of;
  const SolverOptions& m_options;
  Workspace& m_work;
  ActiveSet m_set;
  const std::vector<ActiveSet::Place>* m_swept = nullptr;  ///< rows that are solved one by one
  bool m_has_factor = false;
};

// What the impulses lead to.
void Block::respond(const std::vector<Vector6d>& base, std::vector<Vector6d>& velocities) {
  const int first = m_of.component->first_body;
  std::copy_n(base.begin() + first, m_of.component->bodies, velocities.begin() + first);
  m_of.K->addResponse(m_work.y.data(), firstOf(velocities));
}

bool Block::begin(Sweep sweep, const std::vector<Vector6d>& base,
                  std::vector<Vector6d>& velocities) {
  bool solvable = true;
  if (sweep == Sweep::one_by_one) {
    std::fill(m_work.y.begin(), m_work.y.end(), 0.);
    m_swept = &m_set.all();
    m_set.release(*m_swept);
    m_set.setRows();
  } else {
    measure(velocities);
    m_set.choose();
    solvable = m_has_factor = m_set.factorise(m_options.max_set_factors);
  }
  respond(base, velocities);
  return solvable;
}

// Sets may follow each other without an end: then rows with bounds are solved one by one, from nothing.
bool Block::changeSet() {
  if (m_set.factorise(m_options.max_set_factors)) return true;
  m_swept = &m_set.bounded();
  for (const ActiveSet::Place& of : *m_swept) m_work.y[of.at] = 0;
  m_set.release(*m_swept);
  return m_set.factorise(m_options.max_set_factors + 1);
}

bool Block::sweep(const std::vector<Vector6d>& base, std::vector<Vector6d>& velocities,
                  double& largest) {
  if (m_swept != nullptr) largest = std::fmax(largest, sweepRows(velocities));
  return !m_has_factor || solve(base, velocities);
}

// All at once, and again as long as that gains digits.
bool Block::solve(const std::vector<Vector6d>& base, std::vector<Vector6d>& velocities) {
  for (double last = infinity;;) {
    respond(base, velocities);
    measure(velocities);
    std::fill(m_work.x.begin(), m_work.x.end(), 0.);  // of bodies that are unknowns, too
    const double error = m_set.findResidual();
    if (error <= m_options.newton_tolerance || !(error < last / 2)) {
      if (m_swept != nullptr || !m_set.chooseAgain()) return std::isfinite(error);
      if (!changeSet()) return false;
      last = infinity;
      continue;
    }
    m_of.K->solve(m_work.x.data());
    for (size_t k = 0; k < m_work.y.size(); ++k) m_work.y[k] += m_work.x[k];
    last = error;
  }
}

double Block::sweepRows(std::vector<Vector6d>& velocities) {
  double largest = 0;
  for (const ActiveSet::Place& of : *m_swept) {
    const IslandRow& row = *of.row;
    const IslandJoint& joint = m_island.joints[size_t(m_of.component->first_joint + of.joint)];
    const auto v = [&](int side) -> const Vector6d& {
      const int body = joint.body[size_t(side)];
      return body < 0 ? m_island.unmovedBody(body).v : velocities[size_t(body)];
    };
    double& y = m_work.y[of.at];
    const double lambda = y / row.root_K, free = row.J.along(v(0), v(1)) - row.K * lambda,
                 next = row.law.meet(free, row.K).impulseAt(free, row.K), change = next - lambda;
    if (change == 0) continue;
    y = next * row.root_K;
    m_work.pieces[of.r].impulse = next;
    for (int side = 0; side < 2; ++side) {
      const int body = joint.body[size_t(side)];
      if (body < 0) continue;
      const InverseInertia& by = m_of.K->bodies()[size_t(body - m_of.component->first_body)];
      velocities[size_t(body)].head<3>() += change * by.linear.cwiseProduct(row.J.L(side));
      velocities[size_t(body)].tail<3>() += change * by.angular * row.J.A(side);
    }
    largest = std::fmax(largest, std::abs(row.K * change));
  }
  return largest;
}

void Block::finish(const std::vector<Vector6d>& velocities) {
  const int first = m_of.component->first_body;
  m_work.v.assign(velocities.begin() + first, velocities.begin() + first + m_of.component->bodies);
  measureAtStart(m_island, *m_of.component, m_work.v.data(), m_work.u);
  m_set.keepImpulses();
}

// What impulses of contacts do.
void findAnswers(const Island& island, const std::vector<JointBlock>& of,
                 std::vector<ContactRow>& contacts) {
  std::vector<const InverseInertia*> inertia(island.bodies.size(), nullptr);
  for (const JointBlock& part : of)
    for (int i = 0; i < part.component->bodies; ++i)
      inertia[size_t(part.component->first_body + i)] = &part.K->bodies()[size_t(i)];
  for (ContactRow& row : contacts) {
    row.K = 0;
    for (int side = 0; side < 2; ++side) {
      const int body = row.body[size_t(side)];
      if (body < 0) continue;
      Vector6d& answer = row.answer[size_t(side)];
      answer = island.bodies[size_t(body)].answer(row.J.L(side), row.J.A(side));
      if (const InverseInertia* const by = inertia[size_t(body)])
        answer.tail<3>() = by->angular * row.J.A(side);
      row.K += row.J.L(side).dot(answer.head<3>()) + row.J.A(side).dot(answer.tail<3>());
    }
  }
}

// One pass. Returns the largest change, m/s.
double sweepContacts(std::vector<ContactRow>& contacts, std::vector<Vector6d>& base,
                     std::vector<Vector6d>& velocities) {
  double largest = 0;
  for (ContactRow& row : contacts) {
    if (!(row.K > 0)) continue;
    boundFriction(contacts, row);
    const double next = row.meet(row.velocity(velocities)), change = next - row.impulse;
    if (change == 0) continue;
    row.impulse = next;
    row.push(change, velocities);
    row.push(change, base);
    largest = std::fmax(largest, std::abs(row.K * change));
  }
  return largest;
}

}  // namespace

SolveReport solveInVelocity(const Island& island, std::vector<JointBlock>& of,
                            std::vector<ContactRow>& contacts, const SolverOptions& options,
                            Sweep sweep, int most, std::vector<Vector6d>& velocities) {
  SolveReport report;
  velocities.clear();
  for (const IslandBody& body : island.bodies) velocities.push_back(body.v_free);
  for (const JointBlock& part : of) addStiffness(island, part, velocities);
  findAnswers(island, of, contacts);
  for (ContactRow& row : contacts)
    if (sweep == Sweep::one_by_one)
      row.impulse = 0;
    else
      row.push(row.impulse, velocities);
  std::vector<Vector6d> base = velocities;
  std::vector<Block> blocks;
  blocks.reserve(of.size());
  bool solvable = true;
  for (const JointBlock& part : of) {
    blocks.emplace_back(island, part, options);
    solvable = blocks.back().begin(sweep, base, velocities) && solvable;
  }
  while (solvable && !report.converged && report.steps < most) {
    double largest = sweepContacts(contacts, base, velocities);
    bool direct = contacts.empty();
    for (Block& block : blocks) {
      solvable = block.sweep(base, velocities, largest) && solvable;
      direct = direct && block.isDirect();
    }
    ++report.steps;
    report.error = largest * island.dt;
    report.converged = direct || report.error <= options.contact_tolerance;
  }
  for (Block& block : blocks) {
    report.factors += block.factors();
    block.finish(velocities);
  }
  report.converged = report.converged && solvable;
  return report;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle

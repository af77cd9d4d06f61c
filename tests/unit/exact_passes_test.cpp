// Joints and contacts in velocity: on random bodies, of which no step needs to be played.
#include <pintle/solver/solve/passes.h>

#include <gtest/gtest.h>

#include <numeric>

#include <cmath>
#include <vector>

#include "support.h"

namespace exact_passes_test {

using pintle::AxisLaw;
using pintle::Matrix3d;
using pintle::Vector3d;
using pintle::Vector6d;
using support::Random;

Vector3d numbers(const btVector3& v) { return {double(v.x()), double(v.y()), double(v.z())}; }

// A chain of bodies on the ground, with joints of three rows and a limit each, and contacts at random.
class Chain : public testing::Test {
 protected:
  static constexpr int bodies = 6, rows_of_joint = 4;

  void make(int contact_count, bool with_motors = false, bool with_two_stops = false) {
    m_with_motors = with_motors;
    m_with_two_stops = with_two_stops;
    m_island = {};
    m_island.dt = 1. / 60;
    m_island.unmoved_bodies.emplace_back(Vector6d::Zero(), 0);
    m_component = {0, bodies, 0, bodies, rows_of_joint * bodies};
    std::vector<std::array<int, 2>> joints;
    for (int i = 0; i < bodies; ++i) {
      m_island.bodies.push_back(body());
      joints.push_back({i - 1, i});
      addJoint(i);
    }
    m_K.analyse(joints, pintle::JointMatrix::Locks(bodies));
    m_K.setSizes(std::vector<int>(bodies, rows_of_joint));
    m_work.lambda.assign(size_t(m_component.rows), 0.);
    m_work.stiffness.assign(bodies, Matrix3d::Zero());
    m_work.of_loop.assign(bodies, 0.);
    m_contacts.clear();
    for (int i = 0; i < contact_count; ++i) addContact(int(random.uniform(0, bodies * 0.999)));
  }

  pintle::SolveReport solve(pintle::Sweep sweep, int passes, double impulse = 0) {
    m_work.lambda.assign(m_work.lambda.size(), 0.);
    for (pintle::ContactRow& row : m_contacts) row.impulse = impulse;
    std::vector<pintle::BlockOfJoints> blocks = {{&m_component, &m_K, &m_work}};
    pintle::SolverOptions options;
    options.contact_tolerance = 0;
    options.newton_tolerance = 1e-9;
    std::vector<int> all(m_island.bodies.size());
    std::iota(all.begin(), all.end(), 0);
    m_velocities.resize(all.size());
    m_memory.response.begin(all.size());
    return pintle::solveInVelocity(m_island, blocks, all, m_contacts, options, sweep, passes,
                                   m_velocities, m_memory);
  }
  double kinetic() const {
    double sum = 0;
    for (size_t i = 0; i < m_velocities.size(); ++i) {
      const Vector6d& v = m_velocities[i];
      sum += (m_island.bodies[i].mass * v.head<3>().squaredNorm() +
              v.tail<3>().dot(m_island.bodies[i].inertia * v.tail<3>())) /
             2;
    }
    return sum;
  }

  Random random{5};
  pintle::Island m_island;
  pintle::Component m_component;
  pintle::JointMatrix m_K;
  pintle::Workspace m_work;
  std::vector<pintle::ContactRow> m_contacts;
  std::vector<Vector6d> m_velocities;
  pintle::PassMemory m_memory;

 private:
  bool m_with_motors = false, m_with_two_stops = false;

  pintle::IslandBody body() {
    pintle::IslandBody to = {};
    to.start.setIdentity();
    to.mass = std::pow(10, random.uniform(-1, 1));
    to.inverse_mass.setConstant(1 / to.mass);
    const Matrix3d A = Matrix3d::NullaryExpr([&] { return random.uniform(-1, 1); });
    to.inertia = to.mass * (A * A.transpose() + 0.1 * Matrix3d::Identity());
    to.inverse_inertia = to.inertia.inverse();
    to.scale[0] = std::sqrt(to.mass);
    to.scale[1] = std::sqrt(to.inertia.trace() / 3);
    to.v_free << numbers(random.vector(3)), numbers(random.vector(3));
    to.v0 = to.v_free;
    to.push.setZero();
    return to;
  }
  double K(const std::array<int, 2>& of, const pintle::RowJacobian& J) const {
    double sum = 0;
    for (int side = 0; side < 2; ++side) {
      if (of[size_t(side)] < 0) continue;
      const pintle::IslandBody& body = m_island.bodies[size_t(of[size_t(side)])];
      sum += J.L(side).squaredNorm() / body.mass + J.A(side).dot(body.inverse_inertia * J.A(side));
    }
    return sum;
  }
  void addJoint(int i) {
    pintle::IslandJoint joint = {};
    joint.body = {i - 1, i};
    joint.first_row = joint.row_of_component = rows_of_joint * i;
    for (int r = 0; r < rows_of_joint; ++r) {
      pintle::IslandRow row;
      row.has_position = false;
      row.index = r;
      row.law = AxisLaw(m_island.giveExtras(row).parts);
      Vector3d n = Vector3d::Zero();
      if (r < 3) n[r] = 1;
      const Vector3d A = numbers(random.vector(1)),
                     A_a = r < 3 ? numbers(random.vector(1)) : Vector3d(-A);
      row.J = {-n, A_a, n, A};
      row.setK(K(joint.body, row.J));
      if (r < 3)
        row.law.add({0, 0, -AxisLaw::unbounded, AxisLaw::unbounded});
      else
        row.law.add({random.uniform(-2, 0), 0, 0, AxisLaw::unbounded});
      if (r == 3 && m_with_two_stops)
        row.law.add({random.uniform(0, 2), 0, -AxisLaw::unbounded, 0});
      if (r == 3 && m_with_motors) {
        const double most = random.uniform(0.1, 1);
        row.law.add({random.uniform(-5, 5), 0, -most, most, true});
      }
      joint.add(row);
      m_island.rows.push_back(row);
    }
    m_island.joints.push_back(joint);
  }
  void addContact(int on) {
    pintle::ContactRow row = {};
    row.body = {on, pintle::Island::unmoved(pintle::Island::at_rest)};
    const Vector3d n = numbers(random.unit()), A = numbers(random.vector(1));
    row.J = {n, A, -n, A};
    row.upper = 1e10;
    row.normal = -1;
    m_contacts.push_back(row);
  }
};

// KE(v) - KE(v*) - lambda . target falls with each pass: it is the dual function, of which each block finds its minimum. So KE(v) is
// never above KE(v*): rows push, and limits aim at less than 0.
TEST_F(Chain, NoPassGivesEnergy) {
  int among_contacts = 0;  // limits that go on as contacts do
  for (int trial = 0; trial < support::trials(100); ++trial) {
    make(8);
    m_velocities.clear();
    for (const pintle::IslandBody& body : m_island.bodies) m_velocities.push_back(body.v_free);
    const double start = kinetic();
    double last = 0;
    for (const int passes : {1, 2, 3, 5, 10, 30}) {
      solve(pintle::Sweep::one_by_one, passes);
      double dual = kinetic() - start;
      for (size_t r = 0; r < m_island.rows.size(); ++r)
        dual -= m_work.lambda[r] * m_island.rows[r].law.part(0).target;
      EXPECT_LE(kinetic(), start) << passes;
      EXPECT_LE(dual, last + 1e-9 * start) << passes;
      last = dual;
    }
    for (const int passes : {1, 2, 3, 5, 10, 30}) {
      solve(pintle::Sweep::passes, passes);
      EXPECT_LE(kinetic(), (1 + 1e-9) * start) << passes;
      among_contacts += !m_memory.bounds.empty();
    }
  }
  EXPECT_GT(among_contacts, support::trials(100));
}

TEST_F(Chain, WithoutContactsEveryRowIsOnItsLaw) {
  int found = 0, acts = 0;
  for (int trial = 0; trial < support::trials(300); ++trial) {
    make(0);
    const pintle::SolveReport done = solve(pintle::Sweep::passes, 10);
    if (!done.converged) continue;  // no set of limits was found
    ++found;
    for (size_t r = 0; r < m_island.rows.size(); ++r) {
      const double u = m_work.u[r], lambda = m_work.lambda[r];
      if (r % rows_of_joint < 3) {
        EXPECT_NEAR(u, 0, 1e-6);
        continue;
      }
      const double beyond = u - m_island.rows[r].law.part(0).target;
      EXPECT_GE(beyond, -1e-6);
      EXPECT_GE(lambda, 0);
      EXPECT_LE(std::min(lambda, beyond), 1e-6);
      acts += lambda > 0;
    }
  }
  EXPECT_GT(found, support::trials(250));
  EXPECT_GT(acts, support::trials(250));
}

// Nor do those that press in the end pull, when they are solved with all others, however early the passes end: at a stop they push
// away from it. What the report of a joint says of its stops is what they give.
TEST_F(Chain, LimitsOnlyPush) {
  for (const bool with_two_stops : {false, true}) {
    int press = 0;
    for (int trial = 0; trial < support::trials(200); ++trial) {
      make(8, false, with_two_stops);
      for (const int passes : {1, 2, 5}) {
        solve(pintle::Sweep::passes, passes);
        for (size_t r = 3; r < m_island.rows.size(); r += rows_of_joint) {
          const AxisLaw& law = m_island.rows[r].law;
          const double lambda = m_work.lambda[r];
          const AxisLaw::Parts parts = m_work.split(law, r);
          EXPECT_NEAR(std::accumulate(parts.begin(), parts.end(), 0.), lambda,
                      1e-9 * (1 + std::abs(lambda)))
              << trial << ", " << passes;
          EXPECT_TRUE(with_two_stops || lambda >= 0) << trial << ", " << passes;
          const pintle::LawPiece& piece = m_work.pieces[r];
          if (!piece.acts) continue;
          ++press;
          const double side = piece.target == law.part(0).target ? 1 : -1;
          EXPECT_GE(side * lambda, 0) << trial << ", " << passes;
        }
      }
    }
    EXPECT_GT(press, support::trials(200));
  }
}

// The least kinetic energy is one, however it is found.
TEST_F(Chain, AllWaysLeadToTheSameVelocities) {
  for (int trial = 0; trial < support::trials(30); ++trial) {
    make(3);
    solve(pintle::Sweep::one_by_one, 20000);
    const std::vector<Vector6d> slowly = m_velocities;
    EXPECT_TRUE(solve(pintle::Sweep::passes, 1000).is_solvable);
    for (size_t i = 0; i < slowly.size(); ++i)
      EXPECT_LT((m_velocities[i] - slowly[i]).norm(), 1e-5) << i;
  }
}

// A motor that presses on a stop: what each of them gives is what the passes have found of it, converged or not.
TEST_F(Chain, EachPartOfALawKeepsItsOwnImpulse) {
  int among_contacts = 0;
  for (int trial = 0; trial < support::trials(60); ++trial) {
    make(4, true);
    for (const int passes : {1, 3, 2000}) {
      solve(pintle::Sweep::passes, passes);
      if (m_memory.bounds.empty()) continue;
      ++among_contacts;
      size_t next = 0;
      for (size_t r = 3; r < m_island.rows.size(); r += rows_of_joint) {
        const AxisLaw& law = m_island.rows[r].law;
        const AxisLaw::Parts parts = m_work.split(law, r);
        double sum = 0;
        for (int i = 0; i < law.parts(); ++i) {
          EXPECT_EQ(parts[size_t(i)], m_memory.bounds[next++].impulse);
          sum += parts[size_t(i)];
        }
        EXPECT_NEAR(sum, m_work.lambda[r], 1e-9 * (1 + std::abs(sum)));
        if (passes < 2000) continue;
        for (int i = 0; i < law.parts(); ++i) {
          const pintle::LawPart& part = law.part(i);
          const double off = m_work.u[r] - part.target;
          if (std::abs(off) < 1e-5) continue;
          EXPECT_NEAR(parts[size_t(i)], part.at(m_work.u[r]), 1e-6) << i;
        }
      }
      EXPECT_EQ(next, m_memory.bounds.size());
    }
  }
  EXPECT_GT(among_contacts, support::trials(60));
}

// A warm start of far too much impulse adds no energy: the fraction of it that is best is no worse than none, and no pass raises it.
TEST_F(Chain, NoWarmStartAddsEnergy) {
  for (int trial = 0; trial < support::trials(100); ++trial) {
    make(8);
    m_velocities.clear();
    for (const pintle::IslandBody& body : m_island.bodies) m_velocities.push_back(body.v_free);
    const double start = kinetic();
    for (const int passes : {1, 2, 10}) {
      EXPECT_TRUE(solve(pintle::Sweep::passes, passes, 100).is_solvable);
      EXPECT_LE(kinetic(), (1 + 1e-9) * start) << passes;
    }
  }
}

// Contacts that see only their own bodies find in many passes what joints bear with these.
TEST_F(Chain, ContactsThatSeeTheirJointsAreFoundInFewPasses) {
  double seeing = 0, blind = 0;
  for (int trial = 0; trial < support::trials(60); ++trial) {
    make(8);
    solve(pintle::Sweep::one_by_one, 20000);
    const double least = kinetic();
    EXPECT_TRUE(solve(pintle::Sweep::passes, 5).is_solvable);
    seeing += kinetic() - least;
    solve(pintle::Sweep::one_by_one, 5);
    blind += kinetic() - least;
  }
  EXPECT_GT(blind, 0);
  EXPECT_LT(seeing, blind / 5);
}

}  // namespace exact_passes_test

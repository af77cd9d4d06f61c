// The discrete gradient of every row of every joint: G d = C(end) - C(start) over steps of any turn, in closed form of
// what has one.
#include <pintle/body_pair.h>
#include <pintle/rows/row.h>
#include <pintle/solver/discrete_gradient.h>

#include <gtest/gtest.h>

#include <array>
#include <map>

#include "joint_kinds.h"
#include "physics_support.h"
#include "support.h"

namespace {

using pintle::Displacement;
using pintle::Gradient;
using pintle::RowShape;
using pintle::Vector3d;
using support::Random;
using support::scalar;
using support::vec;

constexpr int max_rows = pintle::max_joint_rows;

struct RowsAtPose {
  pintle::RowMemory<max_rows, 8> memory;
  std::array<RowShape, max_rows> shapes;
  pintle::Rows rows{memory, nullptr, shapes.data()};
};

Vector3d inDouble(const btVector3& v) { return {double(v.x()), double(v.y()), double(v.z())}; }

/// A step from a pose, by Bullet's own integration of a turn of less than pi/4.
struct Step {
  Displacement by;
  btTransform end;

  Step(const btTransform& start, const btVector3& x, const btVector3& phi)
      : by{inDouble(x), inDouble(phi)}, end(start) {
    const btScalar angle = phi.length();
    const btMatrix3x3 turn(angle > 0 ? btQuaternion(phi / angle, angle)
                                     : btQuaternion::getIdentity());
    end.setOrigin(start.getOrigin() + x);
    end.setBasis(turn * start.getBasis());
  }
};

TEST(DiscreteGradient, MeanOfATurnIsTheMean) {
  Random random(1);
  for (const double angle : {0., 1e-5, 0.999e-3, 1.001e-3, 0.1, 1., 3.}) {
    const Vector3d phi = angle * inDouble(random.unit()).normalized(),
                   r = inDouble(random.vector(1));
    Vector3d sum = Vector3d::Zero();
    constexpr int n = 20000;
    for (int i = 0; i < n; ++i) {
      const double t = (i + 0.5) / n;
      const Eigen::AngleAxisd turn(t * angle,
                                   angle > 0 ? Vector3d(phi / angle) : Vector3d::UnitX());
      sum += turn * r / n;
    }
    EXPECT_LT((pintle::meanOfTurn(phi) * r - sum).norm(), 1e-9) << angle;
  }
}

class EveryRow : public testing::TestWithParam<kinds::Kind> {};

TEST_P(EveryRow, TellsHowFarTheStepMovesIt) {
  Random random(2);
  std::map<RowShape::Kind, int> seen;
  for (int n = 0; n < support::trials(200); ++n) {
    const auto a = support::body(1, vec(1, 2, 3), random.pose(1)),
               b = support::body(2, vec(3, 2, 2), random.pose(1));
    const btTransform frame_a = random.pose(1);
    // The joint holds, nearly: what is far off is corrected otherwise.
    const btTransform frame_b =
        b->getCenterOfMassTransform().inverse() * a->getCenterOfMassTransform() * frame_a;
    const int variant = n % GetParam().variants;
    const auto joint = GetParam().make(*a, *b, frame_a, frame_b, variant);
    const double size = n % 4 == 0 ? 1e-3 : 0.4;
    const Step step_a(a->getCenterOfMassTransform(), random.vector(0.3), random.vector(size)),
        step_b(b->getCenterOfMassTransform(), random.vector(0.3), random.vector(size));
    RowsAtPose start, end;
    joint->addRows(pintle::BodyPair(*a, *b), start.rows);
    joint->addRows(pintle::PosePair(step_a.end, step_b.end), end.rows);
    ASSERT_EQ(end.rows.equalities(), start.rows.equalities());
    for (int i = 0; i < start.rows.equalities(); ++i) {
      const double change = double(end.rows[i].position) - double(start.rows[i].position);
      const RowShape::Kind kind = start.shapes[size_t(i)].kind;
      ASSERT_EQ(kind, end.shapes[size_t(i)].kind);
      ++seen[kind];
      const bool closed =
          kind == RowShape::point || kind == RowShape::distance || kind == RowShape::dot;
      const Gradient G = pintle::discreteGradient(
          {start.rows[i], end.rows[i], start.shapes[size_t(i)], end.shapes[size_t(i)]},
          closed ? 1e9 : change, step_a.by, step_b.by);
      EXPECT_NEAR(G.along(step_a.by, step_b.by), change, physics::rounding(2e-6, 1e-13))
          << GetParam() << ", variant " << variant << ", row " << i << ", kind " << int(kind);
      // What is angular acts on both bodies alike.
      if (start.rows[i].angular && kind != RowShape::dot) {
        EXPECT_EQ(G.A_a, G.A_b);
      }
    }
  }
  if (GetParam().holds) {
    EXPECT_FALSE(seen.empty());
  }
}

INSTANTIATE_TEST_SUITE_P(All, EveryRow, testing::ValuesIn(kinds::all()),
                         [](const testing::TestParamInfo<kinds::Kind>& kind) {
                           return kind.param.name;
                         });

}  // namespace

// A spring of any stiffness or softness between two of many bodies gives by what it should.
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/distance_joint.h>
#include <pintle/joints/slider_joint.h>
#include <pintle/solver/solver_options.h>

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "books.h"
#include "cables.h"
#include "physics_support.h"
#include "support.h"

namespace exact_springs_test {
namespace {

using support::Books;
using support::scalar;
using support::vec;

constexpr double size = 0.2;  // m: of a link

/// Three links of 1 kg hang on the ground, the third one bears a fourth by a spring, and that two strings of three links. `load`: that of
/// the last links of both together, kg.
struct Tree {
  Tree(double hz, double stiffness, double load) : books(hz) {
    btRigidBody* last = &books.add(0, vec(0.1, 0.1, 0.1), vec(0, 0, 0));
    for (int i = 0; i < 3; ++i) last = &hang(*last, 0, -size * i, 1);
    above = last;
    // It is bent by most of what it will give by: the rest swings out.
    double z = -3 * size;
    expected = (5 + load) * 9.81 / stiffness;
    z -= 0.9 * expected;
    below = &books.add(1, vec(0.2, 0.05, size / 2), vec(0, 0, z - size / 2));
    // x up.
    btTransform in_below(btQuaternion(vec(0, 1, 0), scalar(-physics::pi / 2))), in_above = in_below;
    in_below.setOrigin(vec(0, 0, size / 2));
    in_above.setOrigin(vec(0, 0, -size / 2));
    auto made = std::make_unique<pintle::SliderJoint>(*below, *above, in_below, in_above, false);
    made->setLowerLinLimit(0);
    made->setUpperLinLimit(0);
    // That of two bodies of 1 kg alone.
    made->setLinLimitSpring(scalar(std::sqrt(stiffness / 0.5) / (2 * physics::pi)), 1);
    books.join(std::move(made));
    for (const double side : {-0.15, 0.15}) {
      last = below;
      for (int i = 0; i < 3; ++i)
        last = &hang(*last, side, z - size * (i + 1), i < 2 ? 1 : load / 2);
    }
    // Critical damping of two bodies of 1 kg is that much of this mass.
    seconds = 7 * (5 + load) * std::sqrt(2 / stiffness) + 1;
  }
  btRigidBody& hang(btRigidBody& on, double x, double z, double mass) {
    btRigidBody& link = books.add(mass, vec(0.05, 0.05, size / 2), vec(x, 0, z - size / 2));
    support::joinAt<pintle::BallJoint>(books, on, link, vec(x, 0, z));
    return link;
  }
  double gives() const {
    return double((above->getCenterOfMassTransform() * vec(0, 0, -size / 2)).z() -
                  (below->getCenterOfMassTransform() * vec(0, 0, size / 2)).z());
  }

  Books books;
  btRigidBody *above, *below;
  double expected, seconds;  ///< m, s
};

TEST(ExactSprings, OfAnyStiffnessGiveByWhatTheyBear) {
  struct Case {
    double stiffness, load;  ///< N/m, kg
  };
  for (const Case& of : {Case{0.01, 2}, Case{1, 2}, Case{100, 2}, Case{100, 100}, Case{1e4, 100},
                         Case{1e6, 1000}, Case{1e9, 1e4}, Case{1e9, 1e5}})
    for (const double hz : {60., 240.}) {
      if (of.stiffness < 100 && hz > 60) continue;  // it takes minutes to come to rest
      SCOPED_TRACE(testing::Message()
                   << of.stiffness << " N/m, " << of.load << " kg, " << hz << " Hz");
      Tree tree(hz, of.stiffness, of.load);
      for (int i = 0; i < int(tree.seconds * hz); ++i) tree.books.step();
      // A stiff one gives by less than a thousand times what bodies may be off.
      const double most = 1e-3 * tree.expected + pintle::SolverOptions().newton_tolerance;
      for (int i = 0; i < int(hz); ++i) {
        tree.books.step();
        ASSERT_NEAR(tree.gives(), tree.expected, most) << i;
      }
    }
}

// How heavy a rod is along a spring depends on how it stands to it. The spring's stiffness does not change with that.
TEST(ExactSprings, OfLimitsFeedNothingWhereBodiesTurnAgainstThem) {
  Books books(60);
  books.world.setGravity(vec(0, 0, 0));
  btRigidBody& post = books.add(0, vec(0.1, 0.1, 0.1), vec(0, 0, 0));
  btRigidBody& rod = books.add(1, vec(0.5, 0.02, 0.02), vec(1.5, 0, 0));
  auto made =
      std::make_unique<pintle::DistanceJoint>(post, rod, vec(0, 0, 0), vec(-0.5, 0, 0), scalar(1));
  made->setLimitSpring(scalar(1.2), 0);
  books.join(std::move(made));
  rod.setLinearVelocity(vec(0.3, 1, 0));
  rod.setAngularVelocity(vec(0, 0, 3));
  const double start = books.kinetic();  // the spring is as long as it is at rest
  for (int i = 0; i < 6000; ++i) {
    books.step();
    ASSERT_LE(books.kinetic(), 1.01 * start) << i;
  }
}

}  // namespace
}  // namespace exact_springs_test

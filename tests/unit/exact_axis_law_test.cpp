// Where a row meets the law of its impulse.
#include <pintle/solver/model/axis_law.h>
#include <pintle/solver/linalg/memory.h>

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "support.h"

namespace exact_axis_law_test {

using pintle::AxisLaw;
using pintle::LawPart;
using pintle::LawPiece;
using support::Random;

constexpr double unbounded = AxisLaw::unbounded;

bool oneIn(int n, Random& random) { return random.uniform(0, n) < 1; }

// With room for all parts.
AxisLaw emptyLaw() {
  static pintle::Pool<std::array<LawPart, AxisLaw::max_parts>> rooms;
  return AxisLaw(rooms.take().data());
}

// Lambda just below or above u. Parts without a bound outweigh those that have one.
double impulse(const AxisLaw& law, double u) {
  double sum = 0;
  int without = 0;
  for (int i = 0; i < law.parts(); ++i) {
    const double part = law.part(i).at(u);
    if (std::abs(part) >= unbounded)
      without += part > 0 ? 1 : -1;
    else
      sum += part;
  }
  return without != 0 ? without * unbounded : sum;
}

// The zero of u - free - K Lambda(u), which rises.
double bisect(const AxisLaw& law, double free, double K) {
  double low = -1e4, high = 1e4;
  for (int n = 0; n < 200; ++n) {
    const double u = (low + high) / 2;
    (u - free - K * impulse(law, u) < 0 ? low : high) = u;
  }
  return (low + high) / 2;
}

struct Point {
  double u, lambda;

  Point(const LawPiece& piece, double free, double K) {
    lambda = piece.acts ? (piece.target - free) / (K + piece.softness) : piece.impulse;
    u = free + K * lambda;
  }
};

LawPart anyPart(Random& random) {
  // Targets are few, so that parts share them.
  const double target =
      oneIn(2, random) ? std::floor(random.uniform(-3, 4)) : random.uniform(-3, 3);
  const double softness = oneIn(2, random) ? 0 : std::pow(10, random.uniform(-3, 1));
  LawPart part{target, softness, -random.uniform(0, 5), random.uniform(0, 5)};
  if (oneIn(3, random)) part.lower = oneIn(2, random) ? 0 : -unbounded;
  if (oneIn(3, random)) part.upper = oneIn(2, random) ? 0 : unbounded;
  return part;
}

// Rigid parts that have no bound do not contradict each other: limits of an axis have a lower and an upper end.
AxisLaw anyLaw(int parts, Random& random) {
  AxisLaw law = emptyLaw();
  double least = -1e9, most = 1e9;  // where the others let u be
  while (law.parts() < parts) {
    LawPart part = anyPart(random);
    if (!(part.softness > 0)) {
      if (part.lower == -unbounded && part.upper == unbounded && (least > -1e9 || most < 1e9))
        continue;
      if (part.upper == unbounded && part.target > most) continue;
      if (part.lower == -unbounded && part.target < least) continue;
      if (part.upper == unbounded) least = std::max(least, part.target);
      if (part.lower == -unbounded) most = std::min(most, part.target);
    }
    law.add(part);
  }
  return law;
}

std::string describe(const AxisLaw& law, double free, double K) {
  std::string text = "free " + std::to_string(free) + ", K " + std::to_string(K);
  for (int i = 0; i < law.parts(); ++i) {
    const LawPart& part = law.part(i);
    text += "\n  target " + std::to_string(part.target) + ", softness " +
            std::to_string(part.softness) + ", from " + std::to_string(part.lower) + " to " +
            std::to_string(part.upper);
  }
  return text;
}

// A steep part makes its impulse as inexact as its velocity is, divided by its softness.
TEST(AxisLaw, MeetsWhereBisectionDoes) {
  Random random(1);
  int acting[AxisLaw::max_parts + 1] = {}, level[AxisLaw::max_parts + 1] = {};
  for (int n = 0; n < support::trials(40000); ++n) {
    const int parts = 1 + n % AxisLaw::max_parts;
    const AxisLaw law = anyLaw(parts, random);
    const double free = random.uniform(-20, 20), K = std::pow(10, random.uniform(-2, 2));
    const LawPiece piece = law.meet(free, K);
    const double u = bisect(law, free, K);
    const Point met(piece, free, K);
    ASSERT_NEAR(met.u, u, 1e-9) << describe(law, free, K);
    ASSERT_NEAR(met.lambda, (u - free) / K, 1e-9 / K) << describe(law, free, K);
    ++(piece.acts ? acting : level)[parts];
  }
  for (int parts = 1; parts <= AxisLaw::max_parts; ++parts) {
    EXPECT_GT(acting[parts], support::trials(2000)) << parts;
    EXPECT_GT(level[parts], support::trials(400)) << parts;
  }
}

// The piece holds not at one point alone: Newton's tangent is made of it.
TEST(AxisLaw, PieceIsThatOfTheNeighbourhood) {
  Random random(2);
  for (int n = 0; n < support::trials(20000); ++n) {
    const AxisLaw law = anyLaw(1 + n % AxisLaw::max_parts, random);
    const double free = random.uniform(-20, 20), K = std::pow(10, random.uniform(-2, 2));
    const LawPiece piece = law.meet(free, K), before = law.meet(free - 1e-6, K),
                   after = law.meet(free + 1e-6, K);
    // Random points are not at corners.
    if (before.acts != after.acts || before.target != after.target) continue;
    EXPECT_EQ(piece.acts, before.acts) << describe(law, free, K);
    EXPECT_EQ(piece.softness, before.softness) << describe(law, free, K);
    EXPECT_EQ(piece.impulse, before.impulse) << describe(law, free, K);
  }
}

TEST(AxisLaw, AnEqualityActsEverywhere) {
  for (const double softness : {0., 0.5}) {
    AxisLaw law = emptyLaw();
    law.add({2, softness, -unbounded, unbounded});
    EXPECT_TRUE(law.isEquality());
    for (const double free : {-1e6, 0., 2., 1e6}) {
      const LawPiece piece = law.meet(free, 3);
      EXPECT_TRUE(piece.acts);
      EXPECT_EQ(piece.target, 2);
      EXPECT_EQ(piece.softness, softness);
    }
  }
}

TEST(AxisLaw, OneBoundMakesNoEquality) {
  AxisLaw law = emptyLaw();
  law.add({0, 0, 0, unbounded});
  EXPECT_FALSE(law.isEquality());
  law = emptyLaw();
  law.add({0, 0, -unbounded, unbounded});
  law.add({0, 0, -1, 1});
  EXPECT_FALSE(law.isEquality());
}

// Two springs in parallel, without bounds: a law without corners.
TEST(AxisLaw, SpringsAddUp) {
  for (const double softness : {1e-14, 1e-3, 1.}) {
    AxisLaw law = emptyLaw();
    law.add({1, softness, -unbounded, unbounded});
    law.add({4, 2 * softness, -unbounded, unbounded});
    for (const double free : {-10., 0., 2., 10.}) {
      const LawPiece piece = law.meet(free, 3);
      EXPECT_TRUE(piece.acts);
      EXPECT_NEAR(piece.target, 2, 1e-14);
      EXPECT_NEAR(piece.softness, 2 * softness / 3, 1e-15 * softness);
    }
  }
}

// A limit at both ends that are one, a friction beside it.
TEST(AxisLaw, LimitsThatMeetHoldLikeAnEquality) {
  AxisLaw law = emptyLaw();
  law.add({0, 0, -2, 2});
  law.add({1, 0, 0, unbounded});
  law.add({1, 0, -unbounded, 0});
  for (const double free : {-10., 0., 1., 10.}) {
    const LawPiece piece = law.meet(free, 0.5);
    EXPECT_TRUE(piece.acts) << free;
    EXPECT_EQ(piece.target, 1) << free;
    EXPECT_EQ(piece.softness, 0) << free;
  }
}

TEST(AxisLaw, SplitsAmongItsParts) {
  Random random(3);
  for (int n = 0; n < support::trials(20000); ++n) {
    const AxisLaw law = anyLaw(1 + n % AxisLaw::max_parts, random);
    const double free = random.uniform(-20, 20), K = std::pow(10, random.uniform(-2, 2));
    const Point met(law.meet(free, K), free, K);
    const AxisLaw::Parts of = law.split(met.u, met.lambda);
    double sum = 0;
    for (int i = 0; i < law.parts(); ++i) {
      const LawPart& part = law.part(i);
      EXPECT_GE(of[size_t(i)], part.lower) << describe(law, free, K);
      EXPECT_LE(of[size_t(i)], part.upper) << describe(law, free, K);
      // On its own law: what another one has too little, none has made up.
      const double least = part.at(met.u + 1e-6), most = part.at(met.u - 1e-6);
      EXPECT_GE(of[size_t(i)], least - 1e-6) << describe(law, free, K);
      EXPECT_LE(of[size_t(i)], most + 1e-6) << describe(law, free, K);
      sum += of[size_t(i)];
    }
    EXPECT_NEAR(sum, met.lambda, 1e-9 * (1 + std::abs(met.lambda))) << describe(law, free, K);
  }
}

// Of a law that is not met yet, as between two passes: a stop that is passed has what is left, not all that it could have.
TEST(AxisLaw, SplitsWhatAStopHasNotTakenYet) {
  AxisLaw law = emptyLaw();
  law.add({0, 0, -2, 2, true});
  law.add({-1, 0, 0, unbounded});
  law.add({1, 0, -unbounded, 0});
  for (const double impulse : {0., 1.5, 7.}) {
    const AxisLaw::Parts of = law.split(-3, impulse);
    EXPECT_EQ(of[0], std::min(impulse, 2.)) << impulse;
    EXPECT_EQ(of[1], std::max(impulse - 2, 0.)) << impulse;
    EXPECT_EQ(of[2], 0) << impulse;
  }
}

// Between two stops a law has no impulse, and at the target of a rigid part as little as can be.
TEST(AxisLaw, IsAsLittleAsCanBe) {
  AxisLaw law = emptyLaw();
  law.add({-1, 0, 0, unbounded});
  law.add({1, 0, -unbounded, 0});
  for (const double u : {-1., 0., 1.}) EXPECT_EQ(law.at(u), 0) << u;
  law.add({0, 0, -2, 3, true});
  EXPECT_EQ(law.at(0), 0);
  EXPECT_EQ(law.at(-0.5), 3);
  EXPECT_EQ(law.at(0.5), -2);
}

}  // namespace exact_axis_law_test

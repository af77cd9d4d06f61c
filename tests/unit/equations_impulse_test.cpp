// The impulse of a row: rigid, soft, and iterated, against the equations that it has to satisfy and
// against the implicit Euler step of a spring and damper.
#include <gtest/gtest.h>
#include <pintle/equations/impulse.h>
#include <pintle/precision.h>

#include "autodiff.h"

namespace {

using namespace autodiff;
namespace equations = pintle::equations;

template <class T>
class Impulse : public testing::Test {
 public:
  static constexpr double kEpsilon = double(std::numeric_limits<T>::epsilon());
  // Formulas of about ten operations; relative to their largest term.
  static constexpr double kTolerance = 10 * kEpsilon;
};
using Scalars = testing::Types<double, pintle::Scalar>;
TYPED_TEST_SUITE(Impulse, Scalars);

// A row in some system.
struct State {
  double K, Jv, c, dt;
};

State any_state(Random& random) {
  const double K = std::exp(random.uniform(-5, 5)), Jv = random.uniform(-10, 10);
  const double c = random.uniform(-1, 1);
  return {K, Jv, c, 1 / random.uniform(20, 1000)};
}

TYPED_TEST(Impulse, RigidSatisfiesTheVelocityConstraint) {
  using T = TypeParam;
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const State s = any_state(random);
    const double beta = random.uniform(0, 1);
    const T b = equations::baumgarte(T(s.c), T(beta), T(s.dt));
    ASSERT_LE(std::abs(double(b) - s.c * beta / s.dt), this->kTolerance * std::abs(s.c / s.dt));
    const double lambda = double(equations::impulse(T(s.K), T(s.Jv), b));
    // J v + b after the impulse.
    ASSERT_LE(std::abs(s.Jv + s.K * lambda + double(b)),
              this->kTolerance * (std::abs(s.Jv) + std::abs(double(b))));
  }
}

TYPED_TEST(Impulse, BaumgarteOfOneTakesTheErrorAwayInOneStep) {
  using T = TypeParam;
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    const State s = any_state(random);
    const T b = equations::baumgarte(T(s.c), T(1), T(s.dt));
    const double after = s.Jv + s.K * double(equations::impulse(T(s.K), T(s.Jv), b));
    ASSERT_LE(std::abs(s.c + s.dt * after),
              this->kTolerance * (std::abs(s.c) + s.dt * std::abs(s.Jv)));
  }
}

template <class T>
double soft(const State& s, const equations::Softness<T>& softness) {
  const T K = equations::soft_effective_mass(T(s.K), softness.gamma, T(s.dt));
  return double(equations::soft_impulse(K, T(s.Jv), softness.beta, T(s.c), T(s.dt)));
}

TYPED_TEST(Impulse, SoftSatisfiesTheSoftVelocityConstraint) {
  using T = TypeParam;
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const State s = any_state(random);
    const equations::Softness<T> softness{T(std::exp(random.uniform(-8, 8))),
                                          T(random.uniform(0, 1))};
    const double lambda = soft(s, softness);
    const double gamma = double(softness.gamma), beta = double(softness.beta);
    const double terms = std::abs(s.Jv) + std::abs(beta * s.c / s.dt);
    ASSERT_LE(std::abs(s.Jv + s.K * lambda + gamma * lambda / s.dt + beta * s.c / s.dt),
              this->kTolerance * terms);
  }
}

TYPED_TEST(Impulse, SoftWithoutSoftnessIsTheRigidOne) {
  using T = TypeParam;
  Random random(4);
  for (int i = 0; i < 200; ++i) {
    const State s = any_state(random);
    const double beta = random.uniform(0, 1);
    const T b = equations::baumgarte(T(s.c), T(beta), T(s.dt));
    const double rigid = double(equations::impulse(T(s.K), T(s.Jv), b));
    const double terms = (std::abs(s.Jv) + std::abs(double(b))) / s.K;
    ASSERT_LE(std::abs(soft<T>(s, {T(0), T(beta)}) - rigid), this->kTolerance * terms);
  }
}

// The implicit Euler step of c'' K^-1 = -k c - d c': its impulse, from lambda = -dt (k c_new +
// d u_new), c_new = c + dt u_new and u_new = u + K lambda.
double implicit_euler(const State& s, double k, double d) {
  const double e = s.dt * k + d;
  return -s.dt * (k * s.c + e * s.Jv) / (1 + s.dt * e * s.K);
}
double implicit_euler_terms(const State& s, double k, double d) {
  const double e = s.dt * k + d;
  return s.dt * (k * std::abs(s.c) + e * std::abs(s.Jv)) / (1 + s.dt * e * s.K);
}

TYPED_TEST(Impulse, SoftIsTheImplicitEulerStepOfASpringAndDamper) {
  using T = TypeParam;
  Random random(5);
  for (double k = 1e-3; k < 2e9; k *= 10) {
    for (int i = 0; i < 50; ++i) {
      const State s = any_state(random);
      const double d = i % 5 ? k * random.uniform(0, 0.1) : 0;
      const double lambda = soft(s, equations::softness(T(k), T(d), T(s.dt)));
      // 4e-15 of the terms in double: two such formulas one after the other.
      ASSERT_LE(std::abs(lambda - implicit_euler(s, k, d)),
                2 * this->kTolerance * implicit_euler_terms(s, k, d))
          << k;
    }
  }
}

TYPED_TEST(Impulse, SoftSpringsStepIsStableAndLosesEnergy) {
  // A mass on a spring so stiff that an explicit step would blow up.
  using T = TypeParam;
  State s{2, 1, 0.3, 1.0 / 60};
  const double k = 1e6;
  double energy = 0.5 * s.Jv * s.Jv / s.K + 0.5 * k * s.c * s.c;
  for (int i = 0; i < 200; ++i) {
    s.Jv += s.K * soft(s, equations::softness(T(k), T(0), T(s.dt)));
    s.c += s.dt * s.Jv;
    const double now = 0.5 * s.Jv * s.Jv / s.K + 0.5 * k * s.c * s.c;
    ASSERT_LT(now, energy);
    energy = now;
    if (energy < 1e-20) break;
  }
}

TYPED_TEST(Impulse, SoftnessHasItsLimitingCases) {
  using T = TypeParam;
  const T dt = T(1) / T(60);
  // Stiff without end: rigid, with all of the error corrected.
  const auto rigid = equations::softness(T(1e30), T(0), dt);
  EXPECT_LE(double(rigid.gamma), 1e-28);
  EXPECT_LE(std::abs(double(rigid.beta) - 1), this->kEpsilon);
  // No stiffness: a damper, with no regard to the error.
  const auto damper = equations::softness(T(0), T(4), dt);
  EXPECT_EQ(damper.gamma, T(0.25));
  EXPECT_EQ(damper.beta, T(0));
  // No damping: beta is one, and gamma 1/(dt k).
  const auto spring = equations::softness(T(240), T(0), dt);
  EXPECT_EQ(spring.beta, T(1));
  EXPECT_LE(std::abs(double(spring.gamma) - 0.25), this->kTolerance);
}

TYPED_TEST(Impulse, SoftnessByFrequencyIsThatOfItsStiffnessAndDamping) {
  using T = TypeParam;
  Random random(6);
  for (int i = 0; i < 500; ++i) {
    const double w = std::exp(random.uniform(-3, 7)), K = std::exp(random.uniform(-8, 8));
    const double z = i % 5 ? random.uniform(0, 5) : 0, dt = 1 / random.uniform(20, 1000);
    const auto found = equations::softness_by_frequency(T(w), T(z), T(dt), T(K));
    const auto expected = equations::softness(w * w / K, 2 * z * w / K, dt);
    ASSERT_LE(std::abs(double(found.gamma) / expected.gamma - 1), this->kTolerance);
    ASSERT_LE(std::abs(double(found.beta) / expected.beta - 1), this->kTolerance);
  }
}

TYPED_TEST(Impulse, SoftnessByFrequencyHasItsLimitingCases) {
  using T = TypeParam;
  const T dt = T(1) / T(60), K = T(3);
  // A high frequency is rigid; w^2 would overflow in float.
  const auto rigid = equations::softness_by_frequency(T(1e25), T(1), dt, K);
  EXPECT_LE(double(rigid.gamma), 1e-40);
  EXPECT_LE(std::abs(double(rigid.beta) - 1), this->kEpsilon);
  // Much damping does not look at the error.
  EXPECT_LE(double(equations::softness_by_frequency(T(10), T(1e12), dt, K).beta), 1e-12);
  // No damping corrects what is left of it, whatever the frequency.
  EXPECT_EQ(equations::softness_by_frequency(T(0.01), T(0), dt, K).beta, T(1));
  EXPECT_EQ(equations::softness_by_frequency(T(1000), T(0), dt, K).beta, T(1));
  // The response of the row does not depend on K: gamma is proportional to it, beta has none of it.
  const auto one = equations::softness_by_frequency(T(20), T(0.5), dt, T(1));
  const auto four = equations::softness_by_frequency(T(20), T(0.5), dt, T(4));
  EXPECT_EQ(four.gamma, T(4) * one.gamma);
  EXPECT_EQ(four.beta, one.beta);
}

TYPED_TEST(Impulse, IteratedUpdatesOfOneRowGiveTheWholeImpulse) {
  // (2.14)-(2.17): the first update is (2.13), the next ones are nothing; and after another row has
  // changed the velocity the updates add up to (2.13) of the velocity without this row's impulse.
  using T = TypeParam;
  Random random(7);
  for (int i = 0; i < 200; ++i) {
    const State s = any_state(random);
    const auto softness = equations::softness_by_frequency(
        T(random.uniform(1, 100)), T(random.uniform(0, 2)), T(s.dt), T(s.K));
    const double gamma = double(softness.gamma);
    const T K = equations::soft_effective_mass(T(s.K), softness.gamma, T(s.dt));
    const double kick = random.uniform(-5, 5);
    double lambda = 0, Jv = s.Jv;
    const auto update = [&] {
      // gamma lambda / dt of what has accumulated acts as velocity.
      const T felt = T(Jv + gamma * lambda / s.dt);
      const double delta = double(equations::soft_impulse(K, felt, softness.beta, T(s.c), T(s.dt)));
      lambda += delta;
      Jv += s.K * delta;
      return delta;
    };
    State kicked = s;
    kicked.Jv += kick;
    const double tolerance =
        3 * this->kTolerance * (std::abs(s.Jv) + std::abs(kick) + std::abs(s.c / s.dt)) / double(K);
    update();
    ASSERT_LE(std::abs(lambda - soft(s, softness)), tolerance);
    ASSERT_LE(std::abs(update()), tolerance);
    Jv += kick;
    update();
    ASSERT_LE(std::abs(lambda - soft(kicked, softness)), tolerance);
  }
}

TYPED_TEST(Impulse, IteratedUpdatesOfTwoRowsConvergeToTheBlockOfBoth) {
  using T = TypeParam;
  Random random(8);
  for (int i = 0; i < 50; ++i) {
    // Two coupled rows of one system: J M^-1 J^T = [K_0 o; o K_1].
    const State s[2] = {any_state(random), any_state(random)};
    const double dt = s[0].dt, o = 0.6 * std::sqrt(s[0].K * s[1].K) * random.uniform(-1, 1);
    equations::Softness<T> soft_rows[2];
    double K[2], b[2], terms = 0;
    for (int k = 0; k < 2; ++k) {
      soft_rows[k] =
          equations::softness_by_frequency(T(random.uniform(5, 100)), T(0.5), T(dt), T(s[k].K));
      K[k] = double(equations::soft_effective_mass(T(s[k].K), soft_rows[k].gamma, T(dt)));
      b[k] = -s[k].Jv - double(soft_rows[k].beta) * s[k].c / dt;
      terms += (std::abs(s[k].Jv) + std::abs(s[k].c / dt)) / s[k].K;
    }
    const double determinant = K[0] * K[1] - o * o;
    const double block[2] = {(K[1] * b[0] - o * b[1]) / determinant,
                             (K[0] * b[1] - o * b[0]) / determinant};
    double lambda[2] = {0, 0}, Jv[2] = {s[0].Jv, s[1].Jv};
    // Each sweep leaves o^2 / (K_0 K_1) < 0.36 of the error: 60 leave 1e-26.
    for (int sweep = 0; sweep < 60; ++sweep) {
      for (int k = 0; k < 2; ++k) {
        const T felt = T(Jv[k] + double(soft_rows[k].gamma) * lambda[k] / dt);
        const double delta =
            double(equations::soft_impulse(T(K[k]), felt, soft_rows[k].beta, T(s[k].c), T(dt)));
        lambda[k] += delta;
        Jv[k] += s[k].K * delta;
        Jv[1 - k] += o * delta;
      }
    }
    for (int k = 0; k < 2; ++k) {
      // The rows' scales differ by sqrt(K_0/K_1), and the coupling passes it on.
      const double scale = 1 + std::sqrt(s[1 - k].K / s[k].K);
      ASSERT_LE(std::abs(lambda[k] - block[k]), this->kTolerance * scale * terms);
    }
  }
}

}  // namespace

// No joint may feed energy, whatever the scene.
#include <gtest/gtest.h>

#include "random_scene.h"

namespace passive {
namespace {

constexpr unsigned count = 300;

TEST(PassiveScenes, GainNothing) {
  for (unsigned seed = 1; seed <= count; ++seed) {
    const Scene scene = makeScene(seed);
    const Outcome out = play(scene);
    EXPECT_TRUE(out.finite) << describe(scene);
    EXPECT_LE(out.gain, 0.01 * out.peak) << describe(scene);
    EXPECT_LE(out.jump, 10) << describe(scene);  // where joints contradict each other
  }
}

}  // namespace
}  // namespace passive

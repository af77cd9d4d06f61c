// "What was wrong": each scene shows a bug of stock's joints that Pintle's do not have.
#include <gtest/gtest.h>
#include <measures/run.h>
#include <scenes/catalog.h>

#include <set>

namespace {

using scenes::Error;
using scenes::Scene;

std::vector<Scene> wrong() {
  std::vector<Scene> scenes = scenes::catalog();
  const auto is_other = [](const Scene& scene) { return scene.group != scenes::Group::wrong; };
  scenes.erase(std::remove_if(scenes.begin(), scenes.end(), is_other), scenes.end());
  return scenes;
}

class WhatWasWrong : public testing::TestWithParam<Scene> {};

TEST_P(WhatWasWrong, StockShowsItAndPintleDoesNot) {
  const Scene& scene = GetParam();
  const auto [error, stock_at_least, pintle_at_most, by_solver] = scene.mended;
  ASSERT_TRUE(scene.has(error)) << "its error is none that is measured";
  const auto of = [&](const char* contender) {
    const auto engine = engines::find_contender(contender)->make(scene, 10);
    return measures::run(scene, *engine, 1. / 60)[scene.mended.error];
  };
  EXPECT_GE(of("stock"), stock_at_least) << scene.text;
  if (by_solver) {
    EXPECT_GE(of("pintle"), stock_at_least) << scene.text;
  } else {
    EXPECT_LE(of("pintle"), pintle_at_most) << scene.text;
  }
  EXPECT_LE(of("exact"), pintle_at_most) << scene.text;
}

INSTANTIATE_TEST_SUITE_P(All, WhatWasWrong, testing::ValuesIn(wrong()),
                         [](const auto& test) { return test.param.name; });

TEST(Catalog, ScenesHaveNamesOfTheirOwnAndWordsForThePage) {
  std::set<std::string> names, headlines;
  for (const Scene& scene : scenes::catalog()) {
    EXPECT_TRUE(names.insert(scene.name).second) << scene.name;
    EXPECT_TRUE(scene.headline.empty() || headlines.insert(scene.headline).second) << scene.name;
    const bool is_wrong = scene.group == scenes::Group::wrong;
    EXPECT_EQ(is_wrong, scene.mended.error != Error::count) << scene.name;
    EXPECT_FALSE(is_wrong && scene.text.find("Look at") == std::string::npos) << scene.name;
  }
}

}  // namespace

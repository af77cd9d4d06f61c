// The scenes' key figures are what is stored of them.
#include <gtest/gtest.h>

#include <numeric>

#include "figures.h"

namespace {

TEST(Figures, AreThoseStored) {
  const std::vector<std::string> changes =
      figures::differences(figures::read(), figures::measure());
  EXPECT_TRUE(changes.empty()) << std::accumulate(
      changes.begin(), changes.end(), std::string("tests/scenes/update.sh stores them anew:\n"),
      [](const std::string& all, const std::string& one) { return all + one + '\n'; });
}

TEST(Figures, ADifferenceIsSeen) {
  const figures::Figures stored = {{"a", 1}, {"b", 1}, {"gone", 1}};
  const figures::Figures measured = {
      {"a", 1 + 2 * figures::tolerance()}, {"b", 1 + figures::tolerance() / 2}, {"new", 1}};
  EXPECT_EQ(figures::differences(stored, measured).size(), 3u);
}

}  // namespace

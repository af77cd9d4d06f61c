// Pareto fronts and the ratios that are taken from them.
#include <gtest/gtest.h>
#include <report/pareto.h>
#include <report/table.h>

#include <cmath>
#include <cstdio>
#include <fstream>

namespace {

using report::Point;

TEST(Pareto, KeepsWhatNothingElseBeats) {
  const auto front =
      report::pareto({{3, 1}, {1, 4}, {2, 5}, {4, HUGE_VAL}, {5, NAN}, {2, 2}, {6, 1}});
  ASSERT_EQ(front.size(), 3u);
  EXPECT_EQ(front[0].time, 1);
  EXPECT_EQ(front[1].error, 2);
  EXPECT_EQ(front[2].time, 3);
  EXPECT_EQ(report::error_at(front, 2), 2);
  EXPECT_EQ(report::time_at(front, 2), 2);
  EXPECT_EQ(report::error_at(front, 10), 1);
  EXPECT_EQ(report::time_at(front, 10), 1);
  // Half the way between on logarithmic axes.
  EXPECT_NEAR(report::error_at(front, std::sqrt(6)), std::sqrt(2), 1e-12);
  EXPECT_NEAR(report::time_at(front, std::sqrt(2)), std::sqrt(6), 1e-12);
  EXPECT_TRUE(std::isinf(report::error_at(front, 0.5)));
  EXPECT_TRUE(std::isinf(report::time_at(front, 0.5)));
}

TEST(Pareto, RatiosOfATenthOfTheErrorAtTwiceTheTime) {
  // error = 1/time of stock; ours a twentieth of that at every time.
  std::vector<Point> stock, ours;
  for (double time = 1; time < 1000; time *= 1.01) {
    stock.push_back({time, 1 / time});
    ours.push_back({2 * time, 0.1 / time});
  }
  const report::Ratio errors = error_ratio(report::pareto(ours), report::pareto(stock));
  EXPECT_NEAR(errors.mean, 0.2, 0.01);
  EXPECT_EQ(errors.share, 1);
  const report::Ratio times = time_ratio(report::pareto(ours), report::pareto(stock));
  // Where stock is worse than ours ever is, ours needs its shortest time: 2.
  EXPECT_GT(times.max, 1.9);
  EXPECT_NEAR(times.min, 0.2, 0.01);
}

TEST(Pareto, ErrorsThatAreNeverReachedAreNoPartOfTheShare) {
  const std::vector<Point> stock = {{1, 1}, {2, 0.01}}, ours = {{1, 0.1}};
  const report::Ratio times = time_ratio(ours, stock);
  EXPECT_NEAR(times.share, 0.5, 0.01);
  EXPECT_EQ(error_ratio({}, stock).share, 0);
}

TEST(Table, ReadsWhatItWritesAndLeavesOutWhatWasCutOff) {
  report::Row row{"single", "chain", "pintle", 10, 60, 12.5, 50};
  row.errors[0] = 1e-3;
  row.errors[1] = HUGE_VAL;
  const std::string path = testing::TempDir() + "pintle_table.csv", whole = line(row);
  std::ofstream(path) << report::head() << '\n'
                      << whole << '\n'
                      << whole.substr(0, whole.size() - 3) << '\n';
  const std::vector<report::Row> rows = report::read(path);
  std::remove(path.c_str());
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].contender, "pintle");
  EXPECT_EQ(rows[0].errors, row.errors);
  EXPECT_EQ(rows[0].milliseconds_per_second(), 0.75);
}

}  // namespace

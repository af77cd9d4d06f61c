// The stored drawings of the joints (plugin/docs/drawings) are those that the library makes today.
#include <drawings/joints.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>

namespace {

const std::filesystem::path kFolder =
    std::filesystem::path(PINTLE_SOURCE_DIR) / "plugin/docs/drawings";

std::string read(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

// Whether they differ in nothing but numbers, and in these by a few tenths of a pixel: compilers and precisions round otherwise.
bool isSame(const std::string& drawn, const std::string& stored) {
  const char *x = drawn.c_str(), *y = stored.c_str();
  while (*x != 0 && *y != 0) {
    const auto begins = [](const char* s) {
      return std::isdigit(static_cast<unsigned char>(*s)) ||
             (*s == '-' && std::isdigit(static_cast<unsigned char>(s[1])));
    };
    if (begins(x) && begins(y)) {
      char *x_end = nullptr, *y_end = nullptr;
      if (std::fabs(std::strtod(x, &x_end) - std::strtod(y, &y_end)) > 0.25) return false;
      x = x_end;
      y = y_end;
    } else if (*x++ != *y++) {
      return false;
    }
  }
  return *x == *y;
}

TEST(Drawings, StoredOnesAreThoseThatTheProgramMakes) {
  std::set<std::string> names;
  for (const drawings::Drawing& drawing : drawings::drawings()) {
    names.insert(drawing.name + ".svg");
    EXPECT_TRUE(isSame(drawing.svg, read(kFolder / (drawing.name + ".svg"))))
        << drawing.name << ".svg: make it anew by bash demos/run.sh drawings, and look at it";
    EXPECT_LT(drawing.svg.size(), 50000u) << drawing.name;
  }
  std::set<std::string> stored;
  for (const auto& entry : std::filesystem::directory_iterator(kFolder))
    stored.insert(entry.path().filename().string());
  EXPECT_EQ(names, stored);
}

// A class that makes a joint of one of Bullet's.
bool hasJointOfBullets(const std::string& header) {
  return std::regex_search(header,
                           std::regex("class \\w+ : public JointOf<bt\\w+Constraint, \\w+Model>"));
}

TEST(Drawings, EveryJointHasOneAndNamesItInItsHeader) {
  for (const char* folder : {"plugin/pintle/joints", "plugin/pintle/joints/unstable"})
    for (const auto& entry :
         std::filesystem::directory_iterator(std::filesystem::path(PINTLE_SOURCE_DIR) / folder)) {
      if (entry.path().extension() != ".h") continue;
      const std::string header = read(entry.path());
      if (header.find("const char* name() const override { return \"") == std::string::npos &&
          header.find("joint_name = \"") == std::string::npos && !hasJointOfBullets(header))
        continue;  // no joint of its own
      const std::string drawing = entry.path().stem().string() + ".svg";
      EXPECT_TRUE(std::filesystem::exists(kFolder / drawing)) << drawing;
      EXPECT_NE(header.find("\\image html " + drawing), std::string::npos) << entry.path();
    }
}

TEST(DrawingsChecker, SeesWhatIsMoreThanRounding) {
  EXPECT_TRUE(isSame("<path d=\"M1.2 -3L4 5\"/>", "<path d=\"M1.3 -3.1L4 5\"/>"));
  EXPECT_FALSE(isSame("M1.2 3", "M1.2 3.5"));
  EXPECT_FALSE(isSame("held", "free"));
  EXPECT_FALSE(isSame("M1", "M1 2"));
  EXPECT_FALSE(isSame("M1", ""));
}

}  // namespace

// The page of errata (plugin/docs/errata.md): every file and test that it names exists, every row names
// both, and every test of an erratum is on it.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

using Names = std::set<std::string>;

const std::filesystem::path kSource = PINTLE_SOURCE_DIR;

std::string read(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

Names matches(const std::string& text, const std::regex& pattern) {
  Names found;
  for (std::sregex_iterator i(text.begin(), text.end(), pattern), end; i != end; ++i) {
    found.insert(i->size() > 2 ? (*i)[1].str() + "." + (*i)[2].str() : (*i)[1].str());
  }
  return found;
}

// `Suite.Name` and `file.h`, as the page has them.
Names tests_named(const std::string& text) {
  return matches(text, std::regex(R"(`([A-Z][A-Za-z0-9]*)\.([A-Z][A-Za-z0-9_]*)`)"));
}
Names files_named(const std::string& text) {
  return matches(text, std::regex(R"(`([a-z_]+\.h)`)"));
}
// TEST(Suite, Name) and its relatives, on one line or two.
Names tests_written(const std::string& source) {
  return matches(source, std::regex(R"(TEST(?:_F|_P)?\((\w+),\s*(\w+)\))"));
}

std::vector<std::string> rows(const std::string& page) {
  std::vector<std::string> found;
  std::istringstream lines(page);
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("| ", 0) == 0 && line.rfind("| place", 0) != 0) found.push_back(line);
  }
  return found;
}

Names all_tests() {
  Names all;
  for (const auto& entry : std::filesystem::directory_iterator(kSource / "tests/unit")) {
    if (entry.path().extension() == ".cpp") all.merge(tests_written(read(entry.path())));
  }
  return all;
}

TEST(ErrataPage, EveryRowNamesAFileAndATestThatExist) {
  const Names written = all_tests();
  const auto table = rows(read(kSource / "plugin/docs/errata.md"));
  EXPECT_GE(table.size(), 27u);
  for (const std::string& row : table) {
    EXPECT_FALSE(tests_named(row).empty()) << row;
    EXPECT_FALSE(files_named(row).empty()) << row;
    for (const std::string& test : tests_named(row)) EXPECT_TRUE(written.count(test)) << test;
    for (const std::string& file : files_named(row)) {
      EXPECT_TRUE(std::filesystem::exists(kSource / "plugin/pintle/equations" / file)) << file;
    }
  }
}

TEST(ErrataPage, EveryTestOfAnErratumIsOnThePage) {
  const Names named = tests_named(read(kSource / "plugin/docs/errata.md"));
  for (const std::string& test : all_tests()) {
    EXPECT_TRUE(test.rfind("Errata.", 0) != 0 || named.count(test)) << test;
  }
}

TEST(ErrataPageChecker, FindsNamesInRowsAndSources) {
  const std::string row = "| (2.6) | `A_b I_b^-1` | `a_b.h` | `Errata.One_2`, `Two.Three` |";
  EXPECT_EQ(tests_named(row), Names({"Errata.One_2", "Two.Three"}));
  EXPECT_EQ(files_named(row), Names({"a_b.h"}));
  EXPECT_EQ(rows("text\n| place | x |\n|---|---|\n" + row + "\n"), std::vector<std::string>{row});
  EXPECT_EQ(tests_written("TEST(A, B) {\nTYPED_TEST(C,\n           D_1) {\nTEST_F(E, F) {}"),
            Names({"A.B", "C.D_1", "E.F"}));
  EXPECT_EQ(tests_written("TEST_SUITE(A, B); contest(A, B)"), Names());
}

}  // namespace

// The pages of documentation: what they link to and name exists, no sentence stands twice, and figures are those of the results.
#include <gtest/gtest.h>
#include <tables/brief.h>

#include <cctype>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <string>

#include "pages.h"

namespace {

namespace fs = std::filesystem;
using Strings = std::vector<std::string>;

const fs::path kSource = PINTLE_SOURCE_DIR;

std::string page(const char* name) { return pages::read(kSource / name); }

Strings matches(const std::string& text, const char* pattern) {
  const std::regex regex(pattern);
  Strings found;
  for (std::sregex_iterator i(text.begin(), text.end(), regex), end; i != end; ++i)
    found.push_back((*i)[1]);
  return found;
}

// The text without its blocks of code.
std::string prose(const std::string& text) {
  pages::Fence fence;
  std::string found;
  for (const std::string& line : pages::lines(text))
    if (!fence.takes(line)) found += line + "\n";
  return found;
}

// --- links ---------------------------------------------------------------------------------------

// The anchor that GitHub and Doxygen make of a heading.
std::string anchor(const std::string& heading) {
  std::string found;
  for (const char c : heading) {
    const auto u = static_cast<unsigned char>(c);
    if (std::isalnum(u) || c == '_' || c == '-') found += static_cast<char>(std::tolower(u));
    if (c == ' ') found += '-';
  }
  return found;
}

std::set<std::string> anchors(const std::string& text) {
  std::set<std::string> found;
  for (const std::string& line : pages::lines(prose(text)))
    if (line.rfind('#', 0) == 0) found.insert(anchor(line.substr(line.find(' ') + 1)));
  return found;
}

// What is wrong with a link of a page in a folder.
std::string complaint(const std::string& link, const std::string& text, const fs::path& folder) {
  if (link.find("://") != std::string::npos) return "";
  const auto hash = link.find('#');
  const std::string file = link.substr(0, hash);
  if (!file.empty() && !fs::exists(folder / file)) return "no such file: " + link;
  if (hash == std::string::npos) return "";
  const std::string target = file.empty() ? text : pages::read(folder / file);
  return anchors(target).count(link.substr(hash + 1)) ? "" : "no such heading: " + link;
}

TEST(Pages, LinksLeadSomewhere) {
  int links = 0;
  for (const fs::path& path : pages::all(kSource)) {
    const std::string text = pages::read(path);
    for (const std::string& link : matches(prose(text), R"(\]\(([^)\s]+)\))")) {
      ++links;
      EXPECT_EQ(complaint(link, text, path.parent_path()), "") << path;
    }
  }
  EXPECT_GT(links, 60);
}

TEST(PagesChecker, SeesBrokenLinks) {
  EXPECT_EQ(anchor("What it holds"), "what-it-holds");
  EXPECT_EQ(anchor("`a_b`: limits, springs"), "a_b-limits-springs");
  EXPECT_EQ(complaint("https://example.org", "", kSource), "");
  EXPECT_EQ(complaint("README.md#joints", "", kSource), "");
  EXPECT_EQ(complaint("#here", "# Here\n", kSource), "");
  EXPECT_NE(complaint("#there", "# Here\n```\n# There\n```\n", kSource), "");
  EXPECT_NE(complaint("nothing.md", "", kSource), "");
  EXPECT_NE(complaint("README.md#nothing", "", kSource), "");
}

TEST(Pages, FilesAndScriptsThatTheyNameExist) {
  for (const fs::path& path : pages::all(kSource)) {
    if (path.filename() == "CHANGELOG.md") continue;  // of what was
    const std::string text = pages::read(path);
    for (const std::string& file :
         matches(text, R"(`((?:adapters|demos|plugin|tests)/[A-Za-z0-9_/.]+)`)"))
      EXPECT_TRUE(fs::exists(kSource / file) || file.find("NAME") != std::string::npos)
          << path << ": " << file;
    for (const std::string& script : matches(text, R"(bash ([a-z_/]+\.sh))"))
      EXPECT_TRUE(fs::exists(kSource / script)) << path << ": " << script;
  }
}

TEST(Pages, AreAllReachedFromTheReadme) {
  const std::string readme = page("README.md");
  for (const fs::path& path : pages::all(kSource))
    if (path.filename() != "README.md") {
      EXPECT_NE(readme.find(fs::relative(path, kSource).generic_string()), std::string::npos)
          << path;
    }
  EXPECT_LE(pages::lines(readme).size(), 100u);
}

TEST(Changelog, BeginsWithTheVersionOfTheProject) {
  const Strings project = matches(page("CMakeLists.txt"), R"(project\(pintle VERSION ([0-9.]+))");
  const Strings versions = matches(page("CHANGELOG.md"), R"(\n## ([0-9]+\.[0-9]+\.[0-9]+)\n)");
  ASSERT_EQ(project.size(), 1u);
  ASSERT_GE(versions.size(), 2u);
  EXPECT_EQ(versions.front(), project.front());
  EXPECT_EQ(versions.size(), std::set<std::string>(versions.begin(), versions.end()).size());
}

// --- sentences -----------------------------------------------------------------------------------

// Of running text: neither tables nor headings nor pictures, without links and marks.
Strings sentences(const std::string& text) {
  std::string running;
  for (const std::string& line : pages::lines(prose(text))) {
    const bool ends =
        line.empty() || line[0] == '|' || line[0] == '#' || line[0] == '!' || line[0] == '<';
    running += ends ? std::string(". ") : line + " ";
  }
  running = std::regex_replace(running, std::regex(R"(\]\([^)]*\)|[\[*`]|^- )"), "");
  running = std::regex_replace(running, std::regex(R"(\s+)"), " ");
  Strings found;
  std::size_t from = 0;
  for (std::size_t i = 0; i + 1 < running.size(); ++i)
    if ((running[i] == '.' || running[i] == ':') && running[i + 1] == ' ') {
      std::string sentence = running.substr(from, i - from);
      sentence.erase(0, sentence.find_first_not_of(" -."));
      if (sentence.size() >= 30) found.push_back(sentence);
      from = i + 1;
    }
  return found;
}

TEST(Pages, HaveNoSentenceTwice) {
  std::map<std::string, std::string> seen;
  for (const fs::path& path : pages::all(kSource)) {
    if (path.filename() == "CHANGELOG.md") continue;
    for (const std::string& sentence : sentences(pages::read(path))) {
      const auto [where, is_new] = seen.insert({sentence, path.filename().string()});
      EXPECT_TRUE(is_new) << where->second << " and " << path.filename() << ": " << sentence;
    }
  }
  EXPECT_GT(seen.size(), 200u);
}

TEST(PagesChecker, SplitsTextIntoSentences) {
  EXPECT_EQ(sentences("# A heading that is long enough\n\nThe first one goes over\ntwo "
                      "[lines](x.md), as it may. And here is the *second* one, as long.\n"),
            Strings({"The first one goes over two lines, as it may",
                     "And here is the second one, as long"}));
}

// --- code ----------------------------------------------------------------------------------------

// Lines of code in blocks that are not marked as C++, which nothing compiles.
Strings unmarked(const std::string& text) {
  Strings found;
  pages::Fence fence;
  for (const std::string& line : pages::lines(text))
    if (fence.takes(line) && fence.language() != "cpp" && !line.empty() &&
        std::string(";{}").find(line.back()) != std::string::npos)
      found.push_back(line);
  return found;
}

TEST(Pages, CodeIsMarkedAsWhatIsCompiled) {
  for (const fs::path& path : pages::all(kSource))
    EXPECT_EQ(unmarked(pages::read(path)), Strings()) << path;
}

TEST(PagesChecker, SeesCodeThatIsNotMarked) {
  EXPECT_EQ(unmarked("```cpp\nint a;\n```\nProse;\n```\nbash run.sh\n```\n"), Strings());
  EXPECT_EQ(unmarked("```\nint a;\n```\n"), Strings({"int a;"}));
}

// --- joints --------------------------------------------------------------------------------------

TEST(Pages, HaveASectionARowAndAnExampleOfEveryJoint) {
  const std::string joints = page("plugin/docs/joints.md"), readme = page("README.md");
  for (const std::string& header :
       matches(page("plugin/pintle/pintle.h"), R"(#include <pintle/joints/(\w+)\.h>)")) {
    if (header == "draw_joints") continue;
    const Strings names = matches(page(("plugin/pintle/joints/" + header + ".h").c_str()),
                                  R"(\nclass (\w+) : public )");
    ASSERT_FALSE(names.empty()) << header;
    const std::string& name = names.back();
    EXPECT_NE(joints.find("\n## " + name + "\n"), std::string::npos) << name;
    EXPECT_NE(joints.find("(drawings/" + header + ".svg)"), std::string::npos) << name;
    EXPECT_NE(joints.find("pintle::" + name + " "), std::string::npos) << name;
    EXPECT_NE(readme.find("[`" + name + "`](plugin/docs/joints.md#" + anchor(name) + ")"),
              std::string::npos)
        << name;
  }
}

// --- figures -------------------------------------------------------------------------------------

Strings cells(const std::string& row) {
  Strings found;
  std::istringstream stream(row.substr(1));
  for (std::string cell; std::getline(stream, cell, '|');) {
    const auto from = cell.find_first_not_of(' ');
    found.push_back(
        from == std::string::npos ? "" : cell.substr(from, cell.find_last_not_of(' ') - from + 1));
  }
  return found;
}

// The rows between two marks of a page, without the head.
std::vector<Strings> rows(const std::string& text, const std::string& mark) {
  std::vector<Strings> found;
  bool inside = false;
  for (const std::string& line : pages::lines(text)) {
    if (line.rfind("<!-- " + mark, 0) == 0) inside = !inside;
    if (inside && line.rfind("| ", 0) == 0) found.push_back(cells(line));
  }
  if (!found.empty()) found.erase(found.begin());
  return found;
}

// Error ratios at equal time, by contender, scene, error and precision.
std::map<Strings, std::string> ratiosAgainstStock() {
  std::map<Strings, std::string> found;
  std::string who;
  for (const std::string& line : pages::lines(page("demos/results/summary.md"))) {
    if (line.rfind("## ", 0) == 0) {
      const auto end = line.find(" against stock");
      who = end == std::string::npos ? "" : line.substr(3, end - 3);
    } else if (!who.empty() && line.rfind("| ", 0) == 0) {
      const Strings row = cells(line);
      if (row.size() >= 4) found[{who, row[0], row[1], row[2]}] = row[3];
    }
  }
  return found;
}

TEST(Figures, OfTheReadmeAreThoseOfTheSummary) {
  const auto ratios = ratiosAgainstStock();
  const auto table = rows(page("README.md"), "figures");
  ASSERT_EQ(table.size(), 5u);
  const char* contenders[] = {"pintle", "exact", "dantzig", "multibody", "jolt", "mujoco", "ode"};
  for (const Strings& row : table) {
    ASSERT_EQ(row.size(), 3 + std::size(contenders)) << row[0];
    EXPECT_EQ(row[2], "1") << "stock's own";
    EXPECT_FALSE(row[7].empty()) << "Jolt has all five: bash demos/run.sh report --peers --publish";
    for (std::size_t k = 0; k < std::size(contenders); ++k) {
      const auto ratio = ratios.find({contenders[k], row.at(0), "**" + row.at(1) + "**", "double"});
      const std::string expected =
          ratio == ratios.end() ? "" : ratio->second.substr(0, ratio->second.find(' '));
      EXPECT_EQ(row[k + 3], expected)
          << row[0] << ' ' << contenders[k] << ": bash demos/run.sh report --publish";
    }
  }
}

TEST(Figures, OfTheBenchmarksAreThoseOfTheSummary) {
  const auto ratios = ratiosAgainstStock();
  const auto table = rows(page("plugin/docs/benchmarks.md"), "report");
  EXPECT_GE(table.size(), 38u);
  for (const Strings& row : table) {
    EXPECT_EQ(ratios.at({"pintle", row.at(0), row.at(1), row.at(2)}), row.at(3)) << row[0];
    EXPECT_EQ(ratios.at({"exact", row.at(0), row.at(1), row.at(2)}), row.at(4)) << row[0];
  }
}

// Of each row what follows the columns that are in words.
void expectNumbers(const char* mark, const std::vector<Strings>& table, std::size_t words,
                   const std::regex& number) {
  for (const Strings& row : table)
    for (std::size_t i = words; i < row.size(); ++i)
      EXPECT_TRUE(std::regex_match(row[i], number)) << mark << ": " << row[i];
}

TEST(Figures, OfPublishedProblemsAndMachinesAreWrittenByTheirCommand) {
  const std::string text = page("plugin/docs/benchmarks.md");
  const std::regex number(R"(([0-9.]+(e[-+][0-9]+)?|lost)?)");
  const struct {
    const char* mark;
    std::size_t least_rows, words;  // columns that are in words
  } tables[] = {{"published", 8, 2}, {"machines", 25, 2}};
  for (const auto& table : tables) {
    const auto all = rows(text, table.mark);
    EXPECT_GE(all.size(), table.least_rows) << table.mark << ": bash demos/run.sh report --publish";
    expectNumbers(table.mark, all, table.words, number);
  }
}

// The rows are those that the command writes, each with two numbers.
TEST(Figures, OfScenesAreWrittenByTheirCommand) {
  const auto table = rows(page("plugin/docs/benchmarks.md"), "scenes");
  const auto& written = tables::Brief::rows();
  ASSERT_EQ(table.size(), written.size()) << "bash demos/run.sh --publish";
  const std::regex number(R"(-?[0-9.]+(e[-+][0-9]+)?(°| m| rad/s)?|never)");
  for (std::size_t i = 0; i < table.size(); ++i) {
    ASSERT_EQ(table[i].size(), 4u);
    EXPECT_EQ(table[i][0], written[i].scene);
    EXPECT_EQ(table[i][1], written[i].what);
    EXPECT_TRUE(std::regex_match(table[i][2], number)) << table[i][2];
    EXPECT_TRUE(std::regex_match(table[i][3], number)) << table[i][3];
  }
  EXPECT_NE(page("plugin/docs/benchmarks.md").find(tables::Brief::head()), std::string::npos);
}

// One number a cell, as the program prints it.
TEST(Figures, OfTheExactSolverAreWrittenByTheirCommand) {
  const struct {
    const char* mark;
    std::size_t rows, words;  // columns that are in words
  } tables[] = {{"holds", 15, 1}, {"motors", 4, 2},        {"scaling", 15, 1},  {"nets", 15, 3},
                {"costs", 33, 1}, {"instructions", 13, 1}, {"exponents", 3, 2}, {"tangles", 3, 1}};
  const std::regex number(R"([0-9.]+(e[-+][0-9]+)?( m| rad| kB)?)");
  const std::string text = page("plugin/docs/exact-solver.md");
  for (const auto& table : tables) {
    const auto all = rows(text, table.mark);
    EXPECT_EQ(all.size(), table.rows) << table.mark << ": bash tests/bench/solver.sh --publish";
    expectNumbers(table.mark, all, table.words, number);
  }
}

}  // namespace

// The index of the document's equations: each number that the library cites, at the right edge of
// the line of code that is that equation, is one of the document's and is cited once.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

using Strings = std::vector<std::string>;

// The numbers at the ends of the lines of code: `code;  // (3.25)`, `code;  // (3.7), (3.8)`. A
// line that is only a comment cites nothing.
Strings citations(const std::string& source) {
  static const std::regex line(R"(^\s*[^\s/].*//\s*(\([0-9AB]+\.[0-9]+[a-z]?\)([,\s]+|$))+$)");
  static const std::regex number(R"(\(([0-9AB]+\.[0-9]+[a-z]?)\))");
  Strings found;
  std::istringstream lines(source);
  for (std::string text; std::getline(lines, text);) {
    if (!std::regex_match(text, line)) continue;
    const std::string comment = text.substr(text.rfind("//"));
    for (std::sregex_iterator i(comment.begin(), comment.end(), number), end; i != end; ++i) {
      found.push_back((*i)[1]);
    }
  }
  return found;
}

// What is wrong with the index: numbers that the document does not have, and numbers cited twice.
Strings complaints(const Strings& cited, const std::set<std::string>& document) {
  std::map<std::string, int> times;
  for (const std::string& number : cited) ++times[number];
  Strings found;
  for (const auto& [number, count] : times) {
    if (!document.count(number)) found.push_back("(" + number + ") is not in the document");
    if (count > 1) found.push_back("(" + number + ") is cited more than once");
  }
  return found;
}

std::string read(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

const std::filesystem::path kSource = PINTLE_SOURCE_DIR;

std::set<std::string> document_numbers() {
  std::ifstream file(kSource / "tests/unit/document_numbers.txt");
  std::set<std::string> numbers;
  for (std::string line; std::getline(file, line);) {
    if (!line.empty() && line[0] != '#') numbers.insert(line);
  }
  return numbers;
}

Strings all_citations() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(kSource / "plugin/pintle/equations")) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  Strings all;
  for (const auto& file : files) {
    const Strings cited = citations(read(file));
    all.insert(all.end(), cited.begin(), cited.end());
  }
  return all;
}

// --- the index -----------------------------------------------------------------------------------

TEST(EquationIndex, CitesNumbersOfTheDocumentEachOnce) {
  for (const std::string& complaint : complaints(all_citations(), document_numbers())) {
    ADD_FAILURE() << complaint;
  }
}

TEST(EquationIndex, HasTheEquationsOfTheSectionsThatAreBuilt) {
  const Strings cited = all_citations();
  for (const char* number :
       {"2.4",  "2.5",  "2.6",  "2.7",  "2.9",  "2.12", "2.13", "3.1",  "3.2",  "3.3",  "3.5",
        "3.6",  "3.7",  "3.8",  "3.10", "3.11", "3.12", "3.15", "3.16", "3.17", "3.19", "3.22",
        "3.24", "3.25", "3.28", "3.29", "3.31", "3.35", "3.36", "3.37", "3.39", "3.40", "3.41",
        "3.42", "3.43", "3.44", "3.45", "3.46", "3.47", "3.48", "3.49", "3.50", "3.52", "3.54",
        "3.55", "3.59", "3.61", "A.1",  "A.6",  "A.10", "A.11", "A.13", "A.15", "A.22", "A.23",
        "A.24", "A.25", "B.5",  "B.6a", "B.6b", "B.7a", "B.7b", "B.8",  "B.9",  "B.10", "B.13"}) {
    EXPECT_EQ(std::count(cited.begin(), cited.end(), number), 1) << number;
  }
}

TEST(EquationIndex, DocumentHasItsNumbersWithoutAGap) {
  const std::set<std::string> numbers = document_numbers();
  std::set<std::string> expected;
  const auto add = [&](const std::string& chapter, int count) {
    for (int i = 1; i <= count; ++i) expected.insert(chapter + "." + std::to_string(i));
  };
  add("2", 17);
  add("3", 61);
  add("A", 27);
  add("B", 14);
  for (const char* pair : {"B.6", "B.7"}) {
    expected.erase(pair);
    expected.insert(pair + std::string("a"));
    expected.insert(pair + std::string("b"));
  }
  EXPECT_EQ(numbers, expected);
}

// --- the checker ---------------------------------------------------------------------------------

TEST(EquationIndexChecker, FindsTheNumbersAtTheEndsOfLinesOfCode) {
  EXPECT_EQ(citations("  return a;   // (3.25)\n"), Strings({"3.25"}));
  EXPECT_EQ(citations("  return a;  // (3.7), (3.8)\n  T m_a;  // (B.6a)"),
            Strings({"3.7", "3.8", "B.6a"}));
  EXPECT_EQ(citations("x = 1 / y;  // (A.10)   \n"), Strings({"A.10"}));
  EXPECT_EQ(citations("f(2); // (2.4) (2.5)"), Strings({"2.4", "2.5"}));
}

TEST(EquationIndexChecker, DoesNotTakeProseForACitation) {
  EXPECT_EQ(citations("/// as (3.25) has it\n// (3.25)\n  // (3.25)\n//\n"), Strings());
  EXPECT_EQ(citations("  return a;  // see (3.25), printed wrong\n"), Strings());
  EXPECT_EQ(citations("  f(3.25);\n  g((3.25));\n"), Strings());
}

TEST(EquationIndexChecker, ComplainsOfUnknownNumbersAndOfDuplicates) {
  const std::set<std::string> document = {"2.4", "3.25", "B.6a"};
  EXPECT_EQ(complaints({"2.4", "B.6a"}, document), Strings());
  EXPECT_EQ(complaints({"2.4", "9.9"}, document), Strings({"(9.9) is not in the document"}));
  EXPECT_EQ(complaints({"B.6"}, document), Strings({"(B.6) is not in the document"}));
  EXPECT_EQ(complaints({"2.4", "3.25", "2.4"}, document),
            Strings({"(2.4) is cited more than once"}));
  EXPECT_EQ(complaints({"9.9", "9.9"}, document).size(), 2u);
}

}  // namespace

// Prints the table of extreme cases: what becomes of each with stock joints, and with Pintle's.

#include <pintle/solver/exact_joint_solver.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "../json_array.h"
#include "../progress.h"
#include "outcome.h"

namespace {

using extreme::Case;
using extreme::Outcome;
using extreme::Result;

struct Contender {
  std::string name, in_words;
  engines::MakeJoint make_joint;
  scenes::SolverFactory make_solver;  // empty: Bullet's
};

std::vector<Contender> contenders() {
  return {{"stock", "", engines::make_stock_joint, {}},
          {"document", "", engines::make_document_joint, {}},
          {"pintle", "Pintle", engines::make_conditioned_joint, {}},
          {"exact", "Pintle on ExactJointSolver", engines::make_conditioned_joint,
           [] { return std::make_unique<pintle::ExactJointSolver>(); }}};
}

// Of one contender against stock's joints.
struct Against {
  int worse = 0, better = 0, lost = 0;
  std::string ours_worse, both_diverge;

  void count(const Case& one, Outcome stock, Outcome ours) {
    better += ours < stock;
    worse += ours > stock;
    lost += ours == Outcome::non_finite;
    if (ours > stock) ours_worse += "- " + one.name() + "\n";
    if (stock >= Outcome::diverges && ours >= Outcome::diverges)
      both_diverge += "- " + one.name() + "\n";
  }
  void print(const std::string& name, size_t cases) const {
    std::printf("\nOf %d cases the outcome of %s is better in %d, worse in %d; not finite in %d.\n",
                int(cases), name.c_str(), better, worse, lost);
    std::printf("\nWorse:\n%s\nBoth diverge:\n%s", ours_worse.c_str(), both_diverge.c_str());
  }
};

void write(JsonArray& to, const Case& one, const std::string& who, const Result& result) {
  if (!to.is_open()) return;
  std::ostream& out = to.next();
  out << R"({"precision": ")" << engines::precision() << R"(", "joint": ")" << one.joint
      << R"(", "case": ")" << one.what << R"(", "who": ")" << who << R"(", "outcome": ")"
      << name(result.outcome) << R"(", "error": )";
  write_json_number(out, result.error);
  out << '}';
}

}  // namespace

int main(int argc, char** argv) {
  bool all = false, list = false;
  std::string text, json;
  std::vector<std::string> who, names;
  for (const Contender& contender : contenders()) names.push_back(contender.name);
  CLI::App app("Prints what becomes of joints under extreme conditions.");
  app.add_flag("--all", all, "Also the cases of 10^6 steps");
  app.add_option("--case", text, "Only those with this in their name")->take_last();
  app.add_option("--contender", who, "Only this contender; may be given more than once")
      ->check(CLI::IsMember(names))
      ->allow_extra_args(false);
  app.add_option("--json", json, "Also write them as an array of objects to this file")
      ->take_last();
  app.add_flag("--list", list, "Name the cases, and run nothing");
  CLI11_PARSE(app, argc, argv);
  std::vector<Case> cases;
  for (const Case& one : extreme::cases()) {
    if ((all || !one.is_long) && one.name().find(text) != std::string::npos) cases.push_back(one);
  }
  if (list) {
    for (const Case& one : cases) std::printf("%s\n", one.name().c_str());
    return EXIT_SUCCESS;
  }
  JsonArray file;
  if (!json.empty() && !file.open(json, 3)) {
    std::fprintf(stderr, "--json: cannot write %s\n", json.c_str());
    return EXIT_FAILURE;
  }
  std::vector<Contender> those;
  for (const Contender& contender : contenders())
    if (who.empty() || std::count(who.begin(), who.end(), contender.name) > 0)
      those.push_back(contender);
  const bool has_stock = those.front().name == "stock";
  std::printf("## %s precision\n\n| joint | extreme |", engines::precision());
  for (const Contender& contender : those) std::printf(" %s |", contender.name.c_str());
  std::printf("\n|---|---|");
  for (size_t i = 0; i < those.size(); ++i) std::printf("---|");
  std::printf("\n");
  std::vector<Against> against(those.size());
  Progress progress(double(cases.size()));
  for (const Case& one : cases) {
    std::vector<Result> results;
    for (const Contender& contender : those)
      results.push_back(run(one, contender.make_joint, contender.make_solver));
    progress.clear();
    std::printf("| %s | %s |", one.joint.c_str(), one.what.c_str());
    for (size_t i = 0; i < those.size(); ++i) {
      const bool counts = has_stock && !those[i].in_words.empty();
      const Outcome stock = results.front().outcome, ours = results[i].outcome;
      const char* const mark = counts && ours > stock ? "**" : "";
      std::printf(" %s%s%s %.1g |", mark, name(ours), mark, results[i].error);
      if (counts) against[i].count(one, stock, ours);
      write(file, one, those[i].name, results[i]);
    }
    std::printf("\n");
    std::fflush(stdout);
    progress.advance(1, one.name());
  }
  progress.clear();
  for (size_t i = 0; i < those.size(); ++i)
    if (has_stock && !those[i].in_words.empty()) against[i].print(those[i].in_words, cases.size());
  if (file.close()) return EXIT_SUCCESS;
  std::fprintf(stderr, "--json: %s could not be written to its end\n", json.c_str());
  return EXIT_FAILURE;
}

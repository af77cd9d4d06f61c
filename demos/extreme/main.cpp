// Prints the table of extreme cases: what becomes of each with stock joints, and with Pintle's.

#include <pintle/solver/exact_joint_solver.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <vector>

#include "../progress.h"
#include "outcome.h"

int main(int argc, char** argv) {
  using extreme::Outcome;
  using extreme::Result;
  bool all = false, list = false;
  std::string text;
  CLI::App app("Prints what becomes of joints under extreme conditions.");
  app.add_flag("--all", all, "Also the cases of 10^6 steps");
  app.add_option("--case", text, "Only those with this in their name")->take_last();
  app.add_flag("--list", list, "Name the cases, and run nothing");
  CLI11_PARSE(app, argc, argv);
  std::vector<extreme::Case> cases;
  for (const extreme::Case& one : extreme::cases()) {
    if ((all || !one.is_long) && one.name().find(text) != std::string::npos) cases.push_back(one);
  }
  if (list) {
    for (const extreme::Case& one : cases) std::printf("%s\n", one.name().c_str());
    return 0;
  }
  std::printf(
      "## %s precision\n\n| joint | extreme | stock | document | pintle | exact |\n"
      "|---|---|---|---|---|---|\n",
      engines::precision());
  struct Against {
    explicit Against(const char* what) : name(what) {}
    const char* name;
    int worse = 0, better = 0, lost = 0;
    std::string ours_worse, both_diverge;
    void count(const extreme::Case& one, Outcome stock, Outcome ours) {
      better += ours < stock;
      worse += ours > stock;
      lost += ours == Outcome::non_finite;
      if (ours > stock) ours_worse += "- " + one.name() + "\n";
      if (stock >= Outcome::diverges && ours >= Outcome::diverges)
        both_diverge += "- " + one.name() + "\n";
    }
  };
  Against pintle("Pintle"), exact("Pintle on ExactJointSolver");
  Progress progress(double(cases.size()));
  for (const extreme::Case& one : cases) {
    const Result of_stock = run(one, engines::make_stock_joint),
                 of_document = run(one, engines::make_document_joint),
                 of_pintle = run(one, engines::make_conditioned_joint),
                 of_exact = run(one, engines::make_conditioned_joint,
                                [] { return std::make_unique<pintle::ExactJointSolver>(); });
    const Outcome stock = of_stock.outcome;
    progress.clear();
    std::printf("| %s | %s | %s %.1g | %s %.1g |", one.joint.c_str(), one.what.c_str(), name(stock),
                of_stock.error, name(of_document.outcome), of_document.error);
    for (const Result& ours : {of_pintle, of_exact}) {
      const char* const mark = ours.outcome > stock ? "**" : "";
      std::printf(" %s%s%s %.1g |", mark, name(ours.outcome), mark, ours.error);
    }
    std::printf("\n");
    std::fflush(stdout);
    pintle.count(one, stock, of_pintle.outcome);
    exact.count(one, stock, of_exact.outcome);
    progress.advance(1, one.name());
  }
  progress.clear();
  for (const Against& of : {pintle, exact}) {
    std::printf("\nOf %d cases the outcome of %s is better in %d, worse in %d; not finite in %d.\n",
                int(cases.size()), of.name, of.better, of.worse, of.lost);
    std::printf("\nWorse:\n%s\nBoth diverge:\n%s", of.ours_worse.c_str(), of.both_diverge.c_str());
  }
}

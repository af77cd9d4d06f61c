// Prints the table of extreme cases: what becomes of each with stock joints, and with Pintle's.
//   --all         also those of 10^6 steps
//   --case TEXT   only those with this in their name

#include <pintle/solver/exact_joint_solver.h>

#include <cstdio>
#include <cstring>

#include "outcome.h"

int main(int argc, char** argv) {
  using extreme::Outcome;
  using extreme::Result;
  bool all = false;
  std::string text;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--all") == 0) all = true;
    if (std::strcmp(argv[i], "--case") == 0 && i + 1 < argc) text = argv[++i];
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
  int count = 0;
  for (const extreme::Case& one : extreme::cases()) {
    if (one.is_long && !all) continue;
    if (one.name().find(text) == std::string::npos) continue;
    const Result of_stock = run(one, engines::make_stock_joint),
                 of_document = run(one, engines::make_document_joint),
                 of_pintle = run(one, engines::make_conditioned_joint),
                 of_exact = run(one, engines::make_conditioned_joint,
                                [] { return std::make_unique<pintle::ExactJointSolver>(); });
    const Outcome stock = of_stock.outcome;
    std::printf("| %s | %s | %s %.1g | %s %.1g |", one.joint.c_str(), one.what.c_str(), name(stock),
                of_stock.error, name(of_document.outcome), of_document.error);
    for (const Result& ours : {of_pintle, of_exact}) {
      const char* const mark = ours.outcome > stock ? "**" : "";
      std::printf(" %s%s%s %.1g |", mark, name(ours.outcome), mark, ours.error);
    }
    std::printf("\n");
    std::fflush(stdout);
    ++count;
    pintle.count(one, stock, of_pintle.outcome);
    exact.count(one, stock, of_exact.outcome);
  }
  for (const Against& of : {pintle, exact}) {
    std::printf("\nOf %d cases the outcome of %s is better in %d, worse in %d; not finite in %d.\n",
                count, of.name, of.better, of.worse, of.lost);
    std::printf("\nWorse:\n%s\nBoth diverge:\n%s", of.ours_worse.c_str(), of.both_diverge.c_str());
  }
}

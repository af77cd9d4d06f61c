// Prints the table of extreme cases: what becomes of each with stock joints, and with Pintle's.
//   --all         also those of 10^6 steps
//   --case TEXT   only those with this in their name

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
      "## %s precision\n\n| joint | extreme | stock | document | pintle |\n|---|---|---|---|---|\n",
      engines::precision());
  int count = 0, worse = 0, better = 0, lost = 0;
  std::string both_diverge, ours_worse;
  for (const extreme::Case& one : extreme::cases()) {
    if (one.is_long && !all) continue;
    if (one.name().find(text) == std::string::npos) continue;
    const Result of_stock = run(one, engines::make_stock_joint),
                 of_document = run(one, engines::make_document_joint),
                 of_ours = run(one, engines::make_conditioned_joint);
    const Outcome stock = of_stock.outcome, ours = of_ours.outcome;
    const char* const mark = ours > stock ? "**" : "";
    std::printf("| %s | %s | %s %.1g | %s %.1g | %s%s%s %.1g |\n", one.joint.c_str(),
                one.what.c_str(), name(stock), of_stock.error, name(of_document.outcome),
                of_document.error, mark, name(ours), mark, of_ours.error);
    std::fflush(stdout);
    ++count;
    better += ours < stock;
    worse += ours > stock;
    lost += ours == Outcome::non_finite;
    if (ours > stock) ours_worse += "- " + one.name() + "\n";
    if (stock >= Outcome::diverges && ours >= Outcome::diverges)
      both_diverge += "- " + one.name() + "\n";
  }
  std::printf("\nOf %d cases Pintle's outcome is better in %d, worse in %d; not finite in %d.\n",
              count, better, worse, lost);
  std::printf("\nWorse:\n%s\nBoth diverge:\n%s\n", ours_worse.c_str(), both_diverge.c_str());
}

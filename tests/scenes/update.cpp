// Stores the figures of this precision anew, and prints what has changed.
#include <engines/engine.h>

#include <cstdio>

#include "figures.h"

int main() {
  const figures::Figures stored = figures::read(), measured = figures::measure();
  const std::vector<std::string> changes = figures::differences(stored, measured);
  for (const std::string& change : changes) std::printf("%s\n", change.c_str());
  std::printf("%s precision: %zu of %zu figures changed by more than %g\n", engines::precision(),
              changes.size(), measured.size(), figures::tolerance());
  if (!changes.empty()) figures::write(measured);
}

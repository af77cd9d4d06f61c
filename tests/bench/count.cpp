// Purpose: a joint's step, many times, for an instruction counter (count.sh).
//   count list            the cases: index, bytes, name, stock counterpart, the case without the parts that
//                         do not act in it, their number
//   count INDEX REPEATS   runs one
#include "joints.h"

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>

namespace {

// What a joint's settings allocate belongs to its size. (Bullet's own allocator makes the joint.)
std::size_t allocated = 0;

}  // namespace

// Not inlined: g++ would see the malloc of one without the free of the other, and warn.
PINTLE_NOINLINE void* operator new(std::size_t size) {
  allocated += size;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
PINTLE_NOINLINE void operator delete(void* memory) noexcept { std::free(memory); }
PINTLE_NOINLINE void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

int main(int argc, char** argv) {
  const auto cases = bench::cases();
  if (argc == 2 && std::strcmp(argv[1], "list") == 0) {
    for (size_t i = 0; i < cases.size(); ++i) {
      bench::JointStep step;
      allocated = 0;
      const auto joint = cases[i].make(step);
      const auto name = [](const char* of) { return of ? of : "-"; };
      std::printf("%zu\t%zu\t%s\t%s\t%s\t%d\n", i, cases[i].bytes + allocated, cases[i].name,
                  name(cases[i].stock), name(cases[i].without), cases[i].parts);
    }
    return 0;
  }
  const size_t index = argc == 3 ? size_t(std::atoi(argv[1])) : cases.size();
  if (index >= cases.size()) return std::fprintf(stderr, "usage: count list | INDEX REPEATS\n"), 2;
  bench::JointStep step;
  const auto joint = cases[index].make(step);
  int rows = 0;
  for (int i = std::atoi(argv[2]); i > 0; --i) rows += step.run(*joint);
  return rows < 0;
}

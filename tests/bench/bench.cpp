// Purpose: times, stock beside ours: the rows of a joint, parts on and off, and a whole step of the chain
// scene. Times of one machine and moment: compare them within a run only.
//   --benchmark_enable_random_interleaving=true --benchmark_repetitions=9 for ratios worth quoting
#include "joints.h"

#include <scenes/chain.h>

#include <benchmark/benchmark.h>

namespace {

void rows(benchmark::State& state, const bench::Case& which) {
  bench::JointStep step;
  const auto joint = which.make(step);
  int count = 0;
  for (auto _ : state) benchmark::DoNotOptimize(count += step.run(*joint));
  state.counters["bytes"] = double(which.bytes);
}

template <class Hinge>
void chainStep(benchmark::State& state) {
  scenes::ChainSettings settings;
  settings.links = int(state.range(0));
  settings.iterations = int(state.range(1));
  settings.seconds = 1;
  double gap = 0;
  for (auto _ : state) {
    const auto result = scenes::chain<Hinge>(settings);
    // Of the steps only: the scene measures its errors in between.
    state.SetIterationTime(result.microseconds_per_step * 1e-6 * settings.seconds / settings.dt);
    gap = result.mean_gap;
  }
  state.counters["mean_gap_m"] = gap;
}

}  // namespace

int main(int argc, char** argv) {
  for (const bench::Case& which : bench::cases())
    benchmark::RegisterBenchmark((std::string("rows/") + which.name).c_str(), rows, which);
  for (const int links : {10, 100}) {
    for (const int iterations : {1, 10, 50}) {
      const std::string size = std::to_string(links) + ", " + std::to_string(iterations);
      benchmark::RegisterBenchmark(("chain second/stock " + size).c_str(), chainStep<btHingeConstraint>)
          ->Args({links, iterations})
          ->UseManualTime();
      benchmark::RegisterBenchmark(("chain second/ours " + size).c_str(),
                                   chainStep<pintle::QuaternionHinge>)
          ->Args({links, iterations})
          ->UseManualTime();
    }
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
}

#!/usr/bin/env bash
# Runs Bullet's own examples with joints, unchanged but for the line that makes the solver, and prints what becomes of their joints: on
# the solver that they make, with stock joints upgraded on Bullet's iterations, and upgraded and exact.
# Usage: examples.sh --bullet DIR [--build BUILD]     DIR has bullet-3.25.tar.xz and examples-3.25.tar.xz; BUILD is a build of Pintle (build/release)
# Everything it makes is in build/examples.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

source tests/clients/options.sh
source tests/setup.sh
pintle_install_packages
build=$PWD/build/examples
mkdir -p "$build"
jobs=${PINTLE_JOBS:-$(nproc)}

build_library "$build/library.log" "$jobs"

# --- the line that makes the solver ------------------------------------------------------------------------------------
tree=$build/bullet-$version
if [ ! -f "$build/whole" ]; then
  rm -rf "$tree"
  for archive in bullet examples; do tar -xf "$bullet/$archive-$version.tar.xz" -C "$build"; done
  # (Some examples may have one that is not iterated, by a global switch.)
  grep -rlE 'new bt(SequentialImpulse|NNCG)ConstraintSolver|bool useMCLPSolver = true' "$tree/examples" --include=*.cpp --include=*.h |
    xargs sed -Ei 's/new btSequentialImpulseConstraintSolver\b(\(\))?/examples::makeSolver()/
      s/new btNNCGConstraintSolver\b(\(\))?/examples::makeNncgSolver()/
      s/bool useMCLPSolver = true/bool useMCLPSolver = examples::usesMlcp()/'
  touch "$build/whole"
fi
cmake -S tests/clients/examples -B "$build/objects" -DCMAKE_BUILD_TYPE=None -DTREE="$tree" \
  -DPINTLE_LIBRARY="$(realpath "$library_build")/libpintle_single.a" >"$build/configure.log" || { cat "$build/configure.log"; exit 1; }
cmake --build "$build/objects" --parallel "$jobs" >"$build/compile.log" 2>&1 ||
  { grep -E "error|undefined reference" "$build/compile.log" | head -n 40; exit 1; }

# --- run ---------------------------------------------------------------------------------------------------------------
row='%-20s %6s  %-9s %9s %9s %9s %10s %8s\n'
echo "600 steps of 1/60 s: gap of the pivots, mean and largest (m), limits passed at the most (m or rad), the rise of the energy above"
echo "that of the start (J), and the CPU time of a step (us)"
printf "$row" scene joints solver gap "gap max" passed energy time
while read -r scene; do
  for contender in stock upgraded exact; do
    line=$(PINTLE_EXAMPLES_SOLVER=$contender timeout 300 "$build/objects/examples" "$scene" 2>"$build/$scene.log" | grep -a '^row: ') || line="row: - ended early"
    read -r joints gap max passed energy time <<<"${line#row: }"
    printf "$row" "$scene" "$joints" "$contender" "$gap" "$max" "$passed" "$energy" "$time"
  done
done < <("$build/objects/examples")

#!/usr/bin/env bash
# Builds the demos and runs them in single, then in double precision.
#   run.sh [options of the demos]           every scene's table, beside the stock joints'
#   run.sh report [options]                 error against run time: tables and plots (--help says more)
#   run.sh extreme [--all] [--case TEXT]    what becomes of joints under extreme conditions; --all: 10^6 steps too
#   run.sh drawings                         draws the joints anew, to plugin/docs/drawings
#   run.sh reference [--scene NAME]...      solves the stored reference solutions again
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

source tests/setup.sh

build() {  # targets
  cmake --preset release >&2
  cmake --build --preset release --parallel "$(nproc)" --target "$@" >&2
}

case "${1-}" in
report)
  shift
  source demos/report/report.sh
  report "$@"
  ;;
reference)
  shift
  pintle_install_packages
  build pintle_reference
  scenes=()
  for argument in "$@"; do [ "$argument" = --scene ] || scenes+=("$argument"); done
  build/release/demos/pintle_reference ${scenes[@]+"${scenes[@]}"}
  ;;
drawings)
  pintle_install_packages
  build pintle_draw
  build/release/demos/pintle_draw plugin/docs/drawings
  ;;
extreme)
  shift
  pintle_install_packages
  build pintle_extreme_single pintle_extreme_double
  for precision in single double; do build/release/demos/pintle_extreme_$precision "$@"; done
  ;;
*)
  pintle_install_packages
  build pintle_demos_single pintle_demos_double
  for precision in single double; do
    build/release/demos/pintle_demos_$precision --csv build/release/demos/results_$precision.csv "$@"
  done
  ;;
esac

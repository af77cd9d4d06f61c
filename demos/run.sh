#!/usr/bin/env bash
# Builds the demos and runs them in single, then in double precision. Options are passed to the demos.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

source tests/setup.sh
pintle_install_packages

cmake --preset release
cmake --build --preset release --parallel "$(nproc)" --target pintle_demos_single pintle_demos_double
for precision in single double; do
  build/release/demos/pintle_demos_$precision --csv build/release/demos/results_$precision.csv "$@"
done

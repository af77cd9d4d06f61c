#!/usr/bin/env bash
# Stores the scenes' key figures anew, in both precisions, and prints what has changed.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

source tests/setup.sh
pintle_install_packages
cmake --preset release
cmake --build --preset release --parallel "$(nproc)" --target pintle_figures_single pintle_figures_double
for precision in single double; do build/release/tests/pintle_figures_$precision; done

#!/usr/bin/env bash
# Builds and runs all tests in both precisions.
# Usage: run.sh [--preset release|debug|sanitizers] [ctest options]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

preset=release
if [ "${1-}" = --preset ]; then
  preset=$2
  shift 2
fi

source tests/setup.sh
packages=()
[ "$preset" != sanitizers ] || packages+=(clang libclang-rt-dev)
pintle_install_packages ${packages[@]+"${packages[@]}"}
# For tests that are skipped without them: of the page, of the documentation's site, of what a recorder costs, and of .bullet files.
if [ "$preset" != sanitizers ]; then
  pintle_install_page_packages chromium doxygen valgrind
  pintle_install_optional_packages libbullet-extras-dev
  bash demos/engines/jolt/install.sh "build/$preset/jolt"  # for its own tests
fi

cmake --preset "$preset"
cmake --build --preset "$preset" --parallel "$(nproc)" --target pintle_tests
ctest --preset "$preset" --parallel "$(nproc)" "$@"

#!/usr/bin/env bash
# Builds everything and runs all tests in both precisions.
# Usage: run.sh [--preset release|debug|sanitizers] [ctest options]; PINTLE_CMAKE_OPTIONS is handed to cmake.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

preset=release
if [ "${1-}" = --preset ]; then
  preset=$2
  shift 2
fi

source tests/setup.sh
pintle_install_packages

cmake --preset "$preset" ${PINTLE_CMAKE_OPTIONS:-}
cmake --build --preset "$preset" --parallel "$(nproc)"
ctest --preset "$preset" --parallel "$(nproc)" "$@"

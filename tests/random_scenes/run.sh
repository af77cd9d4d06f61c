#!/usr/bin/env bash
# Plays random scenes and prints those that gain energy.
# Usage: run.sh [--single] [driven] COUNT [FIRST SEED], or run.sh [--single] show SEED [WHAT] (main.cpp says what)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

precision=double
if [ "${1-}" = --single ]; then
  precision=single
  shift
fi

source tests/setup.sh
pintle_install_packages
cmake --preset release >&2
cmake --build --preset release --parallel "$(nproc)" --target "pintle_random_scenes_$precision" >&2
exec "$(find build/release -name "pintle_random_scenes_$precision" -type f | head -n 1)" "$@"

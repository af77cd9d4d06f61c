#!/usr/bin/env bash
# Prints what whole steps of worlds with many joints cost, and how far their joints are apart: Bullet's joints and Pintle's,
# in double precision, both on Bullet's solver. Times are of the processor, and only their ratio means something.
#   cost.sh             prints the table
#   cost.sh --publish   the same, to plugin/docs/benchmarks.md
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
cmake --preset release >/dev/null
cmake --build --preset release --parallel "$(nproc)" --target pintle_frames_double >/dev/null
table=$(mktemp)
build/release/tests/bench/pintle_frames_double ragdolls doors vehicles bridges net | sed -n '/^cost/,$p' | tee "$table"
if [ "${1-}" = --publish ]; then
  source demos/report/report.sh
  { echo '```'; cat "$table"; echo '```'; } >"$table.page"
  report_replace plugin/docs/benchmarks.md cost "$table.page"
  rm "$table.page"
fi
rm "$table"

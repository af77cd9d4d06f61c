#!/usr/bin/env bash
# Prints what a recorder adds to a step, in double precision. Worlds with and without one take turns, and each step counts with its
# shortest time.
#   record.sh             prints the table
#   record.sh --publish   the same, to plugin/docs/recording.md
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
cmake --preset release >/dev/null
cmake --build --preset release --parallel "$(nproc)" --target pintle_record_double >/dev/null
table=$(mktemp)
build/release/tests/bench/pintle_record_double | tee "$table"
if [ "${1-}" = --publish ]; then
  source demos/report/report.sh
  { echo '```'; cat "$table"; echo '```'; } >"$table.page"
  report_replace plugin/docs/recording.md record "$table.page"
  rm "$table.page"
fi
rm "$table"

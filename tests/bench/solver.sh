#!/usr/bin/env bash
# Prints the exact solver's tables, in double precision: what joints lack, what becomes of motors, limits and tangles, and what
# a step takes. Times are of the processor, and only their ratio means something.
#   solver.sh             prints the tables
#   solver.sh --publish   the same, to plugin/docs/exact-solver.md; with what a step costs and how that grows (linear.sh), by callgrind
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
cmake --preset release >/dev/null
cmake --build --preset release --parallel "$(nproc)" --target pintle_solver_double >/dev/null
program=build/release/tests/bench/pintle_solver_double
[ "${1-}" = --publish ] || exec "$program"

source demos/report/report.sh
page=plugin/docs/exact-solver.md
tables=$(mktemp -d)
bash tests/bench/linear.sh --page "$tables"
"$program" --page "$tables"
for table in "$tables"/*.md; do report_replace "$page" "$(basename "$table" .md)" "$table"; done
rm -r "$tables"

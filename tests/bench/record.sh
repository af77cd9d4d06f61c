#!/usr/bin/env bash
# Prints what a recorder adds to the instructions of a step, by callgrind, in double precision: with 60 frames a second, which is
# each step, and with 30. Instruction counts repeat exactly. (pintle_record_double times the same.)
#   record.sh             prints the table
#   record.sh --publish   the same, to plugin/docs/recording.md
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
command -v valgrind >/dev/null || { echo "record.sh: needs valgrind (Debian: valgrind)" >&2; exit 1; }
cmake --preset release >/dev/null
cmake --build --preset release --parallel "$(nproc)" --target pintle_record_double >/dev/null
program=build/release/tests/bench/pintle_record_double

instructions() {  # of 120 steps: world, frames a second
  local steps count=()
  for steps in 0 120; do
    count+=("$(valgrind --tool=callgrind --callgrind-out-file=/dev/null "$program" "$1" "$2" $steps 2>&1 | sed -n 's/.*Collected : *//p')")
  done
  echo $((count[1] - count[0]))
}
table=$(mktemp)
printf '| world | 60 frames a second | 30 frames a second |\n|---|---|---|\n' | tee "$table"
while IFS=$'\t' read -r index name; do
  without=$(instructions "$index" 0)
  each=()
  for frames in 60 30; do
    each+=("$(awk -v a="$(instructions "$index" $frames)" -v b="$without" 'BEGIN { printf "%.1f %%", 100 * (a / b - 1) }')")
  done
  echo "| $name | ${each[0]} | ${each[1]} |" | tee -a "$table"
done < <("$program" list)
if [ "${1-}" = --publish ]; then
  source demos/report/report.sh
  report_replace plugin/docs/recording.md record "$table"
fi
rm "$table"

#!/usr/bin/env bash
# Prints what a recorder adds to the instructions of a step, by callgrind, in double precision: with 60 frames a second, which is
# each step, and with 30. Instruction counts repeat exactly. (pintle_record_double times the same.)
#   record.sh                   prints the table
#   record.sh --publish         the same, to plugin/docs/recording.md
#   record.sh --check PROGRAM   the same of a program that is built; fails above the most that a recorder may cost, and where the
#                               page has other numbers. Ends with 77 where there is no valgrind
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
page=plugin/docs/recording.md
most=2.0      # %, of a step
another=0.25  # %: so much is what another compiler's instructions may differ by

if [ "${1-}" = --check ]; then
  program=$2
  command -v valgrind >/dev/null || { echo "Skipped: there is no valgrind"; exit 77; }
else
  command -v valgrind >/dev/null || { echo "record.sh: needs valgrind (Debian: valgrind)" >&2; exit 1; }
  program=build/release/tests/bench/pintle_record_double
  cmake --preset release >/dev/null
  cmake --build --preset release --parallel "$(nproc)" --target pintle_record_double >/dev/null
fi

instructions() {  # of 120 steps: world, frames a second
  valgrind --tool=callgrind --callgrind-out-file=/dev/null --toggle-collect='*DynamicsWorld::stepSimulation*' \
    --toggle-collect='*Recorder::step*' "$program" "$1" "$2" 120 2>&1 | sed -n 's/.*Collected : *//p'
}
table=$(mktemp)
trap 'rm "$table"' EXIT
printf '| world | 60 frames a second | 30 frames a second |\n|---|---|---|\n' | tee "$table"
while IFS=$'\t' read -r index name; do
  without=$(instructions "$index" 0)
  each=()
  for frames in 60 30; do
    each+=("$(awk -v a="$(instructions "$index" $frames)" -v b="$without" 'BEGIN { printf "%.1f %%", 100 * (a / b - 1) }')")
  done
  echo "| $name | ${each[0]} | ${each[1]} |" | tee -a "$table"
done < <("$program" list)

case "${1-}" in
--publish)
  source demos/report/report.sh
  report_replace "$page" record "$table"
  ;;
--check)
  # Line by line: the page's table, then this one.
  awk -F '|' -v most=$most -v another=$another '
    function differ(a, b) { return a - b > another || b - a > another }
    FNR == NR { if (/<!-- record/) inside = !inside; else if (inside) written[++lines] = $0; next }
    { split(written[FNR], said) }
    $2 != said[2] { print "recording.md has no row of" $2; failed = 1 }
    FNR > 2 && !(0 < $3 + 0 && $3 + 0 <= most) { print $2 "costs" $3 "of a step, and may cost " most " %"; failed = 1 }
    FNR > 2 && (differ($3, said[3]) || differ($4, said[4])) {
      print "recording.md:" $2 "has" said[3] "and" said[4] "(bash tests/bench/record.sh --publish)"
      failed = 1
    }
    END { exit failed || FNR != lines || lines < 3 }' "$page" "$table"
  ;;
esac

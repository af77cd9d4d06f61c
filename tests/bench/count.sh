#!/usr/bin/env bash
# Prints the instructions of one step of each joint (buildJacobian + getInfo1 + getInfo2), by callgrind,
# and its size in bytes, beside its stock counterpart's; and which part of its instructions a limit takes
# that is far, or a motor that is off. Instruction counts repeat exactly.
#   count.sh [PROGRAM]   default: the release build in single precision, which it makes
#   count.sh --publish   the same, to plugin/docs/benchmarks.md
set -euo pipefail
if [ "${1-}" = --publish ]; then
  cd "$(dirname "${BASH_SOURCE[0]}")/../.."
  source demos/report/report.sh
  table=$(mktemp)
  { echo '```'; bash tests/bench/count.sh | sed 's/ *$//'; echo '```'; } >"$table"
  report_replace plugin/docs/benchmarks.md count "$table"
  rm "$table"
  exit
fi
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
program=${1:-$here/../../build/release/tests/bench/pintle_count_single}
if [ $# -eq 0 ]; then
  (cd "$here/../.." && cmake --preset release >/dev/null && cmake --build --preset release --parallel "$(nproc)" --target pintle_count_single >/dev/null)
fi
command -v valgrind >/dev/null || { echo "count.sh: needs valgrind (Debian: valgrind)" >&2; exit 1; }
[ -x "$program" ] || { echo "count.sh: no $program" >&2; exit 1; }

instructions() {  # of the whole program
  valgrind --tool=callgrind --callgrind-out-file=/dev/null "$program" "$1" "$2" 2>&1 |
    sed -n 's/.*Collected : *//p'
}
# The difference of two runs leaves out all that is not repeated.
few=100 many=300
declare -A of
printf '%-28s %12s %7s %12s %7s %6s %9s\n' joint instructions bytes 'stock instr.' bytes ratio inactive
while IFS=$'\t' read -r index bytes name stock without parts; do
  count=$((($(instructions "$index" $many) - $(instructions "$index" $few)) / (many - few)))
  of[$name]="$count $bytes"
  if [ "$stock" = - ]; then
    printf '%-28s %12d %7d\n' "$name" "$count" "$bytes"
  else
    read -r stock_count stock_bytes <<<"${of[$stock]}"
    inactive=
    if [ "$without" != - ]; then
      read -r least _ <<<"${of[$without]}"
      inactive=$(awk -v a="$count" -v b="$least" -v n="$parts" 'BEGIN { printf "%.1f %%", 100 * (a - b) / a / n }')
    fi
    printf '%-28s %12d %7d %12d %7d %6s %9s\n' "$name" "$count" "$bytes" "$stock_count" "$stock_bytes" \
      "$(awk -v a="$count" -v b="$stock_count" 'BEGIN { printf "%.2f", a / b }')" "$inactive"
  fi
done < <("$program" list)

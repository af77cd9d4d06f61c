#!/usr/bin/env bash
# Prints what a step of a whole world costs on the exact solver beside Bullet's, in double precision, scene by scene: instructions, by
# callgrind, and time. Of chains, trees and stars also how that grows with their joints: the exponents of a step's instructions and
# time, by least squares of their logarithms. Takes some twenty minutes.
#   linear.sh [--page FOLDER] [SCENE]...   default: all, of which `pintle_solver_double costs` has the names; --page: as tables, too
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
program=$here/../../build/release/tests/bench/pintle_solver_double
(cd "$here/../.." && cmake --preset release >/dev/null && cmake --build --preset release --parallel "$(nproc)" --target pintle_solver_double >/dev/null)
command -v valgrind >/dev/null || { echo "linear.sh: needs valgrind (Debian: valgrind)" >&2; exit 1; }
work=$(mktemp -d)
trap 'rm -r "$work"' EXIT
page=$work
if [ "${1-}" = --page ]; then
  page=$2
  shift 2
fi
"$program" costs >"$work/titles"
[ $# -gt 0 ] || set -- $(cut -f 1 "$work/titles")

# Instructions repeat exactly, so that they are counted side by side; the largest worlds first.
count() {  # SCENE SOLVER: to a file, the instructions of a step
  local printed all
  printed=$(valgrind --tool=callgrind --callgrind-out-file=/dev/null --toggle-collect='solver_bench::timedStep*' \
    --log-file="$work/log.$1.$2" "$program" count "$1" "$2")
  all=$(sed -n 's/.*Collected : *//p' "$work/log.$1.$2")
  echo $((all / ${printed#* })) >"$work/count.$1.$2"
}
export -f count
export work program
for scene in "$@"; do echo "$scene stock"; echo "$scene exact"; done | sort -t - -k 2,2nr -s | xargs -P "$(nproc)" -L 1 bash -euc 'count "$0" "$1"'

# Of each scene: its joints, then by Bullet and by the exact solver instructions, time and gap.
for scene in "$@"; do
  read -r joints stock_time stock_gap exact_time exact_gap < <("$program" time "$scene")
  echo "$scene $joints $(<"$work/count.$scene.stock") $(<"$work/count.$scene.exact") $stock_time $exact_time $stock_gap $exact_gap"
done >"$work/all"

awk -F '\t' -v page="$page" '
  function number(x) { return sprintf(x >= 100 ? "%.0f" : "%.2g", x) }
  function row(file, text) { print text >(page "/" file ".md") }
  function begin(file, head, text) {
    if (file in begun) return
    begun[file] = 1
    printf "%s%s\n", n++ ? "\n" : "", text
    row(file, head)
    gsub(/[^|]+/, "---", head)
    row(file, head)
  }
  FNR == NR { title[$1] = $2; next }
  {
    split($0, is, " ")
    scene = is[1]; joints = is[2]
    if (scene !~ /^(chain|tree|star)-[0-9]+$/) {
      begin("costs", "| scene | joints | instructions, exact / Bullet | time, exact / Bullet | mean gap, Bullet | mean gap, exact |",
            sprintf("%-56s %7s %12s %12s %6s %6s %9s %9s", "step of", "joints", "stock instr.", "exact instr.", "ratio", "time", "stock gap", "exact gap"))
      printf "%-56s %7d %12d %12d %6.3f %6.3f %9.1e %9.1e\n", title[scene], joints, is[3], is[4], is[4] / is[3], is[6] / is[5], is[7], is[8]
      row("costs", sprintf("| %s | %d | %.2f | %.2f | %s m | %s m |", title[scene], joints, is[4] / is[3], is[6] / is[5], number(is[7]), number(is[8])))
      next
    }
    begin("instructions", "| shape | joints | Bullet | exact | time, exact / Bullet |",
          sprintf("%-8s %8s %12s %12s %6s %6s", "a joint", "joints", "stock instr.", "exact instr.", "ratio", "time"))
    printf "%-8s %8d %12d %12d %6.3f %6.3f\n", title[scene], joints, is[3] / joints, is[4] / joints, is[4] / is[3], is[6] / is[5]
    row("instructions", sprintf("| %s | %d | %d | %d | %.2f |", title[scene], joints, is[3] / joints, is[4] / joints, is[6] / is[5]))
    shape = title[scene]
    if (!(shape in worlds)) { shapes[++count] = shape; least[shape] = joints }
    ++worlds[shape]
    most[shape] = joints
    x = log(joints)
    sum[shape] += x; squares[shape] += x * x
    for (i = 3; i <= 6; ++i) { sums[shape, i] += log(is[i]); products[shape, i] += x * log(is[i]) }
  }
  END {
    for (k = 1; k <= count; ++k) {
      shape = shapes[k]; n = worlds[shape]
      if (n < 2) continue
      for (i = 3; i <= 6; ++i)
        exponent[i] = (n * products[shape, i] - sum[shape] * sums[shape, i]) / (n * squares[shape] - sum[shape] ^ 2)
      begin("exponents", "| shape | joints | instructions, Bullet | instructions, exact | time, Bullet | time, exact |",
            sprintf("%-8s %18s %12s %12s %10s %10s", "exponent", "joints", "stock instr.", "exact instr.", "stock time", "exact time"))
      range = least[shape] " to " most[shape]
      printf "%-8s %18s %12.3f %12.3f %10.3f %10.3f\n", shape, range, exponent[3], exponent[4], exponent[5], exponent[6]
      row("exponents", sprintf("| %s | %s | %.2f | %.2f | %.2f | %.2f |", shape, range, exponent[3], exponent[4], exponent[5], exponent[6]))
    }
  }' "$work/titles" "$work/all"

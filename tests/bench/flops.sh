#!/usr/bin/env bash
# What stands in the way of a faster step, for each joint and step: instructions that Bullet itself takes beside the exact solver,
# those which that leaves where the whole is to take 1.1 of stock's (chain: 0.9), and the floating-point operations of the exact
# solver: with default options, and at least, with one pass and tolerances of 1e-5 m. Double precision, by callgrind and objdump.
#   flops.sh [SCENE]...   default: doors vehicles bridges ragdolls chain
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
program=$here/../../build/release/tests/bench/pintle_solver_double
(cd "$here/../.." && cmake --preset release >/dev/null && cmake --build --preset release --parallel "$(nproc)" --target pintle_solver_double >/dev/null)
for tool in valgrind objdump nm; do
  command -v $tool >/dev/null || { echo "flops.sh: needs $tool (Debian: valgrind, binutils)" >&2; exit 1; }
done
[ $# -gt 0 ] || set -- doors vehicles bridges ragdolls chain

work=$(mktemp -d)
trap 'rm -r "$work"' EXIT
# Of each instruction that computes: its address, and how many numbers it makes. A multiplication with an addition makes two of each.
objdump -d --no-show-raw-insn "$program" | awk '
  $1 ~ /^[0-9a-f]+:$/ {
    op = $2; sub(/^v/, "", op)
    if (op !~ /^(add|sub|mul|div|sqrt|fn?m(add|sub)[0-9]*)[sp]d$/) next
    n = op !~ /pd$/ ? 1 : /%ymm/ ? 4 : 2
    print substr($1, 1, length($1) - 1), n * (op ~ /^f/ ? 2 : 1)
  }' >"$work/flops"
main=$(nm "$program" | awk '$3 == "main" { print $1 }')

counts() {  # SCENE SOLVER STEPS: instructions of all, those of Bullet's own code, and the operations of the program's own
  valgrind --tool=callgrind --dump-instr=yes --compress-pos=no --compress-strings=no \
    --callgrind-out-file="$work/out.$3" "$program" scene "$@" >/dev/null 2>"$work/log.$3" || { cat "$work/log.$3" >&2; exit 1; }
  awk -v program="$(basename "$program")" -v main="$main" '
    function number(hex, n, i) {
      n = 0
      for (i = 1; i <= length(hex); ++i) n = 16 * n + index("0123456789abcdef", substr(hex, i, 1)) - 1
      return n
    }
    FNR == NR { flops[number($1)] = $2; next }
    /^ob=/ { own = $0 ~ program "$"; is_bullet = $0 ~ /\/lib(Bullet|LinearMath)/; next }
    /^fn=/ { is_main = $0 == "fn=main"; next }
    /^calls=/ { skip = 1; next }
    /^0x/ {
      if (skip) { skip = 0; next }
      all += $3
      if (is_bullet) bullet += $3
      if (!own) next
      at[$1] += $3
      if (!is_main) next
      address = number(substr($1, 3))
      if (first == "" || address < first) first = address
    }
    END {
      base = first - number(main)  # where the program was loaded
      for (a in at) sum += at[a] * flops[number(substr(a, 3)) - base]
      printf "%d %d %d\n", all, bullet, sum
    }' "$work/flops" "$work/out.$3"
}
each() {  # the difference of two runs leaves out all that is not repeated
  local many few
  many=$(counts "$1" "$2" $((2 * steps)))
  few=$(counts "$1" "$2" "$steps")
  awk -v n="$((steps * joints))" '{ print ($1 - $4) / n, ($2 - $5) / n, ($3 - $6) / n }' <<<"$many $few"
}
printf '%-10s %8s %8s %8s %8s %8s %8s %8s\n' '' stock exact Bullet left flops least 'least/left'
steps=60
for scene in "$@"; do
  joints=$("$program" scene "$scene" stock 0)
  [ "$joints" -gt 0 ] || { echo "flops.sh: there is no scene $scene" >&2; exit 1; }
  read -r stock _ _ < <(each "$scene" stock)
  read -r all bullet operations < <(each "$scene" exact)
  read -r _ _ least < <(each "$scene" least)
  part=1.1
  [ "$scene" != chain ] || part=0.9
  awk -v scene="$scene" -v part="$part" -v stock="$stock" -v all="$all" -v bullet="$bullet" -v operations="$operations" -v least="$least" 'BEGIN {
    left = part * stock - bullet
    printf "%-10s %8d %8d %8d %8d %8d %8d %8.2f\n", scene, stock, all, bullet, left, operations, least, least / left
  }'
done

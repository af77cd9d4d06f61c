#!/usr/bin/env bash
# Prints the instructions that a step of a whole world takes, for each of its joints, in chains and in binary trees
# of many joints, by callgrind: Bullet's joints on Bullet's solver, and Pintle's on the exact one, in double precision.
#   linear.sh [--page FILE] [JOINTS]...   default: 10 100 1000 (10000 takes some minutes); --page: as a table, to a file
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
program=$here/../../build/release/tests/bench/pintle_solver_double
(cd "$here/../.." && cmake --preset release >/dev/null && cmake --build --preset release --parallel "$(nproc)" --target pintle_solver_double >/dev/null)
command -v valgrind >/dev/null || { echo "linear.sh: needs valgrind (Debian: valgrind)" >&2; exit 1; }
page=/dev/null
if [ "${1-}" = --page ]; then
  page=$2
  shift 2
fi
[ $# -gt 0 ] || set -- 10 100 1000

instructions() {  # of the whole program
  valgrind --tool=callgrind --callgrind-out-file=/dev/null "$program" steps "$@" 2>&1 |
    sed -n 's/.*Collected : *//p'
}
# The difference of two runs leaves out all that is not repeated.
printf '%-8s %8s %8s %8s\n' '' joints stock exact
printf '| shape | joints | Bullet | exact |\n|---|---|---|---|\n' >"$page"
for shape in chain tree; do
  for joints in "$@"; do
    steps=$((2 + 2000 / joints))
    each=()
    for solver in stock exact; do
      few=$(instructions "$shape" "$joints" "$solver" "$steps")
      many=$(instructions "$shape" "$joints" "$solver" $((2 * steps)))
      each+=($(((many - few) / steps / joints)))
    done
    printf '%-8s %8d %8d %8d\n' "$shape" "$joints" "${each[@]}"
    printf '| %s | %d | %d | %d |\n' "$shape" "$joints" "${each[@]}" >>"$page"
  done
done

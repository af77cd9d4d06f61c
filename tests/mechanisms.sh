#!/usr/bin/env bash
# Switches off each mechanism of the exact solver (mechanisms.txt), one at a time, and prints which tests fail without it. What none misses
# can go. In double precision, and where none fails there, in single, then the joints' on it, and the scenes'.
#   mechanisms.sh [NAME]...    default: all, some 40 minutes; NAME: those whose names begin with it
#   mechanisms.sh --publish    all, and to the table in plugin/docs/exact-solver.md
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

source tests/setup.sh
pintle_install_packages
publish=
[ "${1-}" != --publish ] || { publish=yes; shift; }

# A copy of the tree, in which lines are changed.
copy=build/mechanisms/tree
mkdir -p "$copy"
for part in plugin adapters demos tests cmake CMakeLists.txt CMakePresets.json; do
  [ ! -e "$part" ] || cp -ru --preserve=timestamps "$part" "$copy"
done
solver=$copy/plugin/pintle/solver
(cd plugin/pintle/solver && find . -type f) | while IFS= read -r file; do  # a run that was broken off has left a line changed
  cmp -s "plugin/pintle/solver/$file" "$solver/$file" || cp "plugin/pintle/solver/$file" "$solver/$file"
done
cmake -S "$copy" -B build/mechanisms/build -DCMAKE_BUILD_TYPE=Release -DPINTLE_BENCHMARKS=OFF -DPINTLE_WARNINGS_AS_ERRORS=OFF >/dev/null

failing() {  # BINARY [ENVIRONMENT]: prints the tests of it that fail, a line each; of a build that fails, or a run that does not end, that alone
  cmake --build build/mechanisms/build --parallel "$(nproc)" --target "$1" >/dev/null 2>&1 || { echo "(does not compile)"; return; }
  for shard in 0 1; do
    { GTEST_TOTAL_SHARDS=2 GTEST_SHARD_INDEX=$shard timeout 300 env ${2-} "build/mechanisms/build/tests/$1" 2>&1 || [ $? != 124 ] ||
      echo "[  FAILED  ] (does not end)"; } >build/mechanisms/log.$shard &
  done
  wait
  sed -n 's/^\[  FAILED  \] \([^ ,]*\|(.*)\).*/\1/p' build/mechanisms/log.? | { grep -v '^[0-9]*$' || true; } | sort -u
}

# name: what it is for / file / lines with - and then +, up to an empty line.
table=build/mechanisms/table.md
{
  echo "| mechanism | tests that fail without it |"
  echo "|---|---|"
} >"$table"
block=()
finish() {
  [ ${#block[@]} -gt 0 ] || return 0
  local name=${block[0]} file=$solver/${block[1]} from= to= line
  for line in "${block[@]:2}"; do
    case "$line" in
    -*) from+=${line:1}$'\n' ;;
    +*) to+=${line:1}$'\n' ;;
    esac
  done
  block=()
  local wanted=$# pattern
  for pattern in "$@"; do [[ $name != "$pattern"* ]] || wanted=0; done
  [ "$wanted" = 0 ] || return 0
  cp -p "$file" build/mechanisms/kept
  FROM=$from TO=$to perl -0pi -e '$n = s/\Q$ENV{FROM}\E/$ENV{TO}/; END { exit !$n }' "$file" || { echo "mechanisms.sh: $name: its line is not in $file" >&2; exit 1; }
  local tests other
  tests=$(failing pintle_tests_solver_double)
  for other in pintle_tests_solver_single "pintle_tests_"{double,single}" PINTLE_TEST_SOLVER=exact" pintle_scene_tests_single; do
    [ -n "$tests" ] || tests=$(failing $other)
  done
  cp build/mechanisms/kept "$file"
  printf '%s\n%s\n\n' "$name" "${tests:-    none}" | sed '2,$s/^\([^ ]\)/    \1/'
  # Three of them are enough to tell.
  printf '| %s | %s |\n' "$name" "$(awk '
    NR <= 3 && $0 != "none" { printf("%s`%s`", (NR > 1 ? ", " : ""), $0) }
    END { if (NR > 3) printf(" and %d more", NR - 3); else if ($0 == "none") print "none" }' <<<"${tests:-none}")" >>"$table"
}
while IFS= read -r line; do
  case "$line" in
  '#'*) ;;
  '') finish "$@" ;;
  *) block+=("$line") ;;
  esac
done <tests/mechanisms.txt
finish "$@"

if [ -n "$publish" ]; then
  source demos/report/report.sh
  report_replace plugin/docs/exact-solver.md mechanisms "$table"
fi

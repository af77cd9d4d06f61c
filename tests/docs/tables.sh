#!/usr/bin/env bash
# Measures what a table of plugin/docs/benchmarks.md says, and fails where the table says something else. Times are not compared.
#   tables.sh scenes PROGRAM    of pintle_demos_single
#   tables.sh cost PROGRAM      of pintle_frames_double
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
table=$1 program=$2
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT

case $table in
scenes)
  publish="demos/run.sh --publish"
  "$program" --once --brief "$folder/measured" >/dev/null
  said='^|' columns=1-
  ;;
cost)
  publish="tests/bench/cost.sh --publish"
  "$program" --repeats 1 ragdolls doors vehicles bridges net | sed -n '/^cost/,$p' >"$folder/measured"
  said='^[a-z]' columns=1-75  # names, the number of joints, and the gaps
  ;;
esac
sed -n "/<!-- $table begin/,/<!-- $table end/p" plugin/docs/benchmarks.md | grep "$said" >"$folder/said"
[ "$(wc -l <"$folder/said")" -gt 5 ]
diff <(cut -c $columns "$folder/said") <(cut -c $columns "$folder/measured") ||
  { echo "benchmarks.md has other numbers: bash $publish"; exit 1; }

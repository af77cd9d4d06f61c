#!/usr/bin/env bash
# Builds the demos and runs them, in double precision unless another one is asked for.
#   run.sh                                  tables beside the stock joints', and the page that plays the scenes
#   run.sh [options]                        tables alone: --list, --scene, --contender, --csv, --json (--help says more).
#                                           Any scene of the catalog has one, if it is asked for
#   run.sh single|both [options]            tables in single precision, or in single and then in double
#   run.sh --publish                        the tables, of which plugin/docs/benchmarks.md gets a few numbers
#   run.sh page [options]                   the page alone: --list, --scene, --contender, --json
#   run.sh report [options]                 error against run time: tables and plots (--help says more)
#   run.sh extreme [options]                what becomes of joints under extreme conditions (--help says more)
#   run.sh extreme --publish                all of them, to demos/results/extreme.md
#   run.sh drawings                         draws the joints anew, to plugin/docs/drawings
#   run.sh reference [--scene NAME]...      solves the stored reference solutions again
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

source tests/setup.sh
source demos/page/page.sh

build() {  # targets
  cmake --preset release >&2
  cmake --build --preset release --parallel "$(nproc)" --target "$@" >&2
}

case "${1-}" in
page)
  shift
  pintle_install_packages
  make_page "$@"
  ;;
report)
  shift
  source demos/report/report.sh
  report "$@"
  ;;
reference)
  shift
  pintle_install_packages
  build pintle_reference
  build/release/demos/pintle_reference "$@"
  ;;
drawings)
  pintle_install_packages
  build pintle_draw
  build/release/demos/pintle_draw plugin/docs/drawings
  ;;
extreme)
  shift
  pintle_install_packages
  build pintle_extreme_single pintle_extreme_double
  if [ "${1-}" = --publish ]; then
    {
      echo "# Extreme conditions"
      printf '\nBy `bash demos/run.sh extreme --publish`. '
      echo "Each joint's class of outcome, and the largest error in the last half of the run (of the size, or rad)."
      for precision in single double; do echo && build/release/demos/pintle_extreme_$precision --all; done
    } >build/extreme.md
    mv build/extreme.md demos/results/extreme.md
    exit
  fi
  for precision in single double; do build/release/demos/pintle_extreme_$precision "$@"; done
  ;;
--publish)
  pintle_install_packages
  build pintle_demos_single
  table=$(mktemp)
  build/release/demos/pintle_demos_single --brief "$table"
  source demos/report/report.sh
  report_replace plugin/docs/benchmarks.md scenes "$table"
  rm "$table"
  ;;
*)
  precisions=(double)
  case "${1-}" in
  single) precisions=(single) ;;
  both) precisions=(single double) ;;
  esac
  [ "${1-}" != single ] && [ "${1-}" != both ] || shift
  pintle_install_packages
  targets=("${precisions[@]/#/pintle_demos_}")
  if [ $# -eq 0 ]; then  # with the page: all at once, so that no core waits
    pintle_install_page_packages
    targets+=(pintle_page pintle_gallery_double)
  fi
  build "${targets[@]}"
  for precision in "${precisions[@]}"; do
    results=build/release/demos/results_$precision
    build/release/demos/pintle_demos_$precision --csv $results.csv --json $results.json "$@"
  done
  [ $# -gt 0 ] || make_page
  ;;
esac

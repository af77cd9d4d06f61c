#!/usr/bin/env bash
# Prints after how long the page of all scenes is shown, and how many frames a second it draws of 500 bodies in each of four panes, in
# software rendering: on a machine that does nothing else. Build the page first (bash demos/run.sh).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome) || { echo "measure.sh: needs chromium" >&2; exit 1; }
[ -f build/pintle.html ] || { echo "measure.sh: needs build/pintle.html (bash demos/run.sh)" >&2; exit 1; }
page=build/release/page
cmake --preset release >/dev/null
cmake --build --preset release --parallel "$(nproc)" --target pintle_record_double >/dev/null
build/release/tests/bench/pintle_record_double page "$page/many.html" "$page/pintle_page.html"
PINTLE_BROWSER=$browser PINTLE_PLAYWRIGHT=$PWD/$page/work/node_modules/playwright-core/index.mjs \
  node tests/page/measure.mjs "$PWD/build/pintle.html" "$PWD/$page/many.html"

#!/usr/bin/env bash
# Opens the page in a headless Chromium, with all scenes of the gallery. Its pictures are kept beside the page.
#   run.sh BUILD_DIR GALLERY SHAPES    the gallery's program, and that of other shapes; ends with 77 where there is no browser or no page
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
build=$1 gallery=$2 shapes=$3
form=$build/page/pintle_page.html

skip() {
  echo "Skipped: $1"
  exit 77
}
browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome) || skip "there is no chromium"
command -v node >/dev/null || skip "there is no node"
[ -f "$form" ] || skip "the page was not built (demos/page/build.sh says why)"

mkdir -p "$build/page/pictures"
"$gallery" "$build/page/gallery.html" --template "$form"
"$shapes" "$build/page/shapes.html" "$form"
PINTLE_BROWSER=$browser PINTLE_PAGE=$build/page/gallery.html PINTLE_SHAPES=$build/page/shapes.html PINTLE_PICTURES=$build/page/pictures \
  PINTLE_PLAYWRIGHT=$build/page/work/node_modules/playwright-core/index.mjs node --test "$here/page.test.mjs"

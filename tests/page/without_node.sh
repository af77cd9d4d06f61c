#!/usr/bin/env bash
# Where there is no Node and no npm, the page and Jolt are left out, with a word, and nothing else is.
#   without_node.sh [options of CMake]
set -euo pipefail
source_dir=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

check() {  # what, command...
  local what=$1
  shift
  "$@" || { echo "Not so: $what" && exit 1; }
}
has() { grep -qF "$2" "$1" || { cat "$1" && false; }; }  # file, text
is_absent() { [ ! -e "$1" ]; }

# A PATH that has all but them.
mkdir all_else
IFS=: read -ra folders <<<"$PATH"
for ((i = ${#folders[@]} - 1; i >= 0; --i)); do  # the first one is to win
  [ ! -r "${folders[i]}" ] || find "${folders[i]}/" -maxdepth 1 ! -type d -exec ln -sf -t all_else {} +
done
rm -f all_else/{node,nodejs,npm,npx}
ignored=$(IFS=';' && echo "${folders[*]}")
export PATH=$work/all_else
for tool in node nodejs npm; do check "$tool is hidden" [ -z "$(command -v "$tool" || true)" ]; done

# The page's bundling goes on, or fails if it is asked to, and leaves nothing that is old.
mkdir page
touch page/page.html
check "bundling goes on" bash "$source_dir/demos/page/build.sh" "$work/page/page.html" --or-without 2>bundling.txt
check "bundling says so" has bundling.txt "The page is left out"
check "no old page stays" is_absent page/page.html
! bash "$source_dir/demos/page/build.sh" "$work/page/page.html" 2>/dev/null || check "bundling fails alone" false

# So does Jolt's package.
mkdir -p jolt/node_modules
check "the report goes on" bash "$source_dir/demos/engines/jolt/install.sh" "$work/jolt" 2>jolt.txt
check "the report says so" has jolt.txt "Jolt is left out"
check "no old package stays" is_absent jolt

# CMake looks elsewhere than in PATH, too.
cmake -S "$source_dir" -B build -DCMAKE_BUILD_TYPE=Release "-DCMAKE_IGNORE_PATH=$ignored" "$@" >configuring.txt 2>&1 ||
  { cat configuring.txt && exit 1; }
cmake --build build --target pintle_page >building.txt 2>&1 || { cat building.txt && exit 1; }
check "the page's target says so" has building.txt "The page is left out: there is no node and npm"
cmake --build build --target help >targets.txt
for target in pintle_gallery_double pintle_demos_double pintle_report_double; do
  check "$target is there" has targets.txt "$target"
done

# The demos' last words, of a gallery that is none.
source "$source_dir/demos/page/page.sh"
build() { echo "built: $*"; }
pintle_install_page_packages() { :; }
mkdir -p build/release/{demos,page}
printf '#!/bin/sh\n[ "$4" = --list ] && exit; echo scenes >"$1"; echo recorded\n' >build/release/demos/pintle_gallery_double
chmod +x build/release/demos/pintle_gallery_double
touch build/pintle.html
make_page >words.txt
check "no page is made without its form" is_absent build/pintle.html
check "the demos say so" [ "$(tail -n 1 words.txt)" = "No page was made: it needs Node and npm (Debian: nodejs, npm). All else has run." ]
touch build/release/page/pintle_page.html
make_page >words.txt
check "the page is made" has build/pintle.html scenes
check "the last line names the page" [ "$(tail -n 1 words.txt)" = "build/pintle.html plays the scenes side by side: open it in a browser." ]
make_page --list >words.txt
check "who only lists has no page" is_absent build/pintle.html
check "and nobody says that there is one" [ "$(tail -n 1 words.txt)" = "built: pintle_page pintle_gallery_double" ]
echo "Without Node the page is left out, and nothing else"

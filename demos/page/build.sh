#!/usr/bin/env bash
# Bundles the page into one file. Packages are installed beside it, as the lock file says; no source is touched.
#   build.sh OUTPUT.html [--or-without]    --or-without: where that fails, say so and go on
set -uo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
output=$1
work=$(dirname "$output")/work
source "$here/../npm.sh"

mkdir -p "$work" && rm -rf "$work/src" && cp -r "$here/src" "$here/build.mjs" "$here/tsconfig.json" "$work/" &&
  pintle_npm_ci "$here" "$work" && cd "$work" && node node_modules/typescript/bin/tsc --noEmit && node build.mjs "$output" && exit

rm -f "$output"
echo "The page is left out: it could not be bundled." >&2
[ "${2-}" = --or-without ]

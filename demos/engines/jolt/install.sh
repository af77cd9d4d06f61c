#!/usr/bin/env bash
# Installs npm's package of Jolt; where there is none to be had, says so, and goes on.
#   install.sh FOLDER
set -uo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
source "$here/../../npm.sh"

# An old Node may install it and not run it. (jolt.mjs ends where nobody asks.)
runs() { cp "$here"/*.mjs "$1/" && (cd "$1" && node --no-liftoff jolt.mjs 3</dev/null >/dev/null 2>&1); }
{ command -v node && command -v npm; } >/dev/null && pintle_npm_ci "$here" "$1" && runs "$1" && exit

rm -rf "$1"
echo "Jolt is left out: its npm package could not be installed, or does not run (it needs npm and a recent Node)" >&2

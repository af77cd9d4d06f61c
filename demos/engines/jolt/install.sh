#!/usr/bin/env bash
# Installs npm's package of Jolt; where there is none to be had, says so, and goes on.
#   install.sh FOLDER
set -uo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
source "$here/../../npm.sh"

{ command -v node && command -v npm; } >/dev/null && pintle_npm_ci "$here" "$1" && exit

rm -rf "$1"
echo "Jolt is left out: its npm package could not be installed (it needs Node and npm)" >&2

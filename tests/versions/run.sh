#!/usr/bin/env bash
# Builds the joints with other versions of Bullet, in single precision, and runs their tests.
# Usage: run.sh --bullet DIR [VERSION...]     DIR has bullet-VERSION.tar.xz; default: all that it has
# Everything it makes is in build/versions.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

bullet=
if [ "${1-}" = --bullet ]; then
  bullet=${2:?--bullet: the folder is missing}
  shift 2
fi
if [ -z "$bullet" ]; then
  echo "Versions of Bullet: skipped (--bullet DIR with bullet-VERSION.tar.xz runs them)"
  exit 0
fi
versions=("$@")
if [ ${#versions[@]} -eq 0 ]; then
  mapfile -t versions < <(cd "$bullet" && ls bullet-*.tar.xz | sed 's/^bullet-//; s/\.tar\.xz$//' | sort -V)
fi

source tests/setup.sh
pintle_install_packages
failed=()
for version in "${versions[@]}"; do
  build=build/versions/$version
  mkdir -p "$build"
  [ -d "$build/bullet-$version" ] || tar -xf "$bullet/bullet-$version.tar.xz" -C "$build"
  cmake -S tests/versions -B "$build/build" -DPINTLE_BULLET="$PWD/$build/bullet-$version" -Wno-dev >"$build/log" 2>&1 &&
    cmake --build "$build/build" --parallel "$(nproc)" --target pintle_tests_single >>"$build/log" 2>&1 ||
    { tail -n 40 "$build/log"; failed+=("$version"); continue; }
  grep "^-- Pintle: " "$build/log" || true
  if result=$("$build/build/pintle/tests/pintle_tests_single" --gtest_brief=1 2>&1); then
    echo "Bullet $version: $(grep PASSED <<<"$result")"
  else
    grep "FAILED" <<<"$result" || true
    failed+=("$version")
  fi
done
[ ${#failed[@]} -eq 0 ] || { echo "Failed: ${failed[*]}" >&2; exit 1; }

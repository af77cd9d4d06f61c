# Sourced by the scripts that build Bullet's examples. Takes their options: --bullet DIR [--build BUILD]. Ends the script with 0 where there are no
# archives to build. Sets version, bullet and library_build, and has a function that builds the library.
bullet= library_build=build/release
script=$(basename "$0")
while [ $# -gt 0 ]; do
  case $1 in
    --bullet) bullet=${2:?--bullet: the folder is missing}; shift 2 ;;
    --build) library_build=${2:?--build: the folder is missing}; shift 2 ;;
    *) echo "$script: unknown option $1" >&2; exit 2 ;;
  esac
done
version=3.25
if [ -z "$bullet" ]; then
  echo "Bullet's examples: skipped (--bullet DIR with bullet-$version.tar.xz and examples-$version.tar.xz runs them)"
  exit 0
fi
for archive in "bullet-$version.tar.xz" "examples-$version.tar.xz"; do
  [ -f "$bullet/$archive" ] || { echo "$script: no $archive in $bullet" >&2; exit 2; }
done

build_library() {  # log, jobs
  [ -f "$library_build/CMakeCache.txt" ] || cmake -S . -B "$library_build" -DCMAKE_BUILD_TYPE=Release >"$1"
  cmake --build "$library_build" --parallel "$2" --target pintle_single >>"$1" || { tail -n 40 "$1"; exit 1; }
}

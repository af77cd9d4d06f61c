#!/usr/bin/env bash
# Prints what a file costs that includes Bullet's headers and one of Pintle's: seconds of the compiler and its largest
# memory, beside those of Bullet's headers alone. Each time is the least of several; they take turns.
#   compile.sh [HEADER...]   default: all public ones, such as pintle/joints/ball_joint.h
#   CXX, CXXFLAGS (-std=c++17 -O2), BULLET (/usr/include/bullet), EIGEN (/usr/include/eigen3: extend.h alone), RUNS (5)
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
cxx=${CXX:-c++} flags=${CXXFLAGS:--std=c++17 -O2} runs=${RUNS:-5}
bullet=${BULLET:-/usr/include/bullet} eigen=${EIGEN:-/usr/include/eigen3}
[ -x /usr/bin/time ] || { echo "compile.sh: needs GNU time (Debian: time)" >&2; exit 1; }
[ -f "$bullet/btBulletDynamicsCommon.h" ] || { echo "compile.sh: no Bullet in $bullet (BULLET)" >&2; exit 1; }

if [ $# -eq 0 ]; then
  cd "$root/plugin"
  # Those of the joints' .cpp files are no public headers.
  for header in pintle/*.h pintle/joints/*.h pintle/joints/unstable/*.h \
    pintle/solver/{exact{,_multi_body}_joint_solver,joint_solver,solver_options,step_log,step_report,uses_exact_solver}.h; do
    case $header in */drawing.h | */hinge_rows.h | */solver_rows.h | */single_row.h | */turning.h) continue ;; esac
    set -- "$@" "$header"
  done
fi

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
declare -A seconds memory
measure() {  # name header...
  local name=$1 include=(-I "$bullet" -I "$root/adapters" -I "$root/plugin") user kilobytes
  shift
  [ "$name" != pintle/extend.h ] || include+=(-isystem "$eigen")
  printf '#include <%s>\n' "$@" >"$work/file.cpp"
  # shellcheck disable=SC2086
  /usr/bin/time -f '%U %M' -o "$work/cost" "$cxx" $flags "${include[@]}" -c "$work/file.cpp" -o "$work/file.o"
  read -r user kilobytes <"$work/cost"
  seconds[$name]=$(awk -v a="$user" -v b="${seconds[$name]:-1e9}" 'BEGIN { print a < b ? a : b }')
  memory[$name]=$kilobytes
}
for ((run = 0; run < runs; ++run)); do
  measure bullet btBulletDynamicsCommon.h
  for header in "$@"; do measure "$header" btBulletDynamicsCommon.h "$header"; done
done
printf '%-52s %7s %6s %7s %6s\n' 'btBulletDynamicsCommon.h and' s ratio MB ratio
for name in bullet "$@"; do
  awk -v name="${name/#bullet/nothing else}" -v s="${seconds[$name]}" -v bullet_s="${seconds[bullet]}" \
    -v kb="${memory[$name]}" -v bullet_kb="${memory[bullet]}" \
    'BEGIN { printf "%-52s %7.2f %6.2f %7.0f %6.2f\n", name, s, s / bullet_s, kb / 1024, kb / bullet_kb }'
done

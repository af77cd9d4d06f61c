# Sourced by demos/run.sh: error against run time of all contenders, in tables and plots.

report_help() {
  cat <<'END'
bash demos/run.sh report [options]
  --quick                 few iterations and steps: at most 2 minutes (the whole: at most 30)
  --scene NAME            only this scene; may be given more than once
  --from NAME --to NAME   a range of scenes
  --contender NAME        only this contender; may be given more than once
  --peers                 also Jolt, by npm's package, if there are node and npm, and ODE and MuJoCo, if their Debian
                          packages are installed
  --fresh                 forget what an earlier run has measured
  --json FILE             also write all that was measured as an array of objects
  --publish               copy the plots and tables that the pages show to demos/results, the README and plugin/docs
The run can be interrupted: what was measured is kept, and the same command goes on with it.
Everything goes to build/release/demos/report (report_quick).
END
}

# Instructions of a step, of every scene and contender, by callgrind: the steps alone are counted.
report_instructions() {  # program, file
  command -v valgrind >/dev/null || return 0
  local program=$1 file=$2 scene contender count steps=20
  local scenes contenders
  scenes=$("$program" --list | sed -n 's/^scene //p')
  contenders=$("$program" --list | sed -n 's/^contender \([^ ]*\).*/\1/p')
  touch "$file"
  for scene in $scenes; do
    for contender in $contenders; do
      grep -q "^$scene $contender " "$file" && continue
      # Dantzig's method is too slow to be counted on the bridge.
      [ "$scene $contender" = "bridge dantzig" ] && continue
      count=$(valgrind --tool=callgrind --callgrind-out-file=/dev/null --toggle-collect='*Engine::step*' \
        "$program" steps "$scene" "$contender" 10 60 $steps 2>&1 | sed -n 's/.*Collected : *//p') || true
      [ -n "$count" ] && [ "$count" != 0 ] && echo "$scene $contender $((count / steps))" >>"$file"
      printf '\rinstructions: %s, %s          ' "$scene" "$contender" >&2
    done
  done
  printf '\n' >&2
}

report_plots() {  # folder, program
  local folder=$1 program=$2 scene title errors units contenders precisions who colours terminal
  declare -A colour
  while read -r who colours; do colour[$who]=$colours; done < <("$program" --list | sed -n 's/^contender //p')
  while IFS='|' read -r scene title errors units contenders precisions; do
    colours=
    for who in $contenders; do colours+="${colour[$who]} "; done
    title=${title//\'/\'\'}  # as gnuplot quotes it
    local width=$((360 * $(wc -w <<<"$errors") + 20)) height=$((330 * $(wc -w <<<"$precisions") + 50))
    for terminal in "svg dynamic" pngcairo; do
      gnuplot -e "scene='$scene'; title='${scene//_/ }: $title'; errors='$errors'; units='$units'" \
        -e "contenders='$contenders'; colours='$colours'; precisions='$precisions'; folder='$folder/data/$scene'" \
        -e "output='$folder/$scene.$([ "$terminal" = pngcairo ] && echo png || echo svg)'" \
        -e "terminal=\"$terminal size $width,$height font 'Helvetica,10' background '#ffffff'\"" demos/report/plot.gp
    done
  done <"$folder/plots.txt" 2> >(grep -v -e 'Skipping data file' -e 'empty y range' -e '^$' >&2)
}

# What stands between two marks of a page, replaced by a file.
report_replace() {  # page, mark, file
  sed -i -e "/<!-- $2 begin/,/<!-- $2 end/{/<!-- $2 end/!{/<!-- $2 begin/!d}}" -e "/<!-- $2 begin/r $3" "$1"
}

# The README's five figures, from the summary: each contender's mean error against stock's, which is the column of ones. Of the
# double program, which alone has the other engines.
report_figures() {  # summary
  awk -F ' *[|] *' '
    BEGIN {
      scenes = split("chain crane ragdoll cone_shoulder drive_shaft", scene, " ")
      contenders = split("pintle exact dantzig multibody jolt mujoco ode", contender, " ")
      print "| scene | error | stock: Bullet\047s joints | Pintle\047s joints | on `ExactJointSolver` | Bullet\047s on `btMLCPSolver` | `btMultiBody` | Jolt | MuJoCo | ODE |"
      print "|---|---|---|---|---|---|---|---|---|---|"
    }
    /^## / { who = $0; if (!sub(/ against stock$/, "", who)) who = ""; sub(/^## /, "", who) }
    who != "" && $4 == "double" && $3 ~ /^[*]/ {
      split($5, ratio, " ")
      mean[$2, who] = ratio[1]
      error[$2] = $3
      gsub(/[*]/, "", error[$2])
    }
    END {
      for (i = 1; i <= scenes; ++i) {
        line = "| " scene[i] " | " error[scene[i]] " | 1 |"
        for (k = 1; k <= contenders; ++k) line = line ((scene[i], contender[k]) in mean ? " " mean[scene[i], contender[k]] " |" : " |")
        print line
      }
    }' "$1"
}

# What the pages show: three plots, the summary, the table of the benchmarks and the figures of the README.
report_publish() {  # folder
  local folder=$1 scene
  mkdir -p demos/results
  for scene in chain slider_crank ragdoll; do cp "$folder/$scene.png" demos/results/; done
  cp "$folder/summary.md" demos/results/
  report_figures demos/results/summary.md >"$folder/figures.md"
  report_replace README.md figures "$folder/figures.md"
  report_replace plugin/docs/benchmarks.md report "$folder/brief.md"
  report_replace plugin/docs/benchmarks.md published "$folder/published.md"
  report_replace plugin/docs/benchmarks.md machines "$folder/machines.md"
}

report() {
  local folder=build/release/demos/report options=() json=() publish= fresh= quick= peers=OFF
  while [ $# -gt 0 ]; do
    case "$1" in
    --help) report_help; return ;;
    --quick) folder+=_quick quick=1; options+=(--quick) ;;
    --publish) publish=1 ;;
    --json) json=(--json "${2?--json: needs a file}") && shift ;;
    --fresh) fresh=1 ;;
    --peers) peers=ON ;;
    *) options+=("$1") ;;
    esac
    shift
  done

  pintle_install_packages gnuplot-nox
  [ $peers = OFF ] || bash demos/engines/jolt/install.sh build/release/jolt
  cmake --preset release -DPINTLE_PEERS=$peers
  cmake --build --preset release --parallel "$(nproc)" --target pintle_report_single pintle_report_double pintle_summary
  local programs=build/release/demos/pintle_report precision
  mkdir -p "$folder"
  # What another build has measured is no part of this report.
  local built
  built=$(cat ${programs}_single ${programs}_double $([ $peers = OFF ] || echo demos/engines/jolt/*.{mjs,json}) | cksum)
  if [ -n "$fresh" ] || [ "$built" != "$(cat "$folder/built" 2>/dev/null)" ]; then
    rm -rf "$folder"
    mkdir -p "$folder"
    echo "$built" >"$folder/built"
  fi

  for precision in single double; do
    ${programs}_$precision --csv "$folder/$precision.csv" ${options[@]+"${options[@]}"}
  done
  [ -n "$quick" ] || report_instructions ${programs}_single "$folder/instructions.txt"
  build/release/demos/pintle_summary "$folder" "$folder/instructions.txt" "$folder"/{single,double}.csv ${json[@]+"${json[@]}"}
  report_plots "$folder" ${programs}_double  # which knows the peers
  [ -z "$publish" ] || report_publish "$folder"
  cat "$folder/brief.md"
  echo "All tables and plots: $folder"
}

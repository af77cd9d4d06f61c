# Error against run time of one scene: a row a precision, a panel an error; every run a point, each
# contender's Pareto front a line. Called with
#   title, errors, units, contenders, colours, precisions, folder, output, terminal
set terminal @terminal
set output output
n = words(errors)
rows = words(precisions)
set multiplot layout rows, n title title font ",14" margins char 11, char 3, char 7.5, char 4 spacing char 11, char 6
set logscale xy
set format y "10^{%T}"
set format x "10^{%T}"
set grid xtics ytics linetype 1 linecolor rgb "#d0d0d0" linewidth 0.6
set border linecolor rgb "#606060"
set tics nomirror textcolor rgb "#000000"
set key off
# A key of its own: no panel has all contenders.
do for [c = 1:words(contenders)] {
  set label c word(contenders, c) at screen (c - 0.5) / words(contenders), char 1.5 center \
    font ",12" textcolor rgb word(colours, c) point pointtype 7 pointsize 1 \
    linecolor rgb word(colours, c) offset 0, char 1
}
do for [p = 1:rows] {
  do for [e = 1:n] {
    precision = word(precisions, p)
    set xlabel "run time / (ms per second of the scene)"
    set ylabel word(errors, e) . " / " . word(units, e)
    set title precision . " precision"
    file(who) = sprintf("%s/%s_%s_%s.dat", folder, precision, word(errors, e), who)
    plot for [c = 1:words(contenders)] file(word(contenders, c)) index 0 using 1:2 with points \
           pointtype 7 pointsize 0.6 linecolor rgb "#a0" . word(colours, c)[2:*] notitle, \
         for [c = 1:words(contenders)] file(word(contenders, c)) index 1 using 1:2 with linespoints \
           pointtype 7 pointsize 0.7 linewidth 2.5 linecolor rgb word(colours, c) notitle
    unset label
  }
}
unset multiplot

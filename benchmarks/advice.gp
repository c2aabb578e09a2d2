# gnuplot -e "csv='advice.csv'; out='advice.png'" advice.gp: what one would choose by hand, and what is advised
set terminal pngcairo size 1500,860 font "sans,11" noenhanced
set datafile separator ","
set output out
set multiplot layout 2,3 title "Settings chosen by hand and by advice: error of the whole run and its cost" font "sans:Bold,13"
set grid lc rgb "#dddddd" lt 1
set logscale xy
set format x "%.0e"
set format y "%g"
set xrange [1e-4:2]
set yrange [0.01:30]
set xlabel "error [-]"
set ylabel "processor time over the default's [-]"
set key off
row(scene, what, tolerance, column) = real(system(sprintf("awk -F, '$1 == \"%s\" && $2 == \"%s\"' '%s' | sed -n %dp | cut -d, -f%d", scene, what, csv, tolerance, column)))
do for [scene in "rotor gust wing plate body"] {
  set title scene
  unset arrow
  do for [k=1:2] {
    x = row(scene, "advice", k, 3)
    set arrow k from x, graph 0 to x, graph 1 nohead lw 2 dt 2 lc rgb (k == 1 ? "#d1495b" : "#1b6ca8")
  }
  plot csv using (strcol(1) eq scene && strcol(2) eq "hand" ? $4 : NaN):5 with points pt 7 ps 0.7 lc rgb "#b0b0b0", \
       csv using (strcol(1) eq scene && strcol(2) eq "default" ? $4 : NaN):5 with points pt 3 ps 2 lw 2 lc rgb "#000000", \
       csv using (strcol(1) eq scene && strcol(2) eq "best" ? $4 : NaN):5 with points pt 6 ps 2 lw 2 lc rgb "#3a8f4e", \
       for [k=1:2] csv using (strcol(1) eq scene && strcol(2) eq "advice" && $3 == row(scene, "advice", k, 3) ? $4 : NaN):5 \
         with points pt 5 ps 1.8 lc rgb (k == 1 ? "#d1495b" : "#1b6ca8")
}
unset arrow
unset border
unset tics
unset grid
unset xlabel
unset ylabel
unset logscale
set title ""
set xrange [0:1]
set yrange [0:1]
set key at graph 0.05, 0.9 left Left reverse spacing 1.6 font ",12"
plot NaN with points pt 7 ps 1 lc rgb "#b0b0b0" title "120 settings by hand", \
     NaN with points pt 3 ps 2 lw 2 lc rgb "#000000" title "default", \
     NaN with points pt 6 ps 2 lw 2 lc rgb "#3a8f4e" title "cheapest by hand within a tolerance", \
     NaN with points pt 5 ps 1.8 lc rgb "#d1495b" title "advised for the larger tolerance", \
     NaN with points pt 5 ps 1.8 lc rgb "#1b6ca8" title "advised for the smaller one", \
     NaN with lines lw 2 dt 2 lc rgb "#666666" title "the tolerances"
unset multiplot

# gnuplot -e "csv='peers.csv'; out='peers.png'" peers.gp: what each code takes to an error
set terminal pngcairo size 1500,520 font "sans,11" noenhanced
set datafile separator ","
set output out
set multiplot layout 1,3 title "Processor time of a run over the error of its tip, at every dt and tolerance; the line: each code at its best" font "sans:Bold,13"
set grid lc rgb "#dddddd" lt 1
set logscale xy
set format x "%.0e"
set format y "%g"
set xlabel "error of the tip [m]"
set ylabel "milliseconds"
set key bottom left Left reverse samplen 2 width 1 opaque box lc rgb "#cccccc"
array code[3] = ["spar", "Kynema-FMB", "BeamDyn"]
array colour[3] = ["#1b6ca8", "#d1495b", "#3a8f4e"]
what(scene) = scene eq "push8" ? "box beam, 8 nodes, pushed smoothly" : scene eq "nrel10" ? "turning NREL 5-MW blade, 10 nodes, 96 points" : "three blades set turning, 11 nodes, 50 points each"
do for [scene in "push8 nrel10 rotor11"] {
  set title what(scene)
  codes = scene eq "nrel10" ? 3 : 2 # BeamDyn's driver cannot play the others
  plot for [k=1:codes] csv using (strcol(1) eq scene && strcol(2) eq code[k] ? $8 : NaN):9 with points pt 7 ps 0.6 lc rgb colour[k] notitle, \
       for [k=1:codes] sprintf("< grep '^%s,%s,' '%s' | sort -t, -g -k9 | awk -F, '!e || $8 < 0.95 * e {e = $8; print}'", \
         scene, code[k], csv) using 8:9 with lines lw 2 lc rgb colour[k] title code[k]
}
unset multiplot

# gnuplot -e "csv='<prefix of the CSV files>'; out='<prefix of the pictures>'; scene='<name>'; own=<error of the
# reference>; cost=<column: 5 time, 7 instructions>; lean='<what the lean settings are>'; load='<whose error>'" accuracy.gp
# Names the front and the default; all other settings are grey dots, whose values the CSV has.
set terminal pngcairo size 1500,640 font "sans,12" noenhanced
set datafile separator ","
all = csv.scene.".csv"
front = csv."pareto-".scene.".csv"
grey = "#b9c0c8"
ink = "#1b6ca8"
red = "#c8102e"
failed = int(system(sprintf("awk -F, '$9 == \"fails\"' '%s' | wc -l", all)))
ran(c) = (strcol(2) ne "reference" && strlen(strcol(4)) ? column(c) : NaN)
standard(c) = (strcol(2) eq "default" ? column(c) : NaN)

# the front, and what the picture means, in a table beside the plots
set key off
set label 1 "front" at screen 0.685,0.90 font "sans:Bold,12"
set label 2 "motion" at screen 0.735,0.90 font "sans,11"
set label 3 "loads" at screen 0.78,0.90 font "sans,11"
set label 4 (cost == 7 ? "instr." : "time") at screen 0.822,0.90 font "sans,11"
set label 5 "setting" at screen 0.86,0.90 font "sans,11"
stats front using 1 nooutput
rows = int(STATS_records)
field(i, k) = system(sprintf("sed -n %dp '%s' | cut -d, -f%d", i, front, k))
do for [i=1:rows] {
  y = 0.90 - 0.042 * i
  set label 10 * i sprintf("%d", i) at screen 0.697, y font "sans:Bold,11" tc rgb ink
  set label 10 * i + 1 sprintf("%.1e", real(field(i, 2))) at screen 0.735, y font "sans,11"
  set label 10 * i + 2 sprintf("%.1e", real(field(i, 6))) at screen 0.78, y font "sans,11"
  set label 10 * i + 3 sprintf("%.2f", real(field(i, 3))) at screen 0.822, y font "sans,11"
  set label 10 * i + 4 field(i, 4) at screen 0.86, y font "sans,11"
}
y = 0.90 - 0.042 * (rows + 1.6)
set label 900 "default" at screen 0.70, y point pt 3 ps 1.6 lw 2 lc rgb red offset 1.2,0 tc rgb red
set label 901 "other settings, one changed at a time" at screen 0.70, y - 0.042 point pt 7 ps 0.8 lc rgb grey offset 1.2,0
set label 902 sprintf("settings that fail: %d", failed) at screen 0.712, y - 0.084 font "sans,11" tc rgb "#555555"
set label 903 "lean: Newton 1e-6," at screen 0.685, y - 0.147 font "sans,11"
set label 904 lean at screen 0.685, y - 0.182 font "sans,11"
set label 905 "/modal: in 8 modes; 3 x 6: elements x nodes" at screen 0.685, y - 0.217 font "sans,11"
set label 906 "bar: least to largest error of three similar scenes" at screen 0.685, y - 0.252 font "sans,11"

set grid lc rgb "#eceff2" lt 1
set border 3 lc rgb "#555555"
set tics nomirror
set logscale xy
set format x "10^{%L}"
set yrange [0.1:10]
set tmargin at screen 0.90
set bmargin at screen 0.12
set output out.scene.".png"
set multiplot

set lmargin at screen 0.055
set rmargin at screen 0.40
set format y "%g"
set xlabel "error of the motion, relative to the deformation"
set ylabel "cost: ".(cost == 7 ? "instructions" : "processor time")." over the default's"
set xrange [own / 1.6:2]
set xtics ("1e-6" 1e-6, "1e-5" 1e-5, "1e-4" 1e-4, "0.1 %%" 1e-3, "1 %%" 1e-2, "10 %%" 0.1, "1" 1)
set title scene.": motion" font "sans:Bold,13"
set arrow 1 from own, graph 0 to own, graph 1 nohead lc rgb "#999999" dt 2
set label 100 "error of the reference" at own, graph 0.03 rotate by 90 offset 0.8,0 font "sans,10" tc rgb "#777777"
plot all using (ran(12)):cost with points pt 7 ps 0.8 lc rgb grey, \
     front using 2:3:5:2 with xerrorbars pt -1 lw 1.2 lc rgb ink, \
     front using 2:3 with linespoints pt 7 ps 1.3 lw 2.5 lc rgb ink, \
     front using 2:3:1 with labels font "sans:Bold,12" tc rgb ink offset -0.9,-0.8, \
     all using (standard(12)):cost with points pt 3 ps 2.2 lw 2.5 lc rgb red, \
     all using (standard(12)):cost:("default") with labels right font "sans,12" tc rgb red offset -1.4,0.6

set lmargin at screen 0.43
set rmargin at screen 0.665
set format y ""
unset ylabel
unset label
unset arrow
set xlabel "error of the ".load
set title "the same settings: loads" font "sans:Bold,13"
plot all using (ran(10)):cost with points pt 7 ps 0.8 lc rgb grey, \
     front using 6:3 with linespoints pt 7 ps 1.3 lw 2.5 lc rgb ink, \
     front using 6:3:1 with labels font "sans:Bold,12" tc rgb ink offset -0.9,-0.8, \
     all using (standard(10)):cost with points pt 3 ps 2.2 lw 2.5 lc rgb red
unset multiplot

# gnuplot -e "csv='<prefix of the CSV files>'; out='<prefix of the pictures>'; scene='<name>'; own=<error of the
# reference>; cost=<column: 5 time, 7 instructions>; lean='<what the lean settings are>'; load='<whose error>'" accuracy.gp
set terminal pngcairo size 1760,820 font "sans,11" noenhanced
set datafile separator ","
knobs = "dt nodes elements quadrature rho substeps newton predictor theta start consistent projection acceleration f32 coupling effects fidelity together"
array colour[19] = ["#1b6ca8", "#d1495b", "#e08e45", "#3a8f4e", "#8a5fbf", "#6b6b6b", "#00a3a3", "#b8860b", "#c71585", \
                    "#1f9e9e", "#556b2f", "#87ceeb", "#ff7f50", "#2f4f9f", "#a0522d", "#20a020", "#9acd32", "#000000", "#7a4988"]
array mark[19] = [7, 5, 9, 11, 13, 7, 5, 9, 11, 13, 7, 5, 9, 11, 13, 7, 5, 9, 13]
names(i) = i <= words(knobs) ? word(knobs, i) : "added mass"
all = csv.scene.".csv"
front = csv."pareto-".scene.".csv"
best = csv."best-".scene.".csv"
fails = sprintf("< awk -F, '$9 == \"fails\" { print n++ \",\" $2 \",\" $3 }' '%s'", all)
edge = 3.0 # where errors end and failures stand

# the key, in three columns beside the plots; knobs that the scene has not are left out
set key off
rows = 0
do for [i=1:19] {
  if (system(sprintf("grep -c '^%s,%s,' '%s' || true", scene, names(i), all)) > 0) {
    x = 0.735 + 0.08 * (rows % 3)
    y = 0.95 - 0.025 * (rows / 3)
    set label 200 + i names(i) at screen x, y point pt mark[i] ps 1.1 lc rgb colour[i] offset 1,0 font ",10"
    rows = rows + 1
  }
}
set label 300 "default" at screen 0.735, 0.765 point pt 3 ps 2 lw 2 lc rgb "#d00000" offset 1,0 font ",10"
set label 301 "on the Pareto front; bar: least to largest error" at screen 0.795, 0.765 point pt 6 ps 1.8 lw 1.5 lc rgb "#000000" offset 1,0 font ",10"
set label 302 "of three scenes that are a little other" at screen 0.795, 0.743 offset 1,0 font ",10"

stats all using (strcol(2) eq "default" ? column(12) : NaN) name "D" nooutput
standard = D_max
stats front using 1 nooutput
set label 400 "front" at screen 0.73,0.70 font "sans:Bold,10"
set label 401 "motion" at screen 0.765,0.70 font ",10"
set label 402 "loads" at screen 0.805,0.70 font ",10"
set label 403 (cost == 7 ? "instr." : "time") at screen 0.845,0.70 font ",10"
set label 404 "setting" at screen 0.875,0.70 font ",10"
do for [i=1:STATS_records] {
  y = 0.70 - 0.024 * i
  field(k) = system(sprintf("sed -n %dp '%s' | cut -d, -f%d", i, front, k))
  set label 400 + 10 * i sprintf("%2d", i) at screen 0.735, y font ",10"
  set label 401 + 10 * i sprintf("%.1e", real(field(2))) at screen 0.765, y font ",10"
  set label 402 + 10 * i sprintf("%.1e", real(field(6))) at screen 0.805, y font ",10"
  set label 403 + 10 * i sprintf("%.3f", real(field(3))) at screen 0.845, y font ",10"
  set label 404 + 10 * i field(4) at screen 0.875, y font ",10"
}
y = 0.70 - 0.024 * (STATS_records + 2)
set label 900 "lean: Newton 1e-6, ".lean at screen 0.73, y font ",10"
set label 901 "/modal: in 8 modes; 3 x 6: elements x nodes" at screen 0.73, y - 0.024 font ",10"
set label 902 "grey: values of knobs that make a difference" at screen 0.73, y - 0.048 font ",10" tc rgb "#777777"

set grid lc rgb "#dddddd" lt 1
set logscale xy
set format x "%.0e"
set yrange [0.03:10]
set tmargin at screen 0.945
set bmargin at screen 0.09
other(e, c) = c > 2 || abs(log(e / standard)) > 0.12
set output out.scene.".png"
set multiplot

set lmargin at screen 0.05
set rmargin at screen 0.445
set format y "%g"
set xlabel "error of the tip's motion against the reference, relative to the deformation [-]"
set ylabel (cost == 7 ? "instructions" : "processor time")." of the run over the default's [-]"
set xrange [own / 1.6:9]
set title "What accuracy costs: ".scene
set arrow 1 from own, graph 0 to own, graph 1 nohead lc rgb "#888888" dt 2 lw 2
set label 100 "the reference's own error is at most this" at own, graph 0.02 rotate by 90 offset 0.9,0 font ",9" tc rgb "#666666"
set arrow 2 from edge, graph 0 to edge, graph 1 nohead lc rgb "#d00000" dt 3 lw 1.5
set label 101 "fail" at edge * 1.15, graph 0.02 font "sans:Bold,10" tc rgb "#d00000"
plot front using 2:3 with lines lw 3 lc rgb "#f4c95d", \
     all using (strlen(strcol(4)) && strcol(2) ne "reference" && strcol(2) ne "default" && strcol(2) ne "together" && \
       other(column(12), column(cost)) ? column(12) : NaN):cost:3 with labels left offset 0.6,0 font ",7" tc rgb "#888888", \
     for [i=1:19] all using (strcol(2) eq names(i) && strlen(strcol(4)) ? column(12) : NaN):cost \
       with points pt mark[i] ps 1.1 lc rgb colour[i], \
     for [i=1:19] fails using (strcol(2) eq names(i) ? edge * 1.3 : NaN):(8.5 / 1.22 ** column(1)) \
       with points pt mark[i] ps 1.1 lc rgb colour[i], \
     fails using (edge * 0.95):(8.5 / 1.22 ** column(1)):((strcol(2) eq "together" ? "" : strcol(2)." ").strcol(3)) with labels right font ",7" tc rgb "#d00000", \
     all using (strcol(2) eq "default" ? column(12) : NaN):cost with points pt 3 ps 2.4 lw 2 lc rgb "#d00000", \
     front using 2:3:5:2 with xerrorbars pt 6 ps 1.8 lw 1.5 lc rgb "#000000", \
     front using 2:3:1 with labels font "sans:Bold,9" offset -1.1,-0.7, \
     best using 2:3:(sprintf("%g %%: %s", column(1), strcol(4))) with labels right offset -2.2,0.2 font "sans:Bold,10" tc rgb "#8a5a00"

set lmargin at screen 0.48
set rmargin at screen 0.715
set format y ""
unset ylabel
unset label
unset arrow
set xlabel "error of the ".load.", relative [-]"
set xrange [own / 1.6:3]
set title "the same settings' loads"
plot front using 6:3 with lines lw 2 lc rgb "#f4c95d", \
     for [i=1:19] all using (strcol(2) eq names(i) && strlen(strcol(4)) ? column(10) : NaN):cost \
       with points pt mark[i] ps 1.1 lc rgb colour[i], \
     all using (strcol(2) eq "default" ? column(10) : NaN):cost with points pt 3 ps 2.4 lw 2 lc rgb "#d00000", \
     front using 6:3 with points pt 6 ps 1.8 lw 1.5 lc rgb "#000000", \
     front using 6:3:1 with labels font "sans:Bold,9" offset -1.1,-0.7
unset multiplot

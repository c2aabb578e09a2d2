# gnuplot -e "csv='<prefix of the CSV files>'; out='<prefix of the pictures>'; scene='<name>'; own=<error of the
# reference>; cost=<column: 5 time, 7 instructions>" accuracy.gp
set terminal pngcairo size 1240,760 font "sans,11" noenhanced
set datafile separator ","
set grid lc rgb "#dddddd" lt 1
set lmargin at screen 0.075
set rmargin at screen 0.665
set tmargin at screen 0.945
set bmargin at screen 0.09
set logscale xy
set format x "%.0e"
set format y "%g"
set xlabel "error of the tip's motion against the reference, relative to the deformation [-]"
set ylabel (cost == 7 ? "instructions" : "processor time")." of the run over the default's [-]"
set xrange [own / 1.6:1.6]
set yrange [0.03:10]
set title "What accuracy costs: ".scene
knobs = "dt nodes elements quadrature rho substeps newton predictor theta start consistent projection acceleration f32 coupling effects fidelity together"
array colour[18] = ["#1b6ca8", "#d1495b", "#e08e45", "#3a8f4e", "#8a5fbf", "#6b6b6b", "#00a3a3", "#b8860b", "#c71585", \
                    "#1f9e9e", "#556b2f", "#87ceeb", "#ff7f50", "#2f4f9f", "#a0522d", "#20a020", "#9acd32", "#000000"]
array mark[18] = [7, 5, 9, 11, 13, 7, 5, 9, 11, 13, 7, 5, 9, 11, 13, 7, 5, 9]
all = csv.scene.".csv"
front = csv."pareto-".scene.".csv"

# the key, in two columns beside the plot; knobs that the scene has not are left out
set key off
rows = 0
do for [i=1:words(knobs)] {
  if (system(sprintf("grep -c '^%s,%s,' '%s' || true", scene, word(knobs, i), all)) > 0) {
    x = 0.695 + 0.15 * (rows % 2)
    y = 0.935 - 0.026 * (rows / 2)
    set label 200 + i word(knobs, i) at screen x, y point pt mark[i] ps 1.1 lc rgb colour[i] offset 1,0 font ",10"
    rows = rows + 1
  }
}
set label 300 "default" at screen 0.695, 0.665 point pt 3 ps 2 lw 2 lc rgb "#d00000" offset 1,0 font ",10"
set label 301 "on the Pareto front" at screen 0.845, 0.665 point pt 6 ps 1.8 lw 1.5 lc rgb "#000000" offset 1,0 font ",10"

stats front using 1 nooutput
set label 400 "front" at screen 0.695,0.62 font "sans:Bold,10"
set label 401 "error" at screen 0.745,0.62 font ",10"
set label 402 (cost == 7 ? "instr." : "time") at screen 0.80,0.62 font ",10"
set label 403 "setting" at screen 0.845,0.62 font ",10"
do for [i=1:STATS_records] {
  row = system(sprintf("sed -n %dp '%s' | tr ',' '\\n'", i, front))
  y = 0.62 - 0.024 * i
  field(k) = system(sprintf("sed -n %dp '%s' | cut -d, -f%d", i, front, k))
  set label 400 + 10 * i sprintf("%2d", i) at screen 0.70, y font ",10"
  set label 401 + 10 * i sprintf("%.1e", real(field(2))) at screen 0.745, y font ",10"
  set label 402 + 10 * i sprintf("%.3f", real(field(3))) at screen 0.80, y font ",10"
  set label 403 + 10 * i field(4) at screen 0.845, y font ",10"
}
set arrow 1 from own, graph 0 to own, graph 1 nohead lc rgb "#888888" dt 2 lw 2
set label 100 "the reference's own error is at most this" at own, graph 0.02 rotate by 90 offset 0.9,0 font ",9" tc rgb "#666666"
set output out.scene.".png"
plot front using 2:3 with lines lw 3 lc rgb "#f4c95d", \
     for [i=1:words(knobs)] all using (strcol(2) eq word(knobs, i) && strlen(strcol(4)) ? column(4) : NaN):cost \
       with points pt mark[i] ps 1.1 lc rgb colour[i], \
     all using (strcol(2) eq "default" ? column(4) : NaN):cost with points pt 3 ps 2.4 lw 2 lc rgb "#d00000", \
     front using 2:3 with points pt 6 ps 1.8 lw 1.5 lc rgb "#000000", \
     front using 2:3:1 with labels font "sans:Bold,9" offset -1.1,-0.7

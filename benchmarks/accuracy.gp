# gnuplot -e "csv='<prefix of the CSV files>'; out='<prefix of the pictures>'; scene='<name>'" accuracy.gp
set terminal pngcairo size 900,560 font "sans,11" noenhanced
set datafile separator ","
set grid lc rgb "#dddddd" lt 1
set key outside right top box lc rgb "#cccccc"
set logscale xy
set format x "%.0e"
set format y "%g"
set xlabel "error against the converged reference, relative to the deformation"
set ylabel "CPU time of the steps over the default's"
set xrange [*:1.2]
set title "What accuracy costs: ".scene
knobs = "dt nodes elements quadrature rho substeps newton predictor theta consistent projection f32 coupling effects rung together"
array colour[16] = ["#1b6ca8", "#d1495b", "#e08e45", "#3a8f4e", "#8a5fbf", "#6b6b6b", "#00a3a3", "#b8860b", "#c71585", \
                    "#556b2f", "#87ceeb", "#ff7f50", "#2f4f9f", "#a0522d", "#20a020", "#000000"]
set output out.scene.".png"
plot csv."pareto-".scene.".csv" using 1:2 with lines lw 3 lc rgb "#f4c95d" title "Pareto front", \
     for [i=1:words(knobs)] csv.scene.".csv" using (strcol(2) eq word(knobs, i) && strlen(strcol(4)) ? column(4) : NaN):5 \
       with points pt (i % 2 ? 7 : 5) ps 1.1 lc rgb colour[i] title word(knobs, i), \
     csv.scene.".csv" using (strcol(2) eq "default" ? column(4) : NaN):5 with points pt 3 ps 2.4 lw 2 lc rgb "#d00000" title "default", \
     csv."pareto-".scene.".csv" using 1:2:3 with labels font ",7" left rotate by 25 offset 0.5,0.5 notitle

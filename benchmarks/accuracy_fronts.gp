# gnuplot -e "csv='<prefix of the CSV files>'; out='<picture>'; cost='<instructions | processor time>'" accuracy_fronts.gp
# The fronts of all scenes in one picture: the cheapest settings over their error, and the default of each.
set terminal pngcairo size 1100,620 font "sans,13" noenhanced
set datafile separator ","
scenes = "rotor gust wing plate body"
array colour[5] = ["#1b6ca8", "#00a3a3", "#3a8f4e", "#c8102e", "#8a5fbf"]
set logscale xy
set grid lc rgb "#eceff2" lt 1
set border 3 lc rgb "#555555"
set tics nomirror
set xtics ("0.001 %%" 1e-5, "0.01 %%" 1e-4, "0.1 %%" 1e-3, "1 %%" 1e-2, "10 %%" 0.1, "100 %%" 1)
set format y "%g"
set yrange [0.1:10]
set xrange [1e-5:1]
set xlabel "error of the motion, relative to the deformation"
set ylabel "cost: ".cost.", over that of the scene's default"
set key top right reverse Left spacing 1.2
set output out
standard(c) = (strcol(2) eq "default" ? column(c) : NaN)
plot for [i=1:5] csv."pareto-".word(scenes, i).".csv" using 2:3 with linespoints pt 7 ps 1.2 lw 2.5 lc rgb colour[i] title word(scenes, i), \
     for [i=1:5] csv.word(scenes, i).".csv" using (standard(12)):(1) with points pt 3 ps 2.2 lw 2.5 lc rgb colour[i] notitle, \
     NaN with points pt 3 ps 2 lw 2 lc rgb "#555555" title "default of the scene"

# gnuplot -e "csv='coupling.csv'; out='coupling.png'" coupling.gp: evaluations of the fluid a step, over noise and added mass
set terminal pngcairo size 1560,900 font "sans,11" noenhanced
set datafile separator ","
set output out
set multiplot layout 2,4 title "Evaluations of the fluid a step: default settings and schemes by hand (a point that is missing: it does not end every step)" font "sans:Bold,13"
set grid lc rgb "#dddddd" lt 1
set logscale xy
set key top left Left reverse samplen 2 font ",9"
set ylabel "evaluations a step [-]"
array masses[5] = ["0.1", "1", "4", "30", "1000"]
array colour[5] = ["#1b6ca8", "#00a3a3", "#3a8f4e", "#e08e45", "#d1495b"]
# mean over the seeds; where = pattern of "scene,mass,noise,corrections" fields, one row per x
means(scene, mass, noise, inner, scheme, x) = sprintf("< awk -F, -v OFS=, '$1 == \"%s\" && ($2 == \"%s\" || \"%s\" == \"*\") && ($3 == \"%s\" || (\"%s\" == \"*\" && $3 > 0)) && $4 == \"%s\" && $5 == \"%s\" { k = $%d; if (!(k in n)) order[++c] = k; n[k]++; s[k] += $7; if ($7 ~ /nan/) bad[k] = 1 } END { for (i = 1; i <= c; i++) { k = order[i]; print k, bad[k] ? \"nan\" : s[k] / n[k] } }' '%s'", scene, mass, mass, noise, noise, inner, scheme, x, csv)
do for [scene in "cylinder channel"] {
  set title scene.", exact but for noise"
  set xlabel "noise of a push, relative [-]"
  set format x "1e%T"
  set xrange [5e-9:2e-2]
  set yrange [0.9:20]
  plot for [i=1:5] means(scene, masses[i], "*", "0", "default", 3) using 1:2 with linespoints lw 2 pt 7 ps 0.8 lc rgb colour[i] title "added mass ".masses[i]
  set xlabel "added mass over mass [-]"
  set format x "%g"
  set xrange [0.06:2000]
  set yrange [2:1000]
  do for [inner in "1 2 4"] {
    set title scene.", ".inner.(inner eq "1" ? " correction" : " corrections")." a push"
    plot means(scene, "*", "0", inner, "fixed 0.1", 2) using 1:2 with linespoints lw 1 dt 2 pt 6 ps 0.8 lc rgb "#a0a0a0" title "fixed 0.1", \
         means(scene, "*", "0", inner, "fixed 0.5", 2) using 1:2 with linespoints lw 1 dt 2 pt 4 ps 0.8 lc rgb "#6b6b6b" title "fixed 0.5", \
         means(scene, "*", "0", inner, "fixed 1", 2) using 1:2 with linespoints lw 1 pt 8 ps 0.8 lc rgb "#6b6b6b" title "fixed 1", \
         means(scene, "*", "0", inner, "Aitken 1", 2) using 1:2 with linespoints lw 1.5 pt 9 ps 0.9 lc rgb "#e08e45" title "Aitken 1", \
         means(scene, "*", "0", inner, "Aitken 0.2", 2) using 1:2 with linespoints lw 1.5 pt 11 ps 0.9 lc rgb "#b8860b" title "Aitken 0.2", \
         means(scene, "*", "0", inner, "default", 2) using 1:2 with linespoints lw 3 pt 7 ps 1 lc rgb "#1b6ca8" title "default"
  }
}
unset multiplot

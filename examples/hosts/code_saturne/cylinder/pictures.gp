# cylinder.png: motion, lift and iterations of a run.
set datafile separator ","
set terminal pngcairo size 900,520 font "sans,10"
set output case . ".png"
set multiplot layout 2,1 margins 0.09,0.91,0.1,0.95 spacing 0.09
set key top right
set grid lc rgb "#dddddd"
set ylabel "y, m"; set y2label "lift, N"; set y2tics; set ytics nomirror
plot "history.csv" skip 1 using 1:3 with lines lw 2 lc rgb "#1f4e79" title "place across the stream", \
     "" skip 1 using 1:9 axes x1y2 with lines lc rgb "#c55a11" title "lift"
unset y2label; unset y2tics
set xlabel "t, s"; set ylabel "iterations"; set yrange [0:*]
plot "history.csv" skip 1 using 1:11 with steps lc rgb "#444444" notitle
unset multiplot

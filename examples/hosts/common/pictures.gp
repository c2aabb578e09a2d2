# CASE.png of any case: the motion and the forces of the first member, iterations.
set datafile separator ","
set terminal pngcairo size 900,640 font "sans,10"
set output case . ".png"
set multiplot layout 3,1 margins 0.1,0.97,0.08,0.97 spacing 0.07
set grid lc rgb "#dddddd"
set key top left
set ylabel "motion, m"
plot for [c = 2:4] "history.csv" skip 1 using 1:c with lines title word("u_x u_y u_z", c - 1)
set ylabel "force"
plot for [c = 8:10] "history.csv" skip 1 using 1:c with lines title word("f_x f_y f_z", c - 7)
set xlabel "t, s"; set ylabel "iterations"; set yrange [0:*]
plot "history.csv" skip 1 using 1:11 with steps lc rgb "#444444" notitle
unset multiplot

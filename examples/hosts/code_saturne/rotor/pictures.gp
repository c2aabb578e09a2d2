# CASE.png: thrust and the balance of power.
set datafile separator ","
set terminal pngcairo size 900,520 font "sans,10"
set output case . ".png"
set multiplot layout 2,1 margins 0.09,0.97,0.1,0.95 spacing 0.09
set grid lc rgb "#dddddd"
set key top right
set ylabel "thrust, kN"
plot "history.csv" skip 1 using 1:($2/1e3) with lines lw 2 lc rgb "#1f4e79" notitle
set xlabel "t, s"; set ylabel "power, MW"
plot "history.csv" skip 1 using 1:($11/1e6) with lines lc rgb "#444444" title "taken from the flow", \
     "" skip 1 using 1:($10/1e6) with lines lc rgb "#c55a11" title "given to the blades", \
     "" skip 1 using 1:($3/1e6) with lines lc rgb "#1f4e79" title "shaft"
unset multiplot

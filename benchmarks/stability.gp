# gnuplot -e "csv='<prefix of the CSV files>'; out='<prefix of the pictures>'" stability.gp
set terminal pngcairo size 760,500 font "sans,11" noenhanced
set datafile separator ","
set grid lc rgb "#dddddd" lt 1
set border lw 1
set key opaque box lc rgb "#cccccc"
array colour[4] = ["#1b6ca8", "#d1495b", "#3a8f4e", "#8a5fbf"]

set output out."campbell.png"
set title "A uniform blade that turns (units of sqrt(EI / m L^4))"
set xlabel "rotor speed"
set ylabel "angular frequency, seen from the blade"
set xrange [0:12]
set yrange [0:95]
set key top left opaque box lc rgb "#cccccc"
$wright << END
0,3.516015,22.03449,61.69721,3.516015
2,4.137320,22.61492,62.27318,3.621797
4,5.585001,24.27335,63.96676,3.897722
6,7.360373,26.80908,66.68391,4.263225
8,9.256838,29.99538,70.29296,4.657150
10,11.20233,33.64037,74.64929,5.048975
12,13.17015,37.60311,79.61448,5.427049
END
plot for [k=1:6] k*x with lines dt 3 lc rgb "#999999" title (k == 1 ? "1 to 6 times the speed" : ""), \
     for [k=2:6] csv."campbell.csv" using 1:k with lines lw 2 lc rgb colour[1] title (k == 2 ? "eigenvalues" : ""), \
     for [k=2:5] $wright using 1:k with points pt 6 ps 1.1 lw 1.5 lc rgb colour[2] title (k == 2 ? "Wright et al. 1982" : "")

set output out."beck.png"
set title "Beck's column: a force P that follows its tip"
set xlabel "P L^2 / EI"
set ylabel "growth rate, frequency (sqrt(EI / m L^4))"
set xrange [0:30]
set yrange [-15:25]
set key bottom left opaque box lc rgb "#cccccc"
set arrow from 20.0509,-15 to 20.0509,25 nohead dt 2 lc rgb "#444444"
set label "20.05" at 20.3,22
plot csv."beck.csv" using 1:3 with points pt 7 ps 0.5 lc rgb colour[1] title "frequency", \
     csv."beck.csv" using 1:2 with points pt 7 ps 0.5 lc rgb colour[2] title "growth rate", \
     csv."beck.csv" using 1:4 with lines dt 2 lc rgb "#444444" title "lowest mode of the symmetric part (negative: omega^2 is)"

# V-g: growth rates and frequencies over the speed of the wind
unset arrow
unset label
unset title
set terminal pngcairo size 760,720 font "sans,11" noenhanced
set output out."flutter.png"
set multiplot layout 2,1 title "Goland's wing: eigenvalues of wing and air"
set xrange [0:180]
set lmargin 10
set key bottom left opaque box lc rgb "#cccccc"
set xlabel ""
set ylabel "growth rate, 1/s"
set yrange [-35:15]
set arrow from 0,0 to 180,0 nohead lc rgb "#444444"
set arrow from 137.2,-35 to 137.2,15 nohead dt 2 lc rgb "#444444"
set label "137.2 m/s, Goland & Luke 1948" at 134,12 right
plot csv."goland.csv" using 1:2 with points pt 7 ps 0.5 lc rgb colour[2] title "eigenvalues"
unset arrow
unset label
set xlabel "speed of the wind, m/s"
set ylabel "frequency, rad/s"
set yrange [45:95]
set key top right opaque box lc rgb "#cccccc"
set arrow from 137.2,45 to 137.2,95 nohead dt 2 lc rgb "#444444"
set label "70.7 rad/s" at 139,74 left
plot csv."goland.csv" using 1:3 with points pt 7 ps 0.5 lc rgb colour[1] title "eigenvalues", \
     "-" using 1:2 with points pt 6 ps 1.4 lw 2 lc rgb colour[3] title "Goland & Luke"
137.2,70.7
e
unset multiplot

set terminal pngcairo size 760,500 font "sans,11" noenhanced
set output out."flutter-bent.png"
unset arrow
unset label
set title "The sixteen-metre wing, bent by its lift: the least stable eigenvalue"
set xlabel "speed of the wind, m/s"
set ylabel "growth rate, 1/s"
set xrange [14:36]
set yrange [-1.2:1]
set key top left opaque box lc rgb "#cccccc"
set arrow from 14,0 to 36,0 nohead lc rgb "#444444"
set arrow from 32.21,-1.2 to 32.21,1 nohead dt 2 lc rgb "#444444"
set label "32.21 m/s, straight:\nPatil et al. 2001" at 32.5,-0.85 left
plot for [k=0:3] csv."bent.csv" index k using 2:4 with lines lw 2 lc rgb colour[k+1] title word("0 0.5 1 2", k+1)." degrees at the root"

# gnuplot -e "csv='steps.csv'; out='steps.png'" steps.gp: growth of an oscillator over random steps (benchmarks/steps.c)
set terminal pngcairo size 1200,720 font "sans,11"
set datafile separator ","
set output out
set multiplot layout 2,3 title "x'' + x = 0 in steps of random length: growth of the amplitude, exponent a step (largest of ten sequences; below 0 it fades)" font "sans:Bold,12"
set grid lc rgb "#dddddd" lt 1
set border lw 1
set logscale x
set format x "10^%T"
set xrange [0.01:10000]
set xlabel "omega dt"
array rho[2] = ["0.9", "0"]
array factor[3] = ["1.1", "3", "1000"]
array top[3] = [0.4, 1, 7]
array bottom[3] = [-0.4, -0.6, -2]
do for [i=0:5] {
  k = i % 3 + 1
  set title "dt over a factor of ".factor[k].", rho_{inf} ".rho[i / 3 + 1]
  set yrange [bottom[k]:top[k]]
  set ylabel (k == 1 ? "exponent a step" : "")
  if (i == 0) { set key top left Left reverse samplen 2 font ",10" } else { set key off }
  set arrow 1 from 0.01,0 to 10000,0 nohead lc rgb "#444444"
  plot csv index i using 3:4 with lines lw 2 lc rgb "#d1495b" title "generalised-alpha, memory kept", \
       csv index i using 3:5 with lines lw 2 lc rgb "#e8a33d" title "generalised-alpha, restarted", \
       csv index i using 3:6 with lines lw 2 dt 2 lc rgb "#3a8f4e" title "TR-BDF2 in all steps", \
       csv index i using 3:7 with lines lw 2 lc rgb "#1b6ca8" title "spar"
}
unset multiplot

# CASE_vorticity.png: vorticity at the end of the run, and the motion until then. vorticity.txt: x y vorticity, NaN in bodies.
set terminal pngcairo size 1000,640 font "sans,10"
set output case . "_vorticity.png"
set multiplot
set lmargin at screen 0.08; set rmargin at screen 0.9
set palette defined (-1 "#1f4e79", -0.3 "#9cc3e6", 0 "#ffffff", 0.3 "#f4b183", 1 "#c00000")
set cbrange [-most:most]
set cblabel "vorticity, 1/s"
set xlabel "x, m" offset 0,0.5; set ylabel "y, m"
set size ratio -1
set origin 0,0.36; set size 1,0.64
set xrange [x0:x0 + lx]; set yrange [y0:y0 + ly]
set object 1 rectangle from graph 0,0 to graph 1,1 fillcolor rgb "#404040" behind
plot "vorticity.txt" using 1:2:3 with image notitle
unset object 1
set autoscale
set size noratio
set origin 0,0; set size 1,0.34
set tmargin at screen 0.32; set bmargin at screen 0.09
set xlabel "t, s"; set ylabel "u_y, m"
set grid lc rgb "#dddddd"
set datafile separator ","
plot "history.csv" skip 1 using 1:3 with lines lw 1.5 lc rgb "#1f4e79" notitle
unset multiplot

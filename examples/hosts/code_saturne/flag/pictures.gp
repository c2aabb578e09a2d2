# CASE.png: the tip's motion, drag and lift, iterations.
set datafile separator ","
set terminal pngcairo size 900,640 font "sans,10"
set output case . ".png"
set multiplot layout 3,1 margins 0.09,0.91,0.08,0.97 spacing 0.07
set grid lc rgb "#dddddd"
set key top left
set ytics nomirror; set y2tics
set ylabel "u_y, mm"; set y2label "u_x, mm"
plot "history.csv" skip 1 using 1:($3*1e3) with lines lc rgb "#1f4e79" title "tip, across", \
     "" skip 1 using 1:($2*1e3) axes x1y2 with lines lc rgb "#c55a11" title "along"
set ylabel "lift, N/m"; set y2label "drag, N/m"
plot "history.csv" skip 1 using 1:9 with lines lc rgb "#1f4e79" title "lift", \
     "" skip 1 using 1:8 axes x1y2 with lines lc rgb "#c55a11" title "drag"
unset y2label; unset y2tics
set xlabel "t, s"; set ylabel "iterations"; set yrange [0:*]
plot "history.csv" skip 1 using 1:11 with steps lc rgb "#444444" notitle
unset multiplot

# CASE_mesh.png: the mesh where the flag was farthest out, of all ranks.
reset
meshes = system("ls mesh.*.txt 2>/dev/null")
if (words(meshes) > 0) {
    set terminal pngcairo size 1100,480 font "sans,10"
    set output case . "_mesh.png"
    set size ratio -1
    set xrange [0.05:0.85]; set yrange [0:0.41]
    set xlabel "x, m"; set ylabel "y, m"
    plot for [mesh in meshes] mesh with lines lw 0.5 lc rgb "#1f4e79" notitle
}

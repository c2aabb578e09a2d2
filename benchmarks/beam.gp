# gnuplot -e "csv='<prefix of the CSV files>'; out='<prefix of the pictures>'" beam.gp
set terminal pngcairo size 760,500 font "sans,11" noenhanced
set datafile separator ","
set grid lc rgb "#dddddd" lt 1
set border lw 1
set key opaque box lc rgb "#cccccc"
array colour[4] = ["#1b6ca8", "#d1495b", "#3a8f4e", "#8a5fbf"]

set output out."nodes.png"
set title "Static error at the tip over the nodes of one element"
set xlabel "nodes"
set ylabel "error / length"
set logscale y
set format y "%.0e"
set yrange [1e-16:2]
plot for [k=2:5] csv."nodes.csv" using 1:k with linespoints pt 7 ps 0.7 lw 2 lc rgb colour[k-1] title columnhead(k)

set output out."dt.png"
set title "Dynamic error at the tip over the time step (composite cantilever, 0.4 s)"
set xlabel "dt (s)"
set ylabel "error / length"
set logscale x
set yrange [*:*]
set key bottom right opaque box lc rgb "#cccccc"
plot for [k=2:5] csv."dt.csv" using 1:k with linespoints pt 7 ps 0.7 lw 2 lc rgb colour[k-1] title columnhead(k), \
     [1e-4:2e-2] 10*x**2 with lines dt 2 lc rgb "#444444" title "order 2"
unset logscale x

set output out."points.png"
set title "Error by the quadrature alone, 12 nodes"
set xlabel "quadrature points in the element"
set ylabel "relative error of the tip's deflection"
set yrange [1e-15:3]
set logscale x
set xrange [10:300]
set key bottom left opaque box lc rgb "#cccccc"
pick(scene, rule, v) = (strcol(2) eq scene && strcol(3) eq rule) ? v : NaN
plot csv."points.csv" using 1:(pick("jumps", "gauss", $4)) with points pt 6 ps 0.8 lc rgb colour[2] title "jumping stiffness, Gauss over the beam", \
     "" using 1:(pick("nrel5mw", "gauss", $4)) with points pt 4 ps 0.8 lc rgb colour[4] title "NREL 5-MW, Gauss over the beam", \
     "" using 1:(pick("jumps", "sections", $4)) with points pt 7 ps 1 lc rgb colour[1] title "jumping stiffness, per section", \
     "" using 1:(pick("nrel5mw", "sections", $4)) with points pt 5 ps 1 lc rgb colour[3] title "NREL 5-MW, per section"
unset logscale x
set xrange [*:*]

set output out."pieces.png"
set title "Error against the exact deflection, stiffness jumping at five stations"
set xlabel "nodes"
set ylabel "relative error of the tip's deflection"
set yrange [5e-4:1]
set key top right opaque box lc rgb "#cccccc"
plot for [k=2:3] csv."pieces.csv" using 1:k with linespoints pt 7 ps 0.7 lw 2 lc rgb colour[k-1] title columnhead(k)

set output out."elements.png"
set title "Cost of a step and memory over elements of 6 nodes"
set xlabel "elements"
set ylabel "us a step"
set y2label "kB"
set logscale xy
set logscale y2
set format y "%g"
set format y2 "%g"
set yrange [10:30000]
set y2range [100:300000]
set y2tics
set ytics nomirror
set xrange [0.8:320]
set xtics (1, 2, 4, 8, 16, 32, 64, 128, 256)
set key top left reverse Left opaque box lc rgb "#cccccc"
plot csv."elements.csv" using 1:2 with linespoints pt 7 lw 2 lc rgb colour[1] title "us a step", \
     csv."elements.csv" using 1:($6/1000) axes x1y2 with linespoints pt 5 lw 2 lc rgb colour[3] title "memory, kB", \
     [1:256] 24*x with lines dt 2 lc rgb "#444444" title "linear"

# gnuplot: growth.csv -> growth.png
set datafile separator ","
set terminal pngcairo size 760,520 font "sans,11"
set output "growth.png"
set logscale xy
set xlabel "path length u [m]"
set ylabel "rms displacement x1 [m]"
set format y "10^{%T}"
set key left top
set grid
set xrange [0.01:5]
plot "growth.csv" using 1:2 every ::1 with lines lw 2 lc rgb "#1f5fa8" title "exact tables: expectation", \
     "" using 1:3 every ::1 with points pt 6 lc rgb "#1f5fa8" title "exact tables: six realisations", \
     "" using 1:4 every ::1 with lines lw 2 lc rgb "#c0392b" title "paper's single table, c u", \
     2.08e-6*x**2 with lines dt 2 lc rgb "#555555" title "u^2", \
     9.4e-7*x**1.5 with lines dt 3 lw 2 lc rgb "#555555" title "u^{3/2}"

# gnuplot: tolerance.csv, of tests/tolerance -> tolerance.png
set datafile separator ","
set terminal pngcairo size 900,420 font "sans,11"
set output "tolerance.png"
set logscale xy
set xrange [2:5e-7]
set format x "10^{%T}"
set xlabel "--tolerance [px]"
set grid
set multiplot layout 1,2
airs = "mirage fig5 fig6"
titles = "'mirage.toml, a hot road' 'fig5.toml, 300 blobs' 'fig6.toml, lattice 32^3'"
colours = "#c0392b #1f5fa8 #2e8b57"
set ylabel "processor time of a ray [µs]"
set key left top reverse Left
set yrange [1:20000]
plot for [i=1:3] "< grep ".word(airs, i)." tolerance.csv" using 2:3 with linespoints pt 7 ps 0.7 lw 1.5 lc rgb word(colours, i) title word(titles, i)
set ylabel "largest error of the displacement [px]"
set format y "10^{%T}"
set yrange [1e-9:10]
set key right top noreverse Right
plot for [i=1:3] "< grep ".word(airs, i)." tolerance.csv" using 2:4 with linespoints pt 7 ps 0.7 lw 1.5 lc rgb word(colours, i) notitle, \
     x with lines dt 2 lc rgb "#555555" title "what was asked for"

# gnuplot: blob_cost.csv, of tests/blobs_bench --benchmark_format=csv -> blob_cost.png
set datafile separator ","
set terminal pngcairo size 760,460 font "sans,11"
set output "blob_cost.png"
set logscale xy
set xlabel "area that blobs cover, in pictures"
set ylabel "map of a 1080p frame [ms]"
set grid
set key left top reverse Left
set xrange [0.003:100]
set yrange [5:500]
ten(n) = strstrt(n, "10000") > 0
plot "< grep blobs: blob_cost.csv" using (ten(strcol(1)) ? $11 : 1/0):3 with points pt 6 ps 1.2 lc rgb "#1f5fa8" title "ten thousand, σ = 0.6 to 19 pixels: part of the picture that moves", \
     "" using (ten(strcol(1)) ? $12 : 1/0):3 with points pt 7 ps 1.2 lc rgb "#1f5fa8" title "ten thousand: sum of their areas", \
     "" using (ten(strcol(1)) ? 1/0 : $12):3 with points pt 5 ps 1.2 lc rgb "#c0392b" title "100, 300, 1000 and 3000, σ = 2.4 to 4.8 pixels: sum of their areas", \
     7 + 25*x with lines dt 2 lc rgb "#555555" title "7 ms + 25 ms a picture"

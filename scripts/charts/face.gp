# Draws what `face_fem --chart` measured; called with data (the folder of its tables) and out (the folder of pictures).
set datafile separator ","
set datafile missing "nan"
set grid lc rgb "#dddddd"
set format y "%g"
set key outside right top
set style line 1 lc rgb "#999999" pt 4 lw 2
set style line 2 lc rgb "#1f77b4" pt 7 lw 2
set style line 3 lc rgb "#2ca02c" pt 9 lw 2
set style line 4 lc rgb "#ff7f0e" pt 5 lw 2
set style line 5 lc rgb "#d62728" pt 13 lw 2
set style line 6 lc rgb "#9467bd" pt 2 lw 2

# column of the rows in which another column holds a word
pick(wanted, column, value) = strcol(column) eq wanted ? value : NaN

do for [format in "svg png"] {
  if (format eq "svg") { set terminal svg size 900,540 font "Sans,13" background "white" } else { set terminal pngcairo size 900,540 font "Sans,11" }

  # --- elements: error against set-up cost
  set output out."/face_elements.".format
  set title "Layered cap, 6 muscles: error of the outer surface against the cost of setting up"
  set xlabel "assemble, order, factor: CPU ms"
  set ylabel "relative error (against hex20r 40x40x6)"
  set logscale xy
  table = data."/face_elements.csv"
  octree(e, v) = (strcol(1) eq e && strcol(3) eq "octree") ? v : NaN
  plot table using ($6+$7+$8):(octree("hex8", $5)) with linespoints ls 1 title "hex8 full", \
       "" using ($6+$7+$8):(octree("bbar", $5)) with linespoints ls 2 title "bbar", \
       "" using ($6+$7+$8):(octree("wt", $5)) with linespoints ls 3 title "wt", \
       "" using ($6+$7+$8):(octree("hex20", $5)) with linespoints ls 4 title "hex20", \
       "" using ($6+$7+$8):(octree("hex20r", $5)) with linespoints ls 5 title "hex20r", \
       "" using ($6+$7+$8):(strcol(3) eq "gauss27" ? $5 : NaN) with points ls 6 ps 1.5 title "paper's 3x3x3 muscle rule"

  # --- quadrature: force error against sphere size
  set output out."/face_quadrature.".format
  set title "Total force of a muscle's sphere before scaling, over random places"
  set xlabel "radius / element size"
  set ylabel "mean relative error of the force (a missed sphere counts as 1)"
  table = data."/face_quadrature.csv"
  plot table using 2:(pick("gauss27 sharp", 1, $3)) with linespoints ls 6 title "3x3x3 sharp (paper)", \
       "" using 2:(pick("gauss27 smooth", 1, $3)) with linespoints ls 4 title "3x3x3 smooth", \
       "" using 2:(pick("gauss27 sharp", 1, $5 > 0 ? $5 : NaN)) with linespoints ls 5 dt 2 title "3x3x3: part missed", \
       "" using 2:(pick("octree 3", 1, $6)) with linespoints ls 2 title "octree: centroid, radii", \
       1e-3 with lines lc rgb "#000000" dt 3 title "target for the force"

  # --- frames: cost of a frame by method and mesh
  set output out."/face_frames.".format
  set title "One frame of 20 000 vertices, 36 muscles: what each method costs"
  set xlabel ""
  set ylabel "CPU ms"
  unset logscale x
  set style data histograms
  set style histogram clustered gap 1
  set style fill solid 0.8
  set boxwidth 0.9
  table = data."/face_frames.csv"
  set yrange [0.01:20]
  set xtics ("solve double" 0, "solve single" 1, "36 by basis" 2, "6 by basis" 3, "drag a muscle" 4)
  plot table using 4 every ::1::5 ls 1 title "8x8x3", \
       "" using 4 every ::6::10 ls 2 title "16x16x4", \
       "" using 4 every ::11::15 ls 5 title "32x32x6"
  unset xtics
  set xtics
  set yrange [*:*]
  set style data linespoints

  # --- locking
  set output out."/face_locking.".format
  set title "Toward incompressibility: error of the surface on 12x12x3"
  set xlabel "1/2 - Poisson's ratio"
  set ylabel "relative error (against hex20r 16x16x3)"
  set logscale xy
  set xrange [0.3:5e-7] reverse
  table = data."/face_locking.csv"
  plot for [k=1:5] table using (0.5-$3):(pick(word("hex8 bbar wt hex20 hex20r", k), 1, $5)) with linespoints ls k title word("hex8 bbar wt hex20 hex20r", k)
  set xrange [*:*] noreverse

  # --- large motion
  set output out."/face_nonlinear.".format
  set title "Linear against neo-Hookean tissue under one muscle"
  set xlabel "largest displacement of the linear model, mm"
  set ylabel "relative difference; strain"
  unset logscale
  set y2label "CPU ms of the nonlinear solution"
  set y2tics
  set y2range [0:*]
  table = data."/face_nonlinear.csv"
  plot table using ($1*1000):5 with linespoints ls 2 title "difference", \
       "" using ($1*1000):2 with linespoints ls 4 title "strain", \
       "" using ($1*1000):9 axes x1y2 with linespoints ls 1 title "nonlinear CPU ms"
  unset y2tics
  unset y2label
  unset output
}

# The arm's charts from the files of `arm_ik --chart`; called with `data` = their folder and `out` = where pictures go.
set datafile separator ','
set style data linespoints
set key font ',9' spacing 0.9
set tics font ',9'
set title font ',11'
set grid lc rgb '#e0e0e0'
file = data.'/work_precision.csv'
own = 'auto full reach polish clamped'
own_color(i) = word('#1b6ca8 #7fb069 #c0392b #8e5ea2 #888888', i)
peers = '"KDL LMA" "KDL NR_JL" "DART" "MuJoCo + DLS"'
peer_color(i) = word('#d9a441 #b5651d #4c9f70 #3c3c3c', i)
rows(set, solver) = sprintf("< awk -F, 'NR>1 && $2==\"%s\" && $3==\"%s\"' '%s'", set, solver, file)
share(failed, targets) = failed > 0 ? 100.0 * failed / targets : 0.02

# -- work against precision, and what fails
do for [terminal in 'svg pngcairo'] {
  if (terminal eq 'svg') { set terminal svg size 1180,900 font 'sans,11' background '#ffffff'; set output out.'/arm_work_precision.svg' }
  else { set terminal pngcairo size 1180,900 font 'sans,11'; set output out.'/arm_work_precision.png' }
  set multiplot layout 2,2 title 'eleven-freedom arm: time of a pose against its tolerance (median; rotation ten times the metres)'
  set logscale xy; set format '10^{%T}'
  set xrange [3e-13:3e-2] reverse; set yrange [0.3:3e4]
  set xlabel 'tolerance [m]'; set ylabel 'time of a target [us]'
  do for [set in 'random warm near_limit singular'] {
    set title set noenhanced
    set key outside right top
    plot for [i = 1:5] rows(set, word(own, i)) using 4:7 lw 2 pt 7 ps 0.5 lc rgb own_color(i) title word(own, i) noenhanced, \
         for [i = 1:4] rows(set, word(peers, i)) using 4:7 dt 2 pt 6 ps 0.5 lc rgb peer_color(i) title word(peers, i) noenhanced
  }
  unset multiplot; unset output
  if (terminal eq 'svg') { set terminal svg size 1180,900 font 'sans,11' background '#ffffff'; set output out.'/arm_failures.svg' }
  else { set terminal pngcairo size 1180,900 font 'sans,11'; set output out.'/arm_failures.png' }
  set multiplot layout 2,2 title 'eleven-freedom arm: targets not reached (the lowest line is none; 5 ms a target for the peers, which restart)'
  set yrange [0.012:130]; set ylabel 'failed [%]'; set format y '%g'
  do for [set in 'random warm near_limit singular'] {
    set title set noenhanced
    plot for [i = 1:5] rows(set, word(own, i)) using 4:(share($6, $5)) lw 2 pt 7 ps 0.5 lc rgb own_color(i) title word(own, i) noenhanced, \
         for [i = 1:4] rows(set, word(peers, i)) using 4:(share($6, $5)) dt 2 pt 6 ps 0.5 lc rgb peer_color(i) title word(peers, i) noenhanced
  }
  unset multiplot; unset output
}
unset logscale; set format '%g'; set xrange [*:*] noreverse; set yrange [*:*]

# -- a target that leaves reach and comes back
journey(solver) = sprintf("< awk -F, 'NR>1 && $1==\"%s\"' '%s/out_and_back.csv'", solver, data)
do for [terminal in 'svg pngcairo'] {
  if (terminal eq 'svg') { set terminal svg size 1100,760 font 'sans,11' background '#ffffff'; set output out.'/arm_out_and_back.svg' }
  else { set terminal pngcairo size 1100,760 font 'sans,11'; set output out.'/arm_out_and_back.png' }
  set style data lines
  unset title
  set multiplot layout 3,1 title 'a target goes 0.8 m out of reach and comes back'
  set key outside right top
  set xlabel ''; set ylabel 'distance left [m]'
  plot for [i = 1:4] journey(word(peers, i)) using 2:4 lc rgb peer_color(i) title word(peers, i) noenhanced, journey('tracker') using 2:4 lw 3 lc rgb '#1b6ca8' title 'tracker (ours)'
  set ylabel 'largest step of a tick [rad]'; set logscale y; set yrange [1e-4:10]
  plot for [i = 1:4] journey(word(peers, i)) using 2:($5 > 1e-4 ? $5 : 1e-4) lc rgb peer_color(i) title word(peers, i) noenhanced, journey('tracker') using 2:($5 > 1e-4 ? $5 : 1e-4) lw 3 lc rgb '#1b6ca8' title 'tracker (ours)'
  unset logscale y; set yrange [*:*]
  set xlabel 'time [s]'; set ylabel 'farthest joint from home [rad]'
  plot for [i = 1:4] journey(word(peers, i)) using 2:6 lc rgb peer_color(i) title word(peers, i) noenhanced, journey('tracker') using 2:6 lw 3 lc rgb '#1b6ca8' title 'tracker (ours)'
  unset multiplot; unset output
}

# -- the workspace of the three models
do for [terminal in 'svg pngcairo'] {
  if (terminal eq 'svg') { set terminal svg size 1180,800 font 'sans,11' background '#ffffff'; set output out.'/arm_atlas.svg' }
  else { set terminal pngcairo size 1180,800 font 'sans,11'; set output out.'/arm_atlas.png' }
  set multiplot layout 2,3 title 'how near the wrist comes to every place [cm], without a body in the way; 0 is the shoulder'
  set palette defined (0 '#08306b', 0.01 '#2171b5', 1 '#6baed6', 3 '#c6dbef', 10 '#ffffff')
  set cbrange [0:10]; set size ratio -1; unset key
  set xrange [-0.9:0.9]; set yrange [-0.9:0.9]
  do for [plane in 'frontal sagittal'] {
    do for [model in '4:limb 5:rhythm 6:reach'] {
      column = int(model[1:1]); name = model[3:*]
      set title sprintf('%s, %s', plane, name) noenhanced
      set xlabel plane eq 'frontal' ? 'outwards [m]' : 'forwards [m]'; set ylabel 'up [m]'
      plot sprintf("< awk -F, '$1==\"%s\"' '%s/atlas.csv'", plane, data) using 2:3:(100 * column(column)) with image
    }
  }
  unset multiplot; unset output
}

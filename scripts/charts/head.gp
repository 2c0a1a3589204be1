# The head's charts from the files of `head_ik --chart`; called with `data` = their folder and `out` = where pictures go.
set datafile separator ','
set style data lines
set key font ',9' spacing 0.9
set tics font ',9'
set title font ',11'
set grid lc rgb '#e0e0e0'
rules = 'two_step half_angle arc_cosine not_both paper'
named = '"two steps (ours)" "half angles" "arc cosine" "paper, condition mended" "paper as printed"'
color(i) = word('#1b6ca8 #7fb069 #c98b2b #8e5ea2 #c0392b', i)
width(i) = i == 1 ? 3 : 1.5

# -- orientation to ZYZ angles: error and time against the distance from a pole
error_of(rule, noise, pole) = sprintf("< awk -F, 'NR>1 && $1==\"%s\" && $2==\"%s\" && $3==\"%s\"' %s/zyz_error.csv", rule, noise, pole, data)
time_of(rule, noise, pole) = sprintf("< awk -F, 'NR>1 && $1==\"%s\" && $2==\"%s\" && $3==\"%s\"' %s/zyz_time.csv", rule, noise, pole, data)
do for [terminal in 'svg pngcairo'] {
  if (terminal eq 'svg') { set terminal svg size 1100,760 font 'sans,11' background '#ffffff'; set output out.'/head_zyz.svg' }
  else { set terminal pngcairo size 1100,760 font 'sans,11'; set output out.'/head_zyz.png' }
  set multiplot layout 2,2 title 'ZYZ angles of an orientation (600 orientations a point, a sixth with gamma = 0)'
  set logscale x; set format x '10^{%T}'
  set logscale y; set format y '10^{%T}'
  set yrange [1e-17:10]; set ytics 1e4
  do for [panel in '0:0 0:pi 1e-12:0'] {
    noise = panel[1:strstrt(panel, ':') - 1]; pole = panel[strstrt(panel, ':') + 1:*]
    set title sprintf('largest error [rad], %s', noise eq '0' ? 'exact input' : 'entries with noise of 1e-12')
    set xlabel sprintf('distance of beta from %s [rad]', pole)
    unset key
    plot for [i = 1:5] error_of(word(rules, i), noise, pole) using 4:($5 > 1e-17 ? $5 : 1e-17) lw width(i) lc rgb color(i) title word(named, i)
  }
  unset logscale y; set format y '%g'; set yrange [0:250]; set ytics auto
  set key inside top right
  set title 'processor time of one extraction [ns]'
  set xlabel 'distance of beta from 0 [rad]'
  plot for [i = 1:5] time_of(word(rules, i), '0', '0') using 4:5 lw width(i) lc rgb color(i) title word(named, i)
  unset multiplot
  unset output
}
unset logscale; set format; set yrange [*:*]; set ytics auto

# -- where the head can look, and what the printed rule makes of it
do for [terminal in 'svg pngcairo'] {
  if (terminal eq 'svg') { set terminal svg size 1100,420 font 'sans,11' background '#ffffff'; set output out.'/head_reach.svg' }
  else { set terminal pngcairo size 1100,420 font 'sans,11'; set output out.'/head_reach.png' }
  set multiplot layout 1,2
  set xlabel 'yaw [deg], left positive'; set ylabel 'pitch [deg], up positive'
  set xrange [120:-120]; set yrange [-88:88]; set xtics 30; set ytics 30
  set cbrange [0:60]; set cblabel 'gaze error [deg]'
  set palette defined (0 '#ffffff', 2 '#d7e8f4', 20 '#6aaed6', 60 '#08306b')
  set title 'nearest posture in swing and twist (ours)'
  plot data.'/reach.csv' every ::1 using 1:2:3 with image notitle
  set title "the paper's ZYZ rule as printed, beta limited to 61 deg"
  plot data.'/reach.csv' every ::1 using 1:2:4 with image notitle
  unset multiplot
  unset output
}
set xrange [*:*]; set yrange [*:*]; set xtics auto; set ytics auto; unset cblabel

$monkey << EOD
20,0
90,55
EOD

# -- the share of the head, its motion, its main sequence, the way past the pole
do for [terminal in 'svg pngcairo'] {
  if (terminal eq 'svg') { set terminal svg size 1100,760 font 'sans,11' background '#ffffff'; set output out.'/head_motion.svg' }
  else { set terminal pngcairo size 1100,760 font 'sans,11'; set output out.'/head_motion.png' }
  set multiplot layout 2,2
  set key inside top left
  set title 'who turns how far in a gaze shift to the side'
  set xlabel 'gaze shift [deg]'; set ylabel '[deg]'
  plot data.'/share.csv' every ::1 using 1:2 lw 3 lc rgb color(1) title 'head', \
       '' every ::1 using 1:3 lw 1.5 lc rgb color(3) title 'eyes in the head', \
       '' every ::1 using 1:($1 <= 90 ? $4 : 1/0) lw 1.5 dt 2 lc rgb color(1) title 'head, up and down', \
       $monkey using 1:2 with points pt 7 lc rgb '#333333' title 'end points of Freedman and Sparks 1997'
  set title 'head in time after a target appears at 0 s'
  set xlabel 'time [s]'; set ylabel 'head [deg]'
  plot for [k = 0:4] data.'/shift.csv' every ::(k == 0 ? 1 : 0) index k using 2:3 lw 2 lc rgb color(1) notitle
  set title 'peak speed by amplitude of the head'
  set xlabel 'amplitude [deg]'; set ylabel '[deg/s]'
  plot data.'/speed.csv' every ::1 using 1:2 with linespoints lw 2 pt 7 ps 0.6 lc rgb color(1) title 'ours', \
       [0:65] 4*x lw 1 dt 2 lc rgb '#888888' title '4 /s times amplitude'
  set title 'a gaze passes the pole at 0.001 rad in steps of 0.0001 rad'
  set xlabel 'way along the path [rad]'; set ylabel 'change in one step [rad]'
  set logscale y; set format y '10^{%T}'; set xrange [-0.01:0.01]; set yrange [1e-5:10]; set key top right
  plot data.'/zyz_pass.csv' every ::1 using 1:5 lw 1.5 lc rgb color(5) title 'alpha, paper as printed', \
       '' every ::1 using 1:6 lw 1.5 lc rgb color(3) title 'alpha, exact', \
       '' every ::1 using 1:7 lw 3 lc rgb color(1) title 'largest step of a joint of the neck'
  unset multiplot
  unset output
  unset logscale; set format; set xrange [*:*]; set yrange [*:*]
}

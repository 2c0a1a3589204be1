# Charts of the eyes. Called with: data = folder of `eye_control --chart`, out = folder of the pictures; people = folder of
# recordings and scene = trace of scripts/scenes/follow.dlg, each drawn when it is there.
set datafile separator ","
set grid lc rgb "#dddddd" lt 1
set border lc rgb "#555555"
set style line 1 lc rgb "#1b6ca8" lw 2 pt 7 ps 0.6
set style line 2 lc rgb "#d1495b" lw 2 pt 5 ps 0.6
set style line 3 lc rgb "#2e933c" lw 2 pt 9 ps 0.7
set style line 4 lc rgb "#edae49" lw 2 pt 11 ps 0.7
set style line 5 lc rgb "#6a4c93" lw 2 pt 13 ps 0.7
set style line 6 lc rgb "#333333" lw 2 pt 3 ps 0.7
set style line 7 lc rgb "#999999" lw 1.5 dt 2

# published values of people: lag in ms at 1.25 Hz; peak velocity and its SD by amplitude
$sine_people << EOD
1.25,43
EOD
$saccade_people << EOD
5,213,29
15,352,50
30,455,67
45,502,32
EOD

file(name) = data . "/" . name . ".csv"
there(path) = int(system("test -r '" . path . "' && echo 1 || echo 0"))
if (!exists("people")) people = "none"
if (!exists("scene")) scene = "none"
pursuit_people = people . "/human_pursuit_spm.csv.gz"
saccades_people = people . "/human_saccades_mcsorley.csv"
sequence_people = people . "/human_main_sequence_lund.csv"

# directions of a frame that is turned by a quaternion, deg: its z axis to the person's right and up
degrees(x) = x * 180 / pi
right_of(w, x, y, z) = degrees(atan2(-2 * (x * z + w * y), 1 - 2 * (x * x + y * y)))
# a point of the head (the left eye) in the world
turned_x(w, x, y, z, a, b, c) = (1 - 2 * (y * y + z * z)) * a + 2 * (x * y - w * z) * b + 2 * (x * z + w * y) * c
turned_z(w, x, y, z, a, b, c) = 2 * (x * z - w * y) * a + 2 * (y * z + w * x) * b + (1 - 2 * (x * x + y * y)) * c

do for [kind in "svg png"] {
  if (kind eq "svg") { set terminal svg size 1200,450 font "sans,12" background "white" } \
  else { set terminal pngcairo size 1200,450 font "sans,11" background "white" }

  # error against cost, one panel a target and grid
  set output sprintf("%s/eye_work_precision.%s", out, kind)
  set multiplot layout 1,3 title "Integrating the pursuit loop: error against cost (steps of 10 to 0.25 ms, frames of 1/60 to 1/960 s)"
  set logscale xy
  set xlabel "processor time, us per simulated second"
  set ylabel "largest error of eye velocity, deg/s"
  set format y "10^{%T}"
  set yrange [1e-10:10]
  set key bottom left samplen 2
  methods = "euler zoh heun foh rk4_linear rk4_hermite"
  titles = "ramp,~delays~in~whole~steps ramp,~steps~of~a~frame~rate sine~1~Hz,~delays~in~whole~steps"
  panels = "ramp_aligned ramp_frames sine_aligned"
  do for [k = 1:3] {
    set title system(sprintf("echo '%s' | tr '~' ' '", word(titles, k)))
    plot for [m = 1:6] file("work_precision") using (strcol(1) eq word(panels, k) && strcol(2) eq word(methods, m) ? $4 : NaN):5 \
           with linespoints ls m title system("echo " . word(methods, m) . " | tr _ ' '"), \
         0.05 with lines ls 7 title "visible"
  }
  unset multiplot
  unset logscale
  set format y "%g"
  set autoscale

  # where the loops oscillate for ever: analysis as lines, measured as points
  set output sprintf("%s/eye_stability.%s", out, kind)
  set multiplot layout 1,2 title "Stability: boundaries by analysis (lines) and by simulation (points); stable below"
  set title "the whole loop: pursuit gain against a visual delay that the copy does not know"
  set xlabel "visual delay minus the delay the copy believes in, ms"
  set ylabel "pursuit gain P"
  set yrange [0:3]
  set xrange [-60:240]
  set key top right
  plot file("stability_gain") using 1:2 with lines ls 6 title "characteristic equation", \
       "" using 1:3 with points ls 1 title "step 1 ms", \
       "" using 1:4 with points ls 3 title "step 5 ms", \
       "" using 1:5 with points ls 2 title "step 15 ms", \
       0.95 with lines ls 7 title "P = 0.95"
  set title "the local loop: gain times delay against the step"
  set xlabel "steps per delay"
  set ylabel "K t_m"
  set xrange [1:60]
  set yrange [0.5:2.2]
  set logscale x
  plot file("stability_local") using 1:2 with lines ls 2 title "Euler, 2 d sin(π / (4 d + 2))", \
       "" using 1:3 with points ls 2 notitle, \
       "" using 1:4 with lines ls 1 title "trapezoid, 2 d tan(π / 4 d)", \
       "" using 1:5 with points ls 1 notitle, \
       pi / 2 with lines ls 6 title "the equation itself, π / 2", \
       0.75 with lines ls 7 title "used, 0.75"
  unset multiplot
  unset logscale
  set autoscale

  # smooth pursuit
  set output sprintf("%s/eye_pursuit.%s", out, kind)
  set multiplot layout 1,3 title "Smooth pursuit"
  set title "ramps of 5, 10, 20 and 30 deg/s"
  set xlabel "time after target onset, s"
  set ylabel "eye velocity, deg/s"
  set xrange [0:0.8]
  set key bottom right
  plot file("ramps") using 1:2 with lines ls 1 title "5", "" using 1:3 with lines ls 2 title "10", \
       "" using 1:4 with lines ls 3 title "20", "" using 1:5 with lines ls 4 title "30", \
       "" using 1:6 with lines ls 7 title "10, linear"
  set title "initial acceleration"
  set xlabel "target speed, deg/s"
  set ylabel "mean over 80 to 180 ms, deg/s^2"
  set xrange [0:50]
  set yrange [0:180]
  plot file("accelerations") using 1:2 with linespoints ls 1 title "model", \
       "" using 1:3 with points ls 2 title "people, rightward", "" using 1:4 with points ls 3 title "people, leftward"
  set title "sines of 20 deg/s peak"
  set xlabel "frequency, Hz"
  set ylabel "lag, ms"
  set xrange [0:2.1]
  set yrange [-20:220]
  set key center right
  plot file("sines") using 1:5 with linespoints ls 2 title "without prediction", \
       "" using 1:3 with linespoints ls 1 title "with prediction", \
       $sine_people using 1:2 with points ls 6 title "people (Barnes 2000)"
  unset multiplot
  set autoscale

  # saccades
  set output sprintf("%s/eye_saccades.%s", out, kind)
  set multiplot layout 1,3 title "Saccades"
  set title "peak velocity"
  set xlabel "amplitude, deg"
  set ylabel "deg/s"
  set xrange [0:52]
  set yrange [0:650]
  set key bottom right
  plot file("main_sequence") using 1:3 with lines ls 1 title "model", \
       $saccade_people using 1:2:3 with yerrorbars ls 2 title "people, mean and SD"
  set title "duration (above 20 deg/s)"
  set ylabel "ms"
  set yrange [0:180]
  plot file("main_sequence") using 1:2 with lines ls 1 title "model", \
       2.2 * x + 21 with lines ls 2 title "2.2 A + 21 (clinical)", 2.7 * x + 23 with lines ls 3 title "2.7 A + 23"
  set title "velocity of 2, 5, 10, 20 and 40 deg"
  set xlabel "time after target step, s"
  set ylabel "deg/s"
  set xrange [0.19:0.33]
  set yrange [0:550]
  set key off
  plot for [k = 2:6] file("profiles") using ($1 + 0.2):k with lines ls k - 1
  set key on
  unset multiplot
  set autoscale

  # eyes and head, vergence
  set output sprintf("%s/eye_gaze.%s", out, kind)
  set multiplot layout 1,3 title "Eyes and head, and vergence"
  set xlabel "time after target step, s"
  set ylabel "deg"
  set xrange [-0.1:1.2]
  set key bottom right
  do for [k = 0:1] {
    set title k == 0 ? "gaze shift of 40 deg" : "gaze shift of 120 deg"
    plot file("gaze_shift") using 1:(column(2 + 2 * k) + column(3 + 2 * k)) with lines ls 6 title "gaze", \
         "" using 1:(column(2 + 2 * k)) with lines ls 1 title "eye in head", "" using 1:(column(3 + 2 * k)) with lines ls 2 title "head"
  }
  set title "vergence step between 2 and 6 deg"
  set key center right
  plot file("vergence") using 1:2 with lines ls 1 title "converging", "" using 1:3 with lines ls 2 title "diverging", \
       "" using 1:4 with lines ls 3 title "with a 10 deg saccade", \
       "" using 1:5 with lines ls 7 title "plain delayed feedback, 5 /s"
  unset multiplot
  set autoscale

  # beside recordings of people
  if (there(pursuit_people) && there(saccades_people) && there(sequence_people)) {
    set output sprintf("%s/eye_people.%s", out, kind)
    set multiplot layout 1,4 title "The model beside recordings (* hidden from the people for two stretches, never from the model)"
    do for [c in "FS SS"] {
      set title (c eq "FS" ? "sine of 22 deg/s *" : "sine of 18 deg/s *")
      set xlabel "time, s"
      set ylabel "gaze minus target, deg"
      set yrange [-2:2]
      set key bottom left
      plot sprintf("< zcat %s | awk -F, '$1 == \"%s\" && $2 %% 10 == 0'", pursuit_people, c) using ($2 / 1000):($6 - $5) with lines ls 2 title "people", \
           file("recorded_pursuit") using (strcol(1) eq c ? $2 : NaN):($4 - $3) with lines ls 1 title "model"
    }
    set autoscale
    chosen = "< awk -F, '$2 > 75 && $2 < 600 && $8 > 3 && !seen[$1]++ { print $2 }' " . saccades_people . " | sort -n"
    stats chosen using 1 nooutput
    set title "latency of saccades"
    set xlabel "latency, ms"
    set ylabel "share"
    set xrange [80:400]
    set yrange [0:1]
    set key bottom right
    plot chosen using 1:(($0 + 0.5) / STATS_records) with steps ls 2 title "people", \
         file("latencies") using 2:1 with lines ls 1 title "model"
    set autoscale
    set title "main sequence"
    set xlabel "amplitude, deg"
    set ylabel "peak velocity, deg/s"
    set xrange [0:30]
    set yrange [0:800]
    plot sequence_people using 1:3 with points pt 7 ps 0.2 lc rgb "#d1495b" title "people, Lund", \
         saccades_people using 8:9 with points pt 7 ps 0.2 lc rgb "#edae49" title "people, McSorley", \
         file("main_sequence") using 1:3 with lines ls 1 title "model"
    unset multiplot
    set autoscale
  }

  # the scene in which the sailor follows a ball
  if (there(scene)) {
    set output sprintf("%s/eye_scene.%s", out, kind)
    set multiplot layout 2,1 title "The sailor follows a ball (scripts/scenes/follow.dlg)"
    unset title
    set xlabel ""
    set lmargin 9
    set xrange [0:22.5]
    set yrange [-60:40]
    set xtics 2
    set ylabel "to the right, deg"
    set key bottom right horizontal
    a = 0.028873471; b = 0.030147129; c = 0.085137362
    plot scene using 1:(degrees(atan2(-($2 - $5 - turned_x($8, $9, $10, $11, a, b, c)), $4 - $7 - turned_z($8, $9, $10, $11, a, b, c)))) with lines ls 6 title "ball, seen from the left eye", \
         scene using 1:(right_of($12, $13, $14, $15)) with lines ls 1 title "gaze of that eye", \
         scene using 1:(right_of($8, $9, $10, $11)) with lines ls 2 title "head"
    set xlabel "time, s"
    set ylabel "deg"
    set yrange [0:12]
    set key top right horizontal
    plot scene using 1:(degrees($16)) with lines ls 4 title "gaze error", \
         scene using 1:(degrees($17)) with lines ls 3 title "vergence", \
         scene using 1:(10 * $18) with lines ls 7 title "trust in the forecast, tenths"
    unset multiplot
    set autoscale
    set xtics auto
    unset lmargin
  }

  # what the methods cost and are worth
  set output sprintf("%s/eye_methods.%s", out, kind)
  set title "Methods: angle to the gaze of the whole model against cost"
  set xlabel "processor time of one figure and millisecond, ns (what is seen included)"
  set ylabel "root mean square, deg"
  set xrange [0:450]
  set yrange [-0.5:7]
  set key off
  plot file("methods") using 3:2 with linespoints ls 1, "" using 3:2:1 with labels offset 0,1.2 noenhanced
  set key on
  set autoscale
  unset title
  unset output
}

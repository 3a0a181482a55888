#!/bin/bash
# Installs the build to a folder of its own, builds the examples against it as a user would, and runs them.
#   examples.sh BUILD_DIR WORK_DIR
set -euo pipefail
build=$1 work=$2
rm -rf "$work"
mkdir -p "$work"
cmake --install "$build" --prefix "$work/usr" > "$work/install.log"
"$work/usr/bin/handloop" --version
"$work/usr/bin/handloop" arm show --axis x > /dev/null

launcher=$(command -v ccache || true)
cmake -G Ninja -S "$work/usr/share/doc/handloop/examples" -B "$work/build" -DCMAKE_BUILD_TYPE=Release \
      -DCMAKE_PREFIX_PATH="$work/usr" ${launcher:+-DCMAKE_CXX_COMPILER_LAUNCHER=$launcher} > "$work/configure.log"
cmake --build "$work/build" -j 2 > "$work/build.log" || { tail -30 "$work/build.log"; exit 1; }

cd "$work"
build/margins_of_a_wall
build/model_with_an_effect
grep -q coulomb_friction arm_with_friction.toml
build/own_controller | tee controller.txt
grep -q 'fault: none' controller.txt
# A brake damps: the margin grows and a pull comes less far. A wall turns the bench round before 5 mm.
build/own_effect | tee effect.txt
awk '/gain margin/ { margin[++n] = $0; sub(/.*gain margin /, "", margin[n]); way[n] = $(NF - 1) }
  END { exit !(n == 2 && margin[2] + 0 > margin[1] + 0 && way[2] < way[1] && way[2] > 0) }' effect.txt
build/own_device | tee device.txt
grep -q 'fault: none' device.txt
awk '/deepest/ { exit !($5 > 1 && $5 < 5) }' device.txt
# A recording of a spring: x = F / (300 N/m), with some noise so that nothing is degenerate.
awk 'BEGIN { srand(1); print "time_s,force_N,position_m"
  for (i = 0; i < 20000; i++) { f = 0.9 * f + rand() - 0.5; printf "%.3f,%.6f,%.9f\n", i / 1000, f, f / 300 + 1e-6 * rand() } }' > recording.csv
build/recording_to_report recording.csv report.html
grep -q '<svg' report.html
echo "examples run"

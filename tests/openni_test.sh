#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# `resight recognize --camera openni2` with a camera that a test driver shows, and with a recording of it that OpenNI2
# plays. Usage: openni_test.sh PATH_OF_RESIGHT LIB_OPENNI2 TEST_DRIVER RECORD_CAMERA
set -uo pipefail
resight=$(realpath "$1")
library=$(realpath "$2")
driver=$(realpath "$3")
record_camera=$(realpath "$4")
source "$(dirname "${BASH_SOURCE[0]}")/small_scene.sh"
cd "$work" || exit 1

# OpenNI2 looks for drivers beside its library.
mkdir -p {camera,player,none}/OpenNI2/Drivers
for folder in camera player none; do cp "$library" $folder/libOpenNI2.so.0; done
cp "$driver" camera/OpenNI2/Drivers/libSequenceDriver.so.0
cp "$(dirname "$library")/OpenNI2/Drivers/libOniFile.so.0" player/OpenNI2/Drivers
export RESIGHT_TEST_SEQUENCE=$PWD/scene/test/000001

write_scene 3 -90 -90 true >scene.toml
run simulate scene.toml --out scene --format bop --seed 1
run train scene/models --out models.resight
run recognize --models models.resight --sequence scene/test/000001 --poses fixed --max-views 1 --out recorded
check_places() { # check_places RESULTS: objects are where the sequence shows them, not on the other side
  awk -F, 'FNR == 1 { next }
           { split($6, t, " ") }
           NR == FNR { x_mm[$3] = t[1]; next }
           $3 in x_mm { ++n; d = t[1] - x_mm[$3]; if (d * d > 400) exit wrong = 1 }
           END { exit wrong || !n }' recorded/detections.csv "$1/detections.csv" || fail "$1: objects are elsewhere"
}
recognize=("$resight" recognize --models models.resight --camera openni2 --stream)

LD_LIBRARY_PATH=camera "${recognize[@]}" --out live >lines 2>err &
program=$!
for _ in $(seq 600); do
  [ "$(wc -l <lines)" -ge 2 ] || ! kill -0 $program 2>/dev/null && break
  sleep 0.1
done
kill -TERM $program  # a shell lets its jobs ignore SIGINT
wait $program || fail "a stop ends with status $?: $(tail -1 err)"
[ "$(wc -l <lines)" -ge 2 ] || fail "no views of the camera: $(cat err)"
grep -q 'focal length 262.5 px' err || fail "the focal length is not that of the field of view: $(cat err)"
grep -q '"object": *"tea_box"' live/detections.json || fail "the tea is not recognised"
check_places live
grep -q '"sequence": *"openni2"' live/summary.json || fail "summary.json does not name the camera"

! grep -q 'does not register' err || fail "a warning of depth that is registered: $(cat err)"

RESIGHT_TEST_UNREGISTERED=1 LD_LIBRARY_PATH=camera timeout 60 "${recognize[@]}" --max-views 1 --out other >lines 2>err
grep -q 'warning: .*does not register its depth to its colours' err || fail "no word of unregistered depth: $(cat err)"

# A recording ends by itself.
LD_LIBRARY_PATH=camera timeout 60 "$record_camera" "$PWD/camera.oni" 20 >log 2>&1 || fail "not recorded: $(cat log)"
LD_LIBRARY_PATH=player timeout 120 "$resight" recognize --models models.resight --camera "openni2:$PWD/camera.oni" \
  --out played --stream >lines 2>err || fail "a recording ends with status $?: $(tail -1 err)"
[ "$(wc -l <lines)" -ge 1 ] || fail "no views of the recording: $(cat err)"
grep -q '"object": *"tea_box"' played/detections.json || fail "the tea is not recognised in the recording"
check_places played
grep -q 'note: .*does not tell whether its depth is registered' err || fail "no word of the registration: $(cat err)"

LD_LIBRARY_PATH=player timeout 60 "$resight" recognize --models models.resight --camera "openni2:$PWD/scene.toml" \
  --out no >lines 2>err
[ $? = 2 ] || fail "a file that is no recording is no bad input: $(cat err)"

LD_LIBRARY_PATH=camera timeout 60 "${recognize[@]}" --out no --every 2 >lines 2>err
[ $? = 2 ] || fail "--every is no bad input for a camera: $(cat err)"
grep -q 'resight: --every does not apply' err || fail "the message does not name --every: $(cat err)"

mkfifo pipe.oni
LD_LIBRARY_PATH=player timeout 60 "$resight" recognize --models models.resight --camera "openni2:$PWD/pipe.oni" \
  --out no >lines 2>err
[ $? = 2 ] || fail "a pipe is no bad input: $(cat err)"
grep -q 'pipe.oni: is not a file' err || fail "the message does not say that a pipe is not a file: $(cat err)"

LD_LIBRARY_PATH=none timeout 60 "${recognize[@]}" --out no >lines 2>err
[ $? = 2 ] || fail "a missing camera is no bad input: $(cat err)"
[ "$(wc -l <err)" = 1 ] || fail "expected one line without a camera: $(cat err)"
[ ! -e no ] || fail "a missing camera leaves results"

[ $failures = 0 ] && echo "all as it should be"
exit $failures

#!/bin/bash
# An error or a time in place of a preset: plan says which settings it takes, the stages take them, and only what they change
# runs again.
. "$(dirname "$0")/../lib/chain.sh"
capture=$root/front
mkdir -p "$capture/photos"
"$VARIANT" half "$PHOTO" "$capture/photos/right_a.jpg"
asks() { { sed 's/^camera.focal_px.*/camera.focal_px = 5913.045/' samples/demo/capture.conf; echo "$1"; } >"$capture/capture.conf"; }
setting() { sed -n 's/.*"setting": "\(.*\)".*/\1/p' "$capture/work/plan.json" | tr '\n' ';'; }
scale() { "$BIN/unrefract" --capture="$capture" --print-config | sed -n 's/^unrefract.scale = //p'; }

asks "error = 0.02 mm"
"$BIN/plan" --capture="$capture" >"$log" 2>&1
same "plan: exit" "$?" 0
same "plan says which in one line" "$(grep -c '^plan: error = 0.02 mm: .*unrefract [a-z_]* (0.01[0-9]* mm)' "$log")/$(wc -l <"$log")" "1/1"
check "plan.json has the question" grep -q '"asked": "error = 0.02 mm"' "$capture/work/plan.json"
check "and the settings" grep -q 'scale = .*mm)' <<<"$(setting)"
"$BIN/plan" --capture="$capture" >"$log" 2>&1
same "asked again, plan says nothing" "$(cat "$log")" ""
run_make "$capture" unrefract
same "make with an error" "$? $(ran)" "0 limbus unrefract"
coarse=$(scale) texture=$(sha256sum <"$capture/work/iris/texture.exr")

asks "error = 0.0199 mm"
run_make "$capture" unrefract
same "another error, the same settings: nothing runs" "$? $(ran)" "0 "
asks "error = 0.0001 mm"
run_make "$capture" unrefract
same "a smaller error runs the stage whose setting it changes" "$? $(ran)" "0 unrefract"
check "and says what it cannot reach" grep -q "the best there is" <<<"$("$BIN/plan" --capture="$capture" --show; rm "$capture/work/.made/front"; "$BIN/plan" --capture="$capture" 2>&1)"
check "it is finer" awk "BEGIN { exit !($(scale) > $coarse) }"
check "and so is the texture" test "$(sha256sum <"$capture/work/iris/texture.exr")" != "$texture"
asks "error = 0.0001 mm
unrefract.scale = 0.3"
run_make "$capture" plan
same "a key in capture.conf goes before" "$(scale)" 0.3

asks "time = 1 ms"
run_make "$capture" plan
quick=$(setting)
asks "time = 10 min"
run_make "$capture" plan
check "more time buys other settings" test "$(setting)" != "$quick"

for bad in "error = 0.05" "time = 2" "error = 3 furlong" "time = 2 s
error = 1 mm" "quality = draft
time = 2 s"; do
	asks "$bad"
	run_make "$capture"
	check "refused: $bad" test "$?" != 0
	same "refused in one line: $bad" "$(grep -c '^plan: .*capture.conf' "$log") $(ran)" "1 "
done
# More keys than fit a line of the measured fronts.
face=$root/face
mkdir -p "$face/video" && cp -r samples/face/{subject.ply,capture.conf,targets} "$face" && cp samples/face/video/face.mp4 "$face/video"
of_track() { "$BIN/track" --capture="$face" --print-config | sed -n "s/^track.$1 = //p"; }
asks_face() { { cat samples/face/capture.conf; echo "$1"; } >"$face/capture.conf" && "$BIN/plan" --capture="$face" >"$log" 2>&1; }
check "an error of the video" asks_face "error = 2.9 px"
exact="$(of_track sweeps) $(of_track torsion_rays)"
check "a larger one" asks_face "error = 6 px"
check "takes quicker settings, to the last key" test "$(of_track sweeps)" -le "${exact% *}" -a "$(of_track torsion_rays)" -lt "${exact#* }"

asks "time = 2 s"
rm -rf "$capture/work"
"$BIN/unrefract" --capture="$capture" >"$log" 2>&1
same "a stage before its plan: exit" "$?" 1
check "a stage before its plan: says what to run" grep -q "no setting is chosen yet: run plan first" "$log"
exit 0

#!/bin/bash
# What leaves for other programs: layers of an eye and of a face, the turntable as a film, a character's clip.
. "$(dirname "$0")/../lib/chain.sh"
LAYERS=$PWD/${B:-build}/tests/tools/layers FRAMES=$PWD/${B:-build}/tests/tools/frames

capture=$root/eye
new_capture "$capture"
"$VARIANT" half "$PHOTO" "$capture/photos/right_a.jpg"
sed -i 's/^camera.focal_px.*/camera.focal_px = 5913.045/' "$capture/capture.conf"
printf '%s\n' "render.exr = yes" "render.film = yes" "render.frame_px = 128" "render.size_px = 320" "render.frames = 1" >>"$capture/capture.conf"
run_make "$capture"
same "an eye with layers and a film" "$?" 0
for view in front three_quarter; do
	check "$view: diffuse and specular light are the picture, normals are normals" "$LAYERS" "$capture/work/render/${view}_layers.exr" "$capture/work/render/$view.exr"
done
same "the turntable as a film" "$("$FRAMES" "$capture/work/render/turntable.mp4" 2>&1 | sed 's/, moves.*//')" "120 frames, 30.0 a second, 128 x 128, 0 damaged"
check "and the eye turns in it" test "$("$FRAMES" "$capture/work/render/turntable.mp4" | sed 's/.* //; s/\..*//')" -ge 3

capture=$root/face
"${B:-build}/tests/tools/made_face" "$capture"
echo "render.exr = yes" >>"$capture/capture.conf"
for stage in extrapolate render; do
	"$BIN/$stage" --capture="$capture" --quiet >"$log" 2>&1
	same "$stage of a character" "$? $(cat "$log")" "0 "
done
check "a face's layers, too" "$LAYERS" "$capture/work/render/made_look_layers.exr"
check "its clip can be played and moves" grep -qE '^[1-9][0-9]* frames, .*, 0 damaged, moves by ([1-9]|0\.[2-9])' <<<"$("$FRAMES" "$capture/work/render/made_clip.mp4")"
exit 0

#!/bin/bash
# seeds.sh DIR: whole captures that the fuzz targets of tests/fuzz/capture begin from, DIR/capture_STAGE/NAME each: a photograph and what all
# stages of the iris make of it; a made face with its model, character and film; views of a head; and cases that once went wrong.
cd "$(dirname "$0")/../../.." || exit 1
. tests/lib/chain.sh
out=$1
MADE=${B:-build}/tests/tools/made_face

# pack FOLDER STAGE...: as tests/fuzz/capture/folder.h has it, for these stages; what is longer than 400 KB is left out.
pack() {
	local from=$1 to=$root/packed file stage
	(cd "$from" && find . -type f ! -path './work/.made/*' ! -path './work/log/*' ! -path './work/review/*' ! -path './work/plan*' \
		! -path './work/export/*' -size -400k -printf '%P\n' | sort | while read -r file; do
		printf '@ %s %d\n' "$file" "$(stat -c %s "$file")"
		cat "$file"
	done) >"$to"
	for stage in "${@:2}"; do mkdir -p "$out/capture_$stage" && cp "$to" "$out/capture_$stage/${from##*/}"; done
}

new_capture "$root/eye"
"$VARIANT" half "$PHOTO" "$root/half.jpg" && "$VARIANT" half "$root/half.jpg" "$root/eye/photos/right_a.jpg"
sed -i 's/^camera.focal_px.*/camera.focal_px = 2957/; /^camera.center_px/d' "$root/eye/capture.conf"
printf '%s\n' "render.size_px = 64" "render.frame_px = 64" "render.photo_px = 64" "render.map_size = 128" "render.vein_map_px = 128" \
	"render.look_px = 64" "render.sheet_px = 300" >>"$root/eye/capture.conf"
run_make "$root/eye" || tail -n 2 "$log" >&2
rm -rf "$root"/eye/work/render
pack "$root/eye" plan unrefract freckles heightfield pigment relief refraction render

# limbus looks at each pixel with its network: a smaller picture yet.
cp -r "$root/eye" "$root/small" && rm -rf "$root/small/work"
"$VARIANT" half "$root/eye/photos/right_a.jpg" "$root/small/photos/right_a.jpg"
printf '%s\n' "camera.focal_px = 1478" "limbus.candidates = 2" >"$root/small/capture.conf"
pack "$root/small" limbus

"$MADE" "$root/made"
"$BIN/extrapolate" --capture="$root/made" --quiet
cp "$root/made/targets/made.obj" "$root/made/subject.obj"
mkdir -p "$root/made/script"
printf 'time_s,horizontal_deg,vertical_deg\n0,0,0\n0.1,10,5\n0.2,-10,0\n' >"$root/made/script/look.csv"
printf '%s\n' "render.size_px = 64" "render.look_px = 48" "render.cell_px = 48" "render.blink_frames = 3" "render.sheet_px = 300" "render.clip_px = 48" \
	"render.skin_lights = 4" "render.glb_targets = 4" "render.clip_seconds = 0.05" "train.sample = 64" "transfer.rounds = 1 1 1" \
	"transfer.nodes = 20 40 80" "extrapolate.map_step_px = 32" "track.points = 40" "track.sweeps = 1" "track.settle_frames = 0" >>"$root/made/capture.conf"
pack "$root/made" plan track train transfer extrapolate animate render

mkdir -p "$root/views/views"
for name in a b c; do cp "$root/eye/photos/right_a.jpg" "$root/views/views/$name.jpg"; done
printf '%s\n' "quality = draft" "calibrate.picture_px = 800" "calibrate.features = 256" >"$root/views/capture.conf"
pack "$root/views" plan calibrate

# What once went wrong: STAGE.NAME, a folder in this form.
for file in tests/fuzz/capture/found/*.*; do
	[ -f "$file" ] || continue
	stage=${file##*/} name=${file##*.} stage=${stage%%.*}
	mkdir -p "$out/capture_$stage" && cp "$file" "$out/capture_$stage/found_$name"
done

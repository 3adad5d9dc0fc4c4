#!/bin/bash
# The look in numbers: the exported eye path-traced by Blender's Cycles and drawn by three.js, against render's own still of the same view and
# light. One line a figure; exit status 1 where a goal is missed. Without Blender (apt-get install blender) it is skipped, by name.
#   SAMPLES=256 DEGREES="0 30" tests/bench/look.sh      for the eye: bench/look.png, a row for each view; two by two: bench/look_WHO_DEG.png
. "$(dirname "$0")/../lib/chain.sh"
trap 'rm -rf "$root"' EXIT
SAMPLES=${SAMPLES:-128} DEGREES=${DEGREES:-0 30} missed=0 B=${B:-build} npm=${B:-build}/npm
if ! command -v blender >/dev/null; then
	echo "skipped: bench-look: no blender: apt-get install blender"
	exit 0
fi
mkdir -p bench
capture=$root/eye
new_capture "$capture"
cp "$PHOTO" "$capture/photos"
sed -i 's/^quality.*/quality = review/' "$capture/capture.conf"
run_make "$capture" export || { tail -n 3 "$log"; exit 1; }
export=$capture/work/export

goal() { # WHAT VALUE BOUND
	local ok
	ok=$(awk -v x="$2" -v b="$3" 'BEGIN { print (x != "" && x <= b) }')
	[ "$ok" = 1 ] || missed=1
	printf '%-52s %8s  at most %s: %s\n' "$1" "$2" "$3" "$([ "$ok" = 1 ] && echo reached || echo MISSED)"
}
least_goal() { # WHAT VALUE BOUND
	local ok
	ok=$(awk -v x="$2" -v b="$3" 'BEGIN { print (x != "" && x >= b) }')
	[ "$ok" = 1 ] || missed=1
	printf '%-52s %8s  at least %s: %s\n' "$1" "$2" "$3" "$([ "$ok" = 1 ] && echo reached || echo MISSED)"
}
figure() { printf '%-52s %8s\n' "$1" "$2"; }
said() { sed -n "s/.*$1 \([-0-9.]*\).*/\1/p" "$root/says"; }
# against WHO DEG PICTURE DIFFERENCE
against() {
	local halves=() other=${3%.exr}
	[ ! -s "${other}_1.exr" ] || halves=("${other}_1.exr" "${other}_2.exr")
	"$B/tests/tools/eye_compare" "$export/eye.json" "$2" "$export/reference_$(printf %02d "$2").exr" "$3" "bench/look_$1_$(printf %02d "$2").png" "${halves[@]}" >"$root/says" 2>&1 ||
		{ cat "$root/says"; missed=1; return; }
	goal "$1 at $2 degrees: difference of the eye, CIEDE2000" "$(said ' eye')" "$4"
	figure "$1 at $2 degrees: of the iris, CIEDE2000" "$(said ': iris')"
	goal "$1 at $2 degrees: between the glints, px" "$(said 'glint')" 2
	goal "$1 at $2 degrees: iris detail off, px" "$(sed -n 's/.*detail \([-0-9.]*\) \([-0-9.]*\) px.*/\1 \2/p' "$root/says" | awk '{ printf "%.2f", sqrt($1 * $1 + $2 * $2) }')" 1
	# A path tracer's noise is no difference of the look: what its halves, of a seed each, tell of it is taken off.
	if [ -n "${halves[*]}" ]; then
		figure "$1 at $2 degrees: structural similarity, with noise" "$(said 'structure')"
		least_goal "$1 at $2 degrees: structural similarity" "$(said 'without noise:')" 0.95
	else
		least_goal "$1 at $2 degrees: structural similarity" "$(said 'structure')" 0.95
	fi
	goal "$1 at $2 degrees: between the outlines, px" "$(said 'outlines')" 0.5
}

# shellcheck disable=SC2086
timeout 3000 blender -b --python tests/tools/eye_cycles.py -- "$export" "$root" "$SAMPLES" $DEGREES >"$log" 2>&1 || { tail -n 5 "$log"; exit 1; }
for deg in $DEGREES; do
	against Cycles "$deg" "$root/cycles_$(printf %02d "$deg").exr" 2
done
if command -v chromium >/dev/null && node -e "require('$PWD/$npm/node_modules/three/package.json')" >/dev/null 2>&1; then
	timeout 400 node tests/browser/eye_glb.js "$export" "$npm" "$root" eye.glb >"$log" 2>&1
	for deg in $DEGREES; do
		against three.js "$deg" "$root/eye_$(printf %02d "$deg").npy" 3
	done
else
	echo "skipped: bench-look in three.js: no chromium, or npm could not install three"
fi
rows=()
there_or() { if [ -s "$1" ]; then echo "$1"; else echo -; fi; }
for deg in $DEGREES; do
	at=$(printf %02d "$deg")
	rows+=("$deg degrees" "$export/reference_$at.exr" "$(there_or "$root/eye_$at.npy")" "$(there_or "$root/cycles_$at.exr")")
done
"$B/tests/tools/look_sheet" "$export/eye.json" bench/look.png "${rows[@]}" && echo "for the eye: bench/look.png"

# The driven face: its .glb as Blender imports it, its eyes as blender_eye.py assembles them, part by part. What is asked of the eye is asked of each. FACE=no leaves it out.
if [ "${FACE:-yes}" = yes ]; then
	face=$root/face
	cp -r samples/face "$face"
	# glTF knows nothing of light below the skin: neither picture has any.
	# The .glb's animation begins as the picture stands: looking straight ahead, at nothing near.
	sed -i '0,/^0,0,0,1000,/s//0,0,0,1e7,/' "$face"/script/*.csv
	mkdir -p "$face/photos" && cp "$PHOTO" "$face/photos"
	printf '%s\n' "quality = review" "render.look_px = 640" "render.clip_px = 0" "render.blink_frames = 3" "render.sheet_px = 300" "render.skin_scatter_mm = 0" "export.make = yes" >>"$face/capture.conf"
	run_make "$face" || { tail -n 3 "$log"; exit 1; }
	field=$(sed -n 's/^face_field = //p' config/render.conf)
	for layers in "$face"/work/render/*_look_layers.exr; do
		name=${layers##*/} name=${name%_look_layers.exr}
		read -r width height < <("$B/tests/tools/face_compare" "$layers")
		timeout 3000 blender -b --python tests/tools/face_cycles.py -- "$face/work/render/$name.glb" "$face/work/export" "$root/$name.exr" "$SAMPLES" "$width" "$height" "$field" >"$log" 2>&1 || { tail -n 5 "$log"; exit 1; }
		"$B/tests/tools/face_compare" "$layers" "$root/$name.exr" "bench/look_$name.png" "$root/${name}_parts.exr" "$root/${name}_hair.exr" >"$root/says" 2>&1 || { cat "$root/says"; missed=1; }
		while IFS= read -r line; do
			part=${line%%: *} number=$(sed -n 's/.*difference \([0-9.]*\),.*/\1/p' <<<"$line")
			if [ -n "$number" ]; then
				goal "Cycles, $name: $part, CIEDE2000" "$number" 2
				figure "Cycles, $name: $part, structure with noise" "$(sed -n 's/.*structure \([0-9.]*\),.*/\1/p' <<<"$line")"
			else
				goal "Cycles, $name: ${line% [0-9.]* px}, px" "$(sed -n 's/.* \([0-9.]*\) px$/\1/p' <<<"$line")" 0.5
			fi
		done <"$root/says"
	done
	echo "for the eye: bench/look_*.png"
fi
exit $missed

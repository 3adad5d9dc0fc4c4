#!/bin/bash
# What `render` says of artifacts that are missing, halved, of other sizes, no numbers, or of an eye that cannot be: one clear
# line, or the part left out, said so, and the rest drawn.
. "$(dirname "$0")/../lib/chain.sh"

SPOIL=${B:-build}/tests/tools/spoil
good=$root/good
new_capture "$good"
printf 'render.size_px = 96\nrender.frame_px = 64\nrender.photo_px = 128\nrender.map_size = 128\nrender.vein_map_px = 128\n' >>"$good/capture.conf"
cp "$PHOTO" "$good/photos/right_a.jpg"
run_make "$good" relief refraction
same "what render reads is made" "$?" 0
"$BIN/render" --capture="$good" >"$log" 2>&1
same "good artifacts: nothing is left out" "$? $(grep -c 'skipped: .* eye' "$log")" "0 0"

# with NAME COMMAND: a copy of the good folder in which COMMAND has been run; then render.
with() {
	capture=$root/case
	rm -rf "$capture"
	cp -r "$good" "$capture"
	rm -rf "$capture/work/render" "$capture/work/review"
	(cd "$capture" && eval "$2") || fail "$1" "the case could not be made"
	timeout 60 "$BIN/render" --capture="$capture" >"$log" 2>&1
	status=$?
}
refused() { # NAME COMMAND SAYS: exit 1, one line that says so
	with "$1" "$2"
	same "$1: one clear line" "$status $(grep -c -- "$3" "$log")" "1 1"
	check "$1: no half picture" test -z "$(find "$capture/work" -name '*.new*' -o -name '*.tmp')"
}
left_out() { # NAME COMMAND SAYS: said in one line, and the rest is drawn
	with "$1" "$2"
	same "$1: said, and gone on" "$status $(grep -c "skipped: .*$3" "$log")" "0 1"
	check "$1: the rest is drawn" test -s "$capture/work/render/front.png" -a -s "$capture/work/review/viewer.html"
}

for map in relief.exr texture.exr refraction.exr; do
	refused "half a $map" "truncate -s 600 work/iris/$map" "$map: "
done
refused "half a pigment.json" "truncate -s 800 work/iris/pigment.json" "pigment.json:[0-9]*: "
refused "half a texture.json" "truncate -s 300 work/iris/texture.json" "texture.json:[0-9]*: "
refused "a map that is not square" "'$PWD/$SPOIL' oblong Y,T work/iris/relief.exr work/iris/relief.exr" "relief.exr: an iris map is square"
refused "a map of another eye's size" "'$PWD/$SPOIL' extent Y,T work/iris/relief.exr work/iris/relief.exr" "relief.exr: extentMm = "
refused "a map without its channels" "cp work/iris/texture.exr work/iris/relief.exr" "relief.exr: "
refused "an index of refraction below 1" "echo 'eye.index = 0.9' >>capture.conf" "eye.index = 0.9: must be a number in \[1, 2\]"
refused "an iris at the cornea" "echo 'eye.iris_depth_mm = 0' >>capture.conf" "eye.iris_depth_mm = 0: must be"
refused "an iris in front of the limbus" "echo 'eye.iris_depth_mm = 1.5
eye.cornea_radius_mm = 6.5
eye.limbus_radius_mm = 6.2' >>capture.conf" "eye.iris_depth_mm = 1.5: "
refused "a pupil wider than the limbus" "sed -i '/\"pupil\": {/,/}/s/\"a\": [0-9.]*/\"a\": 99999/' work/limbus/*.json" "pupil: a = 99999 px, must be less than the limbus'"

left_out "no relief" "rm work/iris/relief.exr" "relief of right eye: work/iris/relief.exr is missing"
left_out "no pigment" "rm work/iris/pigment.json" "pigment of right eye: work/iris/pigment.json is missing"
left_out "values that are no numbers" "'$PWD/$SPOIL' nan R,G,B,W work/iris/texture.exr work/iris/texture.exr" "they are no numbers"
left_out "a pupil larger than the iris" "sed -i 's/\"r\": [0-9.]*/\"r\": 9.5/' work/iris/texture.json" "says a radius of 9.5 mm"

# Fewer pixels: the same eye, coarser; no texture: nothing to draw, said; no refraction function: solved for each ray.
with "a map of half the size" "'$PWD/$SPOIL' half Y,T work/iris/relief.exr work/iris/relief.exr"
same "a map of half the size is drawn all the same" "$status $(grep -c "skipped: .* eye" "$log")" "0 0"
with "no texture" "rm work/iris/texture.exr work/iris/clean.exr"
same "no texture: said" "$status $(grep -c 'skipped: .*texture.exr is missing' "$log")" "0 1"
with "no refraction function" "rm work/iris/refraction.exr"
same "no refraction function: drawn by the solver" "$status" 0
check "no refraction function: drawn" test -s "$capture/work/render/front.png"

# A character whose mesh has no globes (their vertices are there, their faces are not): spheres stand for them, and it is said.
capture=$root/made
"${B:-build}/tests/tools/made_face" "$capture"
printf 'render.clip_px = 0\n' >>"$capture/capture.conf"
obj=$capture/targets/made.obj
awk '$1 == "v" { n++; x = $2 < 0 ? $2 + 3.1 : $2 - 3.1; globe[n] = x * x + $3 * $3 + $4 * $4 < 1.32 ^ 2 }
	$1 == "f" { split($2, a, "/"); if (globe[a[1]]) next } { print }' "$obj" >"$obj.new" && mv "$obj.new" "$obj"
"$BIN/extrapolate" --capture="$capture" >"$log" 2>&1
same "a mesh without globe: spheres, said" "$? $(grep -c 'spheres' "$log")" "0 1"
timeout 60 "$BIN/render" --capture="$capture" >"$log" 2>&1
same "a mesh without globe: drawn" "$? $(test -s "$capture/work/render/made_look.png" && echo yes)" "0 yes"

#!/bin/bash
# Lamps are told from pale fibres of the iris: a photograph with two softboxes, and one of an iris that no lamp lights.
. "$(dirname "$0")/../lib/chain.sh"
data=${EYEWRIGHT_DATA:-../shared/data}/eyes

# lamps DIR NAME: how many were found in a photograph of it.
lamps() { sed -n 's/.*"lamps": \([0-9]*\).*/\1/p' "$1/work/render/$2_compare.json"; }

new_capture "$root/lit"
cp "$PHOTO" "$root/lit/photos/right_a.jpg"
run_make "$root/lit"
same "both softboxes are found, the one across the pupil's margin as one" "$(lamps "$root/lit" right_a)" 2
if [ ! -d "$data" ]; then
	skip "no lamp where there is none" "no shared data: set EYEWRIGHT_DATA"
	exit 0
fi
new_capture "$root/unlit"
focal() { sed -n 's/.*"f_px": *\([0-9.]*\).*/\1/p' "$1" | head -n 1; }
for g in G01_blue_00 G03_blue_20 G07_blue_35up; do
	cp "$data/$g/photo.jpg" "$root/unlit/photos/left_$g.jpg"
	echo "photo.left_$g.focal_px = $(focal "$data/$g/truth.json")" >>"$root/unlit/capture.conf"
done
run_make "$root/unlit"
for g in G01_blue_00 G03_blue_20 G07_blue_35up; do
	same "no lamp in $g" "$(lamps "$root/unlit" "left_$g")" 0
done

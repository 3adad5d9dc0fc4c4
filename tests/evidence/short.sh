#!/bin/bash
# Short trainings of the networks on drawn eyes: the losses fall. Skipped where torch is not installed. B: build folder.
. tests/lib/check.sh
train() # NAME PROGRAM GENERATOR (or none) [OPTION ...]
{
	local name="short training of the $1" said
	if ! /usr/bin/python3 -c 'import torch, numpy' 2>/dev/null; then
		skip "$name" "needs python3-torch and python3-numpy"
	elif said=$(OMP_WAIT_POLICY=passive /usr/bin/python3 "tests/evidence/$2" ${3:+--make "${B:-build}/tests/evidence/$3"} --short "${@:4}" 2>&1); then
		pass "$name"
	else
		fail "$name" "$(tail -n 1 <<<"$said")"
	fi
}
lessons=$(mktemp)
trap 'rm -f "$lessons"' EXIT
train "evidence network" train.py make_eyes
# Lessons are pictures and labels as make_eyes writes them.
"${B:-build}/tests/evidence/make_eyes" 700000000 40 192 160 > "$lessons"
train "evidence network with lessons" train.py make_eyes --lessons "$lessons" --held "$lessons"
train "strip network" strip.py make_strips
train "network of what hides an iris" occlusion.py make_occlusions
# Heads of another renderer, where its generator is: photographs with labels and ellipses that make_strips can read.
data=${EYEWRIGHT_DATA:-../shared/data}
faces=$data/../tools/faces
if ! [ -e "$faces/rast.c" ] || ! [ -e "$data/meshes" ]; then
	skip "lessons from heads, and how they are turned" "needs $faces and $data"
elif ! /usr/bin/python3 -c 'import numpy, scipy, cv2' 2>/dev/null; then
	skip "lessons from heads, and how they are turned" "needs python3-numpy, python3-scipy and python3-opencv"
else
	: > "$lessons"
	said=$(/usr/bin/python3 tests/evidence/heads.py --faces "$faces" --data "$data" --photographs --poses 1 --first 30000 --count 1 --out "$lessons" 2>&1)
	strips=$("${B:-build}/tests/evidence/make_strips" 1 2 "$lessons" | wc -c)
	if [ "$strips" = $((2 * 8 * (8 * 64 * 128 + 5 * 128))) ]; then pass "lessons from heads"; else fail "lessons from heads" "$strips bytes of strips: $(tail -n 1 <<<"$said")"; fi
	: > "$lessons"
	said=$(/usr/bin/python3 tests/evidence/turned.py --faces "$faces" --data "$data" --first 30000 --count 1 --out "$lessons" 2>&1)
	check "lessons of how heads are turned (it says: $said)" [ "$(wc -c <"$lessons")" = $((72 * (144 * 144 * 3 + 4 * (2 + 2 * 68)))) ]
	train "network of how heads are turned" turn.py "" --lessons "$lessons"
fi

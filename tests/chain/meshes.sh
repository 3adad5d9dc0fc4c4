#!/bin/bash
# Meshes of strangers through plan and transfer: what is wrong with each is mended and said, or refused in one line, and the
# others go on.
. "$(dirname "$0")/../lib/chain.sh"

# face N M UNIT SLITS: a bumpy face of N x M vertices as quads, UNIT mm each; SLITS: the eyes are open.
face() {
	awk -v n="$1" -v m="$2" -v unit="$3" -v slits="$4" '
	function bump(x, y, cx, cy, w, h, t) { return t * exp(-((x - cx) / w) ^ 2 - ((y - cy) / h) ^ 2) }
	function open(x, y) { return ((x + 28) / 9) ^ 2 + ((y - 18) / 4) ^ 2 < 1 || ((x - 27) / 9) ^ 2 + ((y - 19) / 4) ^ 2 < 1 }
	BEGIN {
		for (j = 0; j < m; j++)
			for (i = 0; i < n; i++) {
				x = -60 + 120 * i / (n - 1); y = -60 + 120 * j / (m - 1)
				z = -0.012 * x * x - 0.006 * y * y + bump(x, y, 1, -10, 9, 20, 22) - bump(x, y, -28, 18, 12, 8, 9) \
					- bump(x, y, 27, 19, 13, 8, 8) + bump(x, y, 3, -48, 16, 9, 10) + bump(x, y, -25, 34, 22, 5, 4)
				printf "v %.9g %.9g %.9g\n", x / unit, y / unit, z / unit
			}
		for (j = 0; j < m - 1; j++)
			for (i = 0; i < n - 1; i++) {
				a = j * n + i + 1
				if (!slits || !open(-60 + 120 * i / (n - 1), -60 + 120 * j / (m - 1)))
					print "f", a, a + 1, a + n + 1, a + n
			}
	}'
}

# Each corner of each face gets a vertex of its own.
apart() { awk '$1 == "v" { at[++n] = $0; next }
	$1 == "f" { line = "f"; for (i = 2; i <= NF; i++) { print at[$i]; line = line " " ++c } print line }'; }

capture=$root/meshes
mkdir -p "$capture"/{targets,video}
: >"$capture/video/none.mp4"
face 60 58 1 1 >"$capture/subject.obj"
targets=$capture/targets
cp "$capture/subject.obj" "$targets/own.obj"
face 49 47 1 1 >"$targets/quads.obj"
face 49 47 10 1 >"$targets/centimetres.obj"
face 49 47 1000 1 >"$targets/metres.obj"
face 49 47 1 0 >"$targets/shut.obj"
apart <"$targets/quads.obj" >"$targets/doubled.obj"
awk '$1 == "f" && ++n > 500 && n < 560 { next } { print }' "$targets/quads.obj" >"$targets/hole.obj"
{ cat "$targets/quads.obj"; echo "v 0 0 40"; echo "f 1200 1201 2304"; echo "f 1201 1200 2304"; } >"$targets/tangled.obj"
{ cat "$targets/quads.obj"; echo "v -60 -60 0"; echo "v -60 -60 1"; echo "v -60 -60 2"; echo "f 2304 2305 2306"; } >"$targets/flat.obj"
awk '$1 == "v" { print $1, $2 / 100, $3, 20 * sin($3) }  $1 == "f"' "$targets/quads.obj" >"$targets/needle.obj"
sed '7s/.*/v 0 0 1e38/' "$targets/quads.obj" >"$targets/far.obj"
printf 'ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n' >"$targets/cloud.ply"
head -c 3000 "$targets/quads.obj" >"$targets/cut.obj"

"$BIN/plan" --capture="$capture" --show >"$log" 2>&1
check "plan: no ICP where the topology is the subject's" grep -q '^transfer .*no ICP for those of its own topology' "$log"
mkdir "$root/only"
cp -r "$capture"/{subject.obj,video} "$root/only"
mkdir "$root/only/targets"
cp "$targets/own.obj" "$root/only/targets"
"$BIN/plan" --capture="$root/only" --show >"$log" 2>&1
check "plan: no ICP at all where all have it" grep -q '^transfer .*every character has the subject.s own topology.*no ICP' "$log"
cp "$targets/quads.obj" "$root/only/targets/own.obj"
"$BIN/plan" --capture="$root/only" --show >"$log" 2>&1
check "plan: characters are fitted where none has it" grep -q '^transfer .*fits the characters to the subject ' "$log"

"$BIN/transfer" --capture="$capture" >"$log" 2>&1
same "transfer: those that can be are laid onto the subject" "$?" 0
# says TARGET TEXT: one line of the log, with that text.
says() { same "$1: $2" "$(grep -F "$1" "$log" | grep -c -- "$2")" 1; }
says own "the subject's own topology: vertex goes to vertex, nothing is registered"
says quads ": 1 mm a unit (guessed)"
says centimetres ": 10 mm a unit (guessed)"
says metres ": 1000 mm a unit (guessed)"
says shut ": 1 mm a unit (guessed)"
says hole ": 1 mm a unit (guessed)"
says doubled.obj "vertices lie exactly on others: joined to them"
says tangled.obj "edges belong to three faces or more"
says flat.obj "1 faces without area are passed over"
says needle.obj "of the subject lies on it wherever it is put"
says far.obj "coordinate = 1e+38, must be within 1e+09 of 0"
says cloud.ply "has no faces: a cloud of points cannot be registered"
says cut.obj "no"
for name in own quads centimetres metres shut hole doubled tangled flat; do
	check "$name is there" test -s "$capture/work/targets/$name/registered.ply"
	share=$(sed -n 's/.*"matched_share": *\([0-9.]*\).*/\1/p' "$capture/work/targets/$name/registration.json")
	check "$name: 80 % of it and more lies on the subject" awk -v s="${share:-0}" 'BEGIN { exit !(s > 0.8) }'
done
for name in needle far cloud cut; do
	check "$name: nothing is left of it" test ! -e "$capture/work/targets/$name/registered.ply"
done

rm "$targets"/{own,quads,centimetres,metres,shut,hole,doubled,tangled,flat}.obj
"$BIN/transfer" --capture="$capture" >"$log" 2>&1
same "transfer: where no character can be used it fails, and says why" "$? $(tail -n 1 "$log" | grep -c 'none of the 4 meshes')" "1 1"

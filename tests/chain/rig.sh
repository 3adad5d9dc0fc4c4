#!/bin/bash
# extrapolate and render on a made face: what they write, the same on any number of threads, and what they say of bad input.
. "$(dirname "$0")/../lib/chain.sh"

MADE=${B:-build}/tests/tools/made_face
program() { "$BIN/$1" --capture="$capture" --quiet "${@:2}" >"$log" 2>&1; }

for n in 1 3; do
	capture=$root/$n
	"$MADE" "$capture"
	program extrapolate --threads=$n
	same "extrapolate with $n threads" "$? $(cat "$log")" "0 "
	program render --threads=$n
	same "render with $n threads, without a photograph" "$? $(cat "$log")" "0 "
done
same "3 threads and 1 give the same bytes" "$(bytes_of "$root/3")" "$(bytes_of "$root/1")"
for file in look.png sheet.png blink.png clip.mp4; do
	check "made_$file is there" test -s "$capture/work/render/made_$file"
done
check "the glTF is one" test "$(head -c 4 "$capture/work/render/made.glb")" = glTF
for map in skull skull_normal globe_left globe_right; do
	check "$map.exr is there" test -s "$capture/work/targets/made/$map.exr"
done
check "the page shows the character" grep -q 'made.glb' "$capture/work/review/index.html"

before=$(times_of "$capture" | grep -v '^log/')
program render
same "again: nothing is written" "$? $(times_of "$capture" | grep -v '^log/')" "0 $before"
clip=$(stat -c %Y.%y "$capture/work/render/made_clip.mp4")
echo "render.gaze = 10 -5" >>"$capture/capture.conf"
program render
same "another gaze leaves the clip alone" "$? $(stat -c %Y.%y "$capture/work/render/made_clip.mp4")" "0 $clip"
check "and draws its own picture" test "$(sha256sum <"$capture/work/render/made_look.png")" != "$(sha256sum <"$root/1/work/render/made_look.png")"

# says NAME PROGRAM TEXT: exit 1 and one line with that text.
says() {
	program "$2"
	local status=$?
	same "$1" "$status $(wc -l <"$log") $(grep -c -- "$3" "$log")" "1 1 1"
}
capture=$root/bad
"$MADE" "$capture"
truncate -s 5000 "$capture/work/targets/made/barycentric.npz"
says "a truncated weight file" extrapolate "barycentric.npz"
"$MADE" "$capture"
echo "v 0 0 0" >>"$capture/targets/made.obj"
says "a character with other vertices than were registered" extrapolate "run transfer again"
"$MADE" "$capture"
echo "{}" >"$capture/work/targets/made/registration.json"
says "a registration that says nothing" extrapolate "subject_from_target"
"$MADE" "$capture"
program extrapolate
truncate -s 40000 "$capture/work/targets/made/rig.npz"
says "a truncated rig" render "rig.npz"
program extrapolate
same "is made again" "$?" 0
sed -i '3s/0.0333[0-9]*/-1/' "$capture/work/skin/gaze.csv"
says "time that runs backwards" render "gaze.csv:3: time_s"

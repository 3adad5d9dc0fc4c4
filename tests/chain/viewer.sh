#!/bin/bash
# The interactive page of the bundled capture, driven in a headless Chromium: agreement with the C renderer, hands, keys, names.
. "$(dirname "$0")/../lib/chain.sh"

if ! command -v chromium >/dev/null || ! command -v node >/dev/null; then
	skip "the interactive page in a browser" "no chromium or no node: apt-get install chromium nodejs"
	exit 0
fi
capture="$root/<b>eye & \"co\""
new_capture "$capture"
cp "$PHOTO" "$capture/photos/right_<img src=x onerror=alert(1)>.jpg"
# The eye's pictures as a review has them, and the page of the same maps.
for key in map_size search shadow steps shading_apart bands vein_map_px lights samples size_px; do
	sed -n "s/^$key = /render.$key = /p" config/render.conf
done >>"$capture/capture.conf"
printf 'render.frames = 1\nrender.exr = no\nexport.make = yes\nexport.texture_px = 512\n' >>"$capture/capture.conf"
run_make "$capture"
same "the page is made" "$?" 0
page=$capture/work/review/viewer.html
check "and linked from the review" grep -q 'href="viewer.html"' "$capture/work/review/index.html"
check "no name is live in it" test "$(grep -c '<img src=x\|<b>eye' "$page")" = 0
SHOTS=${SHOTS:-$root/shots}
mkdir -p "$SHOTS"
character=$root/character
"${B:-build}/tests/tools/made_face" "$character"
sed -i '/^render.clip_px/d' "$character/capture.conf"
# Its pictures are there for the review's links alone; the page draws its own.
printf '%s\n' "render.clip_px = 0" "render.look_px = 200" "render.cell_px = 100" "render.blink_frames = 3" "render.sheet_px = 300" >>"$character/capture.conf"
mkdir -p "$character/script"
sed 1d samples/face/script/look_around.csv | head -n 3 | cut -d, -f1-7 >"$character/script/look.csv"
for stage in extrapolate animate render; do
	"$BIN/$stage" --capture="$character" --quiet >"$log" 2>&1
	same "$stage of a character" "$? $(cat "$log")" "0 "
done
# The same folders with hostile text in all their records; names of maps' channels come from expressions and stay away.
cp -r "$capture" "$capture hostile"
cp -r "$character" "$root/spoilt"
rm -f "$root/spoilt/work/skin/"wrinkles.*
for spoilt in "$capture hostile" "$root/spoilt"; do
	node tests/browser/spoil.js "$spoilt"
	rm -rf "$spoilt/work/review"
	"$BIN/render" --capture="$spoilt" --quiet >"$log" 2>&1
	same "pages of hostile records are made" "$? $(cat "$log")" "0 "
done
# A review of records that hold what stages write at worst: figures near nothing and beyond all measure, exponents in sentences.
cp -r "$character" "$root/told"
mkdir -p "$root/told/work/log"
cat >"$root/told/work/log/pigment.json" <<'RECORD'
{"stage": "pigment", "seconds": 1.5, "error": "followed wrongly with a probability of 1.2e-05, must be at most 1e-3",
 "skipped": ["photo_1e5 stays; a picture of 1.23e+07 px"],
 "figures": {"held_by_priors": {"value": 456812.0, "unit": "of 9 directions"}, "refraction_error_mean": {"value": 4.9e-13, "unit": "mm"},
  "scale_sigma": {"value": -2.5e-4, "unit": "%"}}}
RECORD
rm "$root/told/work/review/index.html"
"$BIN/render" --capture="$root/told" --quiet >"$log" 2>&1
same "a review of them is made" "$? $(cat "$log")" "0 "
mkdir "$root/alone"
timeout 300 node tests/browser/review.js "$SHOTS" "$root/alone" "$root/told/work/review/index.html" "$capture/work/review/index.html" \
	"$character/work/review/index.html" >"$root/said" 2>&1
timeout 300 node tests/browser/hostile.js "$capture hostile" "$root/spoilt" >>"$root/said" 2>&1
timeout 600 node tests/browser/viewer.js "$page" "$capture/work/render/front.png" "$capture/work/render/three_quarter.png" "$SHOTS" \
	"$character/work/review/viewer.html" "$character/work/targets/made/rig.npz" "${B:-build}/tests/tools" >>"$root/said" 2>&1
timeout 300 node tests/browser/hands.js "$page" "$character/work/review/viewer.html" >>"$root/said" 2>&1
timeout 300 node tests/browser/leave.js "$page" "$character/work/review/viewer.html" "${B:-build}/npm" >>"$root/said" 2>&1
# A page that may not carry the character's .glb; and what hands do with the page as a tool.
cp -r "$character" "$root/without"
echo 'render.page_glb_mib = 0.5' >>"$root/without/capture.conf"
"$BIN/render" --capture="$root/without" --quiet >"$log" 2>&1
same "a page without its .glb is made" "$? $(cat "$log")" "0 "
mkdir "$root/kept"
timeout 900 node tests/browser/tool.js "$page" "$character/work/review/viewer.html" "$root/without/work/review/viewer.html" "$root/kept" >>"$root/said" 2>&1
timeout 300 node tests/browser/surroundings.js "$page" >>"$root/said" 2>&1
while IFS= read -r line; do
	case $line in
	"pass "*) pass "${line#pass }" ;;
	"fail "*) fail "${line#fail }" "" ;;
	*) [ -n "${VERBOSE:-}" ] && echo "  $line" ;;
	esac
done <"$root/said"
check "the browser's runs came to their ends" grep -q 'without WebGL 2' "$root/said"
check "those of the review, too" grep -q 'without the files beside it' "$root/said"
check "those of hands, too" grep -q 'hands: no error' "$root/said"
check "those of the tool, too" grep -q 'the tool: no error' "$root/said"
check "those in surroundings of files, too" grep -q 'surroundings: no error' "$root/said"
check "those of what leaves, too" grep -q 'leaving: no error' "$root/said"
check "those on hostile text, too" grep -q 'hostile text: no error' "$root/said"
if [ -s "$SHOTS/lines.conf" ]; then
	cat "$SHOTS/lines.conf" >>"$capture/capture.conf"
	run_make "$capture"
	same "make takes the lines the page offered" "$?" 0
	check "and the pigment is where it was put" grep -q "$(sed -n 's/.*melanin = \([0-9.]*\) .*/\1/p' "$SHOTS/lines.conf" | cut -c1-6)" "$capture/work/iris/pigment.json"
fi
# Every line that Keep offers is a key that some stage has, its value within that key's range.
for lines in "$root/kept/"keep_*.conf; do
	name=${lines##*/keep_}
	rm -rf "$root/keep"
	new_capture "$root/keep"
	cp "$PHOTO" "$root/keep/photos"
	cp "$root/kept/sky-2.exr" "$root/keep"
	# Of a key that the capture has already, the line offered takes the place.
	grep -vF -f <(sed 's/ = .*/ = /' "$lines") "$root/keep/capture.conf" >"$root/keep/others"
	cat "$root/keep/others" "$lines" >"$root/keep/capture.conf"
	rm "$root/keep/others"
	"$BIN/plan" --capture="$root/keep" --quiet >"$log" 2>&1
	same "the stages take the lines of ${name%.conf}" "$? $(cat "$log")" "0 "
done
check "there are such lines" test "$(cat "$root/kept/"keep_*.conf | grep -c ' = ')" -gt 60
echo 'render.aperture = 2.5' >>"$root/keep/capture.conf"
"$BIN/plan" --capture="$root/keep" --quiet >"$log" 2>&1
same "and would not take a value out of its range" "$? $(grep -c 'aperture = 2.5' "$log")" "1 1"
sed -i '/^render.aperture/d' "$root/keep/capture.conf"
run_make "$root/keep"
same "make draws in surroundings that were kept" "$?" 0

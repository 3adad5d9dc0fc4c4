#!/bin/bash
# A photograph whose limbus is known roughly only: it is used, and says so, where no photograph of its eye is better; it is left where one is.
. "$(dirname "$0")/../lib/chain.sh"

face=$root/face
mkdir -p "$face/photos"
echo "quality = draft" >"$face/capture.conf"
"${B:-build}/tests/tools/drawn_face" "$face/photos/portrait.png" 2001 22 >"$root/truth"
record=$face/work/limbus/portrait
said() { tr -d ' \n' <"$record.$1.json" | grep -oE "\"$2\":\"?[a-z0-9.]*" | head -n 1 | sed 's/.*://; s/"//'; }
# within EYE: its ellipse is off by no more than the record says.
within() {
	awk -v side="$1" -v known="$(said "$1" known_to)" -v said="$(tr -d ' \n' <"$record.$1.json" | sed 's/.*"ellipse":{\([^}]*\)}.*/\1/')" '
		$1 == side { n = split(said, part, ","); for (i = 1; i <= n; i++) { split(part[i], kv, ":"); v[kv[1]] = kv[2] }
			d = sqrt((v["\"cx\""] - $2) ^ 2 + (v["\"cy\""] - $3) ^ 2); a = v["\"a\""] - $4; exit !(known > 0 && d <= known * $4 && a * a <= (known * $4) ^ 2) }' "$root/truth"
}

run_make "$face"
same "known roughly: exit status" "$?" 0
check "the log says so" grep -q 'portrait.png: used roughly' "$log"
same "and its record, beside the other eye's" "$(said right status) $(said left status)" "rough ok"
check "it is off by less than it says" within right
check "both irises are made" test -s "$face/work/iris/texture.exr" -a -s "$face/work/iris_right/texture.exr"
check "the page says so" grep -q 'A rough fit, for want of a better' "$face/work/review/index.html"
same "once beside its rendering, once beside the photograph; of the other eye nothing of the kind" "$(grep -c 'A rough fit' "$face/work/review/index.html")" 2
mkdir -p "$root/batch"
printf 'face\0' | "$BIN/summary" --capture="$root" --collect >"$log" 2>&1
check "a table of many captures tells it as a doubt" grep -q 'portrait.right: known to 3 % only' "$root/batch/summary.json"
run_make "$face"
same "a second make runs nothing" "$(ran)" ""

limbus() { "$BIN/limbus" --capture="$face" >"$log" 2>&1 </dev/null; }
printf '%s\n' "quality = draft" "limbus.rough_used = 0" >"$face/capture.conf"
limbus
same "never to be used: rejected, the other eye is not" "$? $(said right status) $(said left status)" "0 rejected ok"
run_make "$face"
check "on the page it begins where it was found, to be confirmed" awk -v at="$(sed -n 's/.*data-key="portrait.right" data-ellipse="\([^"]*\)".*/\1/p' "$face/work/review/index.html")" '
	$1 == "right" { split(at, v, " "); exit !(sqrt((v[1] - $2) ^ 2 + (v[2] - $3) ^ 2) < 0.1 * $4 && v[3] > 0.9 * $4 && v[3] < 1.1 * $4) }' "$root/truth"
limbus
check "and what would take it is said" grep -q 'limbus.rough_used = 0.03 takes it' "$log"

echo "quality = draft" >"$face/capture.conf"
"${B:-build}/tests/tools/drawn_face" "$face/photos/second.png" 2001 24 >"$root/second"
limbus
same "a better photograph of both eyes: the rough one is left" "$? $(said right status) $(said left status)" "0 rejected ok"
rm "$face/photos/second.png"
limbus
same "without it: used again" "$? $(said right status)" "0 rough"

run_make "$face"
ellipse=$(grep -o 'data-key="portrait.right" data-ellipse="[^"]*"' "$face/work/review/index.html" | sed 's/.*ellipse="//; s/"//')
echo "photo.portrait.right.limbus_px = $ellipse" >>"$face/capture.conf"
limbus
same "confirmed by the page's line: by hand, and no longer rough" "$? $(said right status) $(said right by_hand)" "0 ok true"

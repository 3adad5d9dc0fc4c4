#!/bin/bash
# A photograph of a face: both eyes are fitted, left and right, and go through all stages; what capture.conf says of either; one eye of it.
. "$(dirname "$0")/../lib/chain.sh"

face=$root/face
mkdir -p "$face/photos"
echo "quality = draft" >"$face/capture.conf"
"${B:-build}/tests/tools/drawn_face" "$face/photos/portrait.png" 2001 7 >"$root/truth"

# near EYE JSON: whether the limbus of that file lies on that eye.
near() {
	awk -v side="$1" -v said="$(tr -d ' \n' <"$2" | sed 's/.*"ellipse":{\([^}]*\)}.*/\1/')" '
		$1 == side { n = split(said, part, ","); for (i = 1; i <= n; i++) { split(part[i], kv, ":"); v[kv[1]] = kv[2] }
			d = sqrt((v["\"cx\""] - $2) ^ 2 + (v["\"cy\""] - $3) ^ 2); exit !(d < 0.1 * $4) }' "$root/truth"
}
files() { (cd "$face/work/limbus" && ls ./*.json | tr '\n' ' '); }

run_make "$face"
same "a face: exit status" "$?" 0
same "both eyes have records, the photograph has none" "$(files)" "./portrait.left.edge.json ./portrait.left.json ./portrait.right.edge.json ./portrait.right.json "
check "the person's left eye is the one on the right of the picture" near left "$face/work/limbus/portrait.left.json"
check "the right one that on its left" near right "$face/work/limbus/portrait.right.json"
check "each has its picture" test -s "$face/work/limbus/portrait.left.png" -a -s "$face/work/limbus/portrait.right.png"
check "each has its iris" test -s "$face/work/iris/texture.exr" -a -s "$face/work/iris_right/texture.exr"
check "and its rendering" test -s "$face/work/render/portrait.left_view.png" -a -s "$face/work/render_right/portrait.right_view.png"
check "the page has both, to be corrected by hand" sh -c "grep -q 'portrait\.left' '$face/work/review/index.html' && grep -q 'portrait\.right' '$face/work/review/index.html'"
for iris in iris iris_right; do
	check "$iris: its white is that beside both eyes" grep -q '"both_eyes": true' "$face/work/$iris/pigment.json"
done
sclera() { tr -d ' \n' <"$face/work/$1/pigment.json" | sed 's/.*"sclera":\[\([^]]*\)\].*/\1/' | awk -F, '{ printf "%.6f %.6f", $1 / $2, $3 / $2 }'; }
same "one person's scleras are of one colour" "$(sclera iris_right)" "$(sclera iris)"
run_make "$face"
same "a second make runs nothing" "$(ran)" ""

limbus() { "$BIN/limbus" --capture="$face" >"$log" 2>&1 </dev/null; }
printf '%s\n' "quality = draft" "photo.portrait.mirrored = yes" >"$face/capture.conf"
limbus
check "a mirrored picture: left and right change places" near right "$face/work/limbus/portrait.left.json"

read -r x y a < <(awk '$1 == "left" { print $2 + 0.05 * $4, $3, $4 }' "$root/truth")
printf '%s\n' "quality = draft" "photo.portrait.left.limbus_px = $x $y $a $a 0" >"$face/capture.conf"
limbus
same "the left eye drawn by hand" "$? $(grep -o '"by_hand": *[a-z]*' "$face/work/limbus/portrait.left.json")" '0 "by_hand": true'
same "does not touch the right one" "$(grep -o '"by_hand": *[a-z]*' "$face/work/limbus/portrait.right.json")" '"by_hand": false'

printf '%s\n' "quality = draft" "photo.portrait.eye = right" >"$face/capture.conf"
run_make "$face"
same "one eye of it asked for: exit status" "$?" 0
check "is that one" near right "$face/work/limbus/portrait.json"
check "and the only one" test -s "$face/work/iris/texture.exr" -a ! -e "$face/work/render/portrait.left_view.png.new"
same "unrefract merges one photograph" "$(grep -o 'of [0-9]* photograph' "$log" | head -n 1)" "of 1 photograph"

# Another photograph of that name, of one eye.
rm -r "$face/work"
printf '%s\n' "quality = draft" >"$face/capture.conf"
limbus
rm "$face/photos/portrait.png"
cp "$PHOTO" "$face/photos/portrait.jpg"
limbus
same "one eye in its place: the face's records are gone" "$(files)" "./portrait.edge.json ./portrait.json "

printf '%s\n' "photo.portrait.middle.hint_px = 1 2 3" >"$face/capture.conf"
limbus
same "an eye that nobody has" "$? $(grep -c 'no photograph is called portrait.middle' "$log")" "1 1"
printf '%s\n' "photo.portrait.mirrored = perhaps" >"$face/capture.conf"
limbus
same "mirrored: yes or no" "$? $(grep -c 'photo.portrait.mirrored = perhaps: must be yes or no' "$log")" "1 1"

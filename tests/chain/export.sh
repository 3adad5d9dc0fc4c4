#!/bin/bash
# The eye for other programs: what make export makes, that Khronos's validator finds nothing in it, and that three.js shows what render shows
# (a headless Chromium), as Blender's Cycles does. Bounds are the project's where they are reached, else a tenth above what is (a colour difference of 2 in Cycles is not).
. "$(dirname "$0")/../lib/chain.sh"

capture="$root/it's an eye"
new_capture "$capture"
cp "$PHOTO" "$capture/photos"
sed -i 's/^quality.*/quality = review/' "$capture/capture.conf"
export=$capture/work/export

run_make "$capture" export
same "make export" "$?" 0
check "the three files" test -s "$export/eye.glb" -a -s "$export/eye_lod1.glb" -a -s "$export/eye_lod2.glb"
check "no picture but its own" test ! -e "$capture/work/render" -a ! -e "$capture/work/review"
check "textures as PNG and EXR" test "$(find "$export/textures" -name '*.png' | wc -l)" = 13 -a "$(find "$export/textures" -name '*.exr' | wc -l)" = 13
check "Python that compiles" python3 -m py_compile "$export/blender_eye.py"
check "no placeholder is left" test "$(cat "$export/engines.md" "$export/blender_eye.py" | grep -c '{{')" = 0
made=$(bytes_of "$capture")
run_make "$capture"
same "the pictures afterwards" "$?" 0
same "make nothing of it again" "$(bytes_of "$capture" | grep export)" "$(grep export <<<"$made")"
check "render says nothing of an export" test "$(grep -c 'eye.glb' "$log")" = 0
rm "$export/textures/iris_albedo.png"
run_make "$capture" export
same "a lost texture comes back, with the same bytes" "$(bytes_of "$capture" | grep export)" "$(grep export <<<"$made")"
run_make "$capture"
same "and no picture is drawn for it" "$? $(grep -c 'pictures:' "$log")" "0 0"
"$BIN/render" --capture="$capture" --only=export --force --threads=1 >"$log" 2>&1
same "one thread, the same bytes" "$(bytes_of "$capture" | grep export)" "$(grep export <<<"$made")"
"$BIN/limbus" --capture="$capture" --only=export >"$log" 2>&1
same "a program without parts refuses one" "$?" 2
"$BIN/render" --capture="$capture" --only=export --export.texture_px=100 >"$log" 2>&1
same "a texture too small is refused" "$?" 2
check "by its key" grep -q 'export.texture_px = 100' "$log"

draft="$root/draft"
new_capture "$draft"
cp "$PHOTO" "$draft/photos"
run_make "$draft"
check "a draft exports where it is asked to" test ! -e "$draft/work/export"
run_make "$draft" export
check "and then does" test -s "$draft/work/export/eye.glb"
face="$root/face"
"${B:-build}/tests/tools/made_face" "$face"
"$BIN/extrapolate" --capture="$face" --quiet >"$log" 2>&1
mkdir "$face/photos"
cp "$PHOTO" "$face/photos"
grep -v '^quality' samples/demo/capture.conf >>"$face/capture.conf"
run_make "$face" export
if command -v node >/dev/null; then
	same "with a character, its lashes and tears stand round the eye" "$(node -e 'const d = require("fs").readFileSync(process.argv[1]), j = JSON.parse(d.subarray(20, 20 + d.readUInt32LE(12)));
		console.log(String(j.meshes.map(m => m.name)))' "$face/work/export/eye.glb")" "iris,pupil_back,sclera,cornea,lashes,tears"
else
	skip "lashes and tears round an eye" "node is not installed"
fi
check "and eye.json says so" grep -q '"meniscus": true' "$face/work/export/eye.json"
run_make "$root/none" export
check "no capture, no export" test ! -e "$root/none/work/export"

npm=${B:-build}/npm
there() { node -e "require('$PWD/$npm/node_modules/$1/package.json')" >/dev/null 2>&1; }
if command -v npm >/dev/null; then
	mkdir -p "$npm"
	for package in gltf-validator three; do
		there $package || (cd "$npm" && timeout 60 npm install --no-audit --no-fund --silent $package >/dev/null 2>&1)
	done
fi
if there gltf-validator; then
	for f in eye eye_lod1 eye_lod2; do
		node -e "require('$PWD/$npm/node_modules/gltf-validator').validateBytes(new Uint8Array(require('fs').readFileSync(process.argv[1])))
			.then(r => console.log(r.issues.numErrors, r.issues.numWarnings))" "$export/$f.glb" >"$log" 2>&1
		same "Khronos's validator on $f.glb: errors, warnings" "$(cat "$log")" "0 0"
	done
else
	skip "Khronos's validator on eye.glb" "no node, or npm could not install gltf-validator"
fi

# against WHO DEG PICTURE EYE_DE GLINT_PX DETAIL_PX
against() {
	"${B:-build}/tests/tools/eye_compare" "$export/eye.json" "$2" "$export/reference_$(printf %02d "$2").exr" "$3" >"$root/says" 2>&1
	[ -n "${VERBOSE:-}" ] && sed "s/^/  $1, /" "$root/says"
	least "$1 at $2 degrees: CIEDE2000 over the eye" "$(sed -n 's/.* eye \([0-9.]*\) .*/\1/p' "$root/says")" "$4"
	least "$1 at $2 degrees: px between the glints" "$(sed -n 's/.*glint \([0-9.]*\) px.*/\1/p' "$root/says")" "$5"
	least "$1 at $2 degrees: px off, the iris' detail" "$(sed -n 's/.*detail \([-0-9.]*\) \([-0-9.]*\) px.*/\1 \2/p' "$root/says" | awk '{ print sqrt($1 * $1 + $2 * $2) }')" "$6"
}

if there three && command -v chromium >/dev/null; then
	timeout 400 node tests/browser/eye_glb.js "$export" "$npm" "$root" >"$root/said" 2>&1
	same "three.js opens all three" "$(cat "$root/said")" "three.js: drawn"
	for deg in 0 30; do
		against three.js $deg "$root/eye_$(printf %02d $deg).npy" 2 2 1
		against "three.js (eye_lod1.glb)" $deg "$root/eye_lod1_$(printf %02d $deg).npy" 2.2 2 1
	done
else
	skip "an exported eye in three.js" "no chromium, or npm could not install three"
fi
if command -v blender >/dev/null; then
	timeout 900 blender -b --python tests/tools/eye_cycles.py -- "$export" "$root" 64 0 >"$log" 2>&1
	against Cycles 0 "$root/cycles_00.exr" 2.2 2 1
else
	skip "an exported eye in Blender's Cycles" "no blender: apt-get install blender"
fi

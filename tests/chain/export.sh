#!/bin/bash
# The eye for other programs: what make export makes, that Khronos's validator finds nothing in it, and that three.js shows what render shows
# (a headless Chromium), as Blender's Cycles does. Bounds are the project's where they are reached, else a tenth above what is.
. "$(dirname "$0")/../lib/chain.sh"

capture="$root/it's an eye"
new_capture "$capture"
cp "$PHOTO" "$capture/photos"
sed -i 's/^quality.*/quality = review/' "$capture/capture.conf"
# Pictures are drawn in passing: small ones. What is exported has sizes of its own.
small=("render.size_px = 128" "render.photo_px = 128" "render.frames = 1" "render.frame_px = 64" "render.look_px = 128" "render.cell_px = 64"
	"render.blink_frames = 3" "render.sheet_px = 300")
printf '%s\n' "${small[@]}" >>"$capture/capture.conf"
export=$capture/work/export

run_make "$capture" export
same "make export" "$?" 0
check "the three files" test -s "$export/eye.glb" -a -s "$export/eye_lod1.glb" -a -s "$export/eye_lod2.glb"
check "no picture but its own" test ! -e "$capture/work/render" -a ! -e "$capture/work/review"
check "textures as PNG and EXR" test "$(find "$export/textures" -name '*.png' | wc -l)" = 13 -a "$(find "$export/textures" -name '*.exr' | wc -l)" = 13
check "Python that compiles" python3 -m py_compile "$export/blender_eye.py"
# A surface mirrors as much in each version of Blender, which has each name that is used: 4.0 renamed colour spaces and took the index beside "Specular".
same "which means the same to Blender 3.4 to 5.0" "$(python3 tests/tools/blender_names.py "$export" 2>&1 | sed 's/^[0-9.]*: //' | sort -u)" \
	"mirrors $(awk -v n="$(sed -n 's/.*"index": \([0-9.]*\).*/\1/p' "$export/eye.json" | head -n 1)" 'BEGIN { printf "%.6f", ((n - 1) / (n + 1)) ^ 2 }'); exr Linear, exr Non-Color, png Non-Color"
check "no placeholder is left" test "$(cat "$export/engines.md" "$export/blender_eye.py" | grep -c '{{')" = 0
# Each row of a parameter says what of it holds; each number it gives is one of eye.json.
same "engines.md: every row says what is exact" "$(awk -F'|' '/^## /{ part = $0 } part ~ /Unity|Unreal/ && /^\| / && !/^\| (property|parameter) / && $4 !~ /exact|near|by eye|one number/' "$export/engines.md")" ""
check "and names its documents" test "$(grep -c 'Sources: ' "$export/engines.md")" = 2
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
made=$(bytes_of "$draft" | grep export)
run_make "$draft"
same "which the pictures leave as it is" "$(bytes_of "$draft" | grep export)" "$made"
sed -i '/^eye.iris_depth_mm/d' "$draft/capture.conf"
echo "eye.iris_depth_mm = 3.5" >>"$draft/capture.conf"
run_make "$draft"
check "and that of another eye is put aside, not lost" test ! -e "$draft/work/export" -a -s "$draft/work/.made/aside/export/eye.glb"
face="$root/face"
"${B:-build}/tests/tools/made_face" "$face"
"$BIN/extrapolate" --capture="$face" --quiet >"$log" 2>&1
mkdir "$face/photos"
cp "$PHOTO" "$face/photos"
{ grep -v '^quality' samples/demo/capture.conf; printf '%s\n' "${small[@]}"; } >>"$face/capture.conf"
run_make "$face" export
if command -v node >/dev/null; then
	same "with a character, its lashes and tears stand round the eye" "$(node -e 'const d = require("fs").readFileSync(process.argv[1]), j = JSON.parse(d.subarray(20, 20 + d.readUInt32LE(12)));
		console.log(String(j.meshes.map(m => m.name)))' "$face/work/export/eye.glb")" "iris,pupil_back,sclera,cornea,lashes,tears"
else
	skip "lashes and tears round an eye" "node is not installed"
fi
# Its eyeballs have 12 mm in radius: an eye of 11.8 mm passes, one of 14.5 is said to be scaled, in one line and on the page.
"$BIN/render" --capture="$face" >"$log" 2>&1
same "an eye of its sockets' size: not a word" "$? $(grep -c 'times as large' "$log") $(grep -c 'times as large' "$face/work/review/index.html")" "0 0 0"
echo "render.sclera_radius_mm = 14.5" >>"$face/capture.conf"
"$BIN/render" --capture="$face" --quiet >"$log" 2>&1
same "one of another: one line" "$? $(grep -c 'targets/made: .*12.0 mm (left).*14.5 mm.* 0.83 and 0.83 times as large' "$log") $(wc -l <"$log")" "0 1 1"
check "and on the page" grep -q '14.5 mm: the eye is drawn 0.83 and 0.83 times as large' "$face/work/review/index.html"
echo "render.socket_share = 0.2" >>"$face/capture.conf"
"$BIN/render" --capture="$face" --quiet >"$log" 2>&1
same "unless as much may pass" "$? $(wc -l <"$log")" "0 0"
sed -i '/sclera_radius_mm\|socket_share/d' "$face/capture.conf"
run_make "$face" export
check "and eye.json says so" grep -q '"meniscus": true' "$face/work/export/eye.json"
# Both eyes of a person, beside that character.
both="$root/both"
cp -r "$face" "$both"
rm -r "$both/work/export" "$both/photos"/*
cp "$PHOTO" "$both/photos/right_eye.jpg"
cp "$PHOTO" "$both/photos/left_eye.jpg"
sed -i 's/^quality.*//' "$both/capture.conf"
printf '%s\n' "quality = draft" "export.exr = yes" >>"$both/capture.conf"
run_make "$both" export
same "of both eyes one stands in each folder" "$? $(cd "$both/work" && ls -d export*)" "0 export
export_right"
# stated DIR TRIANGLES...: what an eye.json states against its own files: losses of all three views, maps' widths as PNG and EXR have them, EXRs of halves, triangles within export.lod_triangles.
# engine EYE.json: each of the engines' numbers from the eye's own, by what engines.md says it is.
engine() {
	node -e 'const j = JSON.parse(require("fs").readFileSync(process.argv[1])), e = j.engine, [a, b] = j.limbus_mm, R = j.cornea.radius_mm, p = j.cornea.asphericity;
		const rim = a * a / (R + Math.sqrt(R * R - p * a * a)), behind = j.iris.depth_behind_apex_mm - rim;
		const want = { limbus_in_unit: a / (2 * j.sclera_radius_mm), limbus_aspect: b / a, iris_in_unit: behind / (2 * j.sclera_radius_mm), pupil_in_iris: j.iris.pupil_diameter_mm / 2 / a,
			pupil_least: 0.5 / a, pupil_most: 4 / a, limbal_ring: j.limbus_width_mm / 2 / a, iris_uv_radius: a / (2 * j.sclera_radius_mm), depth_over_limbus: behind / a,
			depth_mm: behind, center_in_unit: Math.sqrt(j.sclera_radius_mm ** 2 - a * a) / (2 * j.sclera_radius_mm), iris_crop: a / j.textures.iris_albedo.half_width_mm,
			sclera_reach: j.textures.sclera_albedo.half_width_deg * Math.PI / 180, sclera_rough: Math.sqrt(Math.SQRT2 * Math.tan(3 * Math.PI / 180) * 0.75),
			sclera_smoothness: 1 - Math.sqrt(Math.SQRT2 * Math.tan(3 * Math.PI / 180) * 0.75) };
		const off = Object.keys({ ...want, ...e }).filter(k => !(Math.abs(e[k] - want[k]) < 1e-6 * want[k]));
		console.log(off.map(k => `${k} is ${e[k]}, not ${want[k]}`).join("; "));' "$1" 2>&1
}
stated() {
	node -e 'const fs = require("fs"), dir = process.argv[1], most = process.argv.slice(2).map(Number), j = JSON.parse(fs.readFileSync(dir + "/eye.json")), wrong = [];
		const need = (ok, what) => ok || wrong.push(what);
		need(j.lost.map(l => l.deg).join() === "0,30,60", "views of lost");
		for (const l of j.lost)
			for (const k of ["refraction_mm_mean", "refraction_mm_most", "iris_difference_mean", "iris_difference_95", "eye_difference_mean"])
				need(Number.isFinite(l[k]) && l[k] >= 0, k + " at " + l.deg);
		need(j.lost[2].refraction_mm_mean > j.lost[0].refraction_mm_mean, "more is lost from aside");
		j.files.slice(1).forEach((f, i) => need(f.triangles <= most[i] && f.triangles > most[i] / 4, f.file + " has " + f.triangles));
		j.files.forEach(f => need(fs.statSync(dir + "/" + f.file).size === f.bytes, f.file + " bytes"));
		for (const f of j.files) {
			const d = fs.readFileSync(dir + "/" + f.file), g = JSON.parse(d.subarray(20, 20 + d.readUInt32LE(12)));
			const n = g.meshes.filter(m => ["iris", "pupil_back", "sclera", "cornea"].includes(m.name)).reduce((n, m) => n + g.accessors[m.primitives[0].indices].count / 3, 0);
			need(n === f.triangles, f.file + " says " + f.triangles + ", has " + n);
		}
		need(Object.keys(j.textures).length === 13, "13 maps");
		for (const [name, t] of Object.entries(j.textures)) {
			const png = fs.readFileSync(`${dir}/textures/${name}.png`), exr = fs.readFileSync(`${dir}/textures/${name}.exr`).subarray(0, 8192);
			need(png.readUInt32BE(16) === t.px && png.readUInt32BE(20) === t.px, name + ".png is not " + t.px);
			need(t.px >= 128 && t.px <= 4096 && (t.px & (t.px - 1)) === 0, name + " px " + t.px);
			const box = exr.indexOf("dataWindow\0box2i\0") + 17 + 4, list = exr.indexOf("channels\0chlist\0") + 16, channels = [];
			need(exr.readInt32LE(box + 8) - exr.readInt32LE(box) + 1 === t.px, name + ".exr is not " + t.px);
			for (let at = list + 4; exr[at]; ) {
				const end = exr.indexOf(0, at);
				channels.push(exr.readInt32LE(end + 1));
				at = end + 17;
			}
			need(channels.length === t.channels && channels.every(c => c === 1), name + ".exr has channels " + channels);
		}
		console.log(wrong.join("; "));' "$@" 2>&1
}
if command -v node >/dev/null; then
	most=$(sed -n 's/^export.lod_triangles = //p' config/capture.conf)
	for dir in "$export" "$both/work/export" "$both/work/export_right"; do
		# shellcheck disable=SC2086
		same "eye.json says what is there: ${dir#"$root"/}" "$(stated "$dir" $most)" ""
		same "its engines' numbers by their formulas" "$(engine "$dir/eye.json")" ""
	done
	same "each says its side" "$(sed -n 's/.*"side": "\([a-z]*\)".*/\1/p' "$both"/work/export{,_right}/eye.json | tr '\n' ' ')" "left right "
	check "and each has lashes of its own lid" test "$(node -e 'const j = f => { const d = require("fs").readFileSync(f); return JSON.parse(d.subarray(20, 20 + d.readUInt32LE(12))); };
		const at = f => { const g = j(f), m = g.meshes.find(m => m.name === "lashes"); return m && g.accessors[m.primitives[0].attributes.POSITION]; };
		const a = at(process.argv[1]), b = at(process.argv[2]); console.log(a && b && String(a.min) !== String(b.min))' "$both"/work/export{,_right}/eye.glb)" = true
else
	skip "what eye.json states" "node is not installed"
fi
run_make "$root/none" export
check "no capture, no export" test ! -e "$root/none/work/export"

npm_has gltf-validator three
if there gltf-validator; then
	for f in "$export"/eye{,_lod1,_lod2}.glb "$face/work/export"/eye{,_lod1,_lod2}.glb "$both"/work/export{,_right}/eye.glb; do
		same "Khronos's validator on ${f#"$root"/}: errors, warnings" "$(khronos "$f")" "0 0"
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
	# A path tracer's noise is in the figures: of 64 samples they are 0.1 larger than of 128.
	timeout 1800 blender -b --python tests/tools/eye_cycles.py -- "$export" "$root" 64 0 30 >"$log" 2>&1
	for deg in 0 30; do
		against Cycles $deg "$root/cycles_$(printf %02d $deg).exr" 2 2 1
	done
else
	skip "an exported eye in Blender's Cycles" "no blender: apt-get install blender"
fi

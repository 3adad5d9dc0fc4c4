#!/bin/bash
# Characters as artists have them, from the file to the picture and the .glb that leaves: glTF with textures, several meshes, hair cards
# and blend shapes, in other units, with z up, skinned; hostile ones beside them stop nothing else.
. "$(dirname "$0")/../lib/chain.sh"

DRESSED=${B:-build}/tests/tools/dressed
LASHES=${B:-build}/tests/tools/lashes
POSED=${B:-build}/tests/tools/posed
HALVES=${B:-build}/tests/tools/halves
HEAD=samples/face/targets/mpfb.obj
capture=$root/c
small_face "$capture"
rm "$capture"/targets/*
# Laid onto the subject as wholly as others are, and by more points than a tenth of those: lids that lie a millimetre off it, their lashes do, too.
sed -i '/^target.mpfb/d; /^transfer\./d; /^render.lashes/d; /^render.brow_hairs/d; s/^track.points = .*/track.points = 1500/' "$capture/capture.conf"
"$DRESSED" "$HEAD" "$capture/targets/metres.glb" unit=0.1 px=256
"$DRESSED" "$HEAD" "$capture/targets/blender.glb" unit=10 z_up px=256 lid_hair
# The first, which the page shows: its three maps of 4096 px with a photograph's noise, red on its left and blue on its right.
"$DRESSED" "$HEAD" "$capture/targets/actor.glb" skinned unit=0.1 px=4096 grain halves
"$DRESSED" "$HEAD" "$capture/targets/bare.glb" no_uv no_material
# In centimetres, y up: one mesh of 200 materials, red on its left and blue on its right; and as FBX, its texture where the artist had it.
"$DRESSED" "$HEAD" "$capture/targets/many.glb" unit=10 px=256 materials=200 halves
"$DRESSED" "$HEAD" "$capture/targets/artist.fbx" unit=10 px=256
# Other topologies: that head in triangles of its own, four times as many, each eyeball a mesh of its own; the subject's mesh, stretched into somebody else.
"$DRESSED" "$HEAD" "$capture/targets/fine.glb" unit=0.1 px=256 faces=32000
"$DRESSED" samples/face/subject.ply "$capture/targets/other.glb" unit=0.01 px=256 faces=12000 ball=3.1010,3.6016,7.8602,1.5175 stretch=1.06,0.95,1
head -c 30000 "$capture/targets/metres.glb" >"$capture/targets/cut.glb"
printf 'Kaydara FBX Binary  \0\x1a\0\xe8\x1c\0\0\xff\xff\xff\xff\xff\xff\xff\xff' >"$capture/targets/wild.fbx"
printf '{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"children":[1]},{"children":[0]}]}' >"$capture/targets/cycle.gltf"
run_make "$capture"
same "the capture is made" "$? $(grep -c 'Error' "$log")" "0 0"
for name in metres blender actor bare many artist fine other; do
	check "$name has left with its targets" test -s "$capture/work/render/$name.glb"
done
for name in cut.glb wild.fbx cycle.gltf; do
	same "$name is refused in one line" "$(grep -c "^transfer: \(skipped: \)\?targets/$name: " "$log")" 1
	check "and leaves nothing" test ! -e "$capture/work/targets/${name%.*}/rig.npz"
done

# field FILE EXPRESSION: of the glTF's JSON.
field() { node -e 'const d = require("fs").readFileSync(process.argv[1]), j = JSON.parse(d.subarray(20, 20 + d.readUInt32LE(12)));
	console.log(String(eval(process.argv[2])))' "$1" "$2"; }
if command -v node >/dev/null; then
	glb=$capture/work/render/metres.glb
	same "its meshes, but for the old eyeballs" "$(field "$glb" 'j.meshes.map(m => m.name)')" "Head,Hair,lining,lashes,tears,iris,pupil_back,sclera,cornea"
	same "its textures, byte for byte as many, and those of one eye" "$(field "$glb" 'j.images.slice(0, -7).map(i => j.bufferViews[i.bufferView].byteLength)')" \
		"$(field "$capture/targets/metres.glb" 'j.images.map(i => j.bufferViews[i.bufferView].byteLength)')"
	same "its own blend shapes beside ours" "$(field "$glb" '["jawOpen", "sneer", "eyeBlink_L", "eyeBlinkLeft"].every(n => j.meshes[0].extras.targetNames.includes(n))')" true
	same "each name of ARKit once, ours, the file's or zero" "$(field "$glb" 'const z = j.meshes[0].extras.zeroTargets; z.length + "," + z.includes("jawOpen") + "," + z.includes("mouthPucker")')" \
		"39,false,true"
	same "the seam of the texture is still one" "$(field "$glb" 'j.accessors[j.meshes[0].primitives[0].attributes.TEXCOORD_0].count > 4202')" true
	same "without materials brows, too" "$(field "$capture/work/render/bare.glb" 'j.meshes.map(m => m.name).slice(0, 6)')" "Head,Hair,lining,lashes,brows,tears"
	same "without materials: one colour" "$(field "$capture/work/render/bare.glb" 'j.meshes[0].primitives[0].attributes.TEXCOORD_0 === undefined')" true
	same "of 200 materials one mesh, and each of them" "$(field "$capture/work/render/many.glb" 'const p = j.meshes[0].primitives; j.meshes[0].name + p.length + "," + new Set(p.map(q => q.material)).size')" "Head200,200"
	same "an FBX' mesh, texture and blend shape" "$(field "$capture/work/render/artist.glb" 'const m = j.meshes[0], t = j.materials[m.primitives[0].material].pbrMetallicRoughness.baseColorTexture; m.name + "," +
		j.bufferViews[j.images[j.textures[t.index].source].bufferView].byteLength + "," + m.extras.targetNames.includes("jawOpen")')" "Head,$(stat -c %s "$capture/targets/skin.png"),true"
	# Cards on the skin from the left lid's edge to its brow, the last rows of the file: in a blink each root goes with the skin below it, to a third of a millimetre, the
	# card keeps its lengths to 3 %, and the way it stands off the skin there, by the mean of six normals, to 30 degrees (of a fold of a
	# coarse mesh; posed vertex by vertex lengths are 0.2 to 1.4 times theirs, and angles off by 15 to 105 degrees).
	printf '0 0 0 0 1 1\n0 0 0 0 0 0\n' | "$POSED" "$capture/work/targets/blender/rig.npz" own settled >"$root/posed"
	same "hair cards on a lid go and turn with it" "$(node -e 'const b = require("fs").readFileSync(process.argv[1]), f = new Float32Array(b.buffer, b.byteOffset, b.length / 4), cards = 16, n = f.length / 12, wrong = [];
		const row = (k, i) => [0, 1, 2].map(c => f[(k * n + i) * 3 + c]), at = (pose, i) => row(2 * pose, i), normal = (pose, i) => row(2 * pose + 1, i);
		const minus = (a, b) => a.map((x, c) => x - b[c]), between = (a, b) => Math.hypot(...minus(a, b)), mean = (a, b) => a.map((x, c) => (x + b[c]) / 2), dot = (a, b) => a.reduce((s, x, c) => s + x * b[c], 0);
		let turned = 0;
		for (let i = n - 4 * cards; i < n; i += 4) {
			const root = [0, 1].map(p => mean(at(p, i), at(p, i + 1))), tip = [0, 1].map(p => mean(at(p, i + 2), at(p, i + 3)));
			const near = [...Array(n - 4 * cards).keys()].filter(v => dot(normal(0, v), minus(tip[0], root[0])) > 0).map(v => [between(root[0], at(0, v)), v]).sort((a, b) => a[0] - b[0]).slice(0, 6).map(a => a[1]), below = near[0];
			const off_skin = [0, 1].map(p => { const m = near.map(v => normal(p, v)).reduce((a, b) => a.map((x, c) => x + b[c])); return m.map(x => x / Math.hypot(...m)); });
			const skin = minus(at(1, below), at(0, below)), off = between(skin, minus(root[1], root[0]));
			const length = [0, 1].map(p => between(root[p], tip[p])), stands = [0, 1].map(p => dot(minus(tip[p], root[p]), off_skin[p]) / length[p]);
			const tilt = Math.abs(Math.acos(Math.min(stands[1], 1)) - Math.acos(Math.min(stands[0], 1))) * 180 / Math.PI;
			turned = Math.max(turned, Math.acos(dot(minus(tip[0], root[0]), minus(tip[1], root[1])) / length[0] / length[1]) * 180 / Math.PI);
			if (!(Math.hypot(...skin) > 3 && off < 0.33 && Math.abs(length[1] / length[0] - 1) < 0.03 && tilt < 30))
				wrong.push([i, Math.hypot(...skin), off, length[1] / length[0], tilt].map(x => x.toFixed(2)).join(" "));
		}
		if (!(turned > 15))
			wrong.push("none turns by more than " + turned.toFixed(1));
		console.log(wrong.join("; "));' "$root/posed" 2>&1)" ""
else
	skip "what the glTF holds" "node is not installed"
fi
# Its left is the picture's right.
same "its own colours are in the picture: red on its left, blue on its right" "$("$HALVES" "$capture/work/render/many_look.png" | awk '{ print ($3 > 5 * $1 && $3 > 5 * $2) " " ($4 > 5 * $5 && $4 > 5 * $6) }')" "1 1"
if npm_has gltf-validator; then
	for name in metres blender actor bare many artist fine other; do
		same "Khronos's validator on $name.glb: errors, warnings" "$(khronos "$capture/work/render/$name.glb")" "0 0"
	done
else
	skip "Khronos's validator on driven characters" "no node, or npm could not install gltf-validator"
fi
# What three.js shows of it, round each eye from three sides, px.
npm_has three
# shown NAME INSIDE_OUT LOOKING_DOWN: a character's .glb there; px of skin that may be seen from behind in a pose, and with lids half and all the way down an eye that
# looks down.
shown() {
	local name=$1 most=$2 down=$3 seen=$root/seen.$1
	mkdir -p "$root/$name"
	timeout 300 node tests/browser/face_glb.js "$capture/work/render/$name.glb" "$npm" - >"$seen" 2>&1
	same "$name: three.js opens it without a word" "$(grep '^fail' "$seen")" ""
	same "$name: open eyes show, from all sides" "$(awk '$1 == "open" && $5 > 10000' "$seen" | wc -l)" 6
	# The goal is none, and none is left; a tenth of a per cent is some 20 px.
	same "$name: shut, nothing of an open eye shows, looking down, too" "$(awk '$1 == "open" { open[$2 $3] = $5 } $1 ~ /^shut/ && $5 > 0.001 * open[$2 $3]' "$seen")" ""
	# Targets are added to each other: what they had in common, linings put before the eyeballs, turned lids inside out, 4500 to 14000 px of them; thick margins whose
	# outer edge sank behind the inner one, and corners that crumpled, up to 486. The goal is none; left are up to 57 px of eyes that look aside, 73 of half shut ones that look down.
	same "$name: no lid is turned inside out" "$(awk -v most="$most" -v down="$down" '$6 == "skin" && $9 > ($1 ~ /_down$/ ? down : most)' "$seen")" ""
	# What is behind the head, seen within its outline: a gap between lids, or beside the eye that turned.
	same "$name: no gap in any pose" "$(awk '$4 == "eye" && $11 > 0' "$seen")" ""
	same "$name: no disc of skin over the eye, no hole in it" "$(awk '$4 == "eye" && $17 > 0' "$seen")" ""
	same "$name: no eye through a lid" "$(awk '$4 == "eye" && $1 !~ /^shut/ && $19 > 0.001 * $5 + 10' "$seen")" ""
	# Skin that is outside the eye open and shut. A blink's target by itself leads it straight through the cornea.
	same "$name: half way down lids are before the eye" "$(awk '$1 == "depth" && ($8 > 0.16 || $9 > 0.16 || $10 > 0.16 || $12 < 100)' "$seen")$(grep -c '^depth' "$seen")" 2
	# An eye that looks down or up has its lids led round the turned cornea by that look's target, and by the two that go with it and a blink: of the bundled head's 0.003
	# is left, of a mesh that ends at its lids' edges 0.11. Three quarters down what lined the lids, triangles of 8 mm, was 0.30 deep.
	same "$name: looking down and up, lids are before the eye, open and on their way down" \
		"$(awk '$1 == "turned" && ($5 > 0.15 || $6 > 0.15 || $7 > 0.15 || $9 > 0.15 || $11 < 100)' "$seen")$(grep -c '^turned' "$seen")" 4
	same "$name: lashes are seen in every pose, from all sides" "$(awk '$4 == "eye" && $13 > 1000' "$seen" | wc -l)" 54
	same "$name: tears line the lower lid of an open eye" "$(awk '$1 == "open" && $15 > 100' "$seen" | wc -l)" 6
	same "$name: and none is on shut ones" "$(awk '$1 == "shut" && $15 > 60' "$seen")" ""
	same "$name: looking aside, lids leave at least half of what an open eye shows" \
		"$(awk '$1 == "open" { open[$2 $3] = $5 } ($1 == "left" || $1 == "right") && $5 > open[$2 $3] / 2' "$seen" | wc -l)" 12
}
if there three && command -v chromium >/dev/null; then
	shown metres 80 150
	shown fine 80 150
	# A mesh that ends at its lids' edges, and gets a lining and corners: without those 575 px of nothing beside an eye that looks to the nose, 930 of skin from behind.
	shown other 80 80
else
	skip "a driven face in three.js" "no chromium, or npm could not install three"
fi
# The same in Blender's Cycles, from in front, 256 px.
if command -v blender >/dev/null; then
	for name in metres fine other; do
		seen=$root/cycles.$name
		timeout 600 blender -b --python tests/tools/face_blender.py -- "$capture/work/render/$name.glb" "$root/$name" 2>"$log" | grep '^blender ' >"$seen"
		same "$name: Cycles draws every pose" "$(awk '$1 == "blender" && $5 + $7 + $9 > 40000' "$seen" | wc -l)" 14
		same "$name: shut in Cycles, nothing of an open eye shows, looking down, too" "$(awk '$2 == "open" { open[$3] = $5 } $2 ~ /^shut/ && !($5 < 0.001 * open[$3] + 1)' "$seen")" ""
		same "$name: in Cycles no gap and no lid inside out in any pose" "$(awk '$11 > 0 || $9 > 25' "$seen")" ""
		same "$name: in Cycles eyes that look aside show half of what an open one shows" "$(awk '$2 == "open" { open[$3] = $5 } ($2 == "left" || $2 == "right") && $5 > open[$3] / 2' "$seen" | wc -l)" 4
	done
else
	skip "a driven face in Blender's Cycles" "no blender: apt-get install blender"
fi
# mm of an eyeball of 12 mm; a margin is 1 to 2 mm broad.
for name in metres fine other; do
	same "$name: shut, lashes stand on the seam" "$("$LASHES" "$capture/work/targets/$name/rig.npz" 120 1.1 | awk '$NF > ($2 == "upper" ? 0.8 : 1.2)')" ""
done
# The lids of the bundled head, whose mesh has their linings, and of one that ends at their edges, over the grid of gazes and openings, on the mesh (tools/lids.c
# says what the columns are). As shut as can be counted; what lines a lid was 1.8 mm before its margin.
for name in metres other; do
	"${B:-build}/tests/tools/lids" "$capture/work/targets/$name/rig.npz" >"$root/$name.csv" 2>"$log"
	same "$name's lids are measured" "$? $(wc -l <"$root/$name.csv")" "0 181"
	same "its upper margins are arcs, half open, too" "$(awk -F, 'NR > 1 && $3 > 0 && $6 > 0.25' "$root/$name.csv")" ""
	same "nothing of it is in a turned eyeball" "$(awk -F, 'NR > 1 && ($7 < 0 || $8 < -0.02)' "$root/$name.csv")" ""
	same "shut it is shut at every gaze" "$(awk -F, 'NR > 1 && $3 == 0 && $5 > 0.02' "$root/$name.csv")" ""
	same "what lines its lids stays behind them" "$(awk -F, 'NR > 1 && $14 > 0.3' "$root/$name.csv")" ""
	# Roots on the margins' faces had 8 of 160 crossed open, 15 of another's. Shut, lids of so short a film lie over each other by up to a millimetre.
	same "and open and half open no lash goes through skin, but for 5 of 160" "$(awk -F, 'NR > 1 && $3 > 0 && $9 > 5' "$root/$name.csv")" ""
done
same "other's margins are thick everywhere" "$(awk -F, 'NR > 1 && $12 != "nan" && !($12 > 1.5 && $13 > 2)' "$root/other.csv")" ""
# The page poses vertices by the shader; what makes margins arcs it interpolates between poses. A step of its numbers is some 0.025 mm.
if command -v node >/dev/null && command -v chromium >/dev/null; then
	first=$(ls "$capture/work/targets" | head -n 1)
	timeout 300 node tests/browser/lids.js "$capture/work/review/viewer.html" "$capture/work/targets/$first/rig.npz" "${B:-build}/tests/tools" >"$root/page_lids" 2>&1
	same "the page's lids are those of pictures in the grid's poses" "$(awk '$1 == "grid" && !($6 < 0.06 && $8 < 0.03)' "$root/page_lids")$(grep -c '^grid' "$root/page_lids")" 7
	same "and near them between those" "$(awk '$1 == "between" && !($6 < 0.7 && $8 < 0.15)' "$root/page_lids")$(grep -c '^between' "$root/page_lids")" 8
	same "the page poses them without a word" "$(grep '^fail' "$root/page_lids")" ""
	timeout 300 node tests/browser/worn.js "$capture/work/review/viewer.html" >"$root/worn" 2>&1
	check "the page draws its textures: red on its left, blue on its right" awk '{ ok = NF == 6 && $3 > 2 * $1 && $4 > 2 * $6 } END { exit !ok }' "$root/worn"
else
	skip "the page's lids and textures" "no chromium or no node"
fi
same "its maps have 4096 px" "$(node -e 'const d = require("fs").readFileSync(process.argv[1]); let n = 0;
	for (let i = d.indexOf("IHDR"); i > 0; i = d.indexOf("IHDR", i + 4)) n += d.readUInt32BE(i + 4) === 4096; console.log(n);' "$capture/targets/actor.glb" 2>/dev/null || echo 3)" 3
same "the page with a textured face is small enough" "$(($(stat -c %s "$capture/work/review/viewer.html") < 25000000))" 1
turned() { sed -n 's/.*"target_unit_mm": \([0-9.]*\).*/\1/p' "$capture/work/targets/$1/registration.json"; }
same "units are found" "$(turned metres) $(turned blender) $(turned actor) $(turned many) $(turned artist)" "1000.0 10.0 1000.0 10.0 10.0"

before=$(times_of "$capture" | grep -v '^log/\|plan\|review/')
run_make "$capture"
same "again: nothing is made" "$? $(times_of "$capture" | grep -v '^log/\|plan\|review/')" "0 $before"

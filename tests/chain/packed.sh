#!/bin/bash
# Characters as the web has them: one glTF packed by gltfpack in its three ways (whole numbers, compressed, compressed further) and its textures made WebP
# (gltf-transform, where it can be had) give the character that they were made of.
. "$(dirname "$0")/../lib/chain.sh"

IMPORT=${B:-build}/tests/tools/import
"${B:-build}/tests/tools/dressed" samples/face/targets/mpfb.obj "$root/plain.glb" unit=0.1 px=256

# what NAME: what a file of the folder holds; its vertices, faces and textures, then means.
what() { "$IMPORT" "$root" "$1" 2>&1 | sed 's/ textures .*/ textures/'; }
# as_plain NAME: as the plain one holds, means to the steps of what was packed, 1/30000 of the head.
as_plain() {
	same "$1 holds as much" "$(what "$1" | head -n 1)" "$(what plain.glb | head -n 1)"
	same "$1: its places, texture coordinates and blend shape" "$(paste -d ' ' <(what "$1" | tail -n 1) <(what plain.glb | tail -n 1) |
		awk '{ for (i = 1; i <= NF / 2; i++) off += $i + 0 != $(i + NF / 2) + 0 && ($i - $(i + NF / 2)) ^ 2 > 3e-5 ^ 2; print NF == 22 ? off + 0 : "nothing" }')" 0
}
same "the plain one is read" "$(what plain.glb | head -n 1)" "4442 vertices 8684 faces 4 textures"
if command -v gltfpack >/dev/null; then
	for way in "" -c -cc; do
		# shellcheck disable=SC2086
		gltfpack -i "$root/plain.glb" -o "$root/packed$way.glb" -kn -km $way >"$log" 2>&1
		as_plain "packed$way.glb"
	done
else
	skip "characters packed by gltfpack" "gltfpack is not installed"
fi
if npm_has @gltf-transform/cli; then
	"$npm/node_modules/.bin/gltf-transform" webp "$root/plain.glb" "$root/webp.glb" >"$log" 2>&1
	check "its pictures are WebP" grep -q image/webp "$root/webp.glb"
	as_plain webp.glb
else
	skip "characters with WebP textures" "gltf-transform cannot be had from npm"
fi

# Folders of captures, sourced by the tests of batches.

# small_captures DIR N: c1 ... cN, photographs of their own focal length, made in half a second each.
small_captures() {
	local i
	mkdir -p "$1/c1/photos"
	"$VARIANT" half "$PHOTO" "$1/c1/photos/right_a.jpg"
	for ((i = 1; i <= $2; i++)); do
		[ -d "$1/c$i" ] || cp -r "$1/c1" "$1/c$i"
		printf '%s\n' "camera.focal_px = $((5900 + i))" "quality = draft" "render.size_px = 96" "render.frame_px = 64" "render.photo_px = 128" \
			"render.map_size = 128" "render.vein_map_px = 128" >"$1/c$i/capture.conf"
	done
}

# broken_captures DIR: a key that nobody knows, a photograph that is none, an empty folder.
broken_captures() {
	cp -r "$1/c1" "$1/bad_key" && echo "eye.colour = blue" >>"$1/bad_key/capture.conf"
	mkdir -p "$1/bad_photo/photos" "$1/nothing" && echo "not a picture" >"$1/bad_photo/photos/eye.jpg"
}

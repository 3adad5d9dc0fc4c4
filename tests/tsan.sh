#!/bin/bash
# Every stage under clang's thread sanitizer, on four threads: a photograph, a face's film with its mesh and character, a made face, and where
# COLMAP is, views of a head. B: the folder of the sanitised build. A race that is ours fails the stage by its name.
#   ONLY="limbus track"   these stages; KEEP=DIR: what the sanitizer said is left there
. tests/lib/chain.sh
BIN=${B:?}/bin
VARIANT=${TOOLS:-build}/tests/tools/variant
MADE=${TOOLS:-build}/tests/tools/made_face
said=${KEEP:-$root/said}
ln -sfn ../config "$B/config" # programs look for it beside their folder
mkdir -p "$said"
# OpenMP tells the sanitizer of its barriers and tasks through archer; what libraries do that were built without it is not looked into.
OMP_TOOL_LIBRARIES=$(find /usr/lib/llvm-*/lib /usr/lib/*/ -maxdepth 1 -name libarcher.so 2>/dev/null | head -n 1)
export OMP_TOOL_LIBRARIES OMP_WAIT_POLICY=passive OPENBLAS_NUM_THREADS=1
export TSAN_OPTIONS="suppressions=$PWD/tests/tsan.supp ignore_noninstrumented_modules=1 history_size=4 exitcode=66"
[ -n "$OMP_TOOL_LIBRARIES" ] || { skip "thread sanitizer" "archer (libomp-14-dev) is not there: clang's OpenMP cannot tell of its barriers"; exit 0; }
# The sanitizer's tables want addresses where the kernel's random layout of today puts libraries.
calm=
setarch -R true 2>/dev/null && calm="setarch -R"

# sanitised NAME CAPTURE STAGE...
sanitised() {
	local name=$1 capture=$2 stage got races
	for stage in "${@:3}"; do
		[[ " ${ONLY:-$stage} " == *" $stage "* ]] || continue
		# shellcheck disable=SC2086
		$calm timeout 600 "$BIN/$stage" --capture="$capture" --threads=4 --quiet --force >"$log" 2>&1
		got=$?
		races=$(grep -c '^WARNING: ThreadSanitizer' "$log")
		[ "$races" = 0 ] || cp "$log" "$said/$name-$stage"
		if [ "$races" != 0 ]; then fail "$name, $stage: no race" "$races: $(grep -A 1 SUMMARY "$log" | sort | uniq -c | sort -rn | head -n 3)"
		elif [ "$got" = 0 ]; then pass "$name, $stage: no race"
		else fail "$name, $stage: exit status $got" "$(tail -n 2 "$log")"; fi
	done
}

new_capture "$root/eye"
"$VARIANT" half "$PHOTO" "$root/half.jpg" && "$VARIANT" half "$root/half.jpg" "$root/eye/photos/right_a.jpg"
"$VARIANT" turned "$root/half.jpg" "$root/eye/photos/right_b.jpg"
sed -i 's/^camera.focal_px.*/camera.focal_px = 2957/' "$root/eye/capture.conf"
printf '%s\n' "photo.right_b.focal_px = 5913" "render.size_px = 96" "render.frame_px = 64" "render.photo_px = 96" "render.map_size = 128" "render.vein_map_px = 128" \
	>>"$root/eye/capture.conf"
sanitised photograph "$root/eye" plan limbus unrefract freckles heightfield pigment relief refraction render

"$MADE" "$root/made"
mkdir "$root/made/script" && printf 'time_s,horizontal_deg,vertical_deg\n0,0,0\n0.1,10,5\n' >"$root/made/script/look.csv"
printf '%s\n' "render.size_px = 64" "render.look_px = 96" "render.cell_px = 64" "render.blink_frames = 3" "render.sheet_px = 300" "render.clip_px = 64" \
	"render.skin_lights = 4" "render.glb_targets = 4" "render.clip_seconds = 0.05" >>"$root/made/capture.conf"
sanitised "made face" "$root/made" plan extrapolate animate

small_face "$root/face"
sed -i 's/^transfer.nodes.*/transfer.nodes = 100 200 400/' "$root/face/capture.conf"
sanitised face "$root/face" track train transfer extrapolate animate render

VIEWS=${EYEWRIGHT_DATA:-../shared/data}/views/buddha/images
if [ -d "$VIEWS" ] && command -v colmap >/dev/null; then
	mkdir -p "$root/views/views"
	cp "$VIEWS"/0000[1-4].jpg "$root/views/views"
	printf '%s\n' "quality = draft" "calibrate.picture_px = 800" "calibrate.features = 1024" "calibrate.subject_px = 100" >"$root/views/capture.conf"
	sanitised views "$root/views" calibrate
else skip "views: no race" "COLMAP or views/buddha is not there"; fi
exit 0

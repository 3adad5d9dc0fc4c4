#!/bin/bash
# What is taken out of a capture leaves nothing behind that passes for its own: all files are those of a capture that never had it, byte by
# byte. Put back, no stage computes again what it had.
. "$(dirname "$0")/../lib/chain.sh"

all=$root/all
small_face "$all"
mkdir "$all/photos"
for name in left_a right_a; do
	"$VARIANT" half "$PHOTO" "$all/photos/$name.jpg"
	printf '%s\n' "photo.$name.focal_px = 5913.045" "photo.$name.center_px = 400 300" >>"$all/capture.conf"
done
small=("render.size_px = 96" "render.frame_px = 64" "render.photo_px = 128" "render.map_size = 128" "render.vein_map_px = 128")
printf '%s\n' "${small[@]}" >>"$all/capture.conf"
run_make "$all"
same "the whole capture" "$?" 0
whole=$(bytes_of "$all")

# Everything in work/, and which stages have a log: a review page tells of each that has.
state_of() { bytes_of "$1" | grep -v ' \./plan\.'; (cd "$1/work/log" && ls); }
# never DIR: the same inputs in a folder where nothing was made.
never() {
	mkdir "$root/never" && (cd "$1" && tar c --exclude=./work .) | tar x -C "$root/never" && run_make "$root/never"
	state_of "$root/never"
	cp "$root/never/work/review/index.html" "$root/never.html"
	rm -rf "$root/never"
}
# What the page shows, without how long it took.
shown() { grep -o 'alt="[^"]*"\|<h[23][^>]*>[^<]*' "$1" | sort; }
gone() { # WHAT DIR
	local want
	want=$(never "$2")
	run_make "$2"
	same "$1 gone: make" "$?" 0
	same "$1 gone: what is there is what would be without" "$(state_of "$2")" "$want"
	same "$1 gone: the page shows what it would without" "$(shown "$2/work/review/index.html")" "$(shown "$root/never.html")"
	run_make "$2"
	same "$1 gone: and then nothing runs" "$(ran)" ""
}
back() { # WHAT DIR STAGES: put back, these run
	run_make "$2"
	same "$1 back: what runs" "$(ran)" "$3"
	same "$1 back: all is as it was" "$(bytes_of "$2")" "$whole"
}

cp -a "$all" "$root/face"
rm "$root/face"/script/*
gone "script/" "$root/face"
check "script/ gone: no clip of it" test ! -e "$root/face/work/render/mpfb_script.mp4"
mkdir "$root/kept"
mv "$root/face/targets" "$root/kept"
sed -i '/^target\./d' "$root/face/capture.conf"
gone "the character" "$root/face"
cp "$all/capture.conf" "$root/face"
cp "$all"/script/* "$root/face/script/"
mv "$root/kept/targets" "$root/face"
back "script and character" "$root/face" render

# One eye of two: the other moves into its place.
rm "$root/face/photos/left_a.jpg"
sed -i '/^photo.left_a/d' "$root/face/capture.conf"
gone "the left eye" "$root/face"

# All that was learnt from the video, and the same of a stage that is run alone.
mv "$root/face/video" "$root/kept"
gone "video/" "$root/face"
check "video/ gone: the page has no part about skin" sh -c "! grep -q 'id=\"skin\"' '$root/face/work/review/index.html'"
mv "$root/kept/video" "$root/face"
cp "$all/photos/left_a.jpg" "$root/face/photos/"
cp "$all/capture.conf" "$root/face"
run_make "$root/face"
case " $(ran) " in *" track "* | *" train "* | *" transfer "*) fail "video/ back: is not followed again" "ran $(ran)" ;; *) pass "video/ back: is not followed again" ;; esac
same "video/ and the left eye back: all is as it was" "$(bytes_of "$root/face")" "$whole"

rm "$root/face"/photos/*
sed -i '/^photo\./d' "$root/face/capture.conf"
gone "photos/" "$root/face"
cp "$all"/photos/* "$root/face/photos/"
cp "$all/capture.conf" "$root/face"
back "photos/" "$root/face" render

# What a key has no more of: a clip that is not wanted.
echo "render.clip_px = 0" >"$root/conf"
grep -v '^render.clip_px' "$all/capture.conf" >>"$root/conf"
mv "$root/conf" "$root/face/capture.conf"
gone "clips" "$root/face"

# A file that shows both eyes gives way to one of the same name that shows one.
face=$root/portrait
mkdir -p "$face/photos"
printf '%s\n' "quality = draft" "camera.focal_px = 11826.09" "${small[@]}" >"$face/capture.conf"
"${B:-build}/tests/tools/drawn_face" "$root/two.png" 2001 7 >/dev/null
cp "$root/two.png" "$face/photos/a.png"
run_make "$face"
check "a photograph of both eyes: two fits" test -s "$face/work/limbus/a.left.json" -a -s "$face/work/limbus/a.right.json"
"$VARIANT" png8 "$PHOTO" "$face/photos/a.png"
gone "the second eye of a photograph" "$face"

# Ended while what is not needed was put aside: the next make goes on from there.
cp -a "$all" "$root/ended"
rm "$root/ended"/script/*
mkdir -p "$root/ended/work/.made/aside/skin"
mv "$root/ended/work/skin/animation.csv" "$root/ended/work/.made/aside/skin/"
gone "script/, ended in between," "$root/ended"

# A copy with little of what it was made of, where other programs are: nothing that was made is lost, in sight or aside. What is made of the
# photograph that is left takes its old place.
cp -a "$all" "$root/copy"
rm -r "$root/copy"/{video,targets,script,subject.ply,photos/right_a.jpg}
sed -i '/^photo.right_a/d; /^target\./d' "$root/copy/capture.conf"
mkdir "$root/other"
cp -r "$BIN" "$root/other/bin"
cp -r config "$root/other"
for program in "$root"/other/bin/*; do echo >>"$program"; done
BIN="$root/other/bin" make --no-print-directory -f stages/capture.mk CAPTURE="$root/copy" ready= run >"$log" 2>&1
same "a copy without inputs: make" "$?" 0
check "a copy without inputs: it says what is put aside" grep -q 'plan: .* what track, train, transfer, extrapolate, animate made is put aside in work/.made/aside' "$log"
check "a copy without inputs: there is one eye, and no skin" test -s "$root/copy/work/limbus/left_a.json" -a ! -e "$root/copy/work/limbus/right_a.json" -a ! -e "$root/copy/work/skin"
same "a copy without inputs: what is lost" "$(while read -r hash path; do
	case $path in ./plan.* | ./iris/* | ./limbus/left_a.* | ./render/left_a_*) continue ;; esac
	sha256sum "$root/copy/work/$path" "$root/copy/work/.made/aside/$path" 2>/dev/null | grep -q "^$hash " || echo "$path"
done <<<"$whole")" ""

#!/bin/bash
# Cameras from views: programs that are missing, killed or out of disk, bad sets of photographs, one more photograph, the
# same bytes on any number of threads. What needs COLMAP or photographs of a head is skipped where they are missing.
. "$(dirname "$0")/../lib/chain.sh"

# views DIR FILE...: a capture of those photographs.
views() {
	local dir=$1
	shift
	mkdir -p "$dir/views"
	printf 'quality = draft\ncalibrate.same_level = 0\n' >"$dir/capture.conf"
	cp "$@" "$dir/views/"
}
run_calibrate() { # DIR ARGS...: status; all it says in $log
	local dir=$1
	shift
	"$BIN/calibrate" --capture="$dir" "$@" >"$log" 2>&1 </dev/null
}
one_line() { # NAME TEXT: exit status 1 before, one line of error that says TEXT
	same "$1: exit status" "$status" 1
	check "$1: says why" grep -q "$2" "$log"
	same "$1: one line" "$(grep -vcE ' of [0-9]+(, about .* left)?$' "$log")" 1
}

mkdir -p "$root/made"
for kind in half grey png16; do "$VARIANT" $kind "$PHOTO" "$root/made/$kind.png"; done

# Programs that are not there, or end badly.
views "$root/fake" "$root/made/half.png" "$root/made/png16.png"
PATH=/nonexistent run_calibrate "$root/fake"
status=$?
one_line "colmap not installed" "colmap is not installed: apt-get install colmap"
mkdir "$root/bin"
fake() { printf '#!/bin/sh\n%s\n' "$1" >"$root/bin/colmap" && chmod +x "$root/bin/colmap"; }
for case in 'kill -9 $$|was killed' "echo 'SQLite error: database or disk is full'; exit 1|the disk is full" \
	'echo "ERROR: no"; exit 1|failed: ERROR: no' 'exit 0|database.db'; do
	fake "${case%|*}"
	PATH="$root/bin:$PATH" run_calibrate "$root/fake"
	status=$?
	one_line "colmap: ${case%%|*}" "${case##*|}"
	check "colmap: ${case%%|*}: nothing is left for others to take" test ! -e "$root/fake/work/rig.json"
done

# Nothing to do: calibrate does not run, and the plan says why.
new_capture "$root/single"
cp "$PHOTO" "$root/single/photos/right_a.jpg"
mkdir "$root/single/views"
cp "$PHOTO" "$root/single/views/"
"$BIN/plan" --capture="$root/single" --show >"$log" 2>&1
check "a single view: calibrate is skipped, with its reason" grep -q '^calibrate *skip .*no views' "$log"

# One photograph, one that is none, one twice.
echo "no picture" >"$root/made/text.jpg"
views "$root/few" "$root/made/half.png" "$root/made/text.jpg"
cp "$root/made/half.png" "$root/few/views/copy.png"
run_calibrate "$root/few"
status=$?
same "one usable photograph: exit status" "$status" 1
for says in "text.jpg: is no photograph" "the same file as views/copy.png" "1 usable photographs, at least 2"; do
	check "one usable photograph: $says" grep -q "$says" "$log"
done

# Frames of a video that stands still.
mkdir -p "$root/still/views"
echo "quality = draft" >"$root/still/capture.conf"
for i in $(seq 10 25); do cp "$PHOTO" "$root/still/views/f$i.jpg" && printf '%s' "$i" >>"$root/still/views/f$i.jpg"; done
run_calibrate "$root/still"
check "near-duplicates are left out, and it is said" grep -q "15 of 16 left out" "$log"

# A video and no views: the lens is looked for in it, and where it cannot be found, nothing fails.
CLIP=${B:-build}/tests/tools/clip
mkdir -p "$root/video/video"
echo "quality = draft" >"$root/video/capture.conf"
"$CLIP" "$root/video/video/still.mp4" 480 20 "$PHOTO"
"$BIN/plan" --capture="$root/video" --show >"$log" 2>&1
check "a video in which nothing moves: calibrate does not run, and why" grep -q '^calibrate *skip .*the camera rests in video/' "$log"
run_calibrate "$root/video"
same "a video that stands still: exit status" "$?" 0
why="one picture only"
command -v colmap >/dev/null 2>&1 || why="apt-get install colmap"
check "says that a generic camera is taken" grep -q "still.mp4: no camera found from it.*$why.*generic.*camera.focal_px" "$log"
check "no cameras are left" test ! -e "$root/video/work/rig.json"
PATH=/nonexistent run_calibrate "$root/video" --force
same "a video, colmap not installed: exit status" "$?" 0
check "a video, colmap not installed: said" grep -q "apt-get install colmap.*generic" "$log"
echo "no video" >"$root/video/video/still.mp4"
run_calibrate "$root/video"
same "a video that is none: exit status" "$?" 0
check "a video that is none: said" grep -q "skipped: .*still.mp4" "$log"
echo "camera.focal_px = 900" >>"$root/video/capture.conf"
"$BIN/plan" --capture="$root/video" --show >"$log" 2>&1
check "a video whose lens is given: calibrate does not run" grep -q '^calibrate *skip ' "$log"

heads=${EYEWRIGHT_DATA:-../shared/data}/views/buddha/images
if ! command -v colmap >/dev/null 2>&1; then skip "views through COLMAP" "colmap is not installed"; exit; fi
if [ ! -d "$heads" ]; then skip "views through COLMAP" "no photographs of a head"; exit; fi

views "$root/other" "$heads/00013.jpg" "$root/made/half.png"
run_calibrate "$root/other"
status=$?
same "two different things: exit status" "$status" 1
check "two different things: says what to do" grep -q "walk round the head" "$log"

views "$root/two" "$heads"/000{13,16}.jpg
run_calibrate "$root/two"
same "two photographs: exit status" "$?" 0
same "two photographs: both have a camera" "$(grep -c '"cam_from_head": \[' "$root/two/work/rig.json")" 2
check "two photographs: no mesh, and it is said" grep -q "subject mesh: only .* take more photographs" "$log"

# The same photograph brighter, darker and smaller shows what a camera shows that does not move.
mkdir -p "$root/place"
for kind in half over under; do "$VARIANT" $kind "$heads/00013.jpg" "$root/place/$kind.png"; done
views "$root/one" "$heads/00013.jpg" "$root"/place/*.png
run_calibrate "$root/one"
status=$?
same "all from one place: exit status" "$status" 1
check "all from one place: says so" grep -q "show no depth.*walk round the head instead" "$log"

# A second camera of half the pixels, and the first held upright. Two pictures of a camera leave its lens unsure: 10 %.
for i in 36 62; do "$VARIANT" half "$heads/000$i.jpg" "$root/place/half_$i.jpg"; done
"$VARIANT" turned "$heads/00034.jpg" "$root/place/upright.jpg"
views "$root/mixed" "$heads"/000{13,16,22,31,63}.jpg "$root"/place/{half_36,half_62,upright}.jpg
run_calibrate "$root/mixed"
same "mixed cameras and orientations: exit status" "$?" 0
same "mixed cameras and orientations: all have a camera" "$(grep -c '"cam_from_head": \[' "$root/mixed/work/rig.json")" 8
fx_of() { tr -d '\n' <"$root/mixed/work/rig.json" | grep -o "\"file\": \"views/$1\.jpg\"[^}]*" | sed 's/.*"fx": \([0-9]*\).*/\1/'; }
check "the camera of half the pixels: $(fx_of half_36) of 930 px" test "$(fx_of half_36)" -gt 837 -a "$(fx_of half_36)" -lt 1023

head_views() { views "$1" "$heads"/000{13,16,22,31,34,36,62,63}.jpg; }
head_views "$root/head"
run_calibrate "$root/head" --threads=1
same "eight views of a head: exit status" "$?" 0
same "all have a camera" "$(grep -c '"cam_from_head": \[' "$root/head/work/rig.json")" 8
check "there is a mesh" test -s "$root/head/work/subject.ply"
head_views "$root/again"
run_calibrate "$root/again" --threads=2
results() { (cd "$1/work" && sha256sum rig.json subject.ply calibrate/rig.png); }
same "the same bytes on two threads" "$(results "$root/again")" "$(results "$root/head")"

# One more: what was extracted, matched and found before is not done again, and the old cameras stay where they are.
cp "$heads/00035.jpg" "$root/head/views/"
: >"$root/head/work/calibrate/colmap.log"
run_calibrate "$root/head"
same "one more view: exit status" "$?" 0
same "one more view: it has a camera" "$(grep -c '"cam_from_head": \[' "$root/head/work/rig.json")" 9
same "one more view: the others' features are not sought again" \
	"$(grep -c '^Processed file' "$root/head/work/calibrate/colmap.log")" 1

# What is kept and was deleted, cut, or written into is noticed by make and made again, with the bytes it had.
kept=$root/again/work/calibrate
is_due() { "$BIN/plan" --capture="$root/again" --show | grep -qE "^calibrate +run .*$1"; }
"$BIN/plan" --capture="$root/again" --show >"$log"
check "all there: nothing to do" grep -q '^calibrate *up to date' "$log"
mended=$(results "$root/again")
rm "$kept/database.db"
check "a deleted database: calibrate is to run" is_due "database.db is missing"
picture=$(ls "$kept"/pictures/*.jpg | head -n 1)
scratch "$picture" 5000
truncate -s 5000 "$kept/cloud.grid"
run_calibrate "$root/again"
same "database, a picture and the grid damaged: exit status" "$?" 0
for file in "${picture##*/}" cloud.grid; do check "$file: said" grep -q "$file: not as the last run left it: made anew" "$log"; done
same "the same bytes as before" "$(results "$root/again")" "$mended"
truncate -s 20000 "$kept/database.db" && rm "$root/again/work/.made/calibrate.json"
run_calibrate "$root/again"
same "a database cut while nothing was recorded: exit status" "$?" 0
check "said" grep -q "database.db: damaged: made anew" "$log"
same "the same bytes again" "$(results "$root/again")" "$mended"
printf 'x' | dd of="$kept/model/points3D.bin" bs=1 seek=200 conv=notrunc 2>/dev/null
check "a changed model: calibrate is to run" is_due "points3D.bin has changed"
run_calibrate "$root/again"
same "a changed model: exit status" "$?" 0
check "it is said" grep -q "points3D.bin: not as the last run left it" "$log"
same "the same bytes once more" "$(results "$root/again")" "$mended"
echo "view.00013.distance_mm = 900" >>"$root/again/capture.conf"
check "a length named in capture.conf: calibrate is to run" is_due "view.00013.distance_mm is new"

# Interrupted when its features are known and its matches are not: the next run takes up what is missing.
fake '[ "$1" = matches_importer ] && kill -9 $$; PATH=${PATH#*:}; exec colmap "$@"'
cp "$heads/00060.jpg" "$root/head/views/"
PATH="$root/bin:$PATH" run_calibrate "$root/head"
same "interrupted while a view is added: exit status" "$?" 1
check "interrupted: said" grep -q "matches_importer: was killed" "$log"
run_calibrate "$root/head"
same "gone on with: exit status" "$?" 0
same "gone on with: the view has a camera" "$(grep -c '"cam_from_head": \[' "$root/head/work/rig.json")" 10

# A kept model whose bytes have changed is not gone on with, even where nothing says what they were.
rm "$root/head/work/.made/calibrate.json"
printf 'x' | dd of="$root/head/work/calibrate/model/points3D.bin" bs=1 seek=200 conv=notrunc 2>/dev/null
run_calibrate "$root/head"
same "a changed model: exit status" "$?" 0
check "a changed model: begun anew, and it is said" grep -q "not the ones that were sealed.*begun anew" "$log"

# A video of a walk round the head, and nothing else: its lens, and where the head was.
mkdir -p "$root/walk/video"
echo "quality = draft" >"$root/walk/capture.conf"
"$CLIP" "$root/walk/video/walk.mp4" 1280 3 "$heads"/000{13,16,22,31,34,36,62,63,35,60}.jpg
run_calibrate "$root/walk"
same "a walk filmed: exit status" "$?" 0
check "some frames are enough, and it is said" grep -q "10 of 30 frames taken" "$log"
same "each has a pose" "$(grep -c '"cam_from_head": \[' "$root/walk/work/rig.json")" 10
# Its pictures are the photographs', reduced to 1280 of 2736 px; their published focal length is 1860.9 px. Ten frames: 3 %.
focal=$(sed -n 's/.*"fx": \([0-9]*\).*/\1/p' "$root/walk/work/rig.json" | head -n 1)
check "the lens is found: $focal of 871 px" test "${focal:-0}" -gt 845 -a "${focal:-0}" -lt 897

# A template: the mesh that other photographs of the head gave, in another frame.
template() { printf 'quality = draft\ncalibrate.template = %s\n' "$1" >"$root/walk/capture.conf"; }
elements() { head -c 4000 "$1" | grep -a '^element'; }
cp "$root/again/work/subject.ply" "$root/walk/other.ply"
template other.ply
run_calibrate "$root/walk"
same "a template: exit status" "$?" 0
check "both residuals and the better are said" grep -q "mm from the template, .* mm from the surface: the template is the subject's mesh" "$log"
same "the subject has the template's vertices and faces" "$(elements "$root/walk/work/subject.ply")" "$(elements "$root/walk/other.ply")"
printf 'v 0 0 0\nv 9 0 0\nv 0 9 0\nv 0 0 900\nf 1 2 3\nf 1 4 2\n' >"$root/walk/splinter.obj"
template splinter.obj
run_calibrate "$root/walk"
same "a template like nothing: exit status" "$?" 0
check "a template like nothing: the surface is taken, and it is said" grep -qE "splinter.obj: cannot be laid|the surface is the subject's mesh" "$log"
for bad in missing.ply ../other.ply; do
	template $bad
	run_calibrate "$root/walk"
	status=$?
	one_line "template = $bad" "template"
done

# A mapper that leaves two models which share pictures: joined.
cat >"$root/bin/colmap" <<'END'
#!/bin/bash
PATH=${PATH#*:}
[[ "$1" = mapper && "$*" != *--input_path* ]] || exec colmap "$@"
args=("$@")
for ((i = 0; i < $#; i++)); do
	case ${args[i]} in
	--output_path) out=${args[i + 1]} at=$((i + 1)) ;;
	--image_path) pictures=${args[i + 1]} ;;
	esac
done
ls "$pictures" | sort -t- -k3n >"$out.all"
for part in 0 1; do
	mkdir -p "$out/part"
	args[at]=$out/part
	if [ $part = 0 ]; then head -n 7; else tail -n 7; fi <"$out.all" >"$out.list"
	colmap "${args[@]}" --image_list_path "$out.list" || exit
	mv "$out/part/0" "$out/$part"
done
rm -r "$out/part" "$out.all" "$out.list"
END
for threads in 2 1; do
	split=$root/split$threads
	mkdir -p "$split/video"
	echo "quality = draft" >"$split/capture.conf"
	cp "$root/walk/video/walk.mp4" "$split/video/"
	PATH="$root/bin:$PATH" run_calibrate "$split" --threads=$threads
done
same "two models joined: the same bytes on two threads" "$(results "$root/split1")" "$(results "$root/split2")"
same "two models that share pictures: exit status" "$?" 0
# Neither part has more than 7 pictures; one at an end may share too little with its part.
check "they are joined, and it is said" grep -qE "share pictures: joined to one of (9|10)" "$log"
check "and have cameras" test "$(grep -c '"cam_from_head": \[' "$split/work/rig.json")" -ge 9
focal=$(sed -n 's/.*"fx": \([0-9]*\).*/\1/p' "$split/work/rig.json" | head -n 1)
check "the lens is found: $focal of 871 px" test "${focal:-0}" -gt 845 -a "${focal:-0}" -lt 897
same "nothing is left about" "$(ls "$split/work/calibrate" | grep -cE 'merged|less|joined|models')" 0

# A mesh that is given is not made.
cp "$root/again/work/subject.ply" "$root/again/subject.ply"
run_calibrate "$root/again" --force
check "a mesh is given: said" grep -q "the folder has one" "$log"

#!/bin/bash
# What a folder from a stranger does to what reads and writes it: one line, the right exit status, no hanging, nothing touched outside.
. "$(dirname "$0")/../lib/chain.sh"

# case_of NAME: a capture with one good photograph.
case_of() {
	new_capture "$root/$1"
	"$VARIANT" half "$PHOTO" "$root/$1/photos/right_good.jpg"
	sed -i 's/^camera.focal_px.*/camera.focal_px = 5913/' "$root/$1/capture.conf"
}

# A file of holes claims ten terabytes: nobody reads them.
case_of holes
truncate -s 10T "$root/holes/photos/right_holes.jpg" 2>/dev/null || truncate -s 15T "$root/holes/photos/right_holes.jpg"
timeout 60 "$BIN/limbus" --capture="$root/holes" >"$log" 2>&1
same "a photograph of 10 TB of holes: the others go on" "$?" 0
same "one line" "$(grep -c 'right_holes.*: rejected: [0-9]* bytes, must be <= ' "$log")" 1
mkdir -p "$root/film/video" && truncate -s 10T "$root/film/video/holes.mp4"
timeout 60 "$BIN/track" --capture="$root/film" >"$log" 2>&1
same "a video of 10 TB of holes" "$?" 1
check "one line says so" grep -q 'video/holes.mp4: ' "$log"

# Names end at 255 bytes; what is made of them is longer.
case_of name
cp "$root/name/photos/right_good.jpg" "$root/name/photos/$(printf 'a%.0s' $(seq 251)).jpg"
run_make "$root/name" unrefract
same "a name of 255 bytes stops nobody" "$?" 0
same "one line says so" "$(grep -c 'left out: its name has 255 bytes' "$log")" 1

# Too little address space ends, it does not hang: OpenBLAS asks for memory for ever.
for kib in 200000 400000 700000; do
	(ulimit -v $kib && timeout 60 "$BIN/limbus" --capture="$root/name" --force >"$log" 2>&1)
	case "$? $(wc -l <"$log")" in
	0*) pass "ulimit -v $kib" ;;
	1\ 1) check "ulimit -v $kib: one line" grep -qE 'ulimit -v = |out of memory' "$log" ;;
	*) fail "ulimit -v $kib" "$(tail -n 2 "$log")" ;;
	esac
done

# What surrounds the program.
case_of around
TMPDIR=$root/gone run_make "$root/around"
same "TMPDIR is gone: all is made" "$? $(ran | wc -w)" "0 8"
rm -r "$root/around/work"
make --no-print-directory CAPTURE="$root/around" >&- 2>"$log" </dev/null
same "stdout is closed: all is made" "$? $(ran | wc -w)" "0 8"
rm -r "$root/around/work/review"
make --no-print-directory CAPTURE="$root/around" >/dev/full 2>"$log" </dev/null
same "stdout is full: all is made" "$? $(ran)" "0 render"
check "the page loads nothing from elsewhere" grep -q "Content-Security-Policy\" content=\"default-src 'none'" "$root/around/work/review/index.html"

# A video whose container is whole and whose pictures are not.
mkdir -p "$root/zeros/video"
film=samples/face/video/face.mp4 at=$(grep -abo -m 1 mdat samples/face/video/face.mp4 | head -n 1 | cut -d: -f1)
{ head -c $((at + 4)) "$film"; head -c "$(($(stat -c %s "$film") - at - 4))" /dev/zero; } >"$root/zeros/video/a.mp4"
"$BIN/track" --capture="$root/zeros" --quiet >"$log" 2>&1
same "no picture can be decoded" "$? $(grep -c 'video/a.mp4: none of its first frames can be decoded' "$log")" "1 1"

# Characters alone move nobody; COLMAP is missed before a photograph is read.
mkdir -p "$root/targets" && cp -r samples/face/{subject.ply,targets} "$root/targets"
run_make "$root/targets"
check "a mesh and targets/: says what is missing" grep -q 'learnt from a video: put one of the person into .*/video/' "$log"
mkdir -p "$root/views/views"
for name in a b c; do cp "$root/name/photos/right_good.jpg" "$root/views/views/$name.jpg"; done
PATH=$root/nothing "$BIN/calibrate" --capture="$root/views" >"$log" 2>&1
same "COLMAP is missing: one line, no photograph read" "$? $(wc -l <"$log") $(ls "$root/views/work/calibrate" 2>/dev/null)" "1 1 "

# A record that comes with the folder names files outside: they are not read.
case_of record
"$BIN/limbus" --capture="$root/record" --quiet >"$log" 2>&1
sed -i 's#"photos/right_good.jpg"#"../around/capture.conf"#g' "$root/record/work/.made/limbus.json"
"$BIN/plan" --capture="$root/record" --fresh=limbus >"$log" 2>&1
same "a record of files outside does not hold" "$?" 3
exit 0

#!/bin/bash
# track on a long film: a run that is killed goes on from its last whole chunk and gives the same bytes; memory does not grow with the film.
. "$(dirname "$0")/../lib/chain.sh"

[ -x "$BIN/track" ] || { skip "long films" "track is not built"; exit 0; }
RECUT=${B:-build}/tests/tools/recut

# capture NAME: the bundled face in chunks of 40 frames.
capture() {
	mkdir -p "$root/$1/video"
	cp samples/face/{subject.ply,capture.conf} "$root/$1"
	cp samples/face/video/face.mp4 "$root/$1/video"
	printf 'quality = draft\ntrack.points = 100\ntrack.chunk_frames = 40\n' >>"$root/$1/capture.conf"
}
parts() { find "$root/$1/work/skin" -name 'followed-*' 2>/dev/null | wc -l; }

# killed NAME: track, which dies as soon as it has written its third chunk.
killed() {
	"$BIN/track" --quiet --capture="$root/$1" 2>/dev/null &
	local pid=$! i
	for ((i = 0; i < 3000; i++)); do
		[ -e "$root/$1/work/skin/followed-0002.part" ] && break
		kill -0 $pid 2>/dev/null || break
		sleep 0.02
	done
	kill -9 $pid 2>/dev/null
	wait $pid 2>/dev/null
	check "$1: killed with chunks on the disk" test -e "$root/$1/work/skin/followed-0002.part"
	check "$1: and no result" test ! -e "$root/$1/work/skin/gaze.csv"
}

# goes_on NAME FRAME: track again, from FRAME or a later chunk on (0: from the start), to the bytes of an undisturbed run.
goes_on() {
	local said from
	said=$("$BIN/track" --capture="$root/$1" 2>&1)
	same "$1: exit" "$?" 0
	from=$(sed -n 's/.*goes on from frame \([0-9]*\),.*/\1/p' <<<"$said")
	check "$1: goes on from frame ${from:-0}" test "${from:-0}" -ge "$2"
	[ "$2" -gt 0 ] || same "$1: from the start" "${from:-0}" 0
	same "$1: the same bytes" "$(bytes_of "$root/$1")" "$want"
	same "$1: no chunk is left" "$(parts "$1")" 0
	from=$(stat -c %y "$root/$1/work/skin/gaze.csv")
	"$BIN/track" --quiet --capture="$root/$1"
	same "$1: and then nothing is made again" "$(stat -c %y "$root/$1/work/skin/gaze.csv")" "$from"
}

capture calm
check "an undisturbed run" "$BIN/track" --quiet --capture="$root/calm"
same "no chunk is left" "$(parts calm)" 0
want=$(bytes_of "$root/calm")

capture hit
killed hit
goes_on hit 120

# A chunk that is damaged counts no more than one that is not there; the one before it does.
capture hurt
killed hurt
scratch "$root/hurt/work/skin/followed-0001.part" 100000
goes_on hurt 40

# Those of other settings, and those that came with a folder from elsewhere, are none of this run's.
capture other
killed other
sed -i 's/^track.points = .*/track.points = 100\ntrack.gap_px = 3.5/' "$root/other/capture.conf"
said=$("$BIN/track" --capture="$root/other" 2>&1)
same "other settings: exit" "$?" 0
check "other settings: from the start" test "$(grep -c "goes on from" <<<"$said")" = 0
same "other settings: no chunk is left" "$(parts other)" 0
capture here
killed here
cp -r "$root/here" "$root/copy"
goes_on copy 0

# Memory that is not a file's, which the system cannot take back: what is kept of a frame at 100 points (28 kB) would be 76 MB more of 3000 frames than of 300.
most() {
	local pid kb=0 now
	"$BIN/track" --quiet --capture="$root/$1" 2>/dev/null &
	pid=$!
	while kill -0 $pid 2>/dev/null; do
		now=$(awk '/^RssAnon/ { print $2 }' /proc/$pid/status 2>/dev/null)
		[ "${now:-0}" -le "$kb" ] || kb=$now
		sleep 0.05
	done
	wait $pid && echo "$kb"
}
if [ -x "$RECUT" ]; then
	capture short
	capture film
	"$RECUT" "$root/film/video/face.mp4" samples/face/video/face.mp4 0-299x10
	sed -i 's/chunk_frames = .*/chunk_frames = 250/; /^expression/d' "$root"/{short,film}/capture.conf
	one=$(most short) ten=$(most film)
	check "300 frames take $one kB, 3000 take $ten kB" test "${ten:-999999999}" -le $((${one:-0} + 38000))
else
	skip "memory of a long film" "tests/tools/recut is not built"
fi

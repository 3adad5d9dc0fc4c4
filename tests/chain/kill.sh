#!/bin/bash
# What interrupts a make: kill -9 at random moments, a full disk, a folder that cannot be written, a second make beside it.
# Afterwards a plain make gives the bytes of an undisturbed run, leaves nothing half made, and what was put in is as it was.
#   KILLS=1000 SEED=2 tests/chain/kill.sh
. "$(dirname "$0")/../lib/chain.sh"
KILLS=${KILLS:-6}
RANDOM=${SEED:-1}

new_capture "$root/calm"
cp "$PHOTO" "$root/calm/photos/right_a.jpg"
"$VARIANT" half "$PHOTO" "$root/calm/photos/right_b.jpg"
given() { (cd "$1" && sha256sum capture.conf photos/*); }
# Anything under work/ that an undisturbed run does not leave: temporary files, say.
names_of() { (cd "$1/work" && find . -type f ! -path './log/*' | sort); }
cp -r "$root/calm" "$root/hit"
begin=$(date +%s%N)
run_make "$root/calm"
same "an undisturbed make" "$?" 0
length=$((($(date +%s%N) - begin) / 1000000))
want=$(bytes_of "$root/calm") input=$(given "$root/calm")

# recovers NAME: a plain make mends the capture.
recovers() {
	run_make "$root/hit"
	same "$1: make afterwards succeeds" "$?" 0
	same "$1: the same bytes" "$(bytes_of "$root/hit")" "$want"
	same "$1: nothing is left lying about" "$(names_of "$root/hit")" "$(names_of "$root/calm")"
	same "$1: what was put in is as it was" "$(given "$root/hit")" "$input"
	run_make "$root/hit"
	same "$1: and then nothing runs" "$? $(ran)" "0 "
}

# The whole group of processes dies at once, make and its stages, at a moment anywhere in an undisturbed run.
struck=0
for ((i = 0; i < KILLS; i++)); do
	setsid make --no-print-directory CAPTURE="$root/hit" >"$log" 2>&1 </dev/null &
	pid=$!
	ms=$((RANDOM * (length * 3 / 4) / 32768))
	sleep "$((ms / 1000)).$(printf %03d $((ms % 1000)))"
	kill -9 -- "-$pid" 2>/dev/null && struck=$((struck + 1))
	wait "$pid" 2>/dev/null
	# It goes on from where it was hit, begins anew, or is mended at once and then loses something.
	case $((RANDOM % 3)) in
	0) [ -e "$root/hit/work/review/index.html" ] && rm -rf "$root/hit/work/limbus" ;;
	1) rm -rf "$root/hit/work" ;;
	2) run_make "$root/hit"
		[ "$(bytes_of "$root/hit")" = "$want" ] || fail "kill $i after $ms ms: the same bytes" "$(diff <(bytes_of "$root/hit") <(printf '%s\n' "$want") | head -n 4)"
		rm -f "$root/hit/work/iris/clean.exr" "$root/hit"/work/limbus/right_b.json ;;
	esac
done
check "$KILLS kills: some struck while it ran" test "$struck" -gt 0
recovers "$KILLS kills"

# No file may grow beyond 300 KiB: what a full disk does to a stage that writes.
rm -rf "$root/hit/work"
(ulimit -f 300; trap '' XFSZ; run_make "$root/hit"; exit $?)
check "a full disk: make fails" test "$?" != 0
check "a full disk: one line says so" grep -qE '^[a-z]*: .*cannot write: ' "$log"
recovers "a full disk"

if [ "$(id -u)" = 0 ] && command -v mount >/dev/null && mkdir "$root/small" && mount -t tmpfs -o size=3m tmpfs "$root/small" 2>/dev/null; then
	cp -r "$root/hit/capture.conf" "$root/hit/photos" "$root/small"
	run_make "$root/small"
	check "a disk of 3 MiB: make fails" test "$?" != 0
	check "a disk of 3 MiB: one line says so" grep -q 'No space left on device' "$log"
	mount -o remount,size=200m "$root/small"
	run_make "$root/small"
	same "more room: make succeeds" "$?" 0
	same "more room: the same bytes" "$(bytes_of "$root/small")" "$want"
	mount -o remount,ro "$root/small"
	run_make "$root/small"
	same "a read-only disk, all made: nothing to do" "$(ran)" ""
	mount -o remount,rw "$root/small" && rm -rf "$root/small/work" && mount -o remount,ro "$root/small"
	run_make "$root/small"
	check "a read-only disk: make fails" test "$?" != 0
	check "a read-only disk: one line says so" grep -q 'Read-only file system' "$log"
	umount "$root/small"
fi

if [ "$(id -u)" = 0 ]; then skip "a folder that cannot be written" "root writes everywhere"; else
	rm -rf "$root/hit/work"
	chmod a-w "$root/hit"
	run_make "$root/hit"
	check "a folder that cannot be written: make fails" test "$?" != 0
	check "a folder that cannot be written: one line says so" grep -q 'Permission denied' "$log"
	chmod u+w "$root/hit"
	recovers "a folder that cannot be written"
fi

# Two in one folder.
rm -rf "$root/hit/work"
setsid make --no-print-directory CAPTURE="$root/hit" >"$root/first" 2>&1 </dev/null &
pid=$!
sleep 0.2
run_make "$root/hit"
same "two makes at once: the second succeeds" "$?" 0
wait "$pid"
same "two makes at once: and the first" "$?" 0
recovers "two makes at once"

#!/bin/bash
# What interrupts a make: kill -9 at random moments, a full disk, one without inodes, one whose reads and writes fail (tests/preload/faults.c),
# a clock that jumps, a folder that cannot be written, a second make beside it.
# Afterwards a plain make gives the bytes of an undisturbed run, leaves nothing half made, and what was put in is as it was.
#   KILLS=1000 SEED=2 tests/chain/kill.sh          a third of them on each column, half of them kills; MINUTES=30: each half of a column stops there
#   ONLY=skin                                      this column alone; KINDS="full eio": of the faults these alone
#   EACH=70 STAGES="transfer extrapolate"          beside them so many of each stage's program by itself, or of these
. "$(dirname "$0")/../lib/chain.sh"
KILLS=${KILLS:-12}
MINUTES=${MINUTES:-1000}
EACH=${EACH:-0}
RANDOM=${SEED:-1}
declare -A stages
# far COLUMN DONE OF WHAT: how far a long run is, for who waits for it.
far() { [ $(($2 % 20)) != 0 ] || [ "$3" -lt 40 ] || echo "  $1: $2 of $3 $4 ($((SECONDS / 60)) min)" >&2; }
# COLMAP's database is no artifact: its pages lie where the last interruption left them.
made() { bytes_of "$1" | grep -v ' ./calibrate/database.db$'; }
given() { (cd "$1" && find . -path ./work -prune -o -type f -print0 | sort -z | xargs -0 sha256sum); }
# Anything under work/ that an undisturbed run does not leave: temporary files, say.
names_of() { (cd "$1/work" && find . -type f ! -path './log/*' | sort); }

# undisturbed COLUMN: a make that nobody troubles, in $root/calm; $root/hit is a copy of what goes in.
undisturbed() {
	rm -rf "$root/hit"
	cp -r "$root/calm" "$root/hit"
	local begin
	begin=$(date +%s%N)
	run_make "$root/calm"
	same "$1: an undisturbed make" "$?" 0
	length=$((($(date +%s%N) - begin) / 1000000)) all=$(ran)
	want=$(made "$root/calm") input=$(given "$root/calm")
}

# recovers NAME: a plain make mends the capture.
recovers() {
	run_make "$root/hit"
	same "$1: make afterwards succeeds" "$?" 0
	same "$1: the same bytes" "$(made "$root/hit")" "$want"
	same "$1: nothing is left lying about" "$(names_of "$root/hit")" "$(names_of "$root/calm")"
	same "$1: what was put in is as it was" "$(given "$root/hit")" "$input"
	run_make "$root/hit"
	same "$1: and then nothing runs" "$? $(ran)" "0 "
}

# One artifact, any, is deleted, cut in half or written into.
damage() {
	local files file
	mapfile -t files < <(cd "$root/hit/work" 2>/dev/null && find . -type f ! -path './.made/*' ! -path './log/*' ! -name '*.log' | sort)
	[ ${#files[@]} -gt 0 ] || return
	file=$root/hit/work/${files[RANDOM % ${#files[@]}]}
	# Of a database that COLMAP was killed in only SQLite can tell whether it is whole: it has no sum of its bytes.
	[[ $file != */database.db ]] || grep -qs calibrate/database.db "$root/hit/work/.made/calibrate.json" || return
	case $((RANDOM % 3)) in
	0) rm "$file" ;;
	1) truncate -s "$(($(stat -c %s "$file") / 2))" "$file" ;;
	2) scratch "$file" "$(($(stat -c %s "$file") / 2))" ;;
	esac
}

# moment MS PID: so many milliseconds, or until that process is through.
moment() { timeout "$(($1 / 1000)).$(printf %03d $(($1 % 1000)))" tail --pid="$2" -s 0.05 -f /dev/null; }

# strike COLUMN N: the whole group of processes dies at once, make and its stages, at a moment anywhere in an undisturbed run.
strike() {
	local column=$1 wanted=$2 struck=0 tries=0 missed=0 until=$((SECONDS + 60 * MINUTES)) pid ms name
	while [ "$struck" -lt "$wanted" ] && [ "$tries" -lt $((4 * wanted)) ] && [ "$SECONDS" -lt "$until" ]; do
		tries=$((tries + 1))
		setsid make --no-print-directory CAPTURE="$root/hit" >"$log" 2>&1 </dev/null &
		pid=$!
		ms=$((RANDOM * length / 32768 / (1 + missed)))
		moment "$ms" "$pid"
		name=$(ps -o comm= -g "$pid" 2>/dev/null | grep -vxE 'make|sh|ps|setsid' | tail -n 1)
		if ! kill -9 -- "-$pid" 2>/dev/null; then
			# It was through: little was left to make, or the first run was slow. All of it, then, and sooner.
			missed=$((missed + 1))
			wait "$pid" 2>/dev/null
			rm -rf "$root/hit/work"
			continue
		fi
		struck=$((struck + 1))
		stages[${name:-make}]=$((${stages[${name:-make}]:-0} + 1))
		far "$column" "$struck" "$wanted" kills
		wait "$pid" 2>/dev/null
		# It goes on from where it was hit, loses something, begins anew, or is mended at once.
		case $((RANDOM % 8)) in
		0 | 1) damage ;;
		2) rm -rf "$root/hit/work" ;;
		3) run_make "$root/hit"
			[ "$(made "$root/hit")" = "$want" ] || fail "$column, kill $struck after $ms ms: the same bytes" "$(diff <(made "$root/hit") <(printf '%s\n' "$want") | head -n 4)"
			damage ;;
		*) [ ! -e "$root/hit/work/review/index.html" ] || damage ;;
		esac
	done
	echo "  $column: $struck kills"
	check "$column: struck while it ran" test "$struck" -gt 0
	recovers "$column: $struck kills"
}

# under KIND AT MORE CLOCK COMMAND...: the command with a disk that does so from its call AT on, and a clock that stands so far off.
FAULTS=$PWD/${B:-build}/tests/preload/faults.so
calls() { od -An -tu8 "$root/calls" | tr -d ' '; }
under() {
	head -c 8 /dev/zero >"$root/calls"
	LD_PRELOAD=$FAULTS FAULTS_BELOW=$root/hit FAULTS_COUNT=$root/calls FAULTS_KIND=$1 FAULTS_AT=$2 FAULTS_MORE=$3 FAULTS_CLOCK=$4 "${@:5}"
}

# jump SECONDS: a make whose clock stands so far off is killed at some moment, or the dates of all files are set off.
jump() {
	local pid ms=$((RANDOM * length / 32768))
	if [ $((RANDOM % 3)) = 0 ]; then
		find "$root/hit" -type f -exec touch -h -d "@$(($(date +%s) + $1))" {} +
		return
	fi
	LD_PRELOAD=$FAULTS FAULTS_BELOW=$root/hit FAULTS_CLOCK=$1 setsid make --no-print-directory CAPTURE="$root/hit" >"$log" 2>&1 </dev/null &
	pid=$!
	moment "$ms" "$pid"
	kill -9 -- "-$pid" 2>/dev/null
	wait "$pid" 2>/dev/null
}

# trouble COLUMN N: a disk that fails, or a clock that jumps; each time a plain make mends it, and gives the same bytes.
trouble() {
	local column=$1 wanted=$2 struck=0 tries=0 until=$((SECONDS + 60 * MINUTES)) total kind at status says
	local kinds=(${KINDS:-full inodes eio eio clock}) least most
	rm -rf "$root/hit/work"
	under none 0 0 0 run_make "$root/hit"
	total=$(calls)
	check "$column: calls that may fail are counted" test "${total:-0}" -gt 100
	rm -rf "$root/hit/work"
	while [ "$struck" -lt "$wanted" ] && [ "$tries" -lt $((6 * wanted)) ] && [ "$SECONDS" -lt "$until" ]; do
		tries=$((tries + 1))
		kind=${kinds[RANDOM % ${#kinds[@]}]}
		# Counted are the calls that this kind may strike. A capture that is made but for a part makes fewer: early ones are as likely as late ones
		# in each order of size.
		least=20 most=$total
		[ "$kind" != inodes ] || least=1 most=$(names_of "$root/calm" | wc -l)
		at=$(awk -v u=$RANDOM -v a="$least" -v b="$most" 'BEGIN { printf "%d", a * exp(u / 32768 * log(b / a)) }')
		case $kind in
		clock) jump "$((RANDOM * 20000 - 327680000))" ;;
		*)
			under "$kind" "$at" "$((RANDOM % 4 ? 0 : RANDOM % 20))" 0 run_make "$root/hit"
			status=$?
			if [ "$(calls)" -gt "$at" ]; then
				! grep -vE '^calibrate: colmap ' "$log" | grep -qE 'Segmentation|Aborted|core dumped|terminate called|stack smashing' || fail "$column, $kind at call $at: it dies" "$(tail -n 3 "$log")"
				says=$(grep -cE '^[a-z]+(\[[0-9]+\])?: ' "$log")
				[ "$status" = 0 ] || [ "$says" -gt 0 ] || fail "$column, $kind at call $at: a line says so" "$(tail -n 3 "$log")"
			else
				kind= # the make was through before
			fi ;;
		esac
		[ -n "$kind" ] && struck=$((struck + 1)) && stages[$kind]=$((${stages[$kind]:-0} + 1)) && far "$column" "$struck" "$wanted" faults
		run_make "$root/hit" || fail "$column, ${kind:-nothing} at call $at: make afterwards" "$(tail -n 3 "$log")"
		[ "$(made "$root/hit")" = "$want" ] || fail "$column, ${kind:-nothing} at call $at: the same bytes" "$(diff <(made "$root/hit") <(printf '%s\n' "$want") | head -n 4)"
		if [ $((RANDOM % 6)) = 0 ]; then rm -rf "$root/hit/work"; else damage; fi
	done
	echo "  $column: $struck faults of a disk or a clock"
	check "$column: faults struck" test "$struck" -gt 0
	recovers "$column: $struck faults"
}

# without COLUMN: each artifact is gone while the stages behind the one that made it run by themselves: they fail, or do with what is left. Once it
# is there again what they made without it does not count.
without() {
	local column=$1 file stage past
	for file in $(cd "$root/calm/work" && find . -type f -path "${2:-./*}" ! -path './.made/*' ! -path './log/*' ! -path './review/*' ! -path './render/*' | sort); do
		rm -rf "$root/hit/work" && cp -a "$root/calm/work" "$root/hit/work" && rm "$root/hit/work/$file" && past=
		for stage in $all; do
			[ -z "$past" ] || "$BIN/$stage" --capture="$root/hit" --force --quiet >"$log" 2>&1
			! grep -q "\"work/${file#./}\": *{" "$root/hit/work/.made/$stage.json" || past=yes
		done
		recovers "$column: without ${file#./}"
	done
}

# strike_each COLUMN N: each stage's program by itself, begun anew each time and killed at a moment anywhere in its run.
strike_each() {
	local column=$1 wanted=$2 stage begin took ms pid struck
	export OPENBLAS_NUM_THREADS=1 # as make has it
	for stage in ${STAGES:-$all}; do
		begin=$(date +%s%N) struck=0
		"$BIN/$stage" --capture="$root/hit" --force --quiet >"$log" 2>&1
		took=$((($(date +%s%N) - begin) / 1000000))
		for ((i = 0; i < 2 * wanted && struck < wanted; i++)); do
			setsid "$BIN/$stage" --capture="$root/hit" --force --quiet >"$log" 2>&1 </dev/null &
			pid=$!
			ms=$((RANDOM * took / 32768))
			moment "$ms" "$pid"
			kill -9 -- "-$pid" 2>/dev/null && struck=$((struck + 1))
			wait "$pid" 2>/dev/null
			[ $((i % 16)) != 15 ] || damage
		done
		stages[$stage]=$((${stages[$stage]:-0} + struck))
		recovers "$column: $struck kills of $stage alone"
	done
}

# What goes in: photographs; a video, a mesh and a character; views of a head, where COLMAP and such views are.
photographs() {
	new_capture "$root/calm"
	"$VARIANT" half "$PHOTO" "$root/calm/photos/right_a.jpg"
	"$VARIANT" middle "$PHOTO" "$root/calm/photos/right_b.jpg"
	printf 'render.size_px = 96\nrender.frame_px = 64\nrender.photo_px = 128\nrender.map_size = 128\nrender.vein_map_px = 128\n' >>"$root/calm/capture.conf"
}
skin() { small_face "$root/calm"; }
views() {
	mkdir -p "$root/calm/views"
	cp "$VIEWS"/0000[1-4].jpg "$root/calm/views"
	printf '%s\n' "quality = draft" "calibrate.picture_px = 800" "calibrate.features = 1024" "calibrate.subject_px = 100" >"$root/calm/capture.conf"
}
VIEWS=${EYEWRIGHT_DATA:-../shared/data}/views/buddha/images
columns="skin photographs"
if [ -d "$VIEWS" ] && command -v colmap >/dev/null; then columns="views $columns"; else skip "kills of calibrate" "COLMAP or views/buddha is not there"; fi
for column in ${ONLY:-$columns}; do
	rm -rf "$root/calm"
	"$column"
	undisturbed "$column"
	strike "$column" "$(((KILLS + 5) / 6))"
	trouble "$column" "$(((KILLS + 5) / 6))"
	[ "$column" != skin ] || without skin "$([ "$KILLS" -lt 100 ] && echo ./skin/lids_model.npy || echo './skin/*')"
	[ "$EACH" = 0 ] || strike_each "$column" "$EACH"
done
for name in "${!stages[@]}"; do printf '  struck: %s %s\n' "$name" "${stages[$name]}"; done | sort

# The rest wants a folder whose make writes much.
[ "$column" != views ] || exit 0

# No file may grow beyond 300 KiB: what a full disk does to a stage that writes.
rm -rf "$root/hit/work"
(ulimit -f 300; trap '' XFSZ; run_make "$root/hit"; exit $?)
check "a full disk: make fails" test "$?" != 0
check "a full disk: one line says so" grep -qE '^[a-z]*: .*cannot write: ' "$log"
recovers "a full disk"

if [ "$(id -u)" = 0 ] && command -v mount >/dev/null && mkdir "$root/small" && mount -t tmpfs -o size=3m tmpfs "$root/small" 2>/dev/null; then
	find "$root/hit" -mindepth 1 -maxdepth 1 ! -name work -exec cp -r {} "$root/small" \;
	run_make "$root/small"
	check "a disk of 3 MiB: make fails" test "$?" != 0
	check "a disk of 3 MiB: one line says so" grep -q 'No space left on device' "$log"
	mount -o remount,size=200m "$root/small"
	run_make "$root/small"
	same "more room: make succeeds" "$?" 0
	same "more room: the same bytes" "$(made "$root/small")" "$want"
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

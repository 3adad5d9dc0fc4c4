#!/bin/bash
# Many captures: each folder of $CAPTURES but `batch`, which holds what is told of them. README.md says what stands there.
#   batch.sh local               side by side on this machine, by make's job server: JOBS at a time, THREADS for each
#   batch.sh submit SCHEDULER    as job arrays: slurm.sh
#   batch.sh status              batch/status.csv, and the failures as a table
#   batch.sh one LIST N [TARGETS] runs the capture that stands Nth in a list, and writes what became of it; NEW=yes: unless it has a result
#   batch.sh look N NAME ...     a line for each capture that has something to do; lists.sh calls it
# BIN: folder of the programs. ELSEWHERE: where results are to stand, where $CAPTURES is only read.
# Numbers have points, names are bytes, whatever the locale.
export LC_ALL=C
here=./${BASH_SOURCE[0]}
here=${here%/*} here=${here#./}
[[ $here == /* ]] || here=$PWD/$here
. "$here/lists.sh"
. "$here/tell.sh"

begin() {
	[ -n "${CAPTURES:-}" ] && [ -d "$CAPTURES" ] || die "say which folder holds the captures: make batch CAPTURES=DIR" 2
	CAPTURES=$(cd "$CAPTURES" && pwd -P && echo .) && CAPTURES=${CAPTURES%$'\n'.}
	if [ -n "${ELSEWHERE:-}" ]; then
		mkdir -p "$ELSEWHERE" || exit 1
		ELSEWHERE=$(cd "$ELSEWHERE" && pwd -P && echo .) && ELSEWHERE=${ELSEWHERE%$'\n'.}
		case $ELSEWHERE/ in "$CAPTURES"/*) die "$(one_line "$ELSEWHERE"): WORK must not lie in the folder of the captures" 2 ;; esac
	fi
	export CAPTURES BIN ELSEWHERE
	results=${ELSEWHERE:-$CAPTURES}
	state=$results/batch
	local folder
	for folder in "$state" "$state"/{log,results,rows,thumbs,slurm}; do
		[ ! -L "$folder" ] || die "$folder: is a link: results are written inside the folder alone"
	done
	[ ! -e "$state/photos" ] && [ ! -e "$state/capture.conf" ] || die "$state: is a capture: give it another name"
	[ -d "$state/log" ] && [ -d "$state/results" ] || mkdir -p "$state/log" "$state/results" || exit 1
}

one() { # LIST N [TARGETS]
	local name target=${3:-run} status start ms seconds reason
	local -a line
	mapfile -d '' -t -s $(($2 - 1)) -n 1 line <"$1" && name=${line[0]}
	[ -z "${NEW:-}" ] || [ ! -e "$state/results/$name" ] || return 0
	export CAPTURE="$CAPTURES/$name"
	# The job server is for captures: inside of one a stage at a time writes.
	unset MAKEFLAGS MFLAGS MAKELEVEL
	start=${EPOCHREALTIME/./}
	# shellcheck disable=SC2086
	make --no-print-directory -rf "$here/../capture.mk" ${ELSEWHERE:+"WORK=$ELSEWHERE/$name"} $target >"$state/log/$name" 2>&1 </dev/null
	status=$?
	ms=$(((${EPOCHREALTIME/./} - start) / 1000))
	printf -v seconds %d.%02d $((ms / 1000)) $((ms % 1000 / 10))
	if [ $status != 0 ]; then
		reason=$(why "$state/log/$name")
		tell "$name" failed "$seconds" "$(peak "$name")" "$reason"
	elif [ "$target" = run ]; then
		tell "$name" done "$seconds" "$(peak "$name")" ""
		printf '%s: done in %s s\n' "$(one_line "$name")" "$seconds" >&2
	fi
	if [ $status != 0 ] || [ "$target" = run ]; then
		printf '%s\0' "$name" | "$BIN/summary" --capture="$results" ${LIVE:---only-collect}
	fi
	return $status
}

side_by_side() {
	local cores n
	cores=$(nproc)
	case ${JOBS:=$cores} in *[!0-9]* | 0*) die "JOBS = $(one_line "$JOBS"): must be a whole number from 1" 2 ;; esac
	list_todo
	cut -f 1 "$state/todo" | pick "$state/captures" >"$state/todo.names"
	n=$(wc -l <"$state/todo")
	if [ "$n" != 0 ]; then
		[ "$JOBS" -lt "$n" ] || JOBS=$n
		# Cores are not shared by more threads than there are of them.
		export THREADS=${THREADS:-$((cores > JOBS ? cores / JOBS : 1))}
		unset MAKEFLAGS MFLAGS MAKELEVEL
		LIVE="--collect --now-and-then" ONE=$here/batch.sh LIST=$state/todo.names make --no-print-directory -rsk -j"$JOBS" -f "$here/side_by_side.mk" COUNT="$n" 2> >(grep -v '^make: ' >&2)
	fi
	status
}

begin
case ${1:-} in
local) side_by_side ;;
submit) [ "${2:-}" = slurm ] || die "SCHEDULER = $(one_line "${2:-}"): must be slurm, or nothing" 2
	. "$here/slurm.sh" && submit ;;
status) [ ! -e "$state/slurm/jobs" ] || . "$here/slurm.sh"
	status || true ;;
one) one "${@:2}" ;;
look) look "${@:2}" ;;
*) die "$(sed -n 's/^#   //p' "$0")" 2 ;;
esac

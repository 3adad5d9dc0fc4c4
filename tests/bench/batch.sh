#!/bin/bash
# Many captures, timed: side by side against one after the other, what make costs, Slurm against local, nothing to do. One line a figure;
# exit status 1 where a goal is missed.
#   N=200 SAME=1000 tests/bench/batch.sh       captures that are made; captures that have nothing to do
# The goals hold on a machine that does nothing else: the load before each part is printed.
. "$(dirname "$0")/../lib/chain.sh"
. tests/lib/many.sh
. tests/lib/slurm.sh
N=${N:-200} SAME=${SAME:-1000} PARTS=${PARTS:-local make slurm same}
trap 'slurm_stop 2>/dev/null; rm -rf "$root"' EXIT
missed=0
export OPENBLAS_NUM_THREADS=1 GLIBC_TUNABLES=glibc.malloc.hugetlb=1 OMP_WAIT_POLICY=passive

# captures DIR N: draft captures of one photograph, as they are: the bundled one.
captures() {
	local i
	for ((i = 1; i <= $2; i++)); do
		new_capture "$1/c$i" && cp "$PHOTO" "$1/c$i/photos/right_a.jpg"
	done
}
now() { date +%s%N; }
load() { cut -d' ' -f1 /proc/loadavg; }
seconds() { awk -v ns="$1" 'BEGIN { printf "%.2f", ns / 1e9 }'; }
of() { awk -v a="$1" -v b="$2" 'BEGIN { printf "%.4f", b ? a / b : 0 }'; }
goal() { # WHAT VALUE MOST|LEAST BOUND
	local ok
	if [ "$3" = most ]; then ok=$(awk -v x="$2" -v b="$4" 'BEGIN { print (x <= b) }'); else ok=$(awk -v x="$2" -v b="$4" 'BEGIN { print (x >= b) }'); fi
	[ "$ok" = 1 ] || missed=1
	printf '%-62s %10s  at %s %s: %s\n' "$1" "$2" "$3" "$4" "$([ "$ok" = 1 ] && echo reached || echo MISSED)"
}
figure() { printf '%-62s %10s s  (load before: %s)\n' "$1" "$2" "$3"; }
timed() { # COMMAND...: nanoseconds into `took`
	busy=$(load)
	local begin
	begin=$(now)
	"$@" >"$log" 2>&1 </dev/null
	bad=$?
	took=$(($(now) - begin))
	[ $bad = 0 ] || { echo "failed: $*: $(tail -n 2 "$log")"; missed=1; }
}
one_by_one() { local i; for ((i = 1; i <= N; i++)); do make --no-print-directory CAPTURE="$root/loop/c$i" THREADS="$1" || return 1; done; }
alone() { # FIRST STEP: the programs themselves, one after the other, a thread each
	local i stage
	for ((i = $1; i <= N; i += $2)); do
		for stage in $stages; do "$BIN/$stage" --capture="$root/alone/c$i" --threads=1 || return 1; done
	done
}
loops() { # the same in as many loops as there are cores
	local i pid bad=0 pids=()
	for ((i = 1; i <= $(nproc); i++)); do alone "$i" "$(nproc)" & pids+=($!); done
	for pid in "${pids[@]}"; do wait "$pid" || bad=1; done
	return $bad
}
batch() { make --no-print-directory batch CAPTURES="$@"; }

for part in $PARTS; do
	rm -rf "$root"/{loop,alone,side,one,cluster_of}
	case $part in
	local)
		for folder in loop side; do captures "$root/$folder" "$N"; done
		timed one_by_one 1; loop=$took
		figure "$N captures one after the other, a thread each" "$(seconds "$loop")" "$busy"
		rm -rf "$root/loop"; captures "$root/loop" "$N"
		timed one_by_one "$(nproc)"; wide=$took
		figure "$N captures one after the other, $(nproc) threads each" "$(seconds "$wide")" "$busy"
		timed batch "$root/side"; side=$took
		figure "$N captures side by side on $(nproc) cores" "$(seconds "$side")" "$busy"
		goal "side by side, times faster than one after the other" "$(of "$loop" "$side")" least 1.8
		printf '%-62s %10s\n' "... than one after the other with all cores for each" "$(of "$wide" "$side")" ;;
	make)
		stages="plan limbus unrefract freckles heightfield pigment relief refraction render"
		for folder in alone one; do captures "$root/$folder" "$N"; done
		timed alone 1 1; programs=$took
		figure "the programs of $N captures alone" "$(seconds "$programs")" "$busy"
		rm -rf "$root/alone"; captures "$root/alone" "$N"
		timed loops; beside=$took
		figure "the same in $(nproc) loops beside each other" "$(seconds "$beside")" "$busy"
		printf '%-62s %10s\n' "what the machine's cores give, times one of them" "$(of "$programs" "$beside")"
		timed batch "$root/one" JOBS=1 THREADS=1; one=$took
		figure "$N captures by make batch, one at a time" "$(seconds "$one")" "$busy"
		goal "what make and the batch add" "$(of $((one - programs)) "$programs")" most 0.03 ;;
	slurm)
		command -v slurmctld >/dev/null && unshare --pid --fork --kill-child=KILL --mount-proc true 2>/dev/null || { echo "Slurm: slurm-wlm is not installed, or no process namespaces"; continue; }
		for folder in cluster_of side; do captures "$root/$folder" "$N"; done
		timed batch "$root/side"; side=$took
		figure "$N captures side by side on $(nproc) cores" "$(seconds "$side")" "$busy"
		slurm_start || { echo "Slurm: no cluster: $(tail -n 2 "$cluster"/*.log)"; missed=1; continue; }
		through() { batch "$root/cluster_of" SCHEDULER=slurm && while [ "$(squeue -h | wc -l)" != 0 ]; do sleep 0.5; done; }
		timed through; slurm=$took
		slurm_stop
		figure "the same through Slurm, two nodes of a core each" "$(seconds "$slurm")" "$busy"
		check "all are done" grep -q "^$N captures: $N done, 0 failed" "$root/cluster_of/batch/slurm/summary.out"
		goal "Slurm's wall time over local" "$(of $((slurm - side)) "$side")" most 0.15 ;;
	same)
		small_captures "$root/same" 1
		run_make "$root/same/c1"
		for ((i = 2; i <= SAME; i++)); do cp -r "$root/same/c1" "$root/same/c$i"; done
		batch "$root/same" >"$log" 2>&1 </dev/null
		timed batch "$root/same"
		figure "$SAME captures with nothing to do" "$(seconds "$took")" "$busy"
		goal "seconds for 1000 with nothing to do" "$(of "$took" $((SAME * 1000000)))" most 10
		check "nothing was run" test "$(grep -c ': done in' "$log")" = 0
		rm -rf "$root/same" ;;
	esac
done
exit $missed

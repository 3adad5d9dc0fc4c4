#!/bin/bash
# Many captures, timed: side by side against one after the other, what make costs, Slurm against local, nothing to do. One line a figure;
# exit status 1 where a goal is missed.
#   N=200 SAME=1000 ROUNDS=4 tests/bench/batch.sh       captures that are made, in so many turns; captures that have nothing to do
# The goals hold on a machine that does nothing else: the load before each part is printed.
. "$(dirname "$0")/../lib/chain.sh"
. tests/lib/many.sh
. tests/lib/slurm.sh
N=${N:-200} SAME=${SAME:-1000} ROUNDS=${ROUNDS:-4} PARTS=${PARTS:-local make slurm same}
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
one_by_one() { local i; for ((i = 1; i <= n; i++)); do make --no-print-directory CAPTURE="$root/$1/c$i" THREADS="$2" || return 1; done; }
alone() { # FOLDER FIRST STEP: the programs themselves, one after the other, a thread each
	local i stage
	for ((i = $2; i <= n; i += $3)); do
		for stage in $stages; do "$BIN/$stage" --capture="$root/$1/c$i" --threads=1 || return 1; done
	done
}
loops() { # FOLDER: the same in as many loops as there are cores
	local i pid bad=0 pids=()
	for ((i = 1; i <= $(nproc); i++)); do alone "$1" "$i" "$(nproc)" & pids+=($!); done
	for pid in "${pids[@]}"; do wait "$pid" || bad=1; done
	return $bad
}
batch() { make --no-print-directory batch CAPTURES="$@"; }
through() { batch "$1" SCHEDULER=slurm && while [ "$(squeue -h | wc -l)" != 0 ]; do sleep 0.5; done; }

# A machine's speed drifts: what is compared takes turns, ROUNDS times, there and back. WAYS: names of folders; each's COMMAND is run on n new
# captures in that folder; its nanoseconds are added up in sum[].
declare -A way sum
turns() { # WAYS
	local r name order
	sum=() busy_first=
	for ((r = 1; r <= ROUNDS; r++)); do
		order=$*
		[ $((r % 2)) = 1 ] || order=$(tr ' ' '\n' <<<"$*" | tac | tr '\n' ' ')
		for name in $order; do
			rm -rf "${root:?}/$name" && captures "$root/$name" "$n"
			# shellcheck disable=SC2086
			timed ${way[$name]}
			busy_first=${busy_first:-$busy}
			sum[$name]=$((${sum[$name]:-0} + took))
		done
	done
}
told() { figure "$1" "$(seconds "${sum[$2]}")" "$busy_first"; }

stages="plan limbus unrefract freckles heightfield pigment relief refraction render"
for part in $PARTS; do
	rm -rf "${root:?}"/{loop,wide,side,alone,beside,one,cluster_of}
	n=$(((N + ROUNDS - 1) / ROUNDS)) all=$((n * ROUNDS))
	case $part in
	local)
		way=([loop]="one_by_one loop 1" [wide]="one_by_one wide $(nproc)" [side]="batch $root/side")
		turns loop wide side
		told "$all captures one after the other, a thread each" loop
		told "$all captures one after the other, $(nproc) threads each" wide
		told "$all captures side by side on $(nproc) cores" side
		goal "side by side, times faster than one after the other" "$(of "${sum[loop]}" "${sum[side]}")" least 1.8
		printf '%-62s %10s\n' "... than one after the other with all cores for each" "$(of "${sum[wide]}" "${sum[side]}")" ;;
	make)
		way=([alone]="alone alone 1 1" [beside]="loops beside" [one]="batch $root/one JOBS=1 THREADS=1")
		turns alone beside one
		told "the programs of $all captures alone" alone
		told "the same in $(nproc) loops beside each other" beside
		printf '%-62s %10s\n' "what the machine's cores give, times one of them" "$(of "${sum[alone]}" "${sum[beside]}")"
		told "$all captures by make batch, one at a time" one
		goal "what make and the batch add" "$(of $((sum[one] - sum[alone])) "${sum[alone]}")" most 0.03 ;;
	slurm)
		command -v slurmctld >/dev/null && unshare --pid --fork --kill-child=KILL --mount-proc true 2>/dev/null || { echo "Slurm: slurm-wlm is not installed, or no process namespaces"; continue; }
		slurm_start || { echo "Slurm: no cluster: $(tail -n 2 "$cluster"/*.log)"; missed=1; continue; }
		way=([side]="batch $root/side" [cluster_of]="through $root/cluster_of")
		turns side cluster_of
		slurm_stop
		told "$all captures side by side on $(nproc) cores" side
		told "the same through Slurm, two nodes of a core each" cluster_of
		check "all are done" grep -q "^$n captures: $n done, 0 failed" "$root/cluster_of/batch/slurm/summary.out"
		goal "Slurm's wall time over local" "$(of $((sum[cluster_of] - sum[side])) "${sum[side]}")" most 0.15 ;;
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

#!/bin/bash
# Many captures as Slurm's job arrays, on a cluster of two emulated nodes of this test's own; the power of one is cut in the middle.
. "$(dirname "$0")/../lib/chain.sh"
. tests/lib/many.sh
. tests/lib/slurm.sh
N=${N:-13}

for program in slurmctld slurmd munged sbatch; do
	command -v "$program" >/dev/null || { skip "job arrays of Slurm" "slurm-wlm is not installed ($program)"; exit 0; }
done
unshare --pid --fork --kill-child=KILL --mount-proc true 2>/dev/null || { skip "job arrays of Slurm" "no process namespaces here"; exit 0; }
trap 'slurm_stop; rm -rf "$root"' EXIT
slurm_start || { fail "a cluster of two nodes" "$(tail -n 2 "$cluster"/*.out "$cluster"/*.log)"; exit 0; }

many=$root/many
small_captures "$many" "$N"
broken_captures "$many"
cp -r "$many" "$root/here"
say() { make --no-print-directory "$@" >"$log" 2>&1 </dev/null; }
done_now() { grep -ls "	done	" "$many"/batch/results/* | wc -l; }
wait_for() { for _ in $(seq 3000); do "$@" && return 0; sleep 0.1; done; return 1; }
half_done() { [ "$(done_now)" -ge $((N / 2)) ]; }
all_through() { [ "$(squeue -h 2>/dev/null | wc -l)" = 0 ]; }

say batch CAPTURES="$many" SCHEDULER=slurm
same "submitted; what cannot be planned is not" "$? $(grep -c "^$((N + 1)) captures submitted in 1 job arrays" "$log") $(grep -c '^bad_key: failed' "$log")" "0 1 1"
say batch CAPTURES="$many" SCHEDULER=slurm
check "no capture twice: a second submission is refused" grep -q 'of the last submission wait or run' "$log"
check "half of them are done" wait_for half_done
slurm_kill n2
say batch-status CAPTURES="$many"
check "batch-status meanwhile: what waits, what runs" grep -qE "^$((N + 3)) captures: .* (waiting|running)" "$log"
check "one node is dead: the other finishes all" wait_for all_through
say batch-status CAPTURES="$many"
check "all but the broken ones are done" grep -qx "$((N + 3)) captures: $N done, 3 failed" "$log"
check "the summary came last, by itself" grep -qx "$((N + 3)) captures: $N done, 3 failed" "$many/batch/slurm/summary.out"
check "why a photograph failed" grep -qE '^"bad_photo",.*photos/eye.jpg: rejected: is no photograph' "$many/batch/status.csv"
same "no capture was done twice" "$(grep -h ': done in' "$many"/batch/slurm/*.out | sort | cut -d: -f1 | uniq -d)" ""

make --no-print-directory batch CAPTURES="$root/here" >"$log" 2>&1 </dev/null
differ=
for ((i = 1; i <= N; i++)); do [ "$(bytes_of "$many/c$i")" = "$(bytes_of "$root/here/c$i")" ] || differ="$differ c$i"; done
same "the same bytes as on one machine" "$differ" ""

rm -r "$many/bad_photo"
say batch CAPTURES="$many" SCHEDULER=slurm
check "nothing has changed: nothing is submitted" grep -q '^nothing to do: nothing is submitted' "$log"
slurm_stop
same "nothing is left running" "$(pgrep -f "$cluster")" ""
exit 0

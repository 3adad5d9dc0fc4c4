#!/bin/sh
# What Slurm runs: batch.sh one LIST N TARGETS for each of the task's captures, whose first and last place in the list stand in its line of
# the list's .tasks, or batch.sh status. A task that is queued again leaves out what it has finished: a capture that has its result.
batch=$1 what=$2 list=$3 targets=$4
[ "$what" = one ] || exec "$batch" "$what"
# shellcheck disable=SC2046
set -- $(sed -n "${SLURM_ARRAY_TASK_ID}p" "${list%.list}.tasks")
n=$1 bad=0
while [ "$n" -le "$2" ]; do
	NEW="$([ "$targets" != run ] || echo yes)" "$batch" one "$list" "$n" "$targets" || bad=1
	n=$((n + 1))
done
exit "$bad"

#!/bin/sh
# What Slurm runs: batch.sh one LIST N TARGETS for each of the task's captures, PER of the list, or batch.sh status. A task that is queued
# again leaves out what it has finished: a capture that has its result.
batch=$1 what=$2 list=$3 targets=$4 per=${5:-1}
[ "$what" = one ] || exec "$batch" "$what"
n=$(((SLURM_ARRAY_TASK_ID - 1) * per)) last=$((n + per)) bad=0
all=$(tr -cd '\0' <"$list" | wc -c)
[ "$last" -le "$all" ] || last=$all
while [ "$n" -lt "$last" ]; do
	n=$((n + 1))
	NEW="$([ "$per" = 1 ] || echo yes)" "$batch" one "$list" "$n" "$targets" || bad=1
done
exit "$bad"

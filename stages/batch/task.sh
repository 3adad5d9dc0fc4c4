#!/bin/sh
# What Slurm runs: batch.sh one LIST TARGETS for the task's capture, or batch.sh status.
batch=$1 what=$2
[ "$what" = one ] && exec "$batch" one "$3" "$SLURM_ARRAY_TASK_ID" "$4"
exec "$batch" "$what"

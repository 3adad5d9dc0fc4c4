#!/bin/bash
# All of `make check`, behind the build: adds up what the parts say. B: build folder; SAN_B: the sanitised one.
cd "$(dirname "$0")/.." || exit 1
RESULTS=$(mktemp)
export RESULTS
trap 'rm -f "$RESULTS"' EXIT
begin=$SECONDS
# Programs run side by side: threads that spin while they wait take the cores from the others, four times over in what has many short
# loops. Results do not depend on it; chain/threads.sh runs without it.
export OMP_WAIT_POLICY=${OMP_WAIT_POLICY:-passive} OPENBLAS_NUM_THREADS=${OPENBLAS_NUM_THREADS:-1}

part() { # TITLE COMMAND...
	local title=$1 start=$SECONDS
	shift
	echo "== $title"
	"$@" || echo "fail $title" >>"$RESULTS"
	echo "   $((SECONDS - start)) s"
}

# Side by side, one to a core; what each says comes when it is through.
beside() { # TITLE COMMAND...
	local said
	while [ "$(jobs -r | wc -l)" -ge "${JOBS:-$(nproc)}" ]; do wait -n; done
	{
		said=$(part "$@" 2>&1)
		printf '%s\n' "$said"
	} &
}

beside "layers" tests/layers.sh
part "second compiler, headers alone" tests/syntax.sh
# shellcheck disable=SC2086
part "unit tests" tests/units.sh $TESTS
# shellcheck disable=SC2086
LABEL="sanitised " part "unit tests, address and undefined-behaviour sanitisers" tests/units.sh $SAN_TESTS
beside "short trainings of the networks" tests/evidence/short.sh
# The longest first: they leave the others to fill up what is left.
begun=
for script in tests/chain/{track,viewer,skin,characters,export,views,gone,kill,hostile,long,slurm,head,cast,threads,summary}.sh tests/chain/*.sh; do
	case "$begun " in *" $script "*) continue ;; esac
	begun="$begun $script"
	beside "$script" "$script"
done
wait
[ -n "${FUZZ:-}" ] && part "fuzzing" tests/fuzz.sh

passed=$(grep -c '^pass ' "$RESULTS") failed=$(grep -c '^fail ' "$RESULTS") skipped=$(grep -c '^skip ' "$RESULTS")
echo "$((SECONDS - begin)) s"
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" = 0 ] && [ "$passed" -gt 0 ]

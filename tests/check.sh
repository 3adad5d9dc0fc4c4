#!/bin/bash
# All of `make check`, behind the build: adds up what the parts say. B: build folder; SAN_B: the sanitised one.
cd "$(dirname "$0")/.." || exit 1
RESULTS=$(mktemp)
export RESULTS
trap 'rm -f "$RESULTS"' EXIT
begin=$SECONDS

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

part "layers" tests/layers.sh
part "second compiler, headers alone" tests/syntax.sh
# shellcheck disable=SC2086
part "unit tests" tests/units.sh $TESTS
# shellcheck disable=SC2086
LABEL="sanitised " part "unit tests, address and undefined-behaviour sanitisers" tests/units.sh $SAN_TESTS
# The longest first: they leave the others to fill up what is left.
begun=
for script in tests/chain/{views,track,viewer,head,kill,slurm,accuracy}.sh tests/chain/*.sh; do
	case "$begun " in *" $script "*) continue ;; esac
	begun="$begun $script"
	beside "$script" "$script"
done
wait
part "short trainings of the networks" tests/evidence/short.sh
[ -n "${FUZZ:-}" ] && part "fuzzing" tests/fuzz.sh

passed=$(grep -c '^pass ' "$RESULTS") failed=$(grep -c '^fail ' "$RESULTS") skipped=$(grep -c '^skip ' "$RESULTS")
echo "$((SECONDS - begin)) s"
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" = 0 ] && [ "$passed" -gt 0 ]

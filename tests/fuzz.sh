#!/bin/bash
# Runs every fuzz target for $FUZZ seconds, one to a core, from seeds made anew, from the inputs kept in tests/fuzz/corpus.tar.gz and
# from what earlier runs found, which is kept in build-fuzz/corpus; a target that crashes leaves its input beside it.
# Targets of whole captures (tests/fuzz/capture) run each input in a process that may be too slow or too large: a key at its limit is.
#   CAPTURES=1  targets of whole captures, too
#   ONLY=REGEX  these targets alone
#   KEEP=1      afterwards the smallest inputs that reach the same code are put into the archive
. tests/lib/check.sh
if ! command -v clang >/dev/null 2>&1; then
	skip "fuzzing" "clang is not installed"
	exit 0
fi
if ! make --no-print-directory -j"$(nproc)" fuzzers ${CAPTURES:+capture-fuzzers} >build-fuzz.log 2>&1; then
	if grep -q 'libclang_rt\|cannot find' build-fuzz.log; then skip "fuzzing" "clang's libFuzzer is not installed"
	else fail "fuzz targets build" "$(tail -n 5 build-fuzz.log)"; fi
	rm -f build-fuzz.log
	exit 0
fi
rm -f build-fuzz.log
seeds=$(mktemp -d)
trap 'rm -rf "$seeds"' EXIT
kept=tests/fuzz/corpus.tar.gz
"${B:-build}/tests/tools/seeds" "$seeds" || exit 1
[ ! -f "$kept" ] || tar -xzf "$kept" -C "$seeds" || fail "fuzz: $kept" "cannot be unpacked"
[ -z "${CAPTURES:-}" ] || tests/fuzz/capture/seeds.sh "$seeds" || fail "fuzz: seeds of captures" "cannot be made"
export ASAN_OPTIONS=allocator_may_return_null=1${ASAN_OPTIONS:+:$ASAN_OPTIONS} # as malloc does
export TMPDIR=$seeds # what a target makes for itself goes with it
limits="-timeout=10 -rss_limit_mb=2048 -max_len=65536"

fuzz() { # TARGET NAME
	local target=$1 name=$2 said input
	local limits=$limits ASAN_OPTIONS=$ASAN_OPTIONS
	case $name in capture_*)
		limits="-timeout=20 -rss_limit_mb=3000 -max_len=4000000 -detect_leaks=0 -fork=1 -ignore_timeouts=1 -ignore_ooms=1 -seed=1"
		ASAN_OPTIONS=$ASAN_OPTIONS:detect_leaks=0 ;; # a stage that refuses its configuration exits with it
	esac
	mkdir -p "build-fuzz/corpus/$name"
	# shellcheck disable=SC2086
	if said=$("$target" -max_total_time="$FUZZ" $limits -print_final_stats=1 -artifact_prefix="build-fuzz/crash-$name-" \
		"build-fuzz/corpus/$name" "$seeds/$name" 2>&1 </dev/null); then
		pass "fuzz $name: $(printf %s "$said" | sed -n 's/stat::number_of_executed_units: */runs /p; s/^#\([0-9]*\): cov.*\(oom.*\) time.*/runs \1, \2/p' | tail -n 1)"
	else
		touch "$seeds/failed"
		fail "fuzz $name" "$(printf %s "$said" | grep -E 'ERROR|SUMMARY|Test unit' | head -n 4)"
		# The input itself, where it is gone with the machine: base64 -d brings it back.
		for input in build-fuzz/crash-"$name"-*; do
			[ -f "$input" ] && echo "  $input: $(base64 -w0 <"$input" | head -c 6000)"
		done
	fi
	[ -z "${KEEP:-}" ] || { mkdir -p "$seeds/keep/$name" && "$target" -merge=1 $limits "$seeds/keep/$name" "build-fuzz/corpus/$name" "$seeds/$name" >/dev/null 2>&1; }
}

for target in build-fuzz/fuzz_*; do
	case $target in *.*) continue ;; esac
	[[ ${target##*/fuzz_} =~ ${ONLY:-.} ]] || continue
	[[ $target != *fuzz_capture_* || -n ${CAPTURES:-} ]] || continue
	while [ "$(jobs -r | wc -l)" -ge "${JOBS:-$(nproc)}" ]; do wait -n; done
	fuzz "$target" "${target##*/fuzz_}" &
done
wait
[ -z "${KEEP:-}" ] || tar -C "$seeds/keep" --sort=name --mtime=@0 --owner=0 --group=0 --numeric-owner -cf - . | gzip -9n >"$kept"
# Beside other tests the count tells; alone, the exit status.
[ "$RESULTS" != /dev/null ] || [ ! -e "$seeds/failed" ]

#!/bin/bash
# Runs every fuzz target for $FUZZ seconds, one to a core, from seeds made anew, from the inputs kept in tests/fuzz/corpus.tar.gz and
# from what earlier runs found, which is kept in build-fuzz/corpus; a target that crashes leaves its input beside it.
#   KEEP=1      afterwards the smallest inputs that reach the same code are put into the archive
. tests/lib/check.sh
if ! command -v clang >/dev/null 2>&1; then
	skip "fuzzing" "clang is not installed"
	exit 0
fi
if ! make --no-print-directory -j"$(nproc)" fuzzers >build-fuzz.log 2>&1; then
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
export TMPDIR=$seeds # what a target makes for itself goes with it
limits="-timeout=10 -rss_limit_mb=2048 -max_len=65536"

fuzz() { # TARGET NAME
	local target=$1 name=$2 said input
	mkdir -p "build-fuzz/corpus/$name"
	# shellcheck disable=SC2086
	if said=$("$target" -max_total_time="$FUZZ" $limits -print_final_stats=1 -artifact_prefix="build-fuzz/crash-$name-" \
		"build-fuzz/corpus/$name" "$seeds/$name" 2>&1 </dev/null); then
		pass "fuzz $name: $(printf %s "$said" | sed -n 's/stat::number_of_executed_units: */runs /p')"
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
	while [ "$(jobs -r | wc -l)" -ge "${JOBS:-$(nproc)}" ]; do wait -n; done
	fuzz "$target" "${target##*/fuzz_}" &
done
wait
[ -z "${KEEP:-}" ] || tar -C "$seeds/keep" --sort=name --mtime=@0 --owner=0 --group=0 --numeric-owner -cf - . | gzip -9n >"$kept"
# Beside other tests the count tells; alone, the exit status.
[ "$RESULTS" != /dev/null ] || [ ! -e "$seeds/failed" ]

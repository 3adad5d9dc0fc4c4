#!/bin/bash
# Runs every fuzz target for $FUZZ seconds, from seeds made anew and from what earlier runs found, which is kept in
# build-fuzz/corpus; a target that crashes leaves its input beside it.
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
"${B:-build}/tests/tools/seeds" "$seeds" || exit 1
for target in build-fuzz/fuzz_*; do
	case $target in *.*) continue ;; esac
	name=${target##*/fuzz_}
	mkdir -p "build-fuzz/corpus/$name"
	if said=$("$target" -max_total_time="$FUZZ" -timeout=10 -rss_limit_mb=2048 -max_len=65536 -print_final_stats=1 \
		-artifact_prefix="build-fuzz/crash-$name-" "build-fuzz/corpus/$name" "$seeds/$name" 2>&1 </dev/null); then
		pass "fuzz $name: $(printf %s "$said" | sed -n 's/stat::number_of_executed_units: */runs /p')"
	else
		fail "fuzz $name" "$(printf %s "$said" | grep -E 'ERROR|SUMMARY|Test unit' | head -n 4)"
		# The input itself, where it is gone with the machine: base64 -d brings it back.
		for input in build-fuzz/crash-"$name"-*; do
			[ -f "$input" ] && echo "  $input: $(base64 -w0 <"$input" | head -c 6000)"
		done
	fi
done

#!/bin/bash
# The same captures through programs of two compilers: every artifact of the second against the first, number by number.
#   CC2=clang CXX2=clang++ tests/compilers.sh       or: make check-compilers
# Tolerance: of the numbers of a series (a map's channel, a column, a key) no more than SHARE are off by more than MOST of its
# largest. Compilers round sums in another order; a search that ends on a threshold passes that on.
. "$(dirname "$0")/lib/chain.sh"
CC2=${CC2:-clang} CXX2=${CXX2:-clang++}
B2=build-$CC2
MOST=${MOST:-1e-3} SHARE=${SHARE:-1e-5}
DIFFER=${B:-build}/tests/tools/differ
if ! command -v "$CC2" >/dev/null || ! command -v "$CXX2" >/dev/null; then skip "two compilers" "no $CC2 or $CXX2"; exit 0; fi

# Loops that a compiler does not vectorise as told are slower, not wrong.
other() { make --no-print-directory B="$B2" BIN="$B2/bin" CC="$CC2" CXX="$CXX2" CFLAGS="-O3 -g -Wno-unknown-warning-option -Wno-pass-failed" "$@"; }
mkdir -p "$B2" && ln -sfn ../config "$B2/config"  # programs look for it beside their folder
other -j"$(nproc)" build >"$log" 2>&1
same "$CC2 builds everything without a warning" "$? $(grep -c warning: "$log")" "0 0"

photographs() {
	new_capture "$1"
	sed -i 's/^quality = draft//' "$1/capture.conf"
	cp "$PHOTO" "$1/photos/right_a.jpg"
	"$VARIANT" half "$PHOTO" "$1/photos/right_b.jpg"
	echo "unrefract.write_map = yes" >>"$1/capture.conf"
}
skin() { small_face "$1"; }

artifacts() { (cd "$1/work" && find . -type f ! -path './.made/*' ! -path './log/*' ! -path './review/*' ! -name 'plan.*' ! -name '*.svg' ! -name '*.edge.json' | sort); }
for column in ${ONLY:-photographs skin}; do
	"$column" "$root/$column.1"
	cp -r "$root/$column.1" "$root/$column.2"
	run_make "$root/$column.1"
	same "$column: ${CC:-gcc}'s programs" "$?" 0
	other CAPTURE="$root/$column.2" >"$log" 2>&1 </dev/null
	same "$column: $CC2's programs" "$?" 0
	same "$column: the same artifacts" "$(artifacts "$root/$column.2")" "$(artifacts "$root/$column.1")"
	equal=0
	while IFS= read -r file; do
		if cmp -s "$root/$column.1/work/$file" "$root/$column.2/work/$file"; then equal=$((equal + 1)); continue; fi
		if said=$("$DIFFER" "$root/$column.1/work/$file" "$root/$column.2/work/$file" "$MOST" "$SHARE" 2>&1); then pass "$column: $file within tolerance"
		else fail "$column: $file within tolerance" "see above"; fi
		printf '%s\n' "${said//"$root/$column.1/work/"/}"
	done < <(artifacts "$root/$column.1")
	echo "  $column: $equal artifacts are the same to the byte"
done
exit 0

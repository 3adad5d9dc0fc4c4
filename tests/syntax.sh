#!/bin/bash
# A second compiler's warnings on all C, and every header compiled alone. FLAGS: further include paths; FUZZ: fuzz targets are built
# afterwards, so that what they reach is compiled by clang in any case, with all warnings.
. tests/lib/check.sh

flags="-std=c2x -D_GNU_SOURCE -Wall -Wextra -Wpedantic -Werror -fsyntax-only -Ilib -I. ${FLAGS:-}"
one() { # COMPILER NAME FILE ARGS...
	local compiler=$1 name=$2 said
	shift 2
	# shellcheck disable=SC2086
	if said=$("$compiler" $flags "$@" 2>&1); then pass "$name"; else fail "$name" "$said"; fi
}

# One to a core.
beside() {
	while [ "$(jobs -r | wc -l)" -ge "${JOBS:-$(nproc)}" ]; do wait -n; done
	one "$@" &
}

if command -v clang >/dev/null 2>&1; then
	[ -z "${FUZZ:-}" ] || make --no-print-directory -k -j"${JOBS:-$(nproc)}" build-fuzz/libeyewright.a >/dev/null 2>&1 # what fails is compiled again below, and tells why
	while IFS= read -r f; do
		if [ -n "${FUZZ:-}" ] && [ "build-fuzz/${f%.c}.o" -nt "$f" ]; then pass "clang $f"
		else beside clang "clang $f" "$f"; fi
	done < <(find lib stages render tests -name '*.c' 2>/dev/null | sort)
	cc=clang
else
	skip "clang" "not installed: gcc alone has seen the code"
	cc=gcc
fi
# A header that a source file includes before anything else has been compiled alone there.
first=$(find lib stages render tests -name '*.c' -exec awk 'FNR == 1 { seen = 0 }
	!seen && /^[ \t]*#[ \t]*include/ { seen = 1; if ($2 ~ /^"/) { gsub(/"/, "", $2); print $2; dir = FILENAME; sub(/[^\/]*$/, "", dir); print dir $2 } }' {} +)
while IFS= read -r f; do
	grep -q '^#ifndef' "$f" || continue # without a guard: a part that one source file includes
	if grep -qxF -e "$f" -e "${f#lib/}" <<<"$first"; then pass "header alone $f"
	else beside $cc "header alone $f" -x c -Wno-unused-function -Wno-unused-const-variable -Wno-pedantic -Wno-unknown-pragmas "$f"; fi
done < <(find lib stages render tests -name '*.h' 2>/dev/null | sort)
wait

#!/bin/bash
# A second compiler's warnings on all C, and every header compiled alone. FLAGS: further include paths.
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
	while IFS= read -r f; do
		beside clang "clang $f" "$f"
	done < <(find lib stages render tests -name '*.c' 2>/dev/null | sort)
	cc=clang
else
	skip "clang" "not installed: gcc alone has seen the code"
	cc=gcc
fi
while IFS= read -r f; do
	grep -q '^#ifndef' "$f" || continue # without a guard: a part that one source file includes
	beside $cc "header alone $f" -x c -Wno-unused-function -Wno-unused-const-variable -Wno-empty-translation-unit "$f"
done < <(find lib stages render tests -name '*.h' 2>/dev/null | sort)
wait

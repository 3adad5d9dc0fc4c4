# Sourced by the scripts of `make check`: one line a case, and a count of them.
#   pass NAME            fail NAME WHY            skip NAME WHY
# Cases are appended to $RESULTS as "pass|fail|skip NAME"; tests/check.sh adds them up.
set -u
RESULTS=${RESULTS:-/dev/null}

# A name may hold anything; the count goes by lines.
case_line() { printf '%s %s\n' "$1" "$(printf %s "$2" | tr '\n' ' ')" >>"$RESULTS"; }
pass() { case_line pass "$1"; [ -n "${VERBOSE:-}" ] && printf '  ok      %s\n' "$1"; return 0; }
fail() { case_line fail "$1"; printf '  FAILED  %s: %s\n' "$1" "$2"; return 0; }
skip() { case_line skip "$1"; printf '  skipped %s: %s\n' "$1" "$2"; return 0; }

# check NAME CONDITION...: passes when the command succeeds.
check() {
	local name=$1
	shift
	if "$@"; then pass "$name"; else fail "$name" "$*"; fi
}

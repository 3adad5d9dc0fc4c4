#!/bin/bash
# Runs test programs (arguments), one to a core, and adds up their cases. LABEL: put before each name ("sanitised ").
. tests/lib/check.sh

label=${LABEL:-}
one() { # PROGRAM
	local program=$1 name=${1##*/} out start=$SECONDS status cases=0 line
	out=$(mktemp)
	CMOCKA_MESSAGE_OUTPUT=TAP timeout 600 "$program" >"$out" 2>&1 </dev/null
	status=$?
	while IFS= read -r line; do
		case $line in
		*"ok "*"# SKIP"*) skip "$label$name ${line#*ok }" "see above or run $program" && cases=$((cases + 1)) ;;
		"ok "*) pass "$label$name ${line#ok }" && cases=$((cases + 1)) ;;
		"not ok "*) fail "$label$name ${line#not ok }" "run $program" && cases=$((cases + 1)) ;;
		esac
	done <"$out"
	if [ "$cases" = 0 ] || { [ $status != 0 ] && ! grep -q '^not ok' "$out"; }; then
		fail "$label$name" "ended with status $status after $cases cases"
	fi
	[ $status = 0 ] || sed 's/^/    /' "$out" | tail -n 40
	[ $((SECONDS - start)) -gt 20 ] && echo "  slow: $label$name took $((SECONDS - start)) s"
	rm -f "$out"
}

for program in "$@"; do
	while [ "$(jobs -r | wc -l)" -ge "${JOBS:-$(nproc)}" ]; do wait -n; done
	{
		said=$(one "$program")
		[ -z "$said" ] || printf '%s\n' "$said"
	} &
done
wait
exit 0

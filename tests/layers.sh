#!/bin/bash
# Includes point down only: stages, render -> skin -> eye -> bridge -> optics, image, mesh -> math -> base. Stages never
# include each other; C++ lives in lib/bridge alone; no shell is started with text of a user's.
. tests/lib/check.sh

declare -A rank=([base]=0 [math]=1 [optics]=2 [image]=2 [mesh]=2 [bridge]=3 [eye]=4 [skin]=5)

bad=
while IFS=: read -r file line text; do
	of=${file#lib/} of=${of%%/*}
	to=${text#*\"} to=${to%\"*}
	case $to in */*) into=${to%%/*} ;; *) continue ;; esac
	if [ -z "${rank[$into]:-}" ]; then
		bad+=" $file:$line includes $to, which is no layer;"
	elif [ "$into" != "$of" ] && [ "${rank[$into]}" -ge "${rank[$of]:-9}" ]; then
		bad+=" $file:$line: $of includes $into/;"
	fi
done < <(grep -nE '^[[:space:]]*#[[:space:]]*include[[:space:]]*"' -r lib --include='*.[ch]' --include='*.cc')
if [ -z "$bad" ]; then pass "layers of lib/"; else fail "layers of lib/" "$bad"; fi

bad=
while IFS=: read -r file line text; do
	to=${text#*\"} to=${to%\"*}
	dir=${file%/*}
	case $to in
	"$dir"/*) ;;
	*..*) bad+=" $file:$line includes $to;" ;;
	*/*) [ -n "${rank[${to%%/*}]:-}" ] || [ -e "$dir/$to" ] || bad+=" $file:$line includes $to;" ;;
	*) [ -e "$dir/$to" ] || bad+=" $file:$line includes $to, which is not its own;" ;;
	esac
done < <(grep -nE '^[[:space:]]*#[[:space:]]*include[[:space:]]*"' -r stages render --include='*.[ch]' 2>/dev/null)
if [ -z "$bad" ]; then pass "stages include lib/ and their own"; else fail "stages include lib/ and their own" "$bad"; fi

bad=$(find lib stages render tests \( -name '*.cc' -o -name '*.cpp' -o -name '*.hpp' -o -name '*.cxx' \) 2>/dev/null |
	grep -v '^lib/bridge/[^/]*\.cc$' | tr '\n' ' ')
if [ -z "$bad" ]; then pass "C++ in lib/bridge alone"; else fail "C++ in lib/bridge alone" "$bad"; fi

bad=$(grep -nE '\b(system|popen|wordexp)[[:space:]]*\(' -r lib stages render --include='*.[ch]' --include='*.cc' 2>/dev/null |
	tr '\n' ' ')
if [ -z "$bad" ]; then pass "no shell in lib, stages, render"; else fail "no shell in lib, stages, render" "$bad"; fi

if git rev-parse --is-inside-work-tree >/dev/null 2>&1; then
	bad=$(git ls-files | cut -d/ -f1 | sort -u |
		grep -vxE 'Makefile|README\.md|LICENSE|stages|lib|config|tests|samples|render|\..*' | tr '\n' ' ')
	if [ -z "$bad" ]; then pass "top level"; else fail "top level" "$bad"; fi
else
	skip "top level" "not a git checkout"
fi

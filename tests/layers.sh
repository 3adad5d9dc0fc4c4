#!/bin/bash
# The floors of the house. Includes point down only: stages, render -> the rooms of lib/ -> bridge -> ... -> base. Stages never
# include each other; what a header marked private (impl.h, NAME_impl.h) says stays in its folder and those below it; C++ lives in
# lib/bridge alone; no shell is started with text of a user's. B: build folder, for what is read from objects.
. tests/lib/check.sh

# A room may include rooms of lower rank, and itself.
declare -A rank=([base]=0 [math]=1 [optics]=2 [image]=2 [mesh]=2 [net]=2 [bridge]=3 [character]=4 [anatomy]=4
	[limbus]=5 [iris]=6 [tissue]=7 [model]=5 [register]=5 [plan]=5 [sfm]=6 [rig]=6 [motion]=6 [track]=7 [draw]=8 [export]=9)

includes() { grep -nE '^[[:space:]]*#[[:space:]]*include[[:space:]]*"' -r "$@" --include='*.[ch]' --include='*.cc'; }

bad=
while IFS=: read -r file line text; do
	of=${file#lib/} of=${of%%/*}
	to=${text#*\"} to=${to%\"*}
	case $to in */*) into=${to%%/*} ;; *) continue ;; esac
	if [ -z "${rank[$into]:-}" ]; then
		bad+=" $file:$line includes $to, which is no room;"
	elif [ "$into" != "$of" ] && [ "${rank[$into]}" -ge "${rank[$of]:-10}" ]; then
		bad+=" $file:$line: $of includes $into/;"
	fi
done < <(includes lib)
if [ -z "$bad" ]; then pass "floors of lib/"; else fail "floors of lib/" "$bad"; fi

bad=
while IFS=: read -r file line text; do
	to=${text#*\"} to=${to%\"*}
	case ${to##*/} in impl.h | *_impl.h) ;; *) continue ;; esac
	case $to in */*) [ -e "lib/$to" ] && to=lib/$to ;; *) continue ;; esac
	case $file in "${to%/*}"/*) ;; *) bad+=" $file:$line includes $to;" ;; esac
done < <(includes lib stages render)
if [ -z "$bad" ]; then pass "private headers stay in their rooms"; else fail "private headers stay in their rooms" "$bad"; fi

# A key with a dot is shared: one declaration, so one range, unit and meaning (lib/anatomy/keys.h, eye.h, image/video/video.h ...).
bad=$(grep -rhoE 'OPT_[A-Z_]+\("[a-z_*]+\.[^"]+"' lib stages render --include='*.[ch]' | sed 's/.*("//; s/"$//' | sort | uniq -d | tr '\n' ' ')
if [ -z "$bad" ]; then pass "shared keys are declared once"; else fail "shared keys are declared once" "$bad"; fi

facts() { # NAME KIND: passes where house.sh finds none
	local said
	said=$(tests/house.sh "$2")
	if [ -z "$said" ]; then pass "$1"; else fail "$1" "$(tr '\n' ';' <<<"$said")"; fi
}
facts "no files call each other in a circle" circles
facts "what is exported is called from elsewhere" unused
facts "every file has its header" headless

bad=
while IFS=: read -r file line text; do
	to=${text#*\"} to=${to%\"*}
	dir=${file%/*}
	case $file in render/*) own=render ;; *) own=$dir ;; esac
	case $to in
	"$own"/*) ;;
	*..*) bad+=" $file:$line includes $to;" ;;
	*/*) [ -n "${rank[${to%%/*}]:-}" ] || [ -e "$dir/$to" ] || bad+=" $file:$line includes $to;" ;;
	*) [ -e "$dir/$to" ] || bad+=" $file:$line includes $to, which is not its own;" ;;
	esac
done < <(includes stages render)
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

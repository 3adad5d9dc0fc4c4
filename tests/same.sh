#!/bin/bash
# Does this checkout make the same artifacts as another revision, to the byte? For changes that must not change results.
#   tests/same.sh REV                    or: make check-same BASE=REV
#   CAPTURES="samples/demo" ...          these captures; without it samples/demo and samples/face
#   KEEP=DIR ...                         everything is left there; a second call with it builds and runs REV no more
# REV is built in a clone of its own; both programs run on copies of this checkout's captures. Every file below work/ is compared but
# .made/ (when what was made) and log/ (times). Of the pages, what cannot stay: index.html without times, viewer.html without its sources'
# comments and include guards. Prints what differs; exits 1 if anything does.
cd "$(dirname "$0")/.." || exit 2
B=${B:-build}
CAPTURES=${CAPTURES:-samples/demo samples/face}
[ $# = 1 ] || { sed -n 's/^#   //p' "$0" >&2; exit 2; }
git rev-parse --verify --quiet "$1^{commit}" >/dev/null || { echo "same: $1: no such revision" >&2; exit 2; }
rev=$(git rev-parse --short "$1^{commit}")
if [ -n "${KEEP:-}" ]; then mkdir -p "$KEEP" && root=$(cd "$KEEP" && pwd) || exit 2
else root=$(mktemp -d) && trap 'rm -rf "$root"' EXIT; fi
base=$root/$rev

if [ ! -e "$base/built" ]; then
	rm -rf "$base"
	{ git clone -q --no-checkout . "$base/tree" && git -C "$base/tree" checkout -q "$rev"; } || exit 2
	echo "same: building $rev"
	make --no-print-directory -C "$base/tree" -j"$(nproc)" B=build BIN=bin SAN= build >"$base/log" 2>&1 || { tail -n 5 "$base/log" >&2; exit 2; }
	touch "$base/built"
fi

# run TREE CAPTURE-COPY
run() { (cd "$1" && make --no-print-directory B=build BIN=bin SAN= CAPTURE="$2" >"$2.log" 2>&1 </dev/null); }

# same_but KIND ONE OTHER: equal but for what tools/plain leaves out.
same_but() { cmp -s <("$B/tests/tools/plain" "$1" "$2") <("$B/tests/tools/plain" "$1" "$3"); }

files=0 differ=0
for capture in $CAPTURES; do
	name=${capture##*/} old=$base/captures/${capture##*/} new=$root/now/${capture##*/}
	rm -rf "$new" && mkdir -p "$root/now" "$base/captures"
	cp -r "$capture" "$new" && rm -rf "$new/work" || exit 2
	if ! diff -rq --exclude=work "$capture" "$old" >/dev/null 2>&1 || [ ! -d "$old/work" ]; then
		rm -rf "$old" && cp -r "$new" "$old" && echo "same: $name by $rev" && run "$base/tree" "$old" || { echo "same: $rev fails on $name: $(tail -n 1 "$old.log")"; differ=$((differ + 1)); }
	fi
	echo "same: $name by this checkout"
	run . "$new" || { echo "same: this checkout fails on $name: $(tail -n 1 "$new.log")"; differ=$((differ + 1)); }
	while IFS= read -r file; do
		files=$((files + 1)) one=$old/work/$file other=$new/work/$file
		if [ ! -e "$one" ]; then echo "new      $name/$file"
		elif [ ! -e "$other" ]; then echo "missing  $name/$file"
		elif cmp -s "$one" "$other"; then continue
		else
			case $file in
			review/index.html) same_but times "$one" "$other" && continue ;;
			review/viewer.html) same_but code "$one" "$other" && continue ;;
			esac
			echo "differs  $name/$file ($(wc -c <"$one") and $(wc -c <"$other") bytes)"
		fi
		differ=$((differ + 1))
	done < <({ (cd "$old/work" && find . -type f) && (cd "$new/work" && find . -type f); } | sed 's#^\./##' | grep -vE '^(\.made|log)/' | sort -u)
done
echo "$files artifacts, $differ differ from $rev"
[ "$differ" = 0 ] && [ "$files" -gt 0 ]

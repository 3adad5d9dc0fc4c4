#!/bin/bash
# A photograph in which no eye is found, and the limbus that a person draws on the review page: the line that the page offers makes it usable.
. "$(dirname "$0")/../lib/chain.sh"
if ! command -v chromium >/dev/null || ! command -v node >/dev/null; then
	skip "the limbus drawn in a browser" "no chromium or no node: apt-get install chromium nodejs"
	exit 0
fi

new_capture "$root/a"
cp "$PHOTO" "$root/a/photos/eye.jpg"
# No photograph is as bright as this asks for: it is refused.
echo "limbus.min_level = 1" >>"$root/a/capture.conf"
run_make "$root/a"
check "the photograph is refused" test "$?" != 0 -a ! -d "$root/a/work/iris"
check "the page is there all the same" test -s "$root/a/work/review/index.html"
check "and make says so" grep -q 'can be drawn on .*/work/review/index.html' "$log"
check "on it the drawing is open" grep -q '<details class="hand" open>' "$root/a/work/review/index.html"
timeout 120 node tests/browser/drawn.js "$root/a/work/review/index.html" "$root/line" "${SHOTS:-}" >"$root/said" 2>&1
while IFS= read -r line; do
	case $line in
	"pass "*) pass "${line#pass }" ;;
	"fail "*) fail "${line#fail }" "" ;;
	esac
done <"$root/said"
check "the browser's run came to its end" grep -q 'drawn: no error' "$root/said"
cat "$root/line" >>"$root/a/capture.conf"
"$BIN/limbus" --capture="$root/a" >"$log" 2>&1
same "the page's line is taken" "$? $(grep -o '"by_hand": *[a-z]*' "$root/a/work/limbus/eye.json")" '0 "by_hand": true'

#!/bin/bash
# The table and the page of many captures: what was found in each, worst first; strangers' names and reasons are text and nothing else.
. "$(dirname "$0")/../lib/chain.sh"
. tests/lib/many.sh
N=${N:-10000}

many=$root/many
small_captures "$many" 3
# Told, so that nothing is doubtful: one photograph cannot tell a round limbus from people's.
for i in 1 2 3; do echo "eye.limbus_aspect = 1" >>"$many/c$i/capture.conf"; done
broken_captures "$many"
doubted='</script><script>window.ran=1</script> <b>alert(1)'
mkdir -p "$many/${doubted//\//∕}"
doubted=${doubted//\//∕}
cp -r "$many/c1/." "$many/$doubted" && cp "$many/bad_photo/photos/eye.jpg" "$many/$doubted/photos/right_<img src=x onerror=alert(1)>.jpg"
make --no-print-directory batch CAPTURES="$many" JOBS=2 >"$log" 2>&1 </dev/null
batch=$many/batch
check "a page and two tables" test -s "$batch/index.html" -a -s "$batch/summary.csv" -a -s "$batch/summary.json"
if command -v node >/dev/null; then
	node tests/browser/summary_tables.js "$batch" "$many" c1 right_a >"$root/said" 2>&1
else
	skip "the tables hold what the captures' own files hold" "node is not installed"
	: >"$root/said"
fi
made=$(cd "$batch" && stat -c "%n %y" rows/* thumbs/*)
make --no-print-directory batch CAPTURES="$many" JOBS=2 >"$log" 2>&1 </dev/null
same "again: no row and no picture is written" "$(cd "$batch" && stat -c "%n %y" rows/* thumbs/*)" "$made"
rm -r "$many/c3"
make --no-print-directory batch-status CAPTURES="$many" >"$log" 2>&1 </dev/null
same "a capture that is gone is no longer told of" "$(grep -c '^"c3"' "$batch/summary.csv") $(grep -c '"c2"' "$batch/index.html")" "0 1"

# Made outside of a batch since: the next one tells of it.
echo "eye.limbus_radius_mm = 6.1" >>"$many/c2/capture.conf"
run_make "$many/c2"
make --no-print-directory batch CAPTURES="$many" >"$log" 2>&1 </dev/null
want=$(sed -n 's/^ *"theta_deg": *\([-0-9.e]*\),.*/\1/p' "$many/c2/work/limbus/right_a.json" | head -n 1)
check "made outside of the batch: told of with its new numbers" grep -q "^\"c2\",photograph,.*,$want," "$batch/summary.csv"

# What stands in batch/ may be anybody's, too.
victim=$root/victim && mkdir "$victim" && echo mine >"$victim/a"
mapfile -t rows < <(ls "$batch/rows/"*.json)
echo '{"records": [7, {"part": 3, "of": []}, {"part": "limbus"}], "thumb": "x"}' >"${rows[0]}"
rm "${rows[1]}" && mkfifo "${rows[1]}"
head -c 5000 /dev/urandom >"${rows[2]}"
printf 'c1\tdone\t1\t1\t\0\n' >"$batch/results/c1"
timeout 60 make --no-print-directory batch-status CAPTURES="$many" >"$log" 2>&1 </dev/null
check "rows and results that are nonsense do not hang it" test "$?" != 124
same "what can be told is" "$(grep -c "captures: " "$log") $(grep -c "^summary: " "$log")" "1 0"
rm "${rows[1]}"
rm -r "$batch/thumbs" && ln -s "$victim" "$batch/thumbs"
timeout 60 make --no-print-directory batch CAPTURES="$many" >"$log" 2>&1 </dev/null
check "a link in batch/: one line" grep -q "batch/thumbs: is a link" "$log"
same "nothing is written behind a link in batch/" "$(ls -A "$victim") $(cat "$victim/a")" "a mine"
rm -f "$batch/thumbs"

# As captures finish: a page is there when the first of two is done.
mkdir -p "$root/slow"
cp -r "$root/many/c1" "$root/slow/a" && cp -r "$root/many/c1" "$root/slow/b" && rm -rf "$root/slow"/?/work
mkdir -p "$root/bin" && ln -s "$PWD/$BIN"/* "$root/bin" && rm "$root/bin/render"
printf '#!/bin/bash\n[ "${CAPTURE##*/}" = a ] || { cp "%s/slow/batch/index.html" "%s/seen" 2>/dev/null; }\nexec "%s/%s/render" "$@"\n' "$root" "$root" "$PWD" "$BIN" >"$root/bin/render"
chmod +x "$root/bin/render"
CAPTURES=$root/slow BIN=$root/bin JOBS=1 stages/batch/batch.sh local >"$log" 2>&1
check "written as captures finish" grep -qs '\["pass","a"' "$root/seen"

if command -v chromium >/dev/null && command -v node >/dev/null; then
	# Many, with the results of the few.
	mkdir -p "$root/crowd/batch/results" && cp -r "$many/c1/work" "$root/bare" && rm "$root/bare/limbus/"*.png
	make --no-print-directory batch CAPTURES="$many" >"$log" 2>&1 </dev/null
	node tests/browser/summary_crowd.js "$root/crowd" "$N" "$many/c1/work" "$root/bare" | "$BIN/summary" --capture="$root/crowd" --only-collect >"$log" 2>&1
	same "$N captures are read" "$? $(cat "$log")" "0 "
	begin=$(date +%s%N)
	"$BIN/summary" --capture="$root/crowd" >"$log" 2>&1
	same "$N captures are put together" "$? $(cat "$log")" "0 "
	echo "  $N captures put together in $((($(date +%s%N) - begin) / 1000000)) ms"
	timeout 120 node tests/browser/summary.js "$root/crowd/batch/index.html" "$N" "${SHOTS:-$root}/summary.png" >>"$root/said" 2>&1
	check "the browser's run came to its end" grep -q 'nothing is loaded from elsewhere' "$root/said"
else skip "the page in a browser" "no chromium or no node: apt-get install chromium nodejs"; fi
while IFS= read -r line; do
	case $line in
	"pass "*) pass "${line#pass }" ;;
	"fail "*) fail "${line#fail }" "" ;;
	*) printf '%s\n' "$line" ;;
	esac
done <"$root/said"
exit 0

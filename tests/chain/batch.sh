#!/bin/bash
# Many captures on one machine: side by side, the same bytes as one after the other, one row for each, why each failure failed.
. "$(dirname "$0")/../lib/chain.sh"
. tests/lib/many.sh

many=$root/many
small_captures "$many" 4
broken_captures "$many"
mv "$many/c2" "$many/\$(touch gone) 'a \"b"
cp -r "$many" "$root/single"
for folder in "$root/single"/*/; do run_make "${folder%/}"; done

make --no-print-directory batch CAPTURES="$many" JOBS=3 >"$log" 2>&1 </dev/null
same "some fail: so does make" "$?" 2
cp "$log" "$root/first"
check "the counts" grep -qx '7 captures: 4 done, 3 failed' "$log"
same "a row for each, the failures first" "$(cut -d, -f1,2 "$many/batch/status.csv" | tr '\n' ' ')" \
	'capture,state "bad_key",failed "bad_photo",failed "nothing",failed "$(touch gone) '"'"'a ""b",done "c1",done "c3",done "c4",done '
check "why: a key" grep -qE '^"bad_key",.*capture.conf:[0-9]+: eye.colour = blue: unknown key' "$many/batch/status.csv"
check "why: a photograph" grep -qE '^"bad_photo",.*photos/eye.jpg: rejected: is no photograph' "$many/batch/status.csv"
check "why: an empty folder" grep -qE '^"nothing",.*nothing to work on' "$many/batch/status.csv"
check "peak memory is told" grep -qE '^"c1",done,[0-9.]+,[1-9][0-9]*,' "$many/batch/status.csv"
check "no name reaches a shell" test ! -e gone -a ! -e "$many/gone"
for folder in "$root/single"/*/; do
	name=$(basename "$folder")
	[ ! -d "$folder/work/render" ] || same "$name: the same bytes as alone" "$(bytes_of "$many/$name")" "$(bytes_of "$folder")"
done
made=$(for name in c1 c3 c4; do times_of "$many/$name"; done)
make --no-print-directory batch CAPTURES="$many" JOBS=3 >"$log" 2>&1 </dev/null
same "again: nothing is made" "$(for name in c1 c3 c4; do times_of "$many/$name"; done)" "$made"
check "and the counts stand" grep -qx '7 captures: 4 done, 3 failed' "$log"
make --no-print-directory batch-status CAPTURES="$many" >"$log" 2>&1 </dev/null
same "batch-status" "$? $(grep -c '^bad_' "$log")" "0 2"

# What is called wrongly, and folders that are none.
wrong() { # NAME SAYS ARGUMENT...
	make --no-print-directory batch "${@:3}" >"$log" 2>&1 </dev/null
	check "$1: one line" test "$? $(grep -c "^batch: .*$2" "$log")" = "2 1"
}
wrong "no folder named" "say which folder" CAPTURES=
wrong "a missing folder" "say which folder" CAPTURES="$root/missing"
wrong "JOBS that is no number" "JOBS = two" CAPTURES="$many" JOBS=two
wrong "an unknown scheduler" "SCHEDULER = lsf" CAPTURES="$many" SCHEDULER=lsf
mkdir "$root/linked" "$root/elsewhere" && ln -s "$root/elsewhere" "$root/linked/batch"
wrong "batch/ is a link" "is a link" CAPTURES="$root/linked"
same "nothing is written behind it" "$(ls -A "$root/elsewhere")" ""

# Side by side means at the same time: programs that stand in for plan, each of which waits until the other has begun.
mkdir -p "$root/bin" "$root/two/a/work" "$root/two/b/work"
ln -s "$PWD/$BIN/summary" "$root/bin/summary"
cat >"$root/bin/plan" <<'STAND_IN'
#!/bin/bash
case $* in
*--requests) while IFS= read -r -d '' _; do echo "3	limbus	1	1"; done; exit 0 ;;
esac
touch "$CAPTURE/begun"
for _ in $(seq 200); do [ -e "$CAPTURE/../a/begun" ] && [ -e "$CAPTURE/../b/begun" ] && exit 0; sleep 0.1; done
exit 1
STAND_IN
chmod +x "$root/bin/plan"
CAPTURES=$root/two BIN=$root/bin JOBS=2 stages/batch/batch.sh local >"$log" 2>&1
same "two captures at the same time" "$? $(grep -c '^2 captures: 2 done' "$log")" "0 1"
exit 0

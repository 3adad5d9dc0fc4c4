#!/bin/bash
# What surrounds the programs: captures that are only read, locales, umask. The same bytes whatever it is.
. "$(dirname "$0")/../lib/chain.sh"
. tests/lib/many.sh

small_captures "$root/plain" 1
small_captures "$root/read" 1
cp -r "$root/plain" "$root/batched"
cp -r "$root/plain" "$root/spoken"
for mask in 077 000; do cp -r "$root/plain" "$root/mask$mask"; done
run_make "$root/plain/c1"
same "a capture to compare with" "$?" 0
want=$(bytes_of "$root/plain/c1")

# WORK=: nothing is written in the capture, not even where that could be.
state() { (cd "$1" && find . -printf '%p %y %m %T@ %s\n' | sort && find . -type f -print0 | sort -z | xargs -0 sha256sum); }
share=$root/read/c1 there="$root/else where \$x"
cp "$share/capture.conf" "$root/conf"
echo "render.shots = more/shots.json" >>"$share/capture.conf"
mkdir "$share/more" && echo '[{"name": "a", "cam_from_eye": null, "environment": null}]' >"$share/more/shots.json"
before=$(state "$root/read")
run_make "$share" "WORK=$there"
same "WORK=: all is made there" "$? $(ran | wc -w)" "0 8"
check "its page" test -s "$there/work/review/index.html"
same "the capture is as it was" "$(state "$root/read")" "$before"
run_make "$share" "WORK=$there"
same "again: nothing runs" "$? $(ran)" "0 "
same "a stage alone" "$(run_make "$share" limbus "WORK=$there"; echo $?) $(ran)" "0 "
cp "$share/photos/right_a.jpg" "$share/photos/right_b.jpg" && rm -r "$share/more" && cp "$root/conf" "$share/capture.conf"
run_make "$share" "WORK=$there"
same "what changed in the capture runs again" "$? $(grep -c '^limbus: right_b' "$log")" "0 1"
check "links to what is gone are gone" test ! -L "$there/more"
rm "$share/photos/right_b.jpg"
run_make "$share" clean "WORK=$there"
same "clean" "$? $(ls "$there" | tr '\n' ' ')" "0 capture.conf photos "
ln -s "$PWD/samples/demo/photos/right_softbox.jpg" "$share/photos/right_out.jpg"
run_make "$share" "WORK=$there"
check "a link of the capture that leads out is refused there, too" grep -q 'photos/right_out.jpg: is a link that leads out of the capture' "$log"
rm "$share/photos/right_out.jpg"
for wrong in "$share" "$share/inside" "$root/read" "$root/plain/c1"; do
	run_make "$share" "WORK=$wrong"
	same "WORK=${wrong#"$root/"}: refused in one line" "$? $(grep -c '^plan: ' "$log")" "2 1"
done
rm -rf "$share/inside"
WORK=$root/nowhere run_make "$root/plain/c1"
same "a variable of that name that clusters have is not meant" "$? $(ls -d "$root/nowhere" 2>/dev/null)" "0 "
before=$(state "$root/read")
make --no-print-directory batch CAPTURES="$root/read" WORK="$root/results" >"$log" 2>&1 </dev/null
same "a batch of captures that are only read" "$? $(grep -c '^1 captures: 1 done' "$log") $(bytes_of "$root/results/c1")" "0 1 $want"
same "they are as they were" "$(state "$root/read")" "$before"
if unshare -m true 2>/dev/null; then
	unshare -m bash -c 'mount --bind "$0" "$0" && mount -o remount,bind,ro "$0" && ! touch "$0/x" 2>/dev/null && make --no-print-directory CAPTURE="$0" WORK="$1"' \
		"$share" "$root/ro" >"$log" 2>&1 </dev/null
	same "a share that cannot be written" "$? $(bytes_of "$root/ro")" "0 $want"
else skip "a share that cannot be written" "no mount namespaces here"; fi

# Locales with a decimal comma and with a dotless i: what is read and written has points.
if localedef -i de_DE -f UTF-8 "$root/de_DE.UTF-8" 2>/dev/null && localedef -i tr_TR -f UTF-8 "$root/tr_TR.UTF-8" 2>/dev/null &&
	[ "$(LOCPATH=$root LC_ALL=de_DE.UTF-8 locale decimal_point 2>/dev/null)" = , ]; then
	for locale in de_DE.UTF-8 tr_TR.UTF-8; do
		rm -rf "$root/spoken/c1/work"
		env LOCPATH="$root" LC_ALL=$locale make --no-print-directory CAPTURE="$root/spoken/c1" >"$log" 2>&1 </dev/null
		same "$locale: the same bytes" "$? $(bytes_of "$root/spoken/c1")" "0 $want"
	done
	env LOCPATH="$root" LC_ALL=de_DE.UTF-8 make --no-print-directory batch CAPTURES="$root/batched" >"$log" 2>&1 </dev/null
	same "a batch in de_DE" "$? $(bytes_of "$root/batched/c1")" "0 $want"
	check "its table has points" grep -qE '^"c1",done,[0-9]+\.[0-9]+,[0-9]+,' "$root/batched/batch/status.csv"
else skip "locales" "localedef has no locales: apt-get install locales"; fi

# Whatever the umask: the same bytes, the modes it asks for.
for mask in 077 000; do
	(umask $mask && run_make "$root/mask$mask/c1")
	same "umask $mask: the same bytes" "$? $(bytes_of "$root/mask$mask/c1")" "0 $want"
	(umask $mask && run_make "$root/mask$mask/c1")
	same "umask $mask: again nothing runs" "$? $(ran)" "0 "
	made=$(find "$root/mask$mask/c1/work" -type f | wc -l)
	case $mask in
	077) same "umask 077: nobody else may read it" "$(find "$root/mask077/c1/work" -type f -perm /077 | wc -l)" 0 ;;
	000) same "umask 000: as wide as it allows" "$(find "$root/mask000/c1/work" -type f -perm 666 | wc -l)" "$made" ;;
	esac
done
exit 0

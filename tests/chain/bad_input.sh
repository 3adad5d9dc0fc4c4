#!/bin/bash
# Bad input: one clear line for each photograph, the others go on, what was made before stays.
. "$(dirname "$0")/../lib/chain.sh"

make_bad() { # KIND FILE
	case $1 in
	empty) : >"$2" ;;
	directory) mkdir "$2" ;;
	text) echo "not a picture" >"$2" ;;
	pipe) mkfifo "$2" ;;
	unreadable) cp "$PHOTO" "$2" && chmod 000 "$2" ;;
	dangling) ln -s nowhere "$2" ;;
	*) "$VARIANT" "$1" "$PHOTO" "$2" ;;
	esac
}
# What the one line about each has to say.
declare -A says=([empty]="is empty" [directory]="is a folder" [text]="is no photograph" [pipe]="not a regular file"
	[cmyk]="CMYK" [truncated]="truncated" [mpx200]="200 megapixels" [closed]="eye" [noise]="eye" [over]="over-exposed"
	[dangling]="No such file" [unreadable]="Permission denied" [cut]="")
kinds="empty directory text pipe cmyk truncated mpx200 closed noise over dangling cut"
if [ "$(id -u)" = 0 ]; then skip "unreadable photograph" "root reads everything"; else kinds="$kinds unreadable"; fi

# All of them beside good ones.
capture=$root/mixed
new_capture "$capture"
cp "$PHOTO" "$capture/photos/right_good.jpg"
for kind in $kinds; do make_bad "$kind" "$capture/photos/right_$kind.jpg"; done
run_make "$capture" limbus
same "bad photographs beside a good one" "$?" 0
check "the good one has its fit" grep -q '"status": *"ok"' "$capture/work/limbus/right_good.json"
for kind in $kinds; do
	n=$(grep -c "right_$kind" "$log")
	line=$(grep "right_$kind" "$log")
	if [ "$n" != 1 ]; then fail "$kind: one line" "$n lines: $line"; else
		case $line in
		*"${says[$kind]}"*) pass "$kind: one clear line" ;;
		*) fail "$kind: one clear line" "$line must say ${says[$kind]}" ;;
		esac
	fi
	grep -q '"status": *"rejected"' "$capture/work/limbus/right_$kind.json" 2>/dev/null
	same "$kind: its fit says rejected" "$?" 0
done

# Handled: another depth, no colour, another container behind a name that lies.
capture=$root/handled
new_capture "$capture"
for kind in grey png16 tiff16 exr half; do "$VARIANT" $kind "$PHOTO" "$capture/photos/right_$kind.jpg"; done
run_make "$capture" limbus
same "grey, 16-bit, TIFF, EXR, small" "$?" 0
for kind in grey png16 tiff16 exr half; do
	check "$kind is handled" grep -q '"status": *"ok"' "$capture/work/limbus/right_$kind.json"
done

# Nothing but a bad one, after a good run: exit 1, one line, and what was made stays.
capture=$root/worse
new_capture "$capture"
cp "$PHOTO" "$capture/photos/right_a.jpg"
run_make "$capture" freckles
same "a good run first" "$?" 0
before=$(cd "$capture/work/iris" && sha256sum ./*)
for kind in truncated cmyk closed empty; do
	rm -rf "$capture/photos/right_a.jpg"
	make_bad "$kind" "$capture/photos/right_a.jpg"
	"$BIN/limbus" --capture="$capture" >"$log" 2>&1
	same "$kind alone: exit status" "$?" 1
	check "$kind alone: says what to do" grep -q "${says[$kind]}" "$log"
	run_make "$capture"
	check "$kind alone: make fails" test "$?" != 0
	same "$kind alone: what was made stays" "$(cd "$capture/work/iris" && sha256sum ./*)" "$before"
done

# Folders.
new_capture "$root/none"
run_make "$root/none"
check "no photographs: make fails" test "$?" != 0
check "no photographs: one clear line" grep -q "nothing to work on: put macro photographs" "$log"
run_make "$root/missing"
check "missing folder: make fails" test "$?" != 0
check "missing folder: one clear line" grep -q "no such folder" "$log"
"$BIN/plan" --capture="$root/missing" >"$log" 2>&1
same "missing folder: exit status" "$?" 1
"$BIN/plan" --nonsense >"$log" 2>&1
same "a wrong call: exit status" "$?" 2

# The configuration: every stage's keys are judged before the first stage starts.
capture=$root/conf
conf_case() { # NAME LINE SAYS
	new_capture "$capture"
	cp "$PHOTO" "$capture/photos/right_a.jpg"
	echo "$2" >>"$capture/capture.conf"
	run_make "$capture"
	check "$1: make fails" test "$?" != 0
	same "$1: nothing ran" "$(ran)" ""
	check "$1: one line" test "$(grep -c "capture.conf:" "$log")" = 1
	check "$1: place, key, value, rule" grep -qE "$3" "$log"
	rm -rf "$capture"
}
conf_case "unknown key" "eye.colour = blue" 'capture.conf:[0-9]+: eye.colour = blue: unknown key'
conf_case "a later stage's unknown key" "relief.nonsense = 1" 'capture.conf:[0-9]+: relief.nonsense = 1: unknown key'
conf_case "out of range" "eye.index = 7" 'capture.conf:[0-9]+: eye.index = 7: must be .*\[1, 2\]'
conf_case "not a number" "camera.sensor_mm = long" 'capture.conf:[0-9]+: camera.sensor_mm = long: must be a number'
conf_case "not key = value" "nonsense" 'capture.conf:[0-9]+: not of the form key = value'
conf_case "too few numbers" "photo.x.hint_px = 1 2" 'capture.conf:[0-9]+: photo.*hint_px'

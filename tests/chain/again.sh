#!/bin/bash
# A second make runs no stage; a change runs again what it touches and nothing else, by bytes and not by dates.
. "$(dirname "$0")/../lib/chain.sh"

capture="$root/it's a \"capture\"; \$(touch x) \$HOME %d
second line"
new_capture "$capture"
cp "$PHOTO" "$capture/photos/right_it's \"one\" \$HOME
two.jpg"
cp "$PHOTO" "$capture/photos/right_b.jpg"

run_make "$capture"
same "make on a name with spaces, quotes, dollars and newlines" "$?" 0
all=$(ran)
check "the review page is there" test -s "$capture/work/review/index.html"
for name in "right_it's \"one\" \$HOME
two" right_b; do
	check "a fit of $name" grep -q '"status": *"ok"' "$capture/work/limbus/$name.json"
done
check "nothing is written outside work/" test "$(ls -A "$capture" | tr '\n' ' ')" = "capture.conf photos work "
check "no shell ran the name" test ! -e x

before=$(times_of "$capture")
run_make "$capture"
same "second make succeeds" "$?" 0
same "second make runs no stage" "$(ran)" ""
same "second make writes nothing" "$(times_of "$capture")" "$before"
CAPTURE=$capture make --no-print-directory >"$log" 2>&1
same "through the environment, no stage either" "$? $(ran)" "0 "

touch "$capture"/photos/* "$capture/capture.conf" "$BIN"/*
run_make "$capture"
same "new dates on old bytes run nothing" "$(ran)" ""

made=$(bytes_of "$capture")
rm "$capture/work/iris/clean.exr"
run_make "$capture"
case " $(ran) " in *" freckles "*) pass "a deleted artifact is made again" ;; *) fail "a deleted artifact is made again" "ran $(ran)" ;; esac
case " $(ran) " in *limbus* | *unrefract*) fail "and nothing before it" "ran $(ran)" ;; *) pass "and nothing before it" ;; esac
same "with the same bytes" "$(bytes_of "$capture")" "$made"

truncate -s 1000 "$capture/work/iris/texture.exr"
run_make "$capture"
case " $(ran) " in *" unrefract "*) pass "a truncated artifact is made again" ;; *) fail "a truncated artifact is made again" "ran $(ran)" ;; esac
same "with the same bytes as before" "$(bytes_of "$capture")" "$made"

scratch "$capture/work/iris/texture.exr" 2000
run_make "$capture"
case " $(ran) " in *" unrefract "*) pass "an artifact edited by hand is made again" ;; *) fail "an artifact edited by hand is made again" "ran $(ran)" ;; esac
same "with the bytes it had" "$(bytes_of "$capture")" "$made"

# A key runs the stages that read it, and after them only those whose inputs changed their bytes.
runs() { # KEY VALUE STAGES...: exactly these begin
	local key=$1 value=$2
	shift 2
	cp "$capture/capture.conf" "$root/conf"
	echo "$key = $value" >>"$capture/capture.conf"
	run_make "$capture"
	same "$key runs what reads it" "$(ran)" "$*"
	mv "$root/conf" "$capture/capture.conf"
	run_make "$capture"
	same "and taken back the bytes are the old ones" "$(bytes_of "$capture")" "$made"
}
runs render.gaze "15 -5" render

begin=$(date +%s%N)
run_make "$capture"
[ -n "${VERBOSE:-}" ] && echo "  nothing changed: $((($(date +%s%N) - begin) / 1000000)) ms"
same "nothing changed" "$(ran)" ""

sed "s/^light.illuminant.*/light.illuminant = A/" "$capture/capture.conf" >"$capture/new" && mv "$capture/new" "$capture/capture.conf"
run_make "$capture"
case " $(ran) " in *limbus* | *unrefract* | *freckles*) fail "a key runs the stages that read it" "ran $(ran)" ;;
*" pigment "*) pass "a key runs the stages that read it" ;;
*) fail "a key runs the stages that read it" "ran $(ran)" ;;
esac

rm "$capture/photos/right_b.jpg"
run_make "$capture"
case " $(ran) " in *" limbus "*) pass "a photograph taken away is noticed" ;; *) fail "a photograph taken away is noticed" "ran $(ran)" ;; esac
run_make "$capture"
same "and then nothing runs" "$(ran)" ""

run_make "$capture" clean
same "clean leaves what was put in" "$(ls -A "$capture" | tr '\n' ' ')" "capture.conf photos "
run_make "$capture" plan
same "plan of a clean folder" "$?" 0
check "plan lists the stages" grep -q '^limbus  *run ' "$log"
check "plan says why not" grep -q '^track .*no video/' "$log"
run_make "$capture" limbus
same "one stage alone" "$(ran)" "limbus"
run_make "$capture"
same "and then the others" "limbus $(ran)" "$all"

victim=$root/victim
mkdir "$victim" && touch "$victim/precious"
run_make "$capture" clean
ln -s "$victim" "$capture/work"
run_make "$capture"
check "a work/ that leads elsewhere is refused" test "$?" != 0
run_make "$capture" clean
check "clean does not follow it" test -e "$victim/precious"

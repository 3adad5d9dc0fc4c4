#!/bin/bash
# Of every stage: an artifact that is deleted, cut or written into is found, by that stage and by those that read it, and made
# again with its old bytes; a key that changes is found by exactly the stages that read it; a photograph that is added is worked
# on, and the others are not.
. "$(dirname "$0")/../lib/chain.sh"
photographs() {
	new_capture "$1"
	"$VARIANT" half "$PHOTO" "$1/photos/right_a.jpg"
	printf 'render.size_px = 96\nrender.frame_px = 64\nrender.photo_px = 128\nrender.map_size = 128\nrender.vein_map_px = 128\n' >>"$1/capture.conf"
}
skin() { small_face "$1"; }

# Artifacts that a stage's record names, and those that it read.
outputs() { tr -d '\n' <"$capture/work/.made/$1.json" | sed 's/.*"outputs": *{//' | grep -o '"work/[^"]*": *{ *"hash"' | cut -d'"' -f2; }
reads() { grep -q "\"$2\": \"" "$capture/work/.made/$1.json"; }
stale() { # stages whose record no longer holds, in order
	local stage said=
	for stage in $all; do "$BIN/plan" --capture="$capture" --fresh="$stage" >"$log" 2>&1 || said="$said $stage"; done
	echo "${said# }"
}
counted() { # what a stage says of its last run
	tr -d ' \n' <"$capture/work/log/$1.json" | sed -n 's/.*"artifacts":{"kept":\([0-9]*\),"made":\([0-9]*\)}.*/\2 made, \1 kept/p'
}
spoil() { # KIND FILE
	case $1 in
	deleted) rm "$2" ;;
	cut) truncate -s "$(($(stat -c %s "$2") / 2))" "$2" ;;
	edited) scratch "$2" "$(($(stat -c %s "$2") / 2))" ;;
	esac
}

# Another value that is as good, or none.
other_value() {
	case $1 in
	yes) echo no ;;
	no) echo yes ;;
	[0-9]*[.e][0-9]*) awk -v x="$1" 'BEGIN { if (x == x + 0) print x * 0.99 }' ;;
	[1-9] | [1-9][0-9]*) [[ $1 =~ ^[0-9]+$ ]] && echo $(($1 + 1)) ;;
	esac
}

keys() { # a shared key is each reader's; of a stage's own, three
	for stage in $all; do "$BIN/$stage" --capture="$capture" --print-config | grep "^$stage\." | head -n 3; done
	for stage in $all; do "$BIN/$stage" --capture="$capture" --print-config | grep -E '^(eye|tissue|light|camera)\.' ; done | sort -u | awk 'NR % 4 == 1'
}

for column in photographs skin; do
	capture=$root/$column
	"$column" "$capture"
	run_make "$capture"
	same "$column: made" "$?" 0
	all=$(ran)
	made=$(bytes_of "$capture")
	same "$column: all records hold" "$(stale)" ""
	for stage in $all; do same "$column: $stage accounts for its artifacts" "$(counted "$stage")" "$(outputs "$stage" | wc -l) made, 0 kept"; done

	kinds=(deleted cut edited) n=0 missed=
	for stage in $all; do
		while IFS= read -r file; do
			kind=${kinds[n++ % 3]} readers=
			cp -p "$capture/$file" "$root/kept"
			for reader in $all; do if [ "$reader" = "$stage" ] || reads "$reader" "$file"; then readers="$readers $reader"; fi; done
			spoil "$kind" "$capture/$file"
			[ "$(stale)" = "${readers# }" ] || missed="$missed $file $kind: $(stale), not$readers;"
			cp -p "$root/kept" "$capture/$file"
		done < <(outputs "$stage")
	done
	check "$column: there are artifacts" test "$n" -gt 5
	same "$column: each of $n artifacts, spoilt, is found by its stage and its readers alone" "$missed" ""

	n=0
	for stage in $all; do while IFS= read -r file; do spoil "${kinds[n++ % 3]}" "$capture/$file"; done < <(outputs "$stage"); done
	run_make "$capture"
	same "$column: all of them spoilt: made again by each stage" "$? $(ran)" "0 $all"
	same "$column: with the bytes they had" "$(bytes_of "$capture")" "$made"

	cp "$capture/capture.conf" "$root/conf"
	n=0 missed=
	while IFS= read -r line; do
		key=${line%% = *} value=$(other_value "${line#* = }")
		[ -n "$value" ] || continue
		readers=
		for reader in $all; do grep -q "\"$key\": \"" "$capture/work/.made/$reader.json" && readers="$readers $reader"; done
		{ cat "$root/conf"; echo; echo "$key = $value"; } | awk -F' *= *' -v k="$key" '$1 != k || $2 == "'"$value"'"' >"$capture/capture.conf"
		got=$(stale)
		grep -q 'must be' "$log" && continue # out of its range
		n=$((n + 1))
		[ "$got" = "${readers# }" ] || missed="$missed $key = $value: $got, not$readers;"
	done < <(keys)
	cp "$root/conf" "$capture/capture.conf"
	check "$column: there are keys" test "$n" -gt 10
	same "$column: each of $n keys is found by the stages that read it alone" "$missed" ""
done

capture=$root/photographs
first=$(stat -c %y "$capture/work/limbus/right_a.edge.json") # what is measured in it; the poses of all are weighed together
"$VARIANT" middle "$PHOTO" "$capture/photos/right_b.jpg"
run_make "$capture"
check "a photograph more: it is measured" test -s "$capture/work/limbus/right_b.json"
same "a photograph more: the other is not measured again" "$(stat -c %y "$capture/work/limbus/right_a.edge.json")" "$first"
rm "$capture/work/limbus/right_b.json"
"$BIN/unrefract" --capture="$capture" --quiet >"$log" 2>&1
"$BIN/limbus" --capture="$capture" --quiet >"$log" 2>&1
all=unrefract
same "a fit that was not there, and then is, is found by who had to do without it" "$(stale)" unrefract
check "a photograph more: limbus says what it kept: $(counted limbus)" grep -q ' [1-9][0-9]* kept' <<<"$(counted limbus)"
for figure in "unrefract texels_left_out" "render rays_left_out"; do
	check "it is counted: $figure" grep -q "\"${figure#* }\"" "$capture/work/log/${figure% *}.json"
done
exit 0

#!/bin/bash
# A capture in which a folder of work/ is a link to somewhere else: nothing outside is touched, and one line says why.
. "$(dirname "$0")/../lib/chain.sh"

for folder in iris limbus .made log review; do
	new_capture "$root/c_$folder"
	cp "$PHOTO" "$root/c_$folder/photos/eye.jpg"
	mkdir -p "$root/c_$folder/work" "$root/victim$folder"
	for name in eye.json eye.edge.json texture.exr limbus.json plan.json lock index.html; do echo mine >"$root/victim$folder/$name"; done
	ln -s "$root/victim$folder" "$root/c_$folder/work/$folder"
	before=$(cd "$root/victim$folder" && find . -type f -printf '%P %T@ ' -exec sha256sum {} + | sort)
	"$BIN/limbus" --capture="$root/c_$folder" >"$log" 2>&1
	same "work/$folder is a link: refused" "$?" 1
	same "one line" "$(wc -l <"$log") $(grep -cF "work/$folder: is a link to another folder" "$log")" "1 1"
	run_make "$root/c_$folder"
	check "by make, too" test "$?" != 0
	same "what it leads to is untouched" "$(cd "$root/victim$folder" && find . -type f -printf '%P %T@ ' -exec sha256sum {} + | sort)" "$before"
	rm "$root/c_$folder/work/$folder"
done
"$BIN/limbus" --capture="$root/c_iris" >"$log" 2>&1
same "without the link it runs" "$?" 0

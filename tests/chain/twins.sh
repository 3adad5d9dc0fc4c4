#!/bin/bash
# Several files of one name, as cameras and telephones leave them: the photograph among them is taken, and what is left out is named.
. "$(dirname "$0")/../lib/chain.sh"

new_capture "$root/a"
cp "$PHOTO" "$root/a/photos/IMG_7.jpg"
printf '<?xml version="1.0"?><plist version="1.0"><dict/></plist>\n' >"$root/a/photos/IMG_7.AAE" # sorts before the photograph
printf 'II*\0\020\0\0\0CR\2\0 cut short' >"$root/a/photos/IMG_7.CR2"
"$BIN/limbus" --capture="$root/a" >"$log" 2>&1
same "the eye is found" "$? $(grep -o "\"status\": *\"[a-z]*\"" "$root/a/work/limbus/IMG_7.json")" "0 \"status\": \"ok\""
check "the sidecar is named" grep -q 'photos/IMG_7.AAE: left out: photos/IMG_7' "$log"
check "the raw file is named" grep -q 'photos/IMG_7.CR2: left out: photos/IMG_7' "$log"
# Without the photograph the raw file is what there is, and it is damaged: one line.
rm "$root/a/photos/IMG_7.jpg"
"$BIN/limbus" --capture="$root/a" >"$log" 2>&1
same "nothing else to take" "$?" 1
check "said of the raw file" grep -q 'IMG_7.CR2.*raw file' "$log"

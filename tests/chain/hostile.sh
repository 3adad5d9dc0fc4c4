#!/bin/bash
# Folders from strangers, a row of hostile.tsv each: one clear line, the right exit status, nothing hangs, nothing outside is touched.
#   NAME  BASE  PROGRAM  EXIT  SAYS  DO     tabs between
# BASE: photo (one good photograph), empty, fitted (photo, through all stages), face (video, mesh, character), tracked (face, through track), bare (face without a character), made (a character with its rig)
# PROGRAM: of bin/; make: all of them. SAYS: what the one line has to match; -: nothing may be said. DO: what the stranger does, in the folder.
#   ONLY=REGEX  these rows alone; SHOW=1: what was said
. "$(dirname "$0")/../lib/chain.sh"
MADE=${B:-build}/tests/tools/made_face
VARIANT=$PWD/$VARIANT
LIMIT=${LIMIT:-60}
TABLE=$(dirname "$0")/hostile.tsv
cases=$PWD/tests/chain
FILM=$PWD/samples/face/video/face.mp4

# What rows use.
V=$root/victim
mkdir -p "$V/folder" && echo 'eye.index = 1.4' >"$V/conf" && echo "a stranger's secret" >"$V/secret" && cp "$PHOTO" "$V/eye.jpg" && cp samples/face/subject.ply "$V" && cp samples/face/script/look_around.csv "$V/folder"
cp "$V/secret" "$V/folder/limbus.json"
"${B:-build}/tests/tools/dressed" samples/face/targets/mpfb.obj "$V/head.glb" unit=0.1 px=64
deep() { printf "%$1s" '' | tr ' ' "${2:-[}"; }
noise() { openssl enc -aes-128-ctr -K 0 -iv 0 -nosalt -in /dev/zero 2>/dev/null | head -c "$1"; }
key() { echo "$*" >>capture.conf; }
png() { printf '\211PNG\r\n\032\n'; }
put() { printf "$2" | dd of="$1" bs=1 seek="$3" conv=notrunc 2>/dev/null; } # FILE BYTES AT
# FIELD's value in a line of a table; how many numbers an .npy holds; a PNG with so many texts behind its header, of a few gigabytes each unpacked where N < 0
field() { awk -F, -v OFS=, -v c="$2" -v l="$3" -v v="${4:-}" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == c) k = i } NR == l { $k = v } 1' "$1" >"$1.new" && mv "$1.new" "$1"; }
npy_numbers() { echo "$(($(head -c 128 "$1" | grep -aoE "\([0-9, ]*\)" | tr -d '() ' | sed 's/,$//; s/,/*/g')))"; }
png_texts() { perl -MCompress::Zlib -e '($n, $in, $out) = @ARGV; local $/; open F, "<:raw", $in; $p = <F>; $d = $n > 0 ? "tEXtk\0v" : "zTXtk\0\0" . compress("\0" x 30000000);
	$c = pack("N", length($d) - 4) . $d . pack("N", crc32($d)); open O, ">:raw", $out; print O substr($p, 0, 33), $c x abs $n, substr($p, 33)' -- "$@"; }
edit() { sed -i "$1" "$2"; }
film() { head -c "${1:-250000}" "$FILM"; }
victim_state() { (cd "$V" && find . -printf '%p %y %T@ %C@ %s\n' | sort && find . -type f -print0 | sort -z | xargs -0 sha256sum); }

mkdir "$root/empty"
new_capture "$root/photo"
"$VARIANT" half "$PHOTO" "$root/photo/photos/right_good.jpg"
edit 's/^camera.focal_px.*/camera.focal_px = 5913/' "$root/photo/capture.conf"
printf '%s\n' "render.size_px = 96" "render.frame_px = 64" "render.photo_px = 128" "render.map_size = 128" "render.vein_map_px = 128" >>"$root/photo/capture.conf"
cp -r "$root/photo" "$root/fitted"
run_make "$root/fitted"
same "a capture to begin with" "$?" 0
small_face "$root/face"
cp -r "$root/face" "$root/tracked"
cp -r "$root/face" "$root/bare" && rm "$root/bare/targets/"* && edit '/^target/d' "$root/bare/capture.conf"
"$BIN/track" --capture="$root/tracked" --quiet >"$log" 2>&1
same "a clip to begin with" "$?" 0
"$MADE" "$root/made"
"$BIN/extrapolate" --capture="$root/made" --quiet >"$log" 2>&1

program() { # PROGRAM
	case $1 in
	make) timeout "$LIMIT" make --no-print-directory CAPTURE="$root/case" >"$log" 2>&1 </dev/null ;;
	*) timeout "$LIMIT" "$BIN/$1" --capture="$root/case" --quiet >"$log" 2>&1 </dev/null ;;
	esac
}
before=$(victim_state) beside=$(ls -A "$root") n=0
while IFS=$'\t' read -r name base what status says how; do
	case $name in '' | \#*) continue ;; esac
	[[ $name =~ ${ONLY:-.} ]] || continue
	n=$((n + 1))
	cp -rp "$root/$base" "$root/case"
	(cd "$root/case" && eval "$how") || { fail "$name" "the row itself fails"; rm -rf "$root/case"; continue; }
	program "$what"
	got=$?
	[ -z "${SHOW:-}" ] || printf '%s [%s] %s\n' "$name" "$got" "$(head -c 600 "$log")"
	# Of make the stage's own line counts.
	said=$(grep -av -e "^make" -e "the reasons are above$" -e "the lines above say why$" -e "has a usable limbus: see" "$log")
	[ "$what" != make ] || said=$(grep -aE "^[a-z]+: .*($says)" <<<"$said")
	if [ "$got" = 124 ]; then fail "$name" "hangs"
	elif [ "$what" = make ] && [ "$got" != 0 ]; then got=1; fi
	if [ "$got" != "$status" ]; then fail "$name" "exit status $got, must be $status: $(tail -n 2 "$log")"
	elif [ "$says" = - ] && [ -n "$said" ] && [ "$what" != make ]; then fail "$name" "nothing is to be said: $said"
	elif [ "$says" != - ] && { [ "$(grep -c . <<<"$said")" != 1 ] || ! grep -aqE -- "$says" <<<"$said"; }; then fail "$name" "one line that says $says: $said"
	elif LC_ALL=C grep -q $'[\001-\010\013-\037\177]' <<<"$said"; then fail "$name" "control bytes reach the terminal"
	elif grep -qs "a stranger's secret" "$log" || [ -n "$(find "$root/case/work" -type f -exec grep -ls "a stranger's secret" {} + 2>/dev/null)" ]; then fail "$name" "what stands outside was read"
	else pass "$name"; fi
	chmod -R u+rwX "$root/case" 2>/dev/null
	rm -rf "$root/case"
	[ "$(ls -A "$root")" = "$beside" ] || { fail "$name" "something was made beside: $(ls -A "$root")"; beside=$(ls -A "$root"); }
done <"$TABLE"
same "what stands outside is as it was" "$(victim_state)" "$before"
check "no name was run" test ! -e gone -a ! -e "$root/gone" -a ! -e "$cases/gone"
[ -n "${ONLY:-}" ] || check "150 rows: $n" test "$n" -ge 150
exit 0

#!/bin/bash
# Films of real people, that the tests have none of: FILMS=FOLDER make bench-track_real. Each is followed with nothing told, and what comes out compared with a face-mesh network from
# npm (installed below build/ for this alone). That network is no truth, but it errs otherwise. Nothing of the films is kept. Exit status 1 where a goal is missed.
set -u
B=${B:-build} BIN=${BIN:-bin} missed=0 npm=${B:-build}/npm_peers
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
films=("${FILMS:-}"/*.mp4)
if [ -z "${FILMS:-}" ] || ! [ -e "${films[0]}" ]; then
	echo "skipped: bench-track_real: FILMS= a folder of .mp4 files"
	exit 0
fi
packages=(@vladmandic/human@3 @tensorflow/tfjs@4 @tensorflow/tfjs-core@4 @tensorflow/tfjs-backend-wasm@4)
if ! node -e "require('$PWD/$npm/node_modules/@vladmandic/human/package.json')" >/dev/null 2>&1 &&
	! npm install --prefix "$npm" --no-save --no-audit --no-fund "${packages[@]}" >"$root/log" 2>&1; then
	echo "skipped: bench-track_real: npm could not install ${packages[*]}"
	exit 0
fi
printf '%-22s %6s %8s %7s %8s %9s %6s %7s %6s %7s %5s\n' film frames "gaze, r" "(moves)" "sigma" "aside" r up r blinks theirs
printf '%-22s %6s %8s %7s %8s %9s %6s %7s %6s %7s %5s\n' "" "" "" "% width" deg "off, deg" "" "off" "" "" ""
accepted=0
for film in "${films[@]}"; do
	name=$(basename "$film" .mp4) capture=$root/capture
	rm -rf "$capture"
	mkdir -p "$capture/video"
	cp "$film" "$capture/video/film.mp4"
	: >"$capture/capture.conf"
	if ! said=$("$BIN/track" --quiet --capture="$capture" 2>&1); then
		printf '%-22s refused: %.180s\n' "$name" "${said#track: video/film.mp4: }"
		continue
	fi
	accepted=$((accepted + 1))
	size=$(ffprobe -v error -select_streams v -show_entries stream=width,height -of csv=p=0 "$film" | awk -F, '{ k = 512 / ($1 > $2 ? $1 : $2); k = k > 1 ? 1 : k; print 2 * int($1 * k / 2), 2 * int($2 * k / 2) }')
	# shellcheck disable=SC2086
	node tests/tools/peer_face.js "$film" $size "$PWD/$npm/node_modules" "$root/peer.json" >"$root/log" 2>&1 || { printf '%-22s no peer: %s\n' "$name" "$(tail -n 1 "$root/log")"; continue; }
	node tests/tools/peer_gaze.js "$name" "$root/peer.json" "$capture/work/skin" || missed=1
done
echo "accepted: $accepted of ${#films[@]}"
echo "goal: correlation of gaze at least 0.8 where the eyes move: $([ $missed = 0 ] && echo reached || echo MISSED)"
exit $missed

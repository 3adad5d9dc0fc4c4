#!/bin/bash
# A character of 200 000 vertices with three maps of 4096 px, as a scan leaves: seconds and memory of its import, of laying it onto the subject, of its
# rig and of its pictures, and what its page and its .glb hold. One line a figure; exit status 1 where a goal is missed.
#   FACES=400000 PX=4096 tests/bench/import.sh
. "$(dirname "$0")/../lib/chain.sh"
trap 'rm -rf "$root"' EXIT
FACES=${FACES:-400000} PX=${PX:-4096} missed=0 B=${B:-build}
capture=$root/c
small_face "$capture"
rm "$capture"/targets/*
sed -i '/^target.mpfb/d; /^transfer\./d; s/^track.points = .*/track.points = 1500/' "$capture/capture.conf"
"$B/tests/tools/dressed" samples/face/targets/mpfb.obj "$capture/targets/scan.glb" unit=0.1 px="$PX" grain faces="$FACES" || exit 1

goal() { # WHAT VALUE BOUND
	local ok
	ok=$(awk -v x="$2" -v b="$3" 'BEGIN { print (x != "" && x <= b) }')
	[ "$ok" = 1 ] || missed=1
	printf '%-52s %8s  at most %s: %s\n' "$1" "$2" "$3" "$([ "$ok" = 1 ] && echo reached || echo MISSED)"
}
figure() { printf '%-52s %8s\n' "$1" "$2"; }

read -r vertices _ faces _ textures _ clock _ _ _ _ apart own _ _ _ apart_mib own_mib _ <<<"$("$B/tests/tools/import" "$capture/targets" scan.glb)"
figure "vertices" "$vertices"
figure "faces" "$faces"
figure "textures" "$textures"
figure "file, MB" "$(($(stat -c %s "$capture/targets/scan.glb") / 1000000))"
goal "import, s" "$clock" 20
figure "import, s of processors" "$(awk -v a="$apart" -v b="$own" 'BEGIN { print a + b }')"
goal "import, MiB of its own process" "$apart_mib" 1536
goal "import, MiB of the stage" "$own_mib" 1536
run_make "$capture" || { tail -n 3 "$log"; exit 1; }
for stage in transfer extrapolate render; do
	figure "$stage, s" "$(sed -n "s/^$stage: done in \([0-9.]*\) s.*/\1/p" "$log")"
	figure "$stage, MiB" "$(tr -d ' \n' <"$capture/work/plan.json" | sed -n "s/.*\"name\":\"$stage\"[^}]*\"peak_mib\":\([0-9.]*\).*/\1/p")"
done
goal "page with the textured face, MB" "$(($(stat -c %s "$capture/work/review/viewer.html") / 1000000))" 25
figure "scan.glb driven, MB" "$(($(stat -c %s "$capture/work/render/scan.glb") / 1000000))"
exit $missed

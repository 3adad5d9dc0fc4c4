#!/bin/bash
# render.shots: pictures under a told pose and light, in the photograph's scale; the photographs' own light told by light.environment.
. "$(dirname "$0")/../lib/chain.sh"
data=${EYEWRIGHT_DATA:-../shared/data}/iris_mc/hazel
DIFFER=${B:-build}/tests/tools/differ
cap=$root/told

# shots JSON: the pictures that are asked for.
shots() { printf '%s\n' "$1" >"$cap/shots.json"; }
# refused NAME JSON WORDS: make fails, and its one line says WORDS.
refused() {
	shots "$2"
	if run_make "$cap" render; then fail "$1" "accepted"; else same "$1" "$(grep -c "$3" "$log")" 1; fi
}

new_capture "$cap"
cp "$PHOTO" "$cap/photos/right_a.jpg"
echo "render.shots = shots.json" >>"$cap/capture.conf"
shots '[{"name": "own"}]'
run_make "$cap" || fail "a capture with shots" "$(tail -n 3 "$log")"
pose=$(tr -d '\n' <"$cap/work/limbus/right_a.json" | sed -n 's/.*"cam_from_eye": *\(\[[^]]*\]\).*/\1/p')
shots "[{\"name\": \"own\"}, {\"name\": \"posed\", \"cam_from_eye\": $pose, \"environment\": null}]"
run_make "$cap" || fail "shots that have changed" "$(tail -n 3 "$log")"
check "the photograph's own pose, written out, gives the same picture" "$DIFFER" "$cap/work/render/shot_own.exr" "$cap/work/render/shot_posed.exr" 0.01 0.001
refused "a pose that is no rotation" '[{"name": "a", "cam_from_eye": [2,0,0,0, 0,1,0,0, 0,0,1,170, 0,0,0,1]}]' "\[0\]: cam_from_eye: must be"
refused "a pose of fifteen numbers" '[{"name": "a", "cam_from_eye": [1,0,0,0, 0,1,0,0, 0,0,1,170, 0,0,0]}]' "cam_from_eye"
refused "a name that leads out" '[{"name": "../a"}]' "\[0\]: name: must be"
refused "a light that leads out" '[{"name": "a", "environment": "../x.exr"}]' "\[0\]: "
refused "a light that is not there" '[{"name": "a", "environment": "x.exr"}]' "x.exr"
refused "an object in place of a list" '{"name": "a"}' "must be a JSON array"

if [ ! -d "$data" ]; then
	skip "light.environment" "no shared data: set EYEWRIGHT_DATA"
	exit 0
fi
cap=$root/lit
mkdir -p "$cap"
cp -r "$data/photos" "$data/capture.conf" "$data"/light_*.exr "$cap"
chmod -R u+w "$cap"
{ grep -v '^light.environment' "$data/capture.conf"
	# a ball without lids whose iris has no fibres: taken for a painted eye unless a person says where it is
	printf '%s\n' "photo.right_hazel.hint_px = 400 300 200" "light.environment = light_A.exr" "render.shots = shots.json" "quality = draft"; } >"$cap/capture.conf"
shots '[{"name": "own"}, {"name": "same", "environment": "light_A.exr"}, {"name": "other", "environment": "light_B.exr"}]'
run_make "$cap" || fail "a capture with its light" "$(tail -n 3 "$log")"
check "the photograph's light, as a file, gives its own picture" "$DIFFER" "$cap/work/render/shot_own.exr" "$cap/work/render/shot_same.exr" 0.002 0
check "another light gives another" eval "! '$DIFFER' '$cap/work/render/shot_own.exr' '$cap/work/render/shot_other.exr' 0.02 0.01"
# model_off: mean difference of the fitted model alone from the photograph, CIEDE2000.
model_off() { sed -n 's/.*"model_difference_mean": *\([0-9.]*\).*/\1/p' "$cap/work/render/right_hazel_compare.json"; }
told=$(model_off)
sed -i.told '/^light.environment/d; /^render.shots/d' "$cap/capture.conf"
run_make "$cap" || fail "the same, its light not told" "$(tail -n 3 "$log")"
check "a light that is fitted shows the model nearly as well as the one that is told" awk -v a="$told" -v b="$(model_off)" 'BEGIN { exit !(a > 0 && b > 0 && b < 1.3 * a) }'
mv "$cap/capture.conf.told" "$cap/capture.conf"
sed -i 's/light_A.exr/nothing.exr/' "$cap/capture.conf"
if run_make "$cap"; then fail "a light that is not there" "accepted"; else same "a light that is not there" "$(grep -c 'light.environment.*nothing.exr' "$log")" 1; fi

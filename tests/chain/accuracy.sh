#!/bin/bash
# The accuracy of the bundled captures, as they are configured: no error may be more than three times what is reached today. Errors,
# not times. A change that makes one of them better lowers its figure in the tables below.
# The eye's limbus is round, which one photograph cannot tell from people's, that are oval by 0.95 +- 0.035: of its axis a sigma of 8 degrees
# is told, and what can be reached is a few degrees.
#   QUANTITY | today | unit [| within]     within: a quantity without truth, which may not leave today / 3 ... today * 3
. "$(dirname "$0")/../lib/chain.sh"
ACCURACY=${B:-build}/tests/tools/accuracy

# hold KIND CAPTURE: the run in that folder against the table on standard input.
hold() {
	"$ACCURACY" "$1" "$2" "$2/truth" >"$root/figures" 2>"$log" </dev/null
	same "$1: every figure can be had" "$?" 0
	local name today unit rule got bad
	while IFS='|' read -r name today unit rule; do
		name=$(sed 's/ *$//' <<<"$name")
		[ -n "$name" ] || continue
		got=$(awk -F'\t' -v name="$name" '$1 == name { print $2 }' "$root/figures")
		bad=$(awk -v got="${got:-nan}" -v today="$today" -v within="$rule" 'BEGIN {
			if (got !~ /^[-+0-9.e]+$/ || got + 0 > 3 * today || within ~ /within/ && got + 0 < today / 3) print "out of bounds" }')
		if [ -z "$bad" ]; then pass "$1: $name"; else fail "$1: $name" "${got:-none}, today $today, bound $(awk -v t="$today" 'BEGIN { print 3 * t }')$unit"; fi
	done
	[ -z "${VERBOSE:-}" ] || sed 's/^/    /' "$root/figures"
}

cp -r samples/demo "$root/demo" && rm -rf "$root/demo/work"
# Pictures that nobody looks at are small: the one from the photograph's place is as it is.
printf '%s\n' "unrefract.write_map = yes" "render.size_px = 128" "render.frames = 1" "render.frame_px = 64" >>"$root/demo/capture.conf"
run_make "$root/demo"
same "make on the bundled photograph" "$?" 0
hold eye "$root/demo" <<'TABLE'
limbus, centre                                    | 0.18    | px
limbus, semi-axes                                 | 0.92    | px
pupil, centre                                     | 1.57    | px
pupil, semi-axes                                  | 6.71    | px
optical axis                                      | 3.44    | deg
iris position, median                             | 0.0373  | mm
iris position, 95 %                               | 0.0511  | mm
height field, rms about its mean                  | 0.098   | mm
iris texture, rms of what one gain a channel leaves | 18.5  | %
freckles, 1 - intersection over union             | 0.255   |
melanin of the border layer                       | 0.279   | | within
melanin, residual in colour                       | 15.9    | %
own view, mean difference                         | 0.369   | CIEDE2000
own view, difference, 95 %                        | 0.944   | CIEDE2000
own view, explained by the model                  | 45.1    | % | within
refraction function, worst                        | 8.5e-6  | mm
TABLE

# To the last stage whose errors are known: the pictures take most of the time, and tests/chain/skin.sh makes them.
cp -r samples/face "$root/face" && rm -rf "$root/face/work"
run_make "$root/face" extrapolate
same "make on the bundled video" "$?" 0
hold face "$root/face" <<'TABLE'
gaze, horizontal                                  | 0.287   | deg
gaze, horizontal, 95 %                            | 0.681   | deg
gaze, vertical                                    | 0.079   | deg
gaze, vertical, 95 %                              | 0.276   | deg
torsion                                           | 0.322   | deg
torsion, 95 %                                     | 1.03    | deg
gaze, frames with open eyes that lack it          | 0       | %
lid margins                                       | 0.713   | px
lid margins, 95 %                                 | 2.82    | px
aperture                                          | 1.51    | px
skin, motion since the reference                  | 0.163   | px
skin, motion, 95 %                                | 2.44    | px
skin, place                                       | 1.20    | px
skin, points in sight that are not seen           | 5.55    | %
blinks missed or invented                         | 0       |
expressions, where none is shown, 95 %            | 0.0633      | of the peak
head pose, residual                               | 1.18    | px
model, left lids held out                         | 2.80    | px
model, right lids held out                        | 2.96    | px
model, skin held out                              | 2.46    | px
registration, residual                            | 0.211   | mm
registration, distance, 95 %                      | 1.23    | mm
registered mesh against the skin at rest          | 0.301   | px
lids, left by their own components                | 0.543   | px
closed eyes, left open                            | 0       | mm
TABLE

# The driven lids over 20 degrees to the sides, 15 up to 25 down, open, half open and shut, as the front sees them.
"${B:-build}/tests/tools/lids" "$root/face/work/targets/mpfb/rig.npz" >"$root/lids.csv" 2>"$log"
same "the driven lids can be measured" "$? $(wc -l <"$root/lids.csv")" "0 181"
# most COLUMN CONDITION: the largest of those poses; of h, v and o, gaze and aperture.
most() { awk -F, -v column="$1" 'NR > 1 { h = $1; v = $2; o = $3 } NR > 1 && ('"$2"') && (!n++ || $column > worst) { worst = $column } END { print worst }' "$root/lids.csv"; }
holds() { if awk -v got="$2" -v most="$3" 'BEGIN { exit !(got <= most) }'; then pass "$1"; else fail "$1" "$2, at most $3"; fi; }
holds "shut eyes are shut" "$(most 5 'o == 0')" 0.15
# Curvature of one sign: mm. The character's own margin bends by 0.08 at rest, of eyeballs of 15 mm.
holds "the upper margin of an open eye is an arc" "$(most 6 'o == 1 && v >= -15')" 0.15
# Further down than was filmed it goes along with the eye.
holds "25 degrees down, too" "$(most 6 'o == 1')" 0.22
holds "and that of one half open" "$(most 6 'o == 0.5')" 0.25
# A human margin is 2 mm broad.
check "margins are thick everywhere" awk -F, 'NR > 1 && $12 != "nan" && !($12 > 0.8 && $13 > 1.8) { exit 1 }' "$root/lids.csv"
check "no vertex of skin is inside a turned eyeball" awk -F, 'NR > 1 && $7 < 0 { exit 1 }' "$root/lids.csv"
check "nor is any edge or face by more than 0.02 mm" awk -F, 'NR > 1 && $8 < -0.02 { exit 1 }' "$root/lids.csv"
# Of some 160 lashes of an eye; the goal is none. 4, 2 and 18 are reached: roots of the last lie in the fold of shut lids.
holds "skin crosses few lashes of an open eye" "$(most 9 'o == 1')" 6
holds "and of one half open" "$(most 9 'o == 0.5')" 4
holds "and of a shut one" "$(most 9 'o == 0')" 24
# The subject's lower lid covers no pupil, and up to 0.24 of the iris where that looks 12 to 20 degrees down (truth/). This character's has 0.22 of one that looks
# ahead, at rest.
holds "the lower lid is off the pupil of an eye that looks ahead and 15 degrees down" "$(most 11 'o == 1 && v >= -15 && h == 0')" 0
holds "off all but a little of one that looks aside, too" "$(most 11 'o == 1 && v >= -15')" 0.1
holds "and covers little more of the iris than at rest" "$(most 10 'o == 1 && v >= -15')" 0.36
exit 0

#!/bin/bash
# A grey photograph has no pigments: the plan, the file and the log say why, and all that needs no colour is made. In colour it has them.
. "$(dirname "$0")/../lib/chain.sh"

new_capture "$root/grey"
echo "photo.right_softbox.hint_px = 850 661 405" >>"$root/grey/capture.conf" # without colour the search finds less
"$VARIANT" grey $PHOTO "$root/grey/photos/right_softbox.jpg"
run_make "$root/grey" relief
same "the chain runs through" "$? $(ran)" "0 limbus unrefract freckles heightfield pigment relief"
same "the plan says why" "$(grep -c 'no pigments: the photographs are grey' "$root/grey/work/plan.json")" 1
same "so does the file" "$(grep -c '"without": "the photographs are grey' "$root/grey/work/iris/pigment.json")" 1
check "and the log" grep -q 'pigment: skipped: right: no pigments: the photographs are grey' "$log"
same "how bright white is in it is told, and that white has no colour" "$(tr -d ' \n' <"$root/grey/work/iris/pigment.json" | grep -o '"sclera":\[[0-9.,]*\]' | tr ':[],' '\n' | grep '^0\.' | cut -c1-6 | uniq -c | awk '{ print $1 }')" 3
check "there is a relief" test -s "$root/grey/work/iris/relief.exr"
run_make "$root/grey" relief
same "nothing runs again" "$? $(ran)" "0 "
# The same photograph in three channels says nothing in its head: the pixels do.
"$VARIANT" png8 "$root/grey/photos/right_softbox.jpg" "$root/grey/photos/right_softbox.png"
rm "$root/grey/photos/right_softbox.jpg"
run_make "$root/grey" relief
same "three channels that are alike" "$? $(grep -c '"without": "the photographs are grey' "$root/grey/work/iris/pigment.json")" "0 1"
rm "$root/grey/photos/right_softbox.png"
cp $PHOTO "$root/grey/photos"
run_make "$root/grey" relief
same "in colour there are pigments" "$? $(grep -c '"without"' "$root/grey/work/iris/pigment.json") $(grep -c '"stroma": ' "$root/grey/work/iris/pigment.json")" "0 0 1"

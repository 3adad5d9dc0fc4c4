#!/bin/bash
# The person's mesh, eyes and lens as calibrate leaves them, in place of what the user gives: track and transfer take them.
. "$(dirname "$0")/../lib/chain.sh"

for program in track transfer; do
	[ -x "$BIN/$program" ] || { skip "calibrate's results in the skin column" "$program is not built"; exit 0; }
done
capture=$root/face
mkdir -p "$capture/work"
cp -r samples/face/{video,targets} "$capture"
# The face's eyes are larger than people's.
printf 'quality = draft\nsubject.eye_radius = 15.175\n' >"$capture/capture.conf"
# Its mesh is in centimetres; what calibrate makes is in millimetres.
awk 'body && NF == 3 { printf "%.6f %.6f %.6f\n", 10 * $1, 10 * $2, 10 * $3; next } { print } /^end_header/ { body = 1 }' \
	samples/face/subject.ply >"$capture/work/subject.ply"
# The head rests in front of the camera: where it is, from the skin's true positions in the first frame.
rig() { # EYES
	cat >"$capture/work/rig.json" <<-END
		{"scale_source": "limbus", "scale_sigma": 0.02, "frame_source": "eyes", "eye_center": $1, "cameras": [{
		 "name": "face_20", "frame": 20, "file": "video/face.mp4", "width": 1280, "height": 720, "fx": 6380, "fy": 6380, "cx": 640, "cy": 360,
		 "distortion": [0, 0, 0, 0, 0], "cam_from_head": [1, 0, 0, 0, 0, -1, 0, 35.473, 0, 0, -1, 673.1, 0, 0, 0, 1],
		 "residual_px": 0.5, "points": 100}]}
	END
}

rig null
"$BIN/track" --capture="$capture" >"$log" 2>&1
same "a mesh from views in which nobody named the eyes: exit status" "$?" 1
check "says how to name them" grep -q 'work/subject.ply: where its eyes are is not known.*view.NAME.left_eye_px' "$log"

rig "[31.01, 36.016, 78.602, -31.01, 36.016, 78.602]"
"$BIN/track" --capture="$capture" >"$log" 2>&1
same "the video is tracked with calibrate's lens, eyes and mesh" "$?" 0
same "the lens is not guessed" "$(grep -c 'focal length not known' "$log")" 0
# what strays from its neighbours does not count as seen
check "most of the skin is seen" grep -qE '([89][0-9]|100) % of them seen' "$log"
check "the lens is the rig's" grep -q '"focal_px": 6380' "$capture/work/skin/track.json"

check "the head is where calibrate saw it" grep -q '"reference_frame": 20,' "$capture/work/skin/track.json"
check "to within what calibrate's cameras are good for" grep -q '"pose_rms_px": 0.5,' "$capture/work/skin/track.json"

"$BIN/transfer" --capture="$capture" >"$log" 2>&1
same "the character is laid onto calibrate's mesh" "$?" 0
check "says so" grep -q '"subject": "work/subject.ply"' "$capture/work/targets/mpfb/registration.json"
check "which is in millimetres, not guessed" grep -q '"subject_unit_guessed": false' "$capture/work/targets/mpfb/registration.json"

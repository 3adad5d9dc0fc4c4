#!/bin/bash
# Limits of the configuration hold in every program that reads strangers' files: one line that names the file, its size and
# the limit, before anything is decoded.
. "$(dirname "$0")/../lib/chain.sh"
new_capture "$root/photo"
cp "$PHOTO" "$root/photo/photos/right_a.jpg"
small_face "$root/face"
mkdir -p "$root/views/views"
cp "$PHOTO" "$root/views/views/a.jpg"
"$VARIANT" half "$PHOTO" "$root/views/views/b.jpg"
touch "$root/views/capture.conf"

beyond() { # CAPTURE STAGE KEY VALUE SAYS
	echo "$3 = $4" >"$root/limit"
	cat "$root/$1/capture.conf" "$root/limit" >"$root/conf.new"
	cp -r "$root/$1" "$root/case" && cp "$root/conf.new" "$root/case/capture.conf"
	(ulimit -v 4000000 && "$BIN/$2" --capture="$root/case" >"$log" 2>&1)
	same "$2, $3 = $4: exit status" "$?" 1
	check "$2, $3 = $4: says $5" grep -qE "$5" "$log"
	rm -rf "$root/case"
}
beyond photo limbus limit.photo_mpx 1 'photos/right_a.jpg: .*1600 x 1200 = 2 megapixels: must be <= 1 \(limit.photo_mpx\)'
# What stands before COLMAP does not need it.
mkdir "$root/bin" && ln -s /bin/false "$root/bin/colmap" && PATH=$PATH:$root/bin
beyond views calibrate limit.photo_mpx 1 'views/a.jpg: .*2 megapixels: must be <= 1 \(limit.photo_mpx\)'
beyond face track limit.video_mpx 0.1 'face.mp4: 1280 x 720 px, must be at most 0.1 Mpx \(limit.video_mpx\)'
beyond face track limit.video_frames 5 'face.mp4: has more than 5 frames \(limit.video_frames\)'
beyond face track limit.video_s 0.1 'face.mp4: takes more than 0.1 s \(limit.video_s\)'
beyond face transfer transfer.limit_vertices 1000 'subject.ply: 4490 vert.* must be <= 1000'
exit 0

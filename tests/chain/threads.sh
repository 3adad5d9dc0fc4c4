#!/bin/bash
# The same inputs give the same bytes, on any number of threads.
. "$(dirname "$0")/../lib/chain.sh"

for n in 1 2 5; do
	new_capture "$root/$n"
	cp "$PHOTO" "$root/$n/photos/right_a.jpg"
	"$VARIANT" half "$PHOTO" "$root/$n/photos/right_b.jpg"
	echo "unrefract.write_map = yes" >>"$root/$n/capture.conf"
	run_make "$root/$n" THREADS=$n
	same "make with $n threads" "$?" 0
done
for n in 2 5; do
	different=$(diff <(bytes_of "$root/1") <(bytes_of "$root/$n") | sed -n 's/^> [0-9a-f]*  //p' | tr '\n' ' ')
	same "$n threads and 1 give the same bytes" "$different" ""
done

# Threads that wait spin where nobody says otherwise: programs of many short loops start themselves anew with others that sleep.
made=$(bytes_of "$root/1")
env -u OMP_WAIT_POLICY "$BIN/limbus" --capture="$root/1" --force --quiet >"$log" 2>&1
same "limbus by itself, on threads of its own choice" "$?" 0
env -u OMP_WAIT_POLICY "$BIN/unrefract" --capture="$root/1" --force --quiet >"$log" 2>&1
same "unrefract, on threads that spin" "$?" 0
same "and the same bytes" "$(bytes_of "$root/1")" "$made"

# The skin column.
for n in 1 2; do
	small_face "$root/face$n"
	run_make "$root/face$n" THREADS=$n
	same "the skin column with $n threads" "$?" 0
done
different=$(diff <(bytes_of "$root/face1") <(bytes_of "$root/face2") | sed -n 's/^> [0-9a-f]*  //p' | tr '\n' ' ')
same "the skin column: 2 threads and 1 give the same bytes" "$different" ""

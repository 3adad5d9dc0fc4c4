#!/bin/bash
# Puts the programs into $DEST, or removes them. What is put there is listed in lib/eyewright/files, for the removal.
# BIN: folder of the programs; EXTRA: further options of install(1).
set -e
umask 022
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
lib=$DEST/lib/eyewright

if [ "${1:-}" = --remove ]; then
	[ -f "$lib/files" ] || { echo "uninstall: $lib/files: is not there: nothing is installed in $DEST" >&2; exit 1; }
	mapfile -t there <"$lib/files"
	for file in "${there[@]}"; do case $file in */) ;; *) rm -f "$DEST/$file" ;; esac; done
	# Folders that it made, the deepest first.
	printf '%s\n' "${there[@]}" | grep '/$' | sort -r | while IFS= read -r dir; do rmdir "$DEST/$dir" 2>/dev/null || true; done
	rmdir "$DEST" 2>/dev/null || true
	exit 0
fi

grep -s '/$' "$lib/files" >"$BIN/files.new" || true
put() { # MODE FROM TO
	local dir=$3
	while [ "$dir" != "${dir%/*}" ]; do
		dir=${dir%/*}
		[ -d "$DEST/$dir" ] || printf '%s/\n' "$dir" >>"$BIN/files.new"
	done
	install -D $EXTRA -m "$1" "$2" "$DEST/$3"
	printf '%s\n' "$3" >>"$BIN/files.new"
}
programs=$(find "$BIN" -maxdepth 1 -type f -perm -u+x -printf '%f\n' | sort)
for program in $programs; do EXTRA=${STRIP:+-s} put 755 "$BIN/$program" "lib/eyewright/bin/$program"; done
put 644 "$BIN/version" lib/eyewright/bin/version
for file in config/*.conf config/*.onnx; do put 644 "$file" "lib/eyewright/$file"; done
put 644 stages/capture.mk lib/eyewright/capture.mk
for file in side_by_side.mk lists.sh tell.sh slurm.sh; do put 644 "stages/batch/$file" "lib/eyewright/batch/$file"; done
for file in batch.sh task.sh; do put 755 "stages/batch/$file" "lib/eyewright/batch/$file"; done
put 755 stages/install/eyewright bin/eyewright
put 644 stages/install/completion.bash share/bash-completion/completions/eyewright
for file in README.md LICENSE config/README.md; do put 644 "$file" "share/doc/eyewright/$file"; done

# A page for each program from its table of options, which --help prints.
page() { # PROGRAM SECTION_NAME
	awk -v page="$2" -v version="$(cat "$BIN/version")" -f stages/install/man.awk >"$BIN/page.new"
	put 644 "$BIN/page.new" "share/man/man1/$2.1"
}
for program in $programs; do "$BIN/$program" --help | page "$program" "eyewright-$program"; done
stages/install/eyewright --help | page eyewright eyewright
rm "$BIN/page.new"
printf '%s\n' lib/eyewright/files >>"$BIN/files.new"
install -m 644 "$BIN/files.new" "$lib/files"
rm "$BIN/files.new"

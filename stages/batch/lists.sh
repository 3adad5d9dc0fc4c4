# Which captures there are, and which have something to do. Sourced by batch.sh; `state` is the folder batch/.

die() { printf 'batch: %s\n' "$1" >&2; exit "${2:-1}"; }

# Names of the captures, each with a zero byte behind it, sorted.
names() {
	local folder
	for folder in "$CAPTURES"/*/; do
		[ -d "$folder" ] || continue
		folder=${folder%/} folder=${folder##*/}
		[ "$folder" = batch ] || printf '%s\0' "$folder"
	done
}

# A line for each that has to run: its number TAB what plan --request says of its stages, TABs between. One that cannot be planned
# is told of at once. One process looks into all of them.
look() { # N NAME ...
	local status said was
	local -a known=()
	while IFS=$tab read -r status said; do
		case $status in
		0) was=
			[ ! -f "$state/results/$2" ] || IFS=$tab read -r _ was _ <"$state/results/$2"
			[ "$was" = done ] || tell "$2" done 0 "$(peak "$2")" ""
			known+=("$2") ;;
		3) printf '%s\t%s\n' "$1" "$said" ;;
		*) printf '%s\n' "$said" >"$state/log/$2"
			tell "$2" failed 0 "" "$(one_line "$said")"
			known+=("$2") ;;
		esac
		shift 2
	done < <(every_other "$@" | EYEWRIGHT_SOURCE=${ELSEWHERE:+$CAPTURES} "$BIN/plan" --capture="$results" --requests)
	[ $# = 0 ] || die "$(one_line "$2"): cannot be looked into"
	[ ${#known[@]} = 0 ] || printf '%s\0' "${known[@]}" | "$BIN/summary" --capture="$results" --only-collect
}
every_other() { while [ $# -gt 0 ]; do printf '%s\0' "$2"; shift 2; done; }

# $state/captures: all names; $state/todo: the lines of look, by number.
list_todo() {
	names >"$state/captures"
	[ -s "$state/captures" ] || die "$CAPTURES: holds no folder"
	rm -f "$state/todo"
	local n=0 name
	while IFS= read -r -d '' name; do
		n=$((n + 1))
		printf '%s\0%s\0' "$n" "$name"
	done <"$state/captures" | xargs -0 -n 64 -P "$(nproc)" "$here/batch.sh" look >"$state/.todo.new" || die "some captures cannot be looked into"
	sort -n "$state/.todo.new" >"$state/todo" && rm "$state/.todo.new"
}

# pick LIST: the names of LIST whose numbers stand on stdin, in that order.
pick() {
	local -a all
	local n
	mapfile -d '' -t all <"$1"
	while read -r n; do printf '%s\0' "${all[n - 1]}"; done
}

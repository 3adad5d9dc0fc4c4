# What became of captures. Sourced by batch.sh.
#   batch/results/NAME   one line: name, state, seconds, peak MiB, reason, TABs between
#   batch/log/NAME       all that make and the stages said
#   batch/status.csv     all of them, the failures first
#   batch/index.html, summary.csv, summary.json    what was found in each, worst first: summary/
tab=$'\t'

# One line without control characters, at most 300 bytes.
one_line() {
	local LC_ALL=C line
	line=${1//[$'\001'-$'\037'$'\177']/ } line=${line:0:300}
	printf '%s\n' "${line%"${line##*[! ]}"}"
}

# Why make failed, from what it and the stage that failed have said.
why() { # LOG
	local failed stage how said=
	failed=$(LC_ALL=C sed -n 's/^make[^ ]*: \*\*\* \[.*: \([a-z]*\)\] \(.*\)$/\1 \2/p' "$1" | head -n 1)
	stage=${failed%% *} how=${failed#* }
	case $how in
	"Error "[12]) said=$(grep -a "^$stage: " "$1" | tail -n 1) ;;
	?*) said="$stage: $how" ;;
	esac
	case $said in *"the reasons are above") said=$(grep -am 1 "^$stage: .*: rejected: " "$1") ;; esac
	[ -n "$said" ] || said=$(grep -av '^make' "$1" | tail -n 1)
	[ -n "$said" ] || said=$(tail -n 1 "$1")
	one_line "$said"
}

# The greatest memory that a stage of the capture has needed, MiB.
peak() { awk '/^ *"peak_mib": *[0-9]/ { sub(/^[^:]*: */, ""); if ($0 + 0 > most) most = $0 + 0 } END { if (most) print most }' "$results/$1"/work/log/*.json 2>/dev/null; }

# Replaces what is known of a capture: written beside and renamed, so that any machine may do it without a lock.
tell() { # NAME STATE SECONDS PEAK REASON
	local new=$state/.result.$HOSTNAME.$BASHPID
	[ ! -e "$new" ] && [ ! -L "$new" ] || rm -f -- "$new" || return 1
	printf '%s\t%s\t%s\t%s\t%s\n' "$(one_line "$1")" "$2" "$3" "$4" "$5" >"$new" && mv -fT -- "$new" "$state/results/$1"
	[ "$2" != failed ] || printf '%s: failed: %s\n' "$(one_line "$1")" "$5" >&2
}

# status.csv; the failures and the counts as a table. Fails where a capture has. Of what has no
# result a scheduler tells (queued: name, state, reason).
status() {
	type queued >/dev/null 2>&1 || queued() { :; }
	queued >"$state/.queued"
	names | tr '\n\0' ' \n' | LC_ALL=C tr -c '[:print:]\200-\377\n' ' ' >"$state/.names"
	find "$state/results" -type f -exec cat {} + >"$state/.results"
	(cd "$state" && LC_ALL=C awk -F '\t' -v csv=.status.new '
		function quoted(s) { gsub(/"/, "\"\"", s); return "\"" s "\"" }
		function row(i) { return quoted(name[i]) "," state[name[i]] "," seconds[name[i]] "," mib[name[i]] "," quoted(why[name[i]]) }
		FILENAME == ".names" { name[++n] = $0; state[$0] = "waits" }
		FILENAME == ".queued" { state[$1] = $2; why[$1] = $3 }
		FILENAME == ".results" { state[$1] = $2; seconds[$1] = $3; mib[$1] = $4; why[$1] = $5 }
		END {
			print "capture,state,seconds,peak_mib,reason" >csv
			for (i = 1; i <= n; i++) { count[state[name[i]]]++; if (state[name[i]] == "failed") print row(i) >csv }
			for (i = 1; i <= n; i++) if (state[name[i]] != "failed") print row(i) >csv
			if (count["failed"]) printf "%-24s %9s  %s\n", "failed", "seconds", "why"
			for (i = 1; i <= n; i++) if (state[name[i]] == "failed") printf "%-24s %9s  %s\n", name[i], seconds[name[i]], why[name[i]]
			line = n " captures: " count["done"] + 0 " done, " count["failed"] + 0 " failed"
			if (count["waits"]) line = line ", " count["waits"] " waiting"
			if (count["runs"]) line = line ", " count["runs"] " running"
			print line
			exit count["failed"] > 0
		}' .names .queued .results)
	local bad=$?
	mv -f "$state/.status.new" "$state/status.csv"
	"$BIN/summary" --capture="$results" --queued="$state/.queued"
	rm -f "$state"/.names "$state"/.results "$state"/.queued
	printf 'page: %s\n' "$state/index.html"
	printf 'table: %s\n' "$state/status.csv"
	return $bad
}

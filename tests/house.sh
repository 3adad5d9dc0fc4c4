#!/bin/bash
# Facts about the structure of lib/, stages/ and render/, from sources and compiled objects. B: build folder.
#   house.sh circles    files that call each other in a circle, one circle a line
#   house.sh unused     FILE SYMBOL: exported by lib/, called from no other file of lib/, stages/ or render/; but for those of
#                       tests/house_kept.txt (SYMBOL  REASON)
#   house.sh headless   .c files of lib/ without a header of their own name, in a room without one header for all of it
#   house.sh folders    COUNT FOLDER: .c, .h and .cc files of every folder
cd "$(dirname "$0")/.." || exit 1
B=${B:-build}

# Lines "def SOURCE SYMBOL" and "use SOURCE SYMBOL". Objects whose source is gone are passed over.
symbols() {
	find lib stages render \( -name '*.c' -o -name '*.cc' \) | sort | while IFS= read -r source; do
		[ -e "$B/${source%.*}.o" ] && printf '%s\n' "$source"
	done >"$B/house.sources"
	sed "s#^#$B/#; s#\.[^.]*\$#.o#" "$B/house.sources" | xargs nm -A 2>/dev/null | awk -v sources="$B/house.sources" -v skip="$((${#B} + 1))" '
		BEGIN { while ((getline s < sources) > 0) { o = s; sub(/\.[^.]*$/, ".o", o); of[o] = s } }
		{ colon = index($0, ":"); f = of[substr($1, skip + 1, index($1, ":") - skip - 1)]; n = split(substr($0, colon + 1), part, " ") }
		n == 3 && part[2] ~ /^[TDBRi]$/ && part[3] !~ /\./ { print "def", f, part[3] }
		n == 2 && part[1] == "U" { print "use", f, part[2] }'
}

circles() {
	symbols | awk '
		$1 == "def" { at[$3] = $2 }
		$1 == "use" { user[++n] = $2; used[n] = $3 }
		function reach(from, to, key, b, list, i) { # depth first; seen[] is cleared by the caller
			if (from == to && deep++) return 1
			if (from in seen) return 0
			seen[from] = 1
			split(out[from], list, " ")
			for (i in list) if (list[i] == to || reach(list[i], to)) return 1
			return 0
		}
		END {
			for (i = 1; i <= n; i++) {
				a = user[i]; b = at[used[i]]
				if (b == "" || a == b || (a, b) in edge) continue
				edge[a, b] = 1; out[a] = out[a] " " b; node[a]; node[b]
			}
			# What calls nobody, or nobody that is left, is in no circle: as a rule nothing stays.
			for (gone = 1; gone; ) {
				gone = 0
				for (a in node) {
					n = split(out[a], list, " "); some = ""
					for (i = 1; i <= n; i++) if (list[i] in node) some = some " " list[i]
					out[a] = some
					if (some == "") { delete node[a]; gone = 1 }
				}
			}
			for (a in node) {
				if (a in done) continue
				line = ""
				for (b in node) {
					if (a == b || b in done) continue
					split("", seen); deep = 1
					if (!reach(a, b)) continue
					split("", seen); deep = 1
					if (reach(b, a)) { line = line " " b; done[b] = 1 }
				}
				if (line != "") { done[a] = 1; print a line }
			}
		}' | awk '{ n = split($0, f, " "); for (i = 2; i <= n; i++) for (k = i; k > 1 && f[k] < f[k - 1]; k--) { t = f[k]; f[k] = f[k - 1]; f[k - 1] = t }
			s = f[1]; for (i = 2; i <= n; i++) s = s " " f[i]; print s }' | sort
}

case ${1:-} in
circles) circles ;;
unused)
	find lib -name '*.h' -exec cat {} + | grep -oE '\b[a-z_][a-z0-9_]*\(' | tr -d '(' | sort -u >"$B/house.declared"
	symbols | awk -v declared="$B/house.declared" -v kept=tests/house_kept.txt '
		BEGIN { while ((getline s < declared) > 0) told[s] = 1; while ((getline s < kept) > 0) { sub(/ .*/, "", s); delete told[s] } }
		$1 == "def" && $2 ~ /^lib\// && $3 in told { at[$3] = $2 }
		$1 == "use" { called[$3] = 1 }
		END { for (s in at) if (!(s in called)) print at[s], s }' | sort
	;;
headless)
	# What a file without a header of its own exports has to stand in the room's header: the folder's namesake, or the only one
	# without a source file; or in a private one of the room.
	find lib -name '*.c' | sort | while IFS= read -r c; do
		[ -e "${c%.c}.h" ] && continue
		dir=${c%/*} n=0 room=
		for h in "$dir"/*.h; do
			case ${h##*/} in impl.h | *_impl.h | opts.h | *look.h) ;; *) [ -e "${h%.h}.c" ] || { n=$((n + 1)) && room=$h; } ;; esac
		done
		[ "$n" = 1 ] || room=
		[ -e "$dir/${dir##*/}.h" ] && room=$dir/${dir##*/}.h
		printf '%s %s\n' "$c" "$room"
	done >"$B/house.rooms"
	# "HEADER:NAME(" for all that headers call or declare, then "FILE.o: ADDRESS T SYMBOL" for what these files export.
	{
		find lib -name '*.h' -exec grep -oHE '\b[A-Za-z_][A-Za-z0-9_]*\(' {} +
		sed "s#^\([^ ]*\)\.c .*#$B/\1.o#" "$B/house.rooms" | xargs nm -A 2>/dev/null
	} | awk -v rooms="$B/house.rooms" -v skip="$((${#B} + 1))" '
		BEGIN { while ((getline s < rooms) > 0) { n = split(s, f, " "); order[++files] = f[1]; room[f[1]] = n > 1 ? f[2] : "" } }
		/\($/ {
			colon = index($0, ":"); h = substr($0, 1, colon - 1); s = substr($0, colon + 1, length($0) - colon - 1); dir = h; sub(/\/[^\/]*$/, "", dir)
			told[s] = 1; in_file[h, s] = 1
			if (h ~ /(\/|_)impl\.h$/) private[dir, s] = 1
			next
		}
		NF == 3 && $2 == "T" && $3 !~ /\./ {
			c = substr($1, skip + 1); sub(/\.o:.*$/, ".c", c); dir = c; sub(/\/[^\/]*$/, "", dir)
			if (!((room[c], $3) in in_file) && !((dir, $3) in private) && $3 in told) missing[c] = missing[c] " " $3
		}
		END { for (i = 1; i <= files; i++) if (order[i] in missing) print order[i] ":" missing[order[i]] }'
	;;
folders)
	find lib stages render tests \( -name '*.c' -o -name '*.h' -o -name '*.cc' \) | sed 's#/[^/]*$##' | sort | uniq -c | sort -rn |
		sed 's/^ *//'
	;;
*) sed -n 's/^#   //p' "$0" >&2; exit 2 ;;
esac

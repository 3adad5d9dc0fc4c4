#!/bin/bash
# Installed like other software: the command from anywhere makes what make makes; man pages, completion; removed without a trace.
. "$(dirname "$0")/../lib/chain.sh"
. tests/lib/many.sh
[ "$BIN" = bin ] || { skip "installed" "not for sanitised programs"; exit 0; }

prefix="$root/a prefix"
small_captures "$root/many" 2
cp -r "$root/many" "$root/again"
run_make "$root/many/c1"
mkdir -p "$prefix/bin" && echo mine >"$prefix/bin/other"
make --no-print-directory install PREFIX="$prefix" >"$log" 2>&1 </dev/null
same "make install" "$? $(cat "$log")" "0 "
check "its version names the commit" test "$("$prefix/bin/eyewright" --version)" = "eyewright (Eyewright) $(sed -n 's/.*VERSION "\(.*\)"/\1/p' lib/base/version.h), $(cat bin/version)"

# From elsewhere, without the sources.
eyewright() { (cd / && "$prefix/bin/eyewright" "$@" >"$log" 2>&1 </dev/null); }
eyewright "$root/again/c1"
same "the command makes what make makes" "$? $(bytes_of "$root/again/c1")" "0 $(bytes_of "$root/many/c1")"
eyewright "$root/again/c1"
same "again: nothing runs" "$? $(ran)" "0 "
eyewright "$root/again/c2" limbus
same "one stage" "$? $(ran)" "0 limbus"
eyewright "$root/again/c2" plan
check "the plan" grep -q '^unrefract  *run ' "$log"
eyewright batch "$root/again"
same "a batch" "$? $(grep -c '^2 captures: 2 done, 0 failed' "$log")" "0 1"
eyewright "$root/again/c2" clean
same "clean" "$? $(ls "$root/again/c2" | tr '\n' ' ')" "0 capture.conf photos "
for wrong in "" "$root/none" "--nonsense" "$root/again/c1 nonsense" "--threads=x $root/again/c1" "batch"; do
	# shellcheck disable=SC2086
	eyewright $wrong
	same "a wrong call: eyewright ${wrong//"$root"/}" "$?" 2
done
echo "eye.colour = blue" >>"$root/again/c1/capture.conf"
eyewright "$root/again/c1"
same "data that cannot be used" "$? $(grep -c 'unknown key' "$log")" "1 1"

# Manual pages: one for each program; nothing that the formatter complains of.
same "a page for each program" "$(cd "$prefix/share/man/man1" && echo *)" "$(cd bin && printf 'eyewright-%s.1 ' $(ls -I version) | sed 's/ $//') eyewright.1"
if command -v man >/dev/null && man --version >/dev/null 2>&1; then
	same "the pages are well formed" "$(for page in "$prefix"/share/man/man1/*; do man --warnings -E UTF-8 -l -Tutf8 -Z "$page" 2>&1 >/dev/null; done)" ""
else skip "the pages are well formed" "man is not installed"; fi
check "a page has the options' ranges" grep -q '^(5..12 mm)$' "$prefix/share/man/man1/eyewright-limbus.1"
completes() { # WORDS...: what completion offers for the last of them
	PATH=$prefix/bin:$PATH bash -c '. "$0"; compopt() { :; }; COMP_WORDS=(eyewright "$@"); COMP_CWORD=$#; _eyewright; echo "${COMPREPLY[*]}"' \
		"$prefix/share/bash-completion/completions/eyewright" "$@"
}
same "completion: options, folders, stages" "$(completes --thr) $(completes "$root/aga") $(completes x unr) $(completes x pi)" "--threads= $root/again unrefract pigment"

make --no-print-directory uninstall PREFIX="$prefix" >"$log" 2>&1 </dev/null
same "uninstall leaves what is not ours, and nothing else" "$? $(cd "$prefix" && find . | sort | tr '\n' ' ')" "0 . ./bin ./bin/other "

for program in dpkg dpkg-deb dpkg-shlibdeps; do command -v $program >/dev/null || { skip "a Debian package" "$program is not installed"; exit 0; }; done
make --no-print-directory deb >"$log" 2>&1 </dev/null
same "make deb" "$?" 0
deb=$(tail -n 1 "$log")
if command -v lintian >/dev/null; then same "lintian has no errors" "$(lintian --fail-on none --allow-root "$deb" 2>/dev/null | grep '^E:')" ""
else skip "lintian has no errors" "lintian is not installed"; fi
for needed in make opencv-data libavformat libheif libceres; do check "the package needs $needed" grep -qE "(^|, )$needed" <(dpkg-deb -f "$deb" Depends); done
[ "$(id -u)" = 0 ] || { skip "the package in a clean root" "only root can install"; exit 0; }
clean=$root/clean
mkdir -p "$clean/var/lib/dpkg/"{info,updates,triggers} && touch "$clean/var/lib/dpkg/"{status,available}
dpkg --root="$clean" --force-depends --force-script-chrootless -i "$deb" >"$log" 2>&1
same "installed into a clean root" "$?" 0
rm -rf "$root/again/c1/work" && sed -i '/eye.colour/d' "$root/again/c1/capture.conf"
(cd / && "$clean/usr/bin/eyewright" "$root/again/c1" >"$log" 2>&1)
same "and run there: the same bytes" "$? $(bytes_of "$root/again/c1")" "0 $(bytes_of "$root/many/c1")"
dpkg --root="$clean" --force-script-chrootless --purge eyewright >"$log" 2>&1
same "purged: nothing is left" "$? $(cd "$clean" && find . -type f ! -path './var/lib/dpkg/*' | head -n 3)" "0 "
exit 0

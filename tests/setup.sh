#!/bin/sh
# Installs the Debian packages named on the command line that are missing; where it may not, prints the command.
set -u
command -v dpkg-query >/dev/null 2>&1 || {
	echo "setup: this is not Debian; these are needed: $*" >&2
	exit 0
}
missing=
for p in "$@"; do
	case $(dpkg-query -W -f '${Status}' "$p" 2>/dev/null) in
	*"ok installed"*) ;;
	*) missing="$missing $p" ;;
	esac
done
[ -z "$missing" ] && exit 0
if [ "$(id -u)" = 0 ]; then
	as=
elif command -v sudo >/dev/null 2>&1 && sudo -n true 2>/dev/null; then
	as=sudo
else
	echo "setup: these packages are missing; run this once, then make again:" >&2
	echo "    apt-get install --no-install-recommends$missing" >&2
	exit 1
fi
echo "setup: installing$missing" >&2
$as apt-get update -qq >&2 || true
# shellcheck disable=SC2086
$as env DEBIAN_FRONTEND=noninteractive apt-get install -qq -y --no-install-recommends $missing >&2 </dev/null || {
	echo "setup: could not install$missing" >&2
	exit 1
}

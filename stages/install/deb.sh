#!/bin/bash
# A Debian package of the programs as they are built: $B/eyewright_VERSION_ARCH.deb. What they are linked with is found by
# dpkg-shlibdeps; libraries that are loaded when first needed are named by those that are installed here.
set -e
umask 022
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
for program in dpkg-deb dpkg-shlibdeps; do
	command -v $program >/dev/null || { echo "deb: $program is missing: apt-get install dpkg-dev" >&2; exit 1; }
done
root=$PWD/$B/deb arch=$(dpkg --print-architecture)
version=$(sed -n 's/^#define EYEWRIGHT_VERSION "\(.*\)"/\1/p' lib/base/version.h)+git$(git log -1 --format=%cd.%h --date=format:%Y%m%d --abbrev=8 2>/dev/null || echo 0)
date=$(git log -1 --format=%cD 2>/dev/null || date -R -r Makefile)
rm -rf "$root"
DEST=$root/usr STRIP=1 BIN=$BIN stages/install/install.sh
rm "$root/usr/lib/eyewright/files" "$root/usr/share/doc/eyewright/LICENSE"
gzip -9n "$root"/usr/share/man/man1/*.1
doc=$root/usr/share/doc/eyewright
printf 'eyewright (%s) unstable; urgency=medium\n\n  * Built from the sources.\n\n -- %s  %s\n' "$version" "${DEBFULLNAME:-Eyewright} <${DEBEMAIL:-eyewright@example.org}>" "$date" |
	gzip -9n >"$doc/changelog.gz"
{ echo "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/"; echo "Upstream-Name: Eyewright"; echo
	echo "Files: *"; grep -m 1 '^Copyright' LICENSE | sed 's/^Copyright (c) /Copyright: /'; echo "License: Expat"
	sed '1,/^Copyright/d' LICENSE | sed '/./,$!d; s/^$/./; s/^/ /'; } >"$doc/copyright"

# What they are linked with, and what they load.
mkdir -p "$B/shlibs/debian" && printf 'Source: eyewright\n' >"$B/shlibs/debian/control"
linked=$(cd "$B/shlibs" && dpkg-shlibdeps -O "$root"/usr/lib/eyewright/bin/* 2>/dev/null | sed -n 's/^shlibs:Depends=//p')
loaded=$(ldconfig -p | awk '/lib(avformat|avcodec|avutil|swscale|heif|webp|raw_r)\.so\.[0-9]+ / { print $NF }' | xargs -r -n 1 readlink -f |
	xargs -r -n 1 dpkg-query -S 2>/dev/null | sed 's/:.*//' | sort -u | paste -sd, | sed 's/,/, /g')
mkdir -p "$root/DEBIAN"
cat >"$root/DEBIAN/control" <<END
Package: eyewright
Version: $version
Architecture: $arch
Maintainer: ${DEBFULLNAME:-Eyewright} <${DEBEMAIL:-eyewright@example.org}>
Section: graphics
Priority: optional
Installed-Size: $(du -sk "$root/usr" | cut -f 1)
Depends: $linked, ${loaded:+$loaded, }make, opencv-data
Recommends: colmap
Suggests: slurm-client
Description: fits digital eyes to photographs and video of a person
 From macro photographs of a person's eye it fits that eye: where it looks, its
 iris without the cornea in front of it, the relief and the pigments of that
 iris, each number with its uncertainty. From a video it learns how the skin
 round the eyes moves with them, and drives any character so. It renders both
 for review.
END
(cd "$root" && find usr -type f -print0 | sort -z | xargs -0 md5sum >DEBIAN/md5sums)
chmod -R u=rwX,go=rX "$root"
dpkg-deb --root-owner-group --build "$root" "$B/eyewright_${version}_$arch.deb" >/dev/null
rm -rf "$root" "$B/shlibs"
echo "$B/eyewright_${version}_$arch.deb"

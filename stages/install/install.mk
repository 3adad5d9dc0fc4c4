# The programs as other software is installed.
#   make install PREFIX=/usr/local DESTDIR=    programs, configuration, the command `eyewright`, man pages, completion of bash
#   make uninstall PREFIX=/usr/local DESTDIR=  removes what install has put there, and nothing else
#   make deb                                   a Debian package: build/eyewright_VERSION_ARCH.deb
PREFIX ?= /usr/local
DESTDIR ?=
override PREFIX := $(value PREFIX)
override DESTDIR := $(value DESTDIR)
.PHONY: install uninstall deb
install: build
	@BIN="$(BIN)" DEST="$$DESTDIR$$PREFIX" stages/install/install.sh
uninstall:
	@DEST="$$DESTDIR$$PREFIX" stages/install/install.sh --remove
deb: build
	@BIN="$(BIN)" B="$B" stages/install/deb.sh
install uninstall: export PREFIX := $(value PREFIX)
install uninstall: export DESTDIR := $(value DESTDIR)

# Which commit the programs are of: for --version alone. It stands beside them, not in them: a commit does not run stages again.
# Several makes may run at once (a batch, a cluster's jobs): each writes a file of its own.
build: $(BIN)/version
$(BIN)/version: FORCE
	@mkdir -p $(@D)
	@new=$(@D)/.version.$$$$; { git describe --always --dirty --abbrev=12 2>/dev/null || echo "no commit"; } >$$new; \
	if cmp -s $$new $@; then rm $$new; else mv $$new $@; fi

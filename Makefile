#$ Eyewright: from photographs of a person to fitted, renderable eyes.
#$
#$   make demo                       the whole pipeline on a bundled capture, ending with a picture
#$   make check                      build, then run all tests
#$
#$   make CAPTURE=my-capture         run what the capture needs and what has changed
#$   make CAPTURE=my-capture plan    what would run, what would not and why, and how long it takes
#$   make CAPTURE=my-capture limbus  one stage, after those it needs (any program of bin/)
#$   make CAPTURE=my-capture export  the eye for other programs alone: work/export/
#$   make CAPTURE=my-capture WORK=D  the capture is only read: results stand in D/work/; with any of these
#$   make CAPTURE=my-capture clean   remove my-capture/work/, all that was made
#$   make batch CAPTURES=DIR         every capture folder in DIR, JOBS=N of them side by side; make batch-status: what became of them;
#$                                   DIR/batch/index.html, summary.csv: all that was found, worst first
#$     SCHEDULER=slurm               the same as job arrays of Slurm
#$   make install PREFIX=/usr/local  the command `eyewright CAPTURE [STAGE]`, man pages, completion; uninstall; deb: a Debian package
#$   THREADS=2                       with any of these: at most so many threads; results do not depend on it
#$
#$   make bench                      speed and error of every method in tables and plots: bench/README.md
#$   make bench-NAME                 one benchmark; QUICK=1 with both: fewer cases
#$   make test_NAME                  one unit test
#$   make stress                     long runs over random and hostile cases
#$   make fuzz SECONDS_EACH=60       everything that reads strangers' files, with clang's libFuzzer
#$   make build                      the programs alone: bin/
#$   make setup                      install the Debian packages that are missing, or print the command that does
#$   make clean                      remove everything built
#$
#$ A capture is a folder with photos/ (macro photographs of one eye each) and, if need be, capture.conf:
#$ one "key = value" a line; bin/STAGE --help lists the keys. Results: my-capture/work/review/index.html.

CAPTURE ?=
# V=1 shows the commands.
V ?=
Q := $(if $(V),,@)
tell = $(if $(V),,@echo "  $(1)")

# SAN=1: address and undefined-behaviour sanitisers; TSAN=1: the thread sanitizer, by clang, whose OpenMP it understands.
SAN ?=
TSAN ?=
sanitised := $(SAN)$(TSAN)
B := build$(if $(TSAN),-tsan,$(if $(SAN),-san))
BIN := $(if $(sanitised),$(B)/bin,bin)
CLANG ?= clang
ifneq ($(TSAN),)
override CC := $(CLANG)
override CXX := $(CLANG)++
endif

PACKAGES := gcc g++ make pkg-config libopencv-dev opencv-data libceres-dev libopenexr-dev libopenmesh-dev libjansson-dev \
	libinih-dev libxxhash-dev zlib1g-dev libexif-dev libturbojpeg0-dev libpng-dev libtiff-dev liblapacke-dev \
	libopenblas-dev libsuitesparse-dev libflann-dev libembree-dev libsqlite3-dev libzip-dev libavformat-dev libavcodec-dev \
	libswscale-dev libavutil-dev libqhull-dev libmeshoptimizer-dev libassimp-dev liblcms2-dev libheif-dev libwebp-dev libstb-dev libraw-dev libseccomp-dev \
	libcmocka-dev gnuplot-nox

# Sanitised programs are built to be built fast: they run no longer for it, and functions and lines are what a report needs.
CFLAGS ?= $(if $(sanitised),-O1 -g1,-O3 -g)
# The bridges' libraries are templates whose types would be four fifths of every program: lines suffice.
CXXFLAGS ?= $(if $(sanitised),-O1,-O2) -g1
WARN := -Wall -Wextra -Wpedantic -Werror
comma := ,
SANFLAGS := $(if $(TSAN),-fsanitize=thread,$(if $(SAN),-fsanitize=address$(comma)undefined -fno-sanitize-recover=undefined)) \
	$(if $(sanitised),-fno-omit-frame-pointer) $(if $(TSAN),-Wno-pass-failed)
# No errno from maths and no traps: lets loops with sqrt vectorise. NaN and infinity keep their meaning.
MATHFLAGS := -fno-math-errno -fno-trapping-math -ffp-contract=off
ALL_CFLAGS := -std=gnu2x -D_GNU_SOURCE $(WARN) $(CFLAGS) $(SANFLAGS) $(MATHFLAGS) -fopenmp -Ilib -I. -MMD -MP
ALL_CXXFLAGS := -std=c++17 -D_GNU_SOURCE $(WARN) $(CXXFLAGS) $(SANFLAGS) -fopenmp -Ilib -MMD -MP \
	-isystem /usr/include/opencv4 -isystem /usr/include/eigen3
# Asked when a recipe runs, not when this file is read: on a fresh machine set-up comes in between.
EXR_CFLAGS = $(patsubst -I%,-isystem %,$(shell pkg-config --cflags OpenEXR 2>/dev/null))
EXR_LIBS = $(shell pkg-config --libs OpenEXR 2>/dev/null)
LIBS = -lopencv_aruco -lopencv_objdetect -lopencv_dnn -lopencv_photo -lopencv_video -lopencv_calib3d -lopencv_imgproc -lopencv_core -lceres -lglog \
	-lOpenMeshTools -lOpenMeshCore $(EXR_LIBS) -lexif -lturbojpeg -lpng -ltiff -lcholmod -lqhull_r -lflann -lembree3 -lmeshoptimizer -lassimp -lstb -lsqlite3 -lzip \
	-llapacke -lopenblas -ljansson -linih -lxxhash -lz -llcms2 -lseccomp -lm

LIB_SRC := $(wildcard lib/*/*.c lib/*/*/*.c lib/*/*/*/*.c)
BRIDGE_SRC := $(wildcard lib/bridge/*.cc)
LIB_OBJ := $(LIB_SRC:%.c=$B/%.o) $(BRIDGE_SRC:%.cc=$B/%.o)
STAGES := $(notdir $(patsubst %/,%,$(dir $(wildcard stages/*/main.c render/main.c))))
# Beside the stages: what tells of many captures.
PROGRAMS := $(STAGES:%=$(BIN)/%) $(BIN)/summary
TESTS := $(patsubst %.c,$B/%,$(wildcard tests/unit/*/test_*.c))
BENCHES := $(patsubst %.c,$B/%,$(wildcard tests/bench/bench_*.c tests/bench/*/bench_*.c))
STRESSES := $(patsubst %.c,$B/%,$(wildcard tests/stress/stress_*.c))
TEST_LIB_OBJ := $(patsubst %.c,$B/%.o,$(wildcard tests/lib/*.c tests/lib/*/*.c tests/peers/*.c) \
	$(filter-out tests/evidence/make_%.c,$(wildcard tests/evidence/*.c)))

.DEFAULT_GOAL := all
.DELETE_ON_ERROR:
.SECONDARY:
MAKEFLAGS += --no-builtin-rules

.PHONY: all build setup help check demo bench stress clean FORCE
# One capture, many, and the programs installed.
ready := build
include stages/capture.mk stages/batch/batch.mk stages/install/install.mk $(wildcard tests/*.mk)
all: $(if $(CAPTURE),run,help)

# ---- set-up: what is missing is installed, or named --------------------------------------------------------------
$B/.setup: Makefile
	@tests/setup.sh $(PACKAGES)
	@mkdir -p $B && touch $@
setup: $B/.setup

# ---- build -------------------------------------------------------------------------------------------------------
build: $B/libeyewright.a $(PROGRAMS)

$B/%.o: %.c | $B/.setup
	@mkdir -p $(@D)
	$(call tell,cc $<)
	$(Q)$(CC) $(ALL_CFLAGS) $(EXR_CFLAGS) -c $< -o $@
$B/%.o: %.cc | $B/.setup
	@mkdir -p $(@D)
	$(call tell,c++ $<)
	$(Q)$(CXX) $(ALL_CXXFLAGS) $(EXR_CFLAGS) -c $< -o $@

# q, not r: rooms may hold files of one name.
# Archives and programs are replaced only when their bytes change, so that a comment reruns no stage.
$B/libeyewright.a: $(LIB_OBJ)
	@rm -f $@
	@$(AR) qcsD $@ $(LIB_OBJ)

define program
$(BIN)/$(1): $(2) $B/libeyewright.a
	@mkdir -p $$(@D)
	$$(call tell,link $$@)
	$$(Q)$(CXX) $(SANFLAGS) -fopenmp -Wl,--as-needed -o $$@ $(2) $B/libeyewright.a $$(LIBS)
endef
$(foreach s,$(filter-out render,$(STAGES)),$(eval $(call program,$s,$(patsubst %.c,$B/%.o,$(wildcard stages/$s/*.c)))))
$B/render/page/embed.o: $(wildcard render/page/page.*) render/export/blender_eye.py render/export/engines.md config/animate.conf lib/draw/eye/look.h lib/draw/face/skin_look.h $(wildcard render/viewer/*)
$B/stages/batch/summary/page.o: $(wildcard stages/batch/summary/page.*)
$(eval $(call program,summary,$(patsubst %.c,$B/%.o,$(wildcard stages/batch/summary/*.c))))
$(eval $(call program,render,$(patsubst %.c,$B/%.o,$(wildcard render/*.c render/*/*.c))))

# From archives, so that a test holds what it calls alone: there are 150 of them, twice.
$B/libtests.a: $(TEST_LIB_OBJ)
	@rm -f $@
	@$(AR) qcsD $@ $(TEST_LIB_OBJ)
$B/tests/%: $B/tests/%.o $B/libtests.a $B/libeyewright.a
	@mkdir -p $(@D)
	@$(CXX) $(SANFLAGS) -fopenmp -Wl,--as-needed -o $@ $< $B/libtests.a $B/libeyewright.a -lcmocka -lheif -lwebp $(LIBS)

# ---- the bundled capture, from the photograph to the page -------------------------------------------------------------
demo: setup
	@$(MAKE) --no-print-directory -j$(CORES) build
	@$(MAKE) --no-print-directory run CAPTURE=samples/demo
	@echo
	@for f in work/review/index.html work/render/contact_sheet.png; do \
		test -e samples/demo/$$f && echo "open $(CURDIR)/samples/demo/$$f"; done; true

help:
	@sed -n 's/^#\$$ \{0,1\}//p' Makefile

clean: $(if $(CAPTURE),build)
	@if test -n "$$CAPTURE"; then $(BIN)/plan --capture="$$CAPTURE" --clean; else rm -rf build build-* bin bench; fi

-include $(shell find $B -name '*.d' 2>/dev/null)

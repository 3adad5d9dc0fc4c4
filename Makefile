#$ Eyewright: from photographs of a person to fitted, renderable eyes.
#$
#$   make demo                       the whole pipeline on a bundled capture, ending with a picture
#$   make check                      build, then run all tests
#$
#$   make CAPTURE=my-capture         run what the capture needs and what has changed
#$   make CAPTURE=my-capture plan    what would run, what would not and why, and how long it takes
#$   make CAPTURE=my-capture limbus  one stage, after those it needs (any program of bin/)
#$   make CAPTURE=my-capture clean   remove my-capture/work/, all that was made
#$   make batch CAPTURES=DIR         every capture folder in DIR, one after the other
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
# A folder's name may hold anything: it reaches the programs through the environment, never through a shell's text.
override CAPTURE := $(value CAPTURE)
override CAPTURES := $(value CAPTURES)
export CAPTURE CAPTURES
# Threads that wait sleep: other programs of this machine are not slowed down.
export OMP_WAIT_POLICY ?= passive
# Those of OpenBLAS do not, and a stage's own threads want the cores: its matrices are small.
still := OPENBLAS_NUM_THREADS=$${OPENBLAS_NUM_THREADS:-1}
# Large arrays in large pages, where the kernel has them on request: a fifth of the page faults. For stages alone: a browser
# that a test starts gets no graphics with it.
still += GLIBC_TUNABLES=$${GLIBC_TUNABLES:-glibc.malloc.hugetlb=1}

# V=1 shows the commands.
V ?=
Q := $(if $(V),,@)
tell = $(if $(V),,@echo "  $(1)")

SAN ?=
B := build$(if $(SAN),-san)
BIN := $(if $(SAN),$(B)/bin,bin)

PACKAGES := gcc g++ make pkg-config libopencv-dev opencv-data libceres-dev libopenexr-dev libopenmesh-dev libjansson-dev \
	libinih-dev libxxhash-dev libexif-dev libturbojpeg0-dev libpng-dev libtiff-dev liblapacke-dev \
	libopenblas-dev libsuitesparse-dev libflann-dev libembree-dev libsqlite3-dev libzip-dev libavformat-dev libavcodec-dev \
	libswscale-dev libavutil-dev libqhull-dev liblcms2-dev libheif-dev libwebp-dev libraw-dev \
	libcmocka-dev gnuplot-nox

# Sanitised programs are built to be built fast: they run no longer for it.
CFLAGS ?= $(if $(SAN),-O1,-O3) -g
CXXFLAGS ?= $(if $(SAN),-O1,-O2) -g
WARN := -Wall -Wextra -Wpedantic -Werror
comma := ,
SANFLAGS := $(if $(SAN),-fsanitize=address$(comma)undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
# No errno from maths and no traps: lets loops with sqrt vectorise. NaN and infinity keep their meaning.
MATHFLAGS := -fno-math-errno -fno-trapping-math -ffp-contract=off
ALL_CFLAGS := -std=gnu2x -D_GNU_SOURCE $(WARN) $(CFLAGS) $(SANFLAGS) $(MATHFLAGS) -fopenmp -Ilib -I. -MMD -MP
ALL_CXXFLAGS := -std=c++17 -D_GNU_SOURCE $(WARN) $(CXXFLAGS) $(SANFLAGS) -fopenmp -Ilib -MMD -MP \
	-isystem /usr/include/opencv4 -isystem /usr/include/eigen3
# Asked when a recipe runs, not when this file is read: on a fresh machine set-up comes in between.
EXR_CFLAGS = $(patsubst -I%,-isystem %,$(shell pkg-config --cflags OpenEXR 2>/dev/null))
EXR_LIBS = $(shell pkg-config --libs OpenEXR 2>/dev/null)
LIBS = -lopencv_aruco -lopencv_objdetect -lopencv_dnn -lopencv_photo -lopencv_video -lopencv_calib3d -lopencv_imgproc -lopencv_core -lceres -lglog \
	-lOpenMeshTools -lOpenMeshCore $(EXR_LIBS) -lexif -lturbojpeg -lpng -ltiff -lcholmod -lqhull_r -lflann -lembree3 -lsqlite3 -lzip \
	-llapacke -lopenblas -ljansson -linih -lxxhash -llcms2 -lm

LIB_SRC := $(wildcard lib/*/*.c lib/*/*/*.c lib/*/*/*/*.c)
BRIDGE_SRC := $(wildcard lib/bridge/*.cc)
LIB_OBJ := $(LIB_SRC:%.c=$B/%.o) $(BRIDGE_SRC:%.cc=$B/%.o)
STAGES := $(notdir $(patsubst %/,%,$(dir $(wildcard stages/*/main.c render/main.c))))
PROGRAMS := $(STAGES:%=$(BIN)/%)
TESTS := $(patsubst %.c,$B/%,$(wildcard tests/unit/*/test_*.c))
BENCHES := $(patsubst %.c,$B/%,$(wildcard tests/bench/bench_*.c tests/bench/*/bench_*.c))
STRESSES := $(patsubst %.c,$B/%,$(wildcard tests/stress/stress_*.c))
TEST_LIB_OBJ := $(patsubst %.c,$B/%.o,$(wildcard tests/lib/*.c tests/lib/*/*.c tests/peers/*.c) \
	$(filter-out tests/evidence/make_eyes.c,$(wildcard tests/evidence/*.c)))

.DELETE_ON_ERROR:
.SECONDARY:
MAKEFLAGS += --no-builtin-rules

.PHONY: all build setup help check demo bench stress clean batch $(STAGES) FORCE
all: $(if $(CAPTURE),run,help)

include $(wildcard tests/*.mk)

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
$B/render/page/embed.o: $(wildcard render/page/page.*) config/animate.conf lib/draw/eye/look.h lib/draw/face/skin_look.h $(wildcard render/viewer/*)
$(eval $(call program,render,$(patsubst %.c,$B/%.o,$(wildcard render/*.c render/*/*.c))))

$B/tests/%: $B/tests/%.o $(TEST_LIB_OBJ) $B/libeyewright.a
	@mkdir -p $(@D)
	@$(CXX) $(SANFLAGS) -fopenmp -Wl,--as-needed -o $@ $< $(TEST_LIB_OBJ) $B/libeyewright.a -lcmocka -lheif -lwebp -lz $(LIBS)

# ---- a capture ---------------------------------------------------------------------------------------------------
# plan looks at the folder and writes what has to run; each stage then runs only if its inputs, configuration or
# program differ, by their bytes, from what it last ran with. Where none does, plan alone says so.
# Where no photograph could be used there is the page all the same: on it the limbus can be drawn by hand.
page_alone = test -d "$$CAPTURE/work/limbus" && test ! -d "$$CAPTURE/work/iris" && $(BIN)/render --capture="$$CAPTURE" --quiet >/dev/null 2>&1 && \
	echo "where the eye is can be drawn on $$CAPTURE/work/review/index.html" >&2
.PHONY: run need-capture
need-capture:
	@test -n "$$CAPTURE" || { echo "make: say which folder: make CAPTURE=my-capture $(MAKECMDGOALS)" >&2; exit 2; }
run: need-capture build
	@$(BIN)/plan --capture="$$CAPTURE" --todo; todo=$$?; test $$todo = 3 || exit $$todo; \
		BIN=$(BIN) $(still) $(MAKE) --no-print-directory -f - all < "$$CAPTURE/work/plan.mk" || { bad=$$?; $(page_alone); exit $$bad; }
$(filter-out plan,$(STAGES)): need-capture build
	@$(BIN)/plan --capture="$$CAPTURE" --quiet
	@BIN=$(BIN) $(still) $(MAKE) --no-print-directory -f - $@ < "$$CAPTURE/work/plan.mk"
plan: need-capture build
	@$(BIN)/plan --capture="$$CAPTURE" --show
# The bundled capture, from the photograph to the page.
demo: setup
	@$(MAKE) --no-print-directory -j$(CORES) build
	@$(MAKE) --no-print-directory run CAPTURE=samples/demo
	@echo
	@for f in work/review/index.html work/render/contact_sheet.png; do \
		test -e samples/demo/$$f && echo "open $(CURDIR)/samples/demo/$$f"; done; true
batch: build
	@test -d "$$CAPTURES" || { echo "make: say which folder holds the captures: make batch CAPTURES=DIR" >&2; exit 2; }
	@bad=0; for c in "$$CAPTURES"/*/; do \
		echo "== $$c" >&2; CAPTURE="$${c%/}" $(MAKE) --no-print-directory run || bad=1; done; exit $$bad

help:
	@sed -n 's/^#\$$ \{0,1\}//p' Makefile

clean: $(if $(CAPTURE),build)
	@if test -n "$$CAPTURE"; then $(BIN)/plan --capture="$$CAPTURE" --clean; else rm -rf build build-* bin bench; fi

-include $(shell find $B -name '*.d' 2>/dev/null)

# Tests.
#   make check            everything; ends with one line: N passed, N failed, N skipped
#   make stress           long runs against random and hostile cases; SHARE=10: ten times as many; SEED=2: others
#   make check-compilers  every artifact of the bundled captures by gcc's and by clang's programs, number by number
#   make check-same BASE=REV   every artifact of the bundled captures by this checkout and by another revision, byte by byte
#   make kill N=1000      kill -9, full disks, no inodes, failing disks and jumping clocks at N random moments of every column; SEED=2: others;
#                         ONLY=skin: of this column
#   make tsan             every stage under clang's thread sanitizer
#   make fuzz             libFuzzer on everything that reads strangers' files; SECONDS_EACH=30; KEEP=1: what it found is kept in tests/fuzz/
TOOLS := $(patsubst %.c,$B/%,$(wildcard tests/tools/*.c)) $B/tests/evidence/make_eyes $B/tests/evidence/make_strips $B/tests/evidence/make_occlusions $B/tests/preload/faults.so
$B/tests/preload/%.so: tests/preload/%.c
	@mkdir -p $(@D)
	@$(CC) -std=gnu2x -D_GNU_SOURCE $(WARN) -O2 -g -fPIC -shared -o $@ $<

SECONDS_EACH ?= 30
SEED ?= 1
SHARE ?= 1

.PHONY: tests fuzz fuzzers kill tsan check-compilers check-same
tests: $(TESTS) $(TOOLS)

# Without these the interactive page is not driven and no cameras are found, and the summary says so.
CHECK_PACKAGES := chromium nodejs colmap slurm-wlm lintian gltfpack

CORES = $(shell nproc)
check: setup
	@$(MAKE) --no-print-directory -j$(CORES) build tests $(STRESSES) $B/tests/bench/report/compare $B/tests/bench/report/report
	@tests/setup.sh $(CHECK_PACKAGES) || true
	@$(MAKE) --no-print-directory -j$(CORES) SAN=1 tests-sanitised
	@B=$B BIN=$(BIN) TESTS="$(TESTS)" SAN_TESTS="$(TESTS:$B/%=build-san/%)" FLAGS="$(EXR_CFLAGS)" FUZZ=6 \
		tests/check.sh

# make test_NAME: one of them, on its own.
define test
.PHONY: $(notdir $(1))
$(notdir $(1)): $(1)
	@$(1)
endef
$(foreach t,$(TESTS),$(eval $(call test,$t)))

kill: build $B/tests/tools/variant $B/tests/preload/faults.so
	@B=$B BIN=$(BIN) KILLS=$(or $(N),1000) SEED=$(SEED) tests/chain/kill.sh

# The programs anew by clang, then each stage: TSAN=1 is what the build is made with.
tsan: $B/tests/tools/variant $B/tests/tools/made_face
	@if ! command -v $(firstword $(lastword $(CLANG))) >/dev/null; then echo "  skipped thread sanitizer: clang is not installed"; \
	else $(MAKE) --no-print-directory TSAN=1 build && B=build-tsan TOOLS=$B tests/tsan.sh; fi

check-compilers: build $(TOOLS)
	@B=$B BIN=$(BIN) tests/compilers.sh

check-same: build $B/tests/tools/plain
	@test -n "$(BASE)" || { echo "make: say which revision: make check-same BASE=REV" >&2; exit 2; }
	@B=$B tests/same.sh "$(BASE)"

.PHONY: tests-sanitised
tests-sanitised: $(TESTS)

# Side by side, one to a core, the longest first; what each says comes when it is through.
stress: build $(STRESSES)
	@printf '%s\n' $(filter %_render,$(STRESSES)) $(filter-out %_render,$(STRESSES)) | xargs -P $(CORES) -I{} sh -c 'said=$$({} --share=$(SHARE) --seed=$(SEED) 2>&1); bad=$$?; printf "== %s\n%s\n" {} "$$said"; exit $$bad'

# Fuzz targets need clang; what they reach is built anew with its instrumentation, in one archive. Its C is built with all warnings: a second
# compiler's word on it (tests/syntax.sh).
FUZZ_FLAGS := -gline-tables-only -O1 -fsanitize=address,undefined -fno-sanitize-recover=undefined -Ilib -I. -D_GNU_SOURCE
FUZZ_OBJ := $(LIB_SRC:%.c=build-fuzz/%.o) build-fuzz/lib/bridge/om_mesh.o build-fuzz/lib/bridge/ai_scene.o
FUZZERS := $(patsubst tests/fuzz/fuzz_%.c,build-fuzz/fuzz_%,$(wildcard tests/fuzz/fuzz_*.c))
build-fuzz/%.o: %.c
	@mkdir -p $(@D)
	@$(CLANG) -std=c2x $(WARN) $(FUZZ_FLAGS) -fsanitize=fuzzer-no-link $(EXR_CFLAGS) -MMD -MP -c $< -o $@
build-fuzz/%.o: %.cc
	@mkdir -p $(@D)
	@$(CLANG)++ -std=c++17 -w $(FUZZ_FLAGS) -fsanitize=fuzzer-no-link $(EXR_CFLAGS) -isystem /usr/include/opencv4 -isystem /usr/include/eigen3 -MMD -MP -c $< -o $@
build-fuzz/libeyewright.a: $(FUZZ_OBJ)
	@rm -f $@
	@$(AR) qcsD $@ $(FUZZ_OBJ)
build-fuzz/fuzz_%: build-fuzz/tests/fuzz/fuzz_%.o build-fuzz/libeyewright.a
	@clang++ -fsanitize=fuzzer,address,undefined -Wl,--as-needed -o $@ $^ $(LIBS) -lgomp
-include $(FUZZ_OBJ:.o=.d) $(FUZZERS:build-fuzz/%=build-fuzz/tests/fuzz/%.d)

fuzzers: $(FUZZERS) $(TOOLS)
fuzz: fuzzers
	@FUZZ=$(SECONDS_EACH) CAPTURES=1 B=$B BIN=$(BIN) KEEP=$(KEEP) VERBOSE=1 tests/fuzz.sh

# Tests.
#   make check            everything; ends with one line: N passed, N failed, N skipped
#   make stress           long runs against random and hostile cases
#   make fuzz             libFuzzer on everything that reads strangers' files; SECONDS_EACH=30
TOOLS := $(patsubst %.c,$B/%,$(wildcard tests/tools/*.c))
SECONDS_EACH ?= 30

.PHONY: tests fuzz fuzzers
tests: $(TESTS) $(TOOLS)

check: setup build tests
	@$(MAKE) --no-print-directory SAN=1 tests-sanitised
	@B=$B BIN=$(BIN) TESTS="$(TESTS)" SAN_TESTS="$(TESTS:$B/%=build-san/%)" FLAGS="$(EXR_CFLAGS)" FUZZ=5 \
		tests/check.sh

.PHONY: tests-sanitised
tests-sanitised: $(TESTS)

stress: build $(STRESSES)
	@bad=0; for s in $(STRESSES); do echo "== $$s"; $$s || bad=1; done; exit $$bad

# Fuzz targets need clang; the C parts they reach are built anew with its instrumentation.
FUZZ_SRC := $(wildcard lib/base/*.c lib/image/*.c lib/math/*.c lib/mesh/*.c lib/optics/camera.c)
FUZZERS := $(patsubst tests/fuzz/fuzz_%.c,build-fuzz/fuzz_%,$(wildcard tests/fuzz/fuzz_*.c))
fuzzers: $(FUZZERS)
fuzz: fuzzers
	@FUZZ=$(SECONDS_EACH) tests/fuzz.sh

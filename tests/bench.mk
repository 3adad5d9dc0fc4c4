# Benchmarks: speed and error of the same run, in one table. QUICK=1: fewer repetitions and cases.
#   make bench            all of them, then bench/README.md with tables, plots and the goals reached; exit status 1, and the goals
#                         named last, where any is missed. One that fails does not stop the others
#   make bench-NAME       one; the same exit status
#   make fronts           config/fronts.conf measured anew: settings for `error = ...` and `time = ...` of capture.conf
#   make bench-compare BEFORE=DIR AFTER=DIR   what became worse beyond the spread; AFTER: bench if not said
BENCH_ARGS = --out=bench $(if $(QUICK),--quick)

bench: build
	@bad=0; $(MAKE) --no-print-directory -k $(filter-out bench-limbus_%,$(patsubst bench_%,bench-%,$(notdir $(BENCHES)))) || bad=1; \
		$(MAKE) --no-print-directory bench-report || bad=1; exit $$bad

# Many captures: beside the others, since it wants the machine for itself for half an hour.
.PHONY: bench-batch
bench-batch: build $B/tests/tools/variant
	@B=$B BIN=$(BIN) N=$(or $(N),$(if $(QUICK),20,200)) SAME=$(or $(SAME),$(if $(QUICK),100,1000)) tests/bench/batch.sh

# The exported eye in other programs: beside the others, since it needs Blender, and minutes.
.PHONY: bench-look
bench-look: build $B/tests/tools/eye_compare $B/tests/tools/face_compare $B/tests/tools/look_sheet
	@B=$B BIN=$(BIN) SAMPLES=$(or $(SAMPLES),$(if $(QUICK),16,128)) tests/bench/look.sh

# A character as large as a scan: minutes.
.PHONY: bench-import
bench-import: build $B/tests/tools/dressed $B/tests/tools/import
	@B=$B BIN=$(BIN) $(if $(QUICK),FACES=100000 PX=2048) tests/bench/import.sh

# Films of people, of which the repository has none: FILMS=FOLDER.
.PHONY: bench-track_real
bench-track_real: build
	@B=$B BIN=$(BIN) FILMS="$(FILMS)" tests/bench/real.sh

.PHONY: bench-report bench-compare
bench-compare: $B/tests/bench/report/compare
	@test -n "$(BEFORE)" || { echo "make: say which: make bench-compare BEFORE=old/bench [AFTER=bench]" >&2; exit 2; }
	@$< "$(BEFORE)" "$(or $(AFTER),bench)"
# Parts of a frame follow each other within a fraction of a millisecond: threads stay awake between them, as a viewer's do.
bench-distance bench-scatter bench-render: export OMP_WAIT_POLICY = active
define bench
$(patsubst bench_%,bench-%,$(notdir $(1))): build $(1) FORCE
	@mkdir -p bench
	@bad=0; for b in $(1) $$(also); do $$$$b $$(BENCH_ARGS) || bad=1; done; exit $$$$bad
endef
# The eyes that judge the search for the limbus run with its other figures, or alone, e.g. bench-limbus_unseen.
bench-limbus: also = $(filter $B/tests/bench/bench_limbus_%,$(BENCHES))
bench-limbus: $(filter $B/tests/bench/bench_limbus_%,$(BENCHES))
$(foreach b,$(BENCHES),$(eval $(call bench,$b)))
bench-report: $B/tests/bench/report/report
	@$< --out=bench --compiler="$$($(CC) --version | head -n 1)" --flags="$(CFLAGS) $(MATHFLAGS)"
# Settings that no other beats in time and error, of the stages that have such knobs.
.PHONY: fronts
fronts: bench-fronts bench-fronts_skin bench-fronts_track bench-fronts_render bench-fronts_calibrate
	@{ printf '; Settings of each stage that no other beats in both time and error: error against the finest setting or the truth, and\n'; \
	printf '; time on two processors, fixed, for each megapixel of photographs and for each million texels of the iris map. Made by make fronts on samples/, of\n'; \
	printf '; track on a close-up, too, of calibrate on eight photographs of a head with known cameras, of heightfield and relief on a Monte Carlo iris of known\n'; \
	printf '; thickness.\n'; \
	cat bench/fronts.front bench/fronts_skin.front bench/fronts_track.front bench/fronts_render.front; \
	cat bench/fronts_calibrate.front 2>/dev/null || grep '^calibrate' config/fronts.conf; } > config/fronts.new && mv config/fronts.new config/fronts.conf
	@for s in unrefract track; do cp bench/fronts*-front-of-$$s-*.png samples/front_$$s.png; done
	@$(MAKE) --no-print-directory bench-report
FORCE:

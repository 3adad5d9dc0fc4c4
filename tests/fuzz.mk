# Each stage's own main on a whole capture in memory: tests/fuzz/capture/.
CAPTURE_STAGES := $(STAGES)
CAPTURE_FUZZERS := $(CAPTURE_STAGES:%=build-fuzz/fuzz_capture_%)
CAPTURE_OBJ := $(patsubst %.c,build-fuzz/%.o,$(wildcard tests/fuzz/capture/*.c))
# What surrounds a stage, which run.c replaces; of the bridges those that take strangers' bytes are built anew, too.
CAPTURE_WRAPS := exit _exit opt_resolve guard_enter call_program_path plan_stage_program say_error run_exists run_programs run_program
BRIDGE_FUZZ_OBJ := $(filter-out build-fuzz/lib/bridge/om_mesh.o build-fuzz/lib/bridge/ai_scene.o,$(BRIDGE_SRC:%.cc=build-fuzz/%.o))
build-fuzz/%/main.o: FUZZ_FLAGS += -Dmain=stage_main
build-fuzz/render/page/embed.o: $B/render/page/embed.o
build-fuzz/bridge.a: $(BRIDGE_FUZZ_OBJ)
	@rm -f $@
	@$(AR) qcsD $@ $^
define capture_fuzzer
build-fuzz/fuzz_capture_$(1): $(CAPTURE_OBJ) $(2:%.c=build-fuzz/%.o) build-fuzz/libeyewright.a build-fuzz/bridge.a
	@clang++ -fsanitize=fuzzer,address,undefined -Wl,--as-needed $$(CAPTURE_WRAPS:%=-Wl,--wrap=%) -o $$@ $$(filter %.o,$$^) \
		-Wl,--start-group build-fuzz/libeyewright.a build-fuzz/bridge.a -Wl,--end-group $$(LIBS) -lgomp
endef
$(foreach s,$(filter-out render,$(STAGES)),$(eval $(call capture_fuzzer,$s,$(wildcard stages/$s/*.c))))
$(eval $(call capture_fuzzer,render,$(wildcard render/*.c render/*/*.c)))
.PHONY: capture-fuzzers
capture-fuzzers: $(CAPTURE_FUZZERS) $B/tests/tools/made_face
-include $(CAPTURE_OBJ:.o=.d) $(BRIDGE_FUZZ_OBJ:.o=.d)

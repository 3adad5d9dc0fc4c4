# Benchmarks: speed and error of the same run, in one table. QUICK=1: fewer repetitions and cases.
#   make bench            all of them, then bench/README.md with tables, plots and the goals reached
#   make bench-NAME       one
BENCH_ARGS = --out=bench $(if $(QUICK),--quick)

bench: $(BENCHES:$B/tests/bench/bench_%=bench-%)
	@$(MAKE) --no-print-directory bench-report

.PHONY: bench-report
bench-%: build $B/tests/bench/bench_% FORCE
	@mkdir -p bench
	@$B/tests/bench/bench_$* $(BENCH_ARGS)
bench-report: $B/tests/bench/report
	@$< --out=bench --compiler="$$($(CC) --version | head -n 1)" --flags="$(CFLAGS) $(MATHFLAGS)"
FORCE:

# Many captures: folders in CAPTURES, side by side on this machine or on a cluster of Slurm's.
#   make batch CAPTURES=DIR                    JOBS=N at a time (the machine's cores, when not given), THREADS for each
#   make batch CAPTURES=DIR SCHEDULER=slurm    as job arrays: stages/batch/README.md
#   make batch-status CAPTURES=DIR             what is done, waits, runs, failed, and why: CAPTURES/batch/status.csv
#   make batch CAPTURES=DIR WORK=ELSEWHERE     DIR is only read: results in ELSEWHERE/NAME/work/ and ELSEWHERE/batch/
CAPTURES ?=
override CAPTURES := $(value CAPTURES)
export CAPTURES
ifeq ($(origin WORK),command line)
export ELSEWHERE := $(value WORK)
endif
SCHEDULER ?=
JOBS ?=
.PHONY: batch batch-status
batch: $(ready)
	@BIN="$(abspath $(BIN))" JOBS="$(JOBS)" stages/batch/batch.sh $(if $(SCHEDULER),submit,local) $(SCHEDULER)
batch-status:
	@BIN="$(abspath $(BIN))" stages/batch/batch.sh status

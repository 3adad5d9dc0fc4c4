# One capture, by the programs in the folder BIN. The Makefile includes it; so does the installed command `eyewright` run it.
#   BIN       folder of the programs; with STAGES not given, of the environment
#   CAPTURE   the capture's folder; THREADS: at most so many threads
#   ready     what has to be made before the programs run: in the source tree, themselves

# A folder's name may hold anything: it reaches the programs through the environment, never through a shell's text.
override CAPTURE := $(value CAPTURE)
# A capture that is only read: make WORK=DIR; that folder stands for it, with links to what is read (stages/plan/mirror.h). Of the
# call alone: clusters have a variable of that name in their environment.
ifeq ($(origin WORK),command line)
export EYEWRIGHT_SOURCE := $(value CAPTURE)
override CAPTURE := $(value WORK)
# Makes below take the new name from the environment, not the old one from this call.
MAKEOVERRIDES :=
endif
export CAPTURE BIN
# Threads that wait sleep: other programs of this machine are not slowed down.
export OMP_WAIT_POLICY ?= passive
# Make, COLMAP and others put temporary files there: a folder that is gone is not taken.
ifneq ($(TMPDIR),)
export TMPDIR := $(shell test -d "$$TMPDIR" && test -w "$$TMPDIR" && printf %s "$$TMPDIR" || echo /tmp)
endif
# Those of OpenBLAS do not, and a stage's own threads want the cores: its matrices are small.
still := OPENBLAS_NUM_THREADS=$${OPENBLAS_NUM_THREADS:-1}
# Large arrays in large pages, where the kernel has them on request: a fifth of the page faults. For stages alone: a browser
# that a test starts gets no graphics with it.
still += GLIBC_TUNABLES=$${GLIBC_TUNABLES:-glibc.malloc.hugetlb=1}
# By its path, not through a pipe: make would copy that into TMPDIR. A path may not begin with a tilde.
run_plan = case "$$CAPTURE" in /*) mk=$$CAPTURE ;; *) mk=./$$CAPTURE ;; esac; $(still) $(MAKE) --no-print-directory -rf "$$mk/work/plan.mk"

# plan looks at the folder and writes what has to run; each stage then runs only if its inputs, configuration or
# program differ, by their bytes, from what it last ran with. Where none does, plan alone says so.
# Where no photograph could be used there is the page all the same: on it the limbus can be drawn by hand.
page_alone = test -d "$$CAPTURE/work/limbus" && test ! -d "$$CAPTURE/work/iris" && "$$BIN/render" --capture="$$CAPTURE" --quiet >/dev/null 2>&1 && \
	echo "where the eye is can be drawn on $$CAPTURE/work/review/index.html" >&2
# Where a film was followed and a stage after it could not use it, the page shows what there is.
page_film = test -f "$$CAPTURE/work/skin/gaze.csv" && test -e "$$CAPTURE/work/.made/track.json" && "$$BIN/plan" --capture="$$CAPTURE" --fresh=track >/dev/null 2>&1 && \
	"$$BIN/render" --capture="$$CAPTURE" --quiet >/dev/null 2>&1 && echo "what was followed is on $$CAPTURE/work/review/index.html" >&2
ifeq ($(origin STAGES),undefined)
STAGES := $(shell ls -I version -I summary "$$BIN")
endif
.PHONY: run need-capture plan $(STAGES) export
need-capture:
	@test -n "$$CAPTURE" || { echo "make: say which folder: make CAPTURE=my-capture $(MAKECMDGOALS)" >&2; exit 2; }
run: need-capture $(ready)
	@"$$BIN/plan" --capture="$$CAPTURE" --todo; todo=$$?; test $$todo = 3 || exit $$todo; \
		{ $(run_plan) all; } || { bad=$$?; $(page_alone); $(page_film); exit $$bad; }
$(filter-out plan,$(STAGES)) export: need-capture $(ready)
	@"$$BIN/plan" --capture="$$CAPTURE" --quiet
	@$(run_plan) $@
plan: need-capture $(ready)
	@"$$BIN/plan" --capture="$$CAPTURE" --show

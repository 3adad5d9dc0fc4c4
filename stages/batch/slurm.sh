# Captures as job arrays of Slurm. Sourced by batch.sh.
#   batch/slurm/jobs    the last submission's arrays: job TAB list of captures TAB captures a task
#   batch/slurm/*.list  names of an array's captures, by task, a zero byte behind each

TASK_SECONDS=${TASK_SECONDS:-20}

# What Slurm says of our tasks: job, task, state.
tasks() { squeue -h -r --me -n eyewright -o '%F %K %T' 2>/dev/null | grep -F -f <(cut -f 1 "$state/slurm/jobs" 2>/dev/null) | grep -v ' N/A '; }

# Captures with the same waves and the same requests, a line: NUMBERS, captures a task, then for each wave TARGETS|MIB|MINUTES, TABs
# between. Waves: cameras, fits, pictures; those that need at most 2 GiB, which a core of a cluster has anyway, are one. Slurm takes up to
# some seconds to start a task: one of a single wave holds captures of about $TASK_SECONDS, as long as each core still gets four tasks.
waves() { # CORES
	awk -F '\t' -v cores="$1" -v task="$TASK_SECONDS" '
		function up(x, from) { while (from < x) from *= 2; return from }
		{
			split("", s); split("", m); split("", t)
			for (i = 2; i < NF; i += 3) {
				w = $i == "calibrate" ? 1 : $i == "render" ? 3 : 2
				s[w] += $(i + 1); if ($(i + 2) > m[w]) m[w] = $(i + 2); t[w] = t[w] (t[w] == "" ? "" : " ") $i
			}
			key = ""; ts = 0; tm = 0; tt = ""; all = 0
			for (w = 1; w <= 3; w++) if (w in s) all += s[w]
			for (w = 1; w <= 3; w++) if (w in s) {
				if (tt != "" && (tm > 1500 || m[w] > 1500)) { key = key "\t" tt "|" up(tm * 1.3, 512) "|" up(ts / 6, 10); ts = tm = 0; tt = "" }
				ts += s[w]; if (m[w] > tm) tm = m[w]; tt = tt (tt == "" ? "" : " ") t[w]
			}
			key = key "\trun|" up(tm * 1.3, 512) "|" up(ts / 6, 10)
			of[key] = of[key] (of[key] == "" ? "" : " ") $1
			n[key]++; seconds[key] += all
		}
		END {
			for (k in of) {
				per = 1
				if (split(k, wave, "\t") == 2) { # one wave
					per = int(task * n[k] / (seconds[k] + 1e-9)); share = int(n[k] / (4 * cores))
					per = per < share ? per : share; per = per > 1 ? per : 1
				}
				print of[k] "\t" per k
			}
		}' "$state/todo" | sort -n
}

# One array: the captures of a list. Prints its job.
array() { # LIST TASKS WAVE AFTER PER
	local targets=${3%%|*} minutes=${3##*|} mib=${3#*|}
	sbatch --parsable --job-name=eyewright --array="1-$2${JOBS:+%$JOBS}" --mem="${mib%|*}M" --time="$minutes" \
		--cpus-per-task="$THREADS" --requeue --open-mode=append --output="${state//%/%%}/slurm/%A.out" \
		${4:+--dependency="aftercorr:$4" --kill-on-invalid-dep=yes} "$here/task.sh" "$here/batch.sh" one "$1" "$targets" "$5" </dev/null
}

submit() {
	command -v sbatch >/dev/null || die "sbatch is not there: SCHEDULER=slurm needs Slurm's commands (Debian: slurm-client)"
	case ${JOBS:-1} in *[!0-9]* | 0*) die "JOBS = $(one_line "$JOBS"): must be a whole number from 1" 2 ;; esac
	export THREADS=${THREADS:-1}
	mkdir -p "$state/slurm" || exit 1
	local left most cores n=0 numbers per rest wave list after all='' job
	left=$(tasks | wc -l)
	[ "$left" = 0 ] || die "$left tasks of the last submission wait or run: make batch-status tells of them, scancel --name=eyewright ends them"
	list_todo
	rm -f "$state"/slurm/*.list "$state/slurm/jobs"
	[ -s "$state/todo" ] || { echo "nothing to do: nothing is submitted" >&2; status; return; }
	cut -f 1 "$state/todo" | pick "$state/captures" | (cd "$state/results" && xargs -0 rm -f --)
	most=$(scontrol show config | sed -n 's/^MaxArraySize *= *\([0-9]*\).*/\1/p')
	cores=$(sinfo -h -o %C 2>/dev/null | awk -F / '{ n += $4 } END { print (n > 0 ? n : 1) }')
	unset MAKEFLAGS MFLAGS MAKELEVEL
	while IFS=$'\t' read -r numbers per rest; do
		# shellcheck disable=SC2086
		while read -r numbers; do
			n=$((n + 1)) after='' list=$state/slurm/$n.list
			tr ' ' '\n' <<<"$numbers" | pick "$state/captures" >"$list"
			while IFS= read -r wave; do
				job=$(array "$list" "$((($(wc -w <<<"$numbers") + per - 1) / per))" "$wave" "$after" "$per") || die "sbatch refused it"
				job=${job%%;*} after=$job all=$all:$job
				printf '%s\t%s\t%s\n' "$job" "$list" "$per" >>"$state/slurm/jobs"
			done < <(tr '\t' '\n' <<<"$rest")
		done < <(xargs -n "$(((${most:-1001} - 1) * per))" <<<"$numbers")
	done < <(waves "$cores")
	sbatch --parsable --job-name=eyewright-summary --dependency="afterany$all" --mem=256M --time=60 --output="${state//%/%%}/slurm/summary.out" \
		"$here/task.sh" "$here/batch.sh" status </dev/null >"$state/slurm/summary" || die "sbatch refused the summary"
	echo "$(wc -l <"$state/todo") captures submitted in $(wc -l <"$state/slurm/jobs") job arrays; make batch-status tells of them" >&2
}

# What Slurm knows of the submitted captures, for status: NAME TAB STATE TAB REASON. Of one that it knows no more and that has left no
# result, its record tells why, where the cluster keeps records.
queued() {
	[ -s "$state/slurm/jobs" ] || return 0
	local job list per
	{
		while IFS=$'\t' read -r job list per; do
			tr '\n\0' ' \n' <"$list" | LC_ALL=C tr -c '[:print:]\200-\377\n' ' ' | awk -v job="$job" -v per="${per:-1}" '{ print "name\t" job "\t" int((NR - 1) / per) + 1 "\t" $0 }'
		done <"$state/slurm/jobs"
		tasks | awk '{ print "task\t" $1 "\t" $2 "\t" $3 }'
		sacct -n -P -X -o JobID,State -j "$(cut -f 1 "$state/slurm/jobs" | paste -sd,)" 2>/dev/null | awk -F '[_|]' '{ print "record\t" $1 "\t" $2 "\t" $3 }'
	} | awk -F '\t' '
		$1 == "name" { name[$2, $3, ++count[$2, $3]] = $4; if (!($4 in state)) state[$4] = "failed" }
		$1 == "task" {
			for (i = 1; i <= count[$2, $3]; i++) { n = name[$2, $3, i]; if (state[n] != "runs") state[n] = $4 == "RUNNING" || $4 == "COMPLETING" ? "runs" : "waits" }
		}
		$1 == "record" && $4 !~ /^(COMPLETED|PENDING|RUNNING|REQUEUED)/ { for (i = 1; i <= count[$2, $3]; i++) why[name[$2, $3, i]] = "Slurm: " $4 }
		END { for (n in state) print n "\t" state[n] "\t" (state[n] != "failed" ? "" : n in why ? why[n] : "its task ended without a word: batch/slurm/*.out, slurmctld.log") }'
}

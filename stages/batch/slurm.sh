# Captures as job arrays of Slurm. Sourced by batch.sh.
#   batch/slurm/jobs     the last submission's arrays: job TAB list of captures
#   batch/slurm/*.list   names of an array's captures, by task, a zero byte behind each
#   batch/slurm/*.tasks  first and last place in the list of each task's captures

TASK_SECONDS=${TASK_SECONDS:-20}
TASK_MOST=${TASK_MOST:-120}

# What Slurm says of our tasks: job, task, state.
tasks() { squeue -h -r --me -n eyewright -o '%F %K %T' 2>/dev/null | grep -F -f <(cut -f 1 "$state/slurm/jobs" 2>/dev/null) | grep -v ' N/A '; }

# Captures with the same waves and the same requests, a line: NUMBERS, how many of them each task holds, then for each wave
# TARGETS|MIB|MINUTES, TABs between. Waves: cameras, fits, pictures; those that need at most 2 GiB, which a core of a cluster has anyway,
# are one. Slurm takes up to some seconds to start a task: one of a single wave holds several captures, by guided self-scheduling
# (Polychronopoulos and Kuck 1987): a 2 * CORES-th of the seconds that are left, at most $TASK_MOST and at least $TASK_SECONDS of them, so
# that the first tasks are few and the last ones end together; but each core gets four tasks, as far as there are captures.
waves() { # CORES
	awk -F '\t' -v cores="$1" -v least="$TASK_SECONDS" -v most="$TASK_MOST" '
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
				waves = split(k, wave, "\t") - 1
				left = n[k]; mean = seconds[k] / n[k] + 1e-9; share = int(n[k] / (4 * cores)); longest = 1; sizes = ""
				while (left > 0) {
					s_of = left * mean / (2 * cores)
					per = int((s_of > most ? most : s_of < least ? least : s_of) / mean)
					per = per < share ? per : share; per = waves == 1 && per > 1 ? per : 1; per = per < left ? per : left
					if (per > longest) longest = per
					sizes = sizes (sizes == "" ? "" : " ") per
					left -= per
				}
				if (waves == 1) { split(wave[2], of_wave, "|"); k_of = "\t" of_wave[1] "|" of_wave[2] "|" up(longest * mean / 6, of_wave[3] + 0) } else k_of = k
				print of[k] "\t" sizes k_of
			}
		}' "$state/todo" | sort -n
}

# One array: the captures of a list. Prints its job.
array() { # LIST WAVE AFTER
	local targets=${2%%|*} minutes=${2##*|} mib=${2#*|}
	sbatch --parsable --job-name=eyewright --array="1-$(wc -l <"${1%.list}.tasks")${JOBS:+%$JOBS}" --mem="${mib%|*}M" --time="$minutes" \
		--cpus-per-task="$THREADS" --requeue --open-mode=append --output="${state//%/%%}/slurm/%A.out" \
		${3:+--dependency="aftercorr:$3" --kill-on-invalid-dep=yes} "$here/task.sh" "$here/batch.sh" one "$1" "$targets" </dev/null
}

submit() {
	command -v sbatch >/dev/null || die "sbatch is not there: SCHEDULER=slurm needs Slurm's commands (Debian: slurm-client)"
	case ${JOBS:-1} in *[!0-9]* | 0*) die "JOBS = $(one_line "$JOBS"): must be a whole number from 1" 2 ;; esac
	export THREADS=${THREADS:-1}
	mkdir -p "$state/slurm" || exit 1
	local left most cores n=0 from t numbers sizes rest wave list after all='' job
	local -a number size
	left=$(tasks | wc -l)
	[ "$left" = 0 ] || die "$left tasks of the last submission wait or run: make batch-status tells of them, scancel --name=eyewright ends them"
	list_todo
	rm -f "$state"/slurm/*.{list,tasks} "$state/slurm/jobs"
	[ -s "$state/todo" ] || { echo "nothing to do: nothing is submitted" >&2; status; return; }
	cut -f 1 "$state/todo" | pick "$state/captures" | (cd "$state/results" && xargs -0 rm -f --)
	most=$(scontrol show config | sed -n 's/^MaxArraySize *= *\([0-9]*\).*/\1/p')
	cores=$(sinfo -h -o %C 2>/dev/null | awk -F / '{ n += $4 } END { print (n > 0 ? n : 1) }')
	unset MAKEFLAGS MFLAGS MAKELEVEL
	while IFS=$'\t' read -r numbers sizes rest; do
		read -ra number <<<"$numbers"
		read -ra size <<<"$sizes"
		for ((from = t = 0; t < ${#size[@]}; t += ${most:-1001} - 1)); do
			n=$((n + 1)) after='' list=$state/slurm/$n.list
			printf '%s\n' "${size[@]:t:${most:-1001}-1}" | awk '{ print last + 1, last += $1 }' >"${list%.list}.tasks"
			numbers=$(tail -n 1 "${list%.list}.tasks")
			printf '%s\n' "${number[@]:from:${numbers#* }}" | pick "$state/captures" >"$list"
			from=$((from + ${numbers#* }))
			while IFS= read -r wave; do
				job=$(array "$list" "$wave" "$after") || die "sbatch refused it"
				job=${job%%;*} after=$job all=$all:$job
				printf '%s\t%s\n' "$job" "$list" >>"$state/slurm/jobs"
			done < <(tr '\t' '\n' <<<"$rest")
		done
	done < <(waves "$cores")
	sbatch --parsable --job-name=eyewright-summary --dependency="afterany$all" --mem=256M --time=60 --output="${state//%/%%}/slurm/summary.out" \
		"$here/task.sh" "$here/batch.sh" status </dev/null >"$state/slurm/summary" || die "sbatch refused the summary"
	echo "$(wc -l <"$state/todo") captures submitted in $(wc -l <"$state/slurm/jobs") job arrays; make batch-status tells of them" >&2
}

# What Slurm knows of the submitted captures, for status: NAME TAB STATE TAB REASON. Of one that it knows no more and that has left no
# result, its record tells why, where the cluster keeps records.
queued() {
	[ -s "$state/slurm/jobs" ] || return 0
	local job list
	{
		while IFS=$'\t' read -r job list; do
			tr '\n\0' ' \n' <"$list" | LC_ALL=C tr -c '[:print:]\200-\377\n' ' ' | awk -v job="$job" '
				NR == FNR { last[NR] = $2; next }
				{ while (last[t + 1] < FNR) t++; print "name\t" job "\t" t + 1 "\t" $0 }' "${list%.list}.tasks" -
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

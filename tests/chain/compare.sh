#!/bin/bash
# Two benchmark runs compared: what is worse beyond the spread is named, and what is not, is not. And the report of one run: a goal
# that is missed is named last and is its exit status.
. "$(dirname "$0")/../lib/chain.sh"
COMPARE=${B:-build}/tests/bench/report/compare
mkdir "$root/a" "$root/b"
head="table,method,setting,per,median_s,low_s,high_s,error,error_unit,error_of"
rows() { # MEDIAN LOW HIGH ERROR of the last row; how much slower the others are: $5
	echo "$head"
	for i in 1 2 3 4 5 6; do awk -v s="${5:-1}" -v i="$i" 'BEGIN { printf "t,ours,%d steps,solve,%g,%g,%g,0.5,px,worst\n", i, s * i, s * i * 0.9, s * i * 1.1 }'; done
	echo "t,ours,last,solve,$1,$2,$3,$4,px,worst"
}
goals() { printf 'measure,reach,got,unit,reached\nworst,below 1,%s,px,%s\n' "$1" "$2"; }
says() { # NAME STATUS LINE...: what compare has to say
	local name=$1 status=$2
	"$COMPARE" "$root/a" "$root/b" >"$log" 2>&1
	same "$name: exit status" "$?" "$status"
	shift 2
	for line in "$@"; do check "$name: $line" grep -qE "$line" "$log"; done
}
rows 1 0.9 1.1 0.5 >"$root/a/x.csv"
echo 0.001 >"$root/a/x.yard"
goals 0.5 yes >"$root/a/x.goals.csv"
cp "$root"/a/* "$root/b"
says "the same" 0 "^7 rows in both .* 0 worse, 0 better; 0 gone, 0 new"
rows 1.15 1 1.2 0.505 >"$root/b/x.csv"
says "within the spread" 0 " 0 worse, 0 better"
rows 1.5 1.4 1.6 0.5 >"$root/b/x.csv"
says "slower" 1 "^SLOWER  x.csv: t, ours, last: time 1 -> 1.5 s" " 1 worse, 0 better"
rows 0.5 0.4 0.6 0.6 >"$root/b/x.csv"
says "faster, and less exact" 1 "^faster " "^WORSE .*: worst 0.5 -> 0.6 px"
rows 2 1.8 2.2 0.5 2 >"$root/b/x.csv"
echo 0.002 >"$root/b/x.yard"
says "a machine half as fast" 0 "machine 2.00 times as slow" " 0 worse"
rows 1 0.9 1.1 0.5 0.4 >"$root/b/x.csv"
cp "$root/a/x.yard" "$root/b"
says "most rows faster: the others are not slower" 0 "machine 1.00 times as slow" " 0 worse, 6 better"
rows 1.2 1.2 1.2 0.5 >"$root/b/x.csv"
says "measured once: that may be chance" 0 " 0 worse"
rows 1.5 1.5 1.5 0.5 >"$root/b/x.csv"
says "measured once: that is not" 1 "^SLOWER " " 1 worse"
rm "$root/b/x.yard"
rows 2 1.8 2.2 0.5 2 >"$root/b/x.csv"
says "without a yardstick" 1 "^note .*no yardstick" " 7 worse"
cp "$root/a/x.csv" "$root/b" && goals 1.5 no >"$root/b/x.goals.csv"
says "a goal lost" 1 "^MISSED  x.csv: worst: 0.5 -> 1.5 px"
rm "$root"/b/*
says "nothing to compare" 1 "no row in both"

reports() { # NAME STATUS LAST-LINE
	"${B:-build}/tests/bench/report/report" --out="$root/a" >"$log" 2>&1
	same "$1: exit status" "$?" "$2"
	check "$1: $3" grep -qE "$3" <(tail -n 1 "$log")
}
goals 0.5 yes >"$root/a/x.goals.csv"
reports "all goals reached" 0 "^tables and plots: "
{ goals 1.5 no; echo "second,none,0,,yes"; } >"$root/a/x.goals.csv"
reports "a goal missed" 1 "^missed: bench-x: worst: below 1; got 1.5 px"
exit 0

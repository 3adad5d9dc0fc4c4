#!/bin/bash
# A short share of each stress run, of `make stress`: whatever the numbers, an answer that is right or says that it is not.
. "$(dirname "$0")/../lib/chain.sh"
declare -A share=([ellipse]=0.02 [train]=0.01 [nricp]=0.04 [pigment]=0.03 [render]=0.002 [edges]=0.004 [lightpath]=0.01 [pose]=0.1)

for name in "${!share[@]}"; do
	"${B:-build}/tests/stress/stress_$name" --share="${share[$name]}" >"$log" 2>&1
	same "stress of $name: exit status" "$?" 0
	grep -A 2 WRONG "$log"
done
exit 0

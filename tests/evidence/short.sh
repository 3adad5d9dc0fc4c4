#!/bin/bash
# Short trainings of the networks on drawn eyes: the losses fall. Skipped where torch is not installed. B: build folder.
. tests/lib/check.sh
train() # NAME PROGRAM GENERATOR
{
	local name="short training of the $1" said
	if ! /usr/bin/python3 -c 'import torch, numpy' 2>/dev/null; then
		skip "$name" "needs python3-torch and python3-numpy"
	elif said=$(OMP_WAIT_POLICY=passive /usr/bin/python3 "tests/evidence/$2" --make "${B:-build}/tests/evidence/$3" --short 2>&1); then
		pass "$name"
	else
		fail "$name" "$(tail -n 1 <<<"$said")"
	fi
}
train "evidence network" train.py make_eyes
train "strip network" strip.py make_strips

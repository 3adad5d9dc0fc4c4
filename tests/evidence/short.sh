#!/bin/bash
# A short training of the evidence network on drawn eyes: the loss falls. Skipped where torch is not installed. B: build folder.
. tests/lib/check.sh
name="short training of the evidence network"
if ! /usr/bin/python3 -c 'import torch, numpy' 2>/dev/null; then
	skip "$name" "needs python3-torch and python3-numpy"
elif said=$(OMP_WAIT_POLICY=passive /usr/bin/python3 tests/evidence/train.py --make "${B:-build}/tests/evidence/make_eyes" --short 2>&1); then
	pass "$name"
else
	fail "$name" "$(tail -n 1 <<<"$said")"
fi

# Sourced by tests/chain/*.sh: captures in a folder of their own, make on them, what ran.
cd "$(dirname "${BASH_SOURCE[0]}")/../.." || exit 1
. tests/lib/check.sh
BIN=${BIN:-bin}
VARIANT=${B:-build}/tests/tools/variant
PHOTO=samples/demo/photos/right_softbox.jpg
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
log=$root/log

# new_capture DIR: the bundled capture's configuration at draft quality; no photograph yet.
new_capture() {
	mkdir -p "$1/photos"
	{ cat samples/demo/capture.conf; echo "quality = draft"; } >"$1/capture.conf"
}

# small_face DIR: the skin column in a few seconds: the first frames of the bundled clip, a character, everything coarse.
small_face() {
	mkdir -p "$1/video" "$1/script"
	cp -r samples/face/{targets,subject.ply} "$1"
	# The first 11 frames: what a copy that broke off leaves is followed as far as it goes.
	head -c 250000 samples/face/video/face.mp4 >"$1/video/face.mp4"
	head -n 4 samples/face/script/look_around.csv | sed 1d | cut -d, -f1-7 >"$1/script/look.csv"
	{ grep -v '^expression' samples/face/capture.conf
		printf '%s\n' "quality = draft" "track.settle_frames = 0" "track.points = 200" "track.sweeps = 1" "train.sample = 64" \
			"transfer.rounds = 1 1 1" "transfer.nodes = 100 300 1000" "extrapolate.map_step_px = 8" \
			"render.look_px = 200" "render.cell_px = 100" "render.blink_frames = 3" "render.sheet_px = 300" "render.clip_px = 160" \
			"render.skin_lights = 4" "render.lashes = 12" "render.brow_hairs = 30" "render.glb_targets = 4" "render.clip_seconds = 0.1"; } >"$1/capture.conf"
}

# run_make DIR [TARGET...]: status of make; all it says in $log. A capture's name goes through the environment or as
# make's argument: both have to take any name.
run_make() {
	local capture=$1
	shift
	make --no-print-directory CAPTURE="$capture" "$@" >"$log" 2>&1 </dev/null
}

# Stages that ran, in order.
ran() { sed -n 's/^\([a-z]*\): done in .*/\1/p' "$log" | tr '\n' ' ' | sed 's/ $//'; }

# Names, times and bytes of everything made, but for what tells how long it took.
bytes_of() { (cd "$1/work" && find . -type f ! -path './.made/*' ! -path './log/*' ! -path './review/*' ! -name '*.log' -print0 |
	sort -z | xargs -0 sha256sum); }
times_of() { (cd "$1/work" && find . -type f ! -path './.made/*' -printf '%P %T@\n' | sort); }

# least NAME VALUE BOUND: VALUE is a number, at most BOUND.
least() { if awk -v a="$2" -v b="$3" 'BEGIN { exit !(a != "" && a <= b) }'; then pass "$1: $2 (at most $3)"; else fail "$1" "$2, must be at most $3"; fi; }

# scratch FILE AT: another byte at that place than the one that is there, whichever that is.
scratch() {
	local byte=X
	[ "$(tail -c +$(($2 + 1)) "$1" | head -c 1 | tr '\0' 0)" != X ] || byte=Y
	printf %s "$byte" | dd of="$1" bs=1 seek="$2" conv=notrunc 2>/dev/null
}

# same NAME GOT WANT: equal; of longer texts the first lines that differ are shown.
same() {
	if [ "$2" = "$3" ]; then pass "$1"; return; fi
	fail "$1" "$(diff <(printf '%s\n' "$2") <(printf '%s\n' "$3") | head -n 8); log: $(tail -n 4 "$log")"
}

# Packages of Node's that tests use, beside the build: npm_has NAME... : installed once; whether all are there.
npm=${B:-build}/npm
there() { node -e "require('$PWD/$npm/node_modules/$1/package.json')" >/dev/null 2>&1; }
npm_has() {
	local package ok=0
	command -v npm >/dev/null || return 1
	mkdir -p "$npm"
	for package; do
		there "$package" || (cd "$npm" && timeout 60 npm install --no-audit --no-fund --silent "$package" >/dev/null 2>&1)
		there "$package" || ok=1
	done
	return $ok
}
# khronos FILE.glb: how many errors and warnings Khronos's validator finds, and the first.
khronos() {
	node -e "require('$PWD/$npm/node_modules/gltf-validator').validateBytes(new Uint8Array(require('fs').readFileSync(process.argv[1])), { maxIssues: 0 })
		.then(r => console.log(r.issues.numErrors, r.issues.numWarnings, ...r.issues.messages.filter(m => m.severity < 2).slice(0, 1).map(m => m.pointer + ': ' + m.message)))" "$1" 2>&1
}

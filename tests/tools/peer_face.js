// A face-mesh network from npm (@vladmandic/human) on a film: FILM WIDTH HEIGHT PACKAGES OUT.json.
// Of each frame the person's left eye, by that network's points: where the iris lies between the corners of its opening (-0.5 to 0.5, towards the picture's right), and how open it
// is over its width; how the head is turned aside and nods, degrees, with the signs of gaze.csv. (That package mirrors the right iris of the eye it crops mirrored: it is left out.)
const [film, width, height, packages, out] = process.argv.slice(2);
const fs = require('fs'), http = require('http'), { spawnSync } = require('child_process');
const models = packages + '/@vladmandic/human/models/';
const loaded = require(packages + '/@vladmandic/human/dist/human.node-wasm.js');
const OUTER = 263, INNER = 362, UPPER = 386, LOWER = 374, IRISES = [468, 473];
const W = +width, H = +height;

function of(face) {
	if (!face || !face.meshRaw || face.meshRaw.length < 478) return null;
	const at = (i) => [face.meshRaw[i][0] * W, face.meshRaw[i][1] * H];
	const [a, b] = [at(OUTER), at(INNER)].sort((p, q) => p[0] - q[0]);
	const middle = [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2], far = (p) => Math.hypot(p[0] - middle[0], p[1] - middle[1]);
	const iris = IRISES.map(at).sort((p, q) => far(p) - far(q))[0];
	const wide = [b[0] - a[0], b[1] - a[1]], long = wide[0] ** 2 + wide[1] ** 2;
	const up = at(UPPER), down = at(LOWER), turn = face.rotation.angle;
	return { iris: ((iris[0] - a[0]) * wide[0] + (iris[1] - a[1]) * wide[1]) / long - 0.5, open: Math.hypot(up[0] - down[0], up[1] - down[1]) / Math.sqrt(long),
		aside: -turn.yaw * 180 / Math.PI, up: -turn.pitch * 180 / Math.PI };
}

const server = http.createServer((request, answer) => {
	const file = models + require('path').basename(request.url);
	fs.existsSync(file) ? answer.end(fs.readFileSync(file)) : answer.writeHead(404).end();
});
server.listen(0, '127.0.0.1', async () => {
	const off = { enabled: false };
	const human = new (loaded.Human || loaded.default)({ backend: 'wasm', wasmPath: packages + '/@tensorflow/tfjs-backend-wasm/dist/', debug: false, filter: off,
		modelBasePath: `http://127.0.0.1:${server.address().port}/`, cacheSensitivity: 0, skipAllowed: false, body: off, hand: off, object: off, gesture: off, segmentation: off,
		face: { enabled: true, detector: { rotation: true, maxDetected: 1, skipFrames: 0, skipTime: 0, minConfidence: 0.2 }, mesh: { enabled: true }, iris: { enabled: true },
			description: off, emotion: off, attention: off, antispoof: off, liveness: off } });
	await human.load();
	const raw = spawnSync('ffmpeg', ['-v', 'error', '-i', film, '-vf', `scale=${W}:${H}`, '-f', 'rawvideo', '-pix_fmt', 'rgb24', '-'], { maxBuffer: 4e9 }).stdout;
	const rows = [];
	for (let at = 0; at + W * H * 3 <= raw.length; at += W * H * 3) {
		const picture = human.tf.tensor(raw.subarray(at, at + W * H * 3), [1, H, W, 3], 'float32');
		const found = await human.detect(picture);
		picture.dispose();
		rows.push(of(found.face[0]));
	}
	fs.writeFileSync(out, JSON.stringify(rows));
	process.exit(0);
});

// One line of a film: what track made of it against a face-mesh network's. FILM PEER.json FOLDER (work/skin). Goal: correlation of the left eye's horizontal gaze in the picture with
// where that network has its iris, 0.8, where it moves by a twentieth of the opening's width. Besides: how the head is turned, less what differs in all frames; how often that eye
// blinks fully, and how often it shuts there.
const [name, peer, folder] = process.argv.slice(2);
const fs = require('fs');
const theirs = JSON.parse(fs.readFileSync(peer));
const [head, ...lines] = fs.readFileSync(folder + '/gaze.csv', 'utf8').trim().split('\n').map((line) => line.split(','));
const column = (what) => lines.map((line) => line[head.indexOf(what)]).map((x) => x === '' || x === undefined ? NaN : +x);

function pairs(x, y) {
	return x.map((v, i) => [v, y[i]]).filter(([a, b]) => Number.isFinite(a) && Number.isFinite(b));
}
function correlation(p) {
	const n = p.length, mean = [0, 1].map((k) => p.reduce((s, v) => s + v[k], 0) / n);
	const [xx, xy, yy] = [[0, 0], [0, 1], [1, 1]].map(([a, b]) => p.reduce((s, v) => s + (v[a] - mean[a]) * (v[b] - mean[b]), 0));
	return n > 20 ? xy / Math.sqrt(xx * yy) : NaN;
}
const median = (x) => x.length ? [...x].sort((a, b) => a - b)[Math.floor(x.length / 2)] : NaN;
const spread = (p, k) => Math.sqrt(p.reduce((s, v) => s + v[k] ** 2, 0) / p.length - (p.reduce((s, v) => s + v[k], 0) / p.length) ** 2);
// Shut: below 0.45 of what it is as a rule, for two frames; open again above 0.65.
function shut(open) {
	const usual = median(open.filter(Number.isFinite));
	let down = 0, count = 0, counted = false;
	for (const x of open) {
		down = x < 0.45 * usual ? down + 1 : x > 0.65 * usual ? 0 : down;
		if (!down) counted = false;
		if (down === 1 && !counted) { count++; counted = true; }
	}
	return count;
}
const get = (what) => theirs.map((row) => row ? row[what] : NaN);
const gaze = pairs(column('sight_left_h_deg'), get('iris')), aside = pairs(column('head_h_deg'), get('aside')), up = pairs(column('head_v_deg'), get('up'));
const off = (p) => median(p.map(([a, b]) => Math.abs(a - b - median(p.map(([c, d]) => c - d)))));
const blinks = JSON.parse(fs.readFileSync(folder + '/track.json')).blinks.filter((b) => b.eye === 'left' && b.amplitude > 0.6).length;
console.log([name.padEnd(22), String(lines.length).padStart(6), correlation(gaze).toFixed(2).padStart(8), (100 * spread(gaze, 1)).toFixed(0).padStart(7),
	median(column('sigma_g1_deg').filter(Number.isFinite)).toFixed(1).padStart(8), off(aside).toFixed(1).padStart(9), correlation(aside).toFixed(2).padStart(6),
	off(up).toFixed(1).padStart(7), correlation(up).toFixed(2).padStart(6), String(blinks).padStart(7), String(shut(get('open'))).padStart(5)].join(' '));
process.exit(correlation(gaze) >= 0.8 || !(spread(gaze, 1) >= 0.05) ? 0 : 1);

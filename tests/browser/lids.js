"use strict";
/* The lids of a driven character on the interactive page against those of pictures: VIEWER.html RIG.npz TOOLS. One line a pose: how far the vertices of its lids
 * are from where pictures have them, at worst and in the root mean square, mm; without what makes margins arcs, the same. */
const path = require("path");
const { execFileSync } = require("child_process");
const { pathToFileURL } = require("url");
const { Browser } = require("./browser.js");
const [, , page, rig, tools] = process.argv;

// Of the grid of poses from which the page knows it, and between those.
const grid = [[0, 0, 1], [16, 0, 1], [-16, -20, 1], [0, -20, 0.5], [0, 22, 1], [0, 0, 0.5], [16, 22, 0]];
const between = [[10, 5, 1], [-20, -15, 1], [20, 15, 1], [0, -25, 1], [0, -8, 0.75], [8, 0, 0.75], [-8, -11, 0.5], [0, 0, 0.25]];

(async () => {
	const b = await Browser.start(["--allow-file-access-from-files"]);
	try {
		await b.open(pathToFileURL(page).href);
		await b.until("window.eyewright && eyewright.face && eyewright.face.poser", 120);
		const floats = bytes => new Float32Array(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length));
		const many = await b.value("data.face.expressions.length"), full = [...Array(many).keys()].map(k => [0, 0, 1, ...Array.from({ length: many }, (_, i) => +(i === k))]), poses = [...grid, ...between, ...full];
		const input = poses.map(([h, v, o, ...strengths]) => `${h} ${v} ${h} ${v} ${o} ${o} ${strengths.join(" ")}`).join("\n") + "\n";
		const want = floats(execFileSync(path.join(tools, "posed"), [rig, "settled"], { input, maxBuffer: 1 << 30 })), n = want.length / poses.length / 6;
		const rows = JSON.parse(await b.value("JSON.stringify(Array.from(new Int32Array(data.face.rig.rows.buffer)))"));
		const of = JSON.parse(await b.value(`(() => { const t = new Float32Array(data.face.rig.terms.buffer), out = [];
			for (let i = 0; i < eyewright.face.poser.posed; i++) if (t[28 * i + 11] > 0) out.push(i);
			return JSON.stringify(out); })()`));
		for (let k = 0; k < poses.length; k++) {
			const said = [];
			for (const on of [true, false]) {
				const [h, v, o, ...strengths] = poses[k], got = floats(Buffer.from(await b.value(`(() => {
					const f = eyewright.face.poser, step = f.maps.settle_step;
					f.key = "";
					if (!${on})
						f.maps.settle_step = 0;
					f.pose([[${h}, ${v}], [${h}, ${v}]], [${o}, ${o}], ${JSON.stringify(strengths)});
					f.maps.settle_step = step;
					const bytes = new Uint8Array(f.read(f.at).buffer, 0, 16 * f.base);
					let text = ""; for (let i = 0; i < bytes.length; i += 32768) text += String.fromCharCode(...bytes.subarray(i, i + 32768));
					return btoa(text); })()`), "base64"));
				let worst = 0, sum = 0;
				for (const i of of) {
					const d = Math.hypot(...[0, 1, 2].map(c => got[4 * i + c] - want[6 * n * k + 3 * rows[i] + c]));
					worst = Math.max(worst, d);
					sum += d * d;
				}
				said.push(worst.toFixed(3), Math.sqrt(sum / of.length).toFixed(3));
			}
			console.log(`${k < grid.length ? "grid" : k < poses.length - many ? "between" : "expression"} ${poses[k].join(" ")} off ${said[0]} rms ${said[1]} as learnt ${said[2]} rms ${said[3]} of ${of.length}`);
		}
		for (const problem of b.problems)
			if (!/GPU stall|ReadPixels/.test(problem))
				console.log(`fail the page says: ${problem}`);
	} catch (e) {
		console.log(`fail ${e.message} ${b.problems.join("; ")}`);
	} finally {
		await b.end();
	}
})();

"use strict";
/* Times of the interactive page in a headless Chromium. Called by tests/bench/bench_viewer.c: node bench.js KIND PAGE QUICK
 * Prints lines of "opened SECONDS", "driver NAME", "frame PRESET SECONDS...", "count PRESET OPERATIONS READS SECONDS GPU" (estimates
 * for GPUs of 2015), "skip WHAT SECONDS ..." and "fallback FROM TO SECONDS". */
const { pathToFileURL } = require("url");
const { Browser } = require("./browser.js");
const { picture, seconds_on, GPUS } = require("./count.js");

const [, , page, quick] = process.argv;

/* Seconds of pictures of one preset, waited for to the last pixel; eyes turned a little from one to the next. On a graphics
 * processor sixteen are waited for together: the way to it and back takes longer than a picture. */
const frames = (preset, n) => `(() => { const p = eyewright, gl = p.graphics.gl, out = [], one = new Uint8Array(4);
	const together = /SwiftShader|llvmpipe/.test(p.graphics.name) ? 1 : 16;
	for (let i = 0, k = 0; i <= ${n}; i++) {
		const t = performance.now();
		for (let j = 0; j < together; j++, k++) { p.eyes.eye = [k % 7, k % 5]; p.scene.restart(); p.draw(presets[${preset}]); }
		gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, one);
		if (i) out.push((performance.now() - t) / 1000 / together);
	}
	return out.join(" "); })()`;

/* Operations and texture reads, from the shaders' text. */
async function count(b) {
	const d = JSON.parse(await b.value(`(() => { const p = eyewright, e = p.eye; return JSON.stringify({ shaders: p.graphics.shaders, presets, face: !!p.face,
		directions: e.lights[0].lights.length, grid: e.constants.grid, coarse: e.constants.coarse, map: e.eye.map_px, search: e.eye.search }); })()`));
	const below = { eye: ["ground", "iris"], march: ["ground", "lights"], beside: ["ground", "lights"] };
	const text = (name, parts) => ["common", ...(below[name] || []), ...parts.filter(p => p in d.shaders), name].map(p => d.shaders[p]).join("\n");
	for (const p of d.presets) {
		const sum = picture(text, p, 1280, 1024, d.directions, d.grid, d.coarse, d.map, d.search, d.face);
		for (const [name, gpu] of Object.entries(GPUS))
			console.log(`count ${p.name} ${sum[0]} ${sum[1]} ${seconds_on(gpu, sum)} ${name}`);
	}
}

/* What skipping saves, least seconds: both eyes of a face open and shut, the skin standing; pictures with all rays traced, and with
 * what an earlier one found only shaded. */
const skips = n => `(() => { const p = eyewright, gl = p.graphics.gl, one = new Uint8Array(4), least = {};
	const wait = () => { p.graphics.target(null, 1, 1); gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, one); };
	const timed = (name, work) => { wait(); const t = performance.now(); work(); wait(); least[name] = Math.min(least[name] || 1e9, (performance.now() - t) / 1000); };
	const eyes = (name, aperture, gaze) => {
		const calls = [];
		p.values.aperture = aperture;
		p.eyes.eye = gaze;
		p.scene.restart();
		p.face.draw_eye = (...call) => calls.push(call);
		p.draw(presets[1]);
		delete p.face.draw_eye;
		gl.enable(gl.SCISSOR_TEST);
		timed(name, () => calls.forEach(call => p.face.draw_eye(...call)));
		gl.disable(gl.SCISSOR_TEST);
		gl.disable(gl.DEPTH_TEST);
		p.values.aperture = 1;
	};
	const picture = (name, yaw) => { p.values.light_yaw = yaw; p.scene.restart(); timed(name, () => p.draw(presets[1])); };
	for (let i = 0; i <= ${n}; i++) {
		if (p.face) {
			eyes("open", 1, [i + 0.5, i]);
			eyes("shut", 0, [i + 0.5, i]);
		}
		p.scene.seen = {};
		picture("traced", 9 * i + 3);
		picture("found", 9 * i + 6);
		picture("shaded", 9 * i + 9);
		if (!i)
			for (const k in least)
				least[k] = 1e9;
	}
	return Object.entries(least).map(e => e.join(" ")).join(" "); })()`;

(async () => {
	const b = await Browser.start();
	try {
		// What a person waits for: until the first picture stands.
		await b.size(1632, 1024);  // 1280 x 1024 beside the controls
		await b.send("Emulation.setEmulatedMedia", { features: [{ name: "prefers-reduced-motion", value: "reduce" }] });
		await b.open(pathToFileURL(page).href + "#gaze=0,0");
		await b.until("window.eyewright && document.documentElement.dataset.open && eyewright.warm", 60);
		console.log(`opened ${await b.value("eyewright.first_picture / 1000")}`);
		console.log(`driver ${await b.value("eyewright.graphics.name")}`);
		console.log(`size ${await b.value("eyewright.size(1).join(' ')")}`);
		const names = JSON.parse(await b.value("JSON.stringify(presets.map(p => p.name))"));
		await b.value("eyewright.busy = true");  // the page itself draws no more
		for (let k = 0; k < names.length; k++)
			if (quick !== "1" || k === 0 || k + 1 === names.length)
				console.log(`frame ${names[k]} ${await b.value(frames(k, quick === "1" ? 1 : 3), 120000)}`);
		console.log(`skip ${await b.value(skips(quick === "1" ? 1 : 3), 120000)}`);
		await count(b);
		if (quick === "1")
			return;
		await b.value(`eyewright.preset = 0; eyewright.times = []; eyewright.automatic = true; eyewright.busy = false; eyewright.set_follow('wander');
			eyewright.eyes.still = false; eyewright.changed()`);
		await b.until("eyewright.preset + 1 === presets.length || eyewright.times.length > 20", 20).catch(() => 0);
		await b.until("eyewright.times.length > 4", 10);
		console.log(`fallback ${names[0]} ${await b.value("presets[eyewright.preset].name")} ${await b.value("eyewright.frame_ms / 1000")}`);
	} finally {
		await b.end();
	}
})().catch(e => { console.log(`failed ${e.message}`); process.exit(1); });

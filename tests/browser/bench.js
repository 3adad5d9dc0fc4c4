"use strict";
/* Times of the interactive page in a headless Chromium. Called by tests/bench/bench_viewer.c: node bench.js KIND PAGE QUICK
 * Prints lines of "opened SECONDS", "frame PRESET SECONDS..." and "fallback FROM TO SECONDS", "driver NAME". */
const { pathToFileURL } = require("url");
const { Browser } = require("./browser.js");

const [, , page, quick] = process.argv;

/* Seconds of pictures of one preset, each waited for to its last pixel; eyes turned a little from one to the next. */
const frames = (preset, n) => `(() => { const p = eyewright, gl = p.graphics.gl, out = [], one = new Uint8Array(4);
	for (let i = 0; i <= ${n}; i++) { p.eyes.eye = [i % 7, i % 5]; p.scene.restart(); const t = performance.now(); p.draw(presets[${preset}]);
		gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, one); if (i) out.push((performance.now() - t) / 1000); }
	return out.join(" "); })()`;

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
		const names = JSON.parse(await b.value("JSON.stringify(presets.map(p => p.name))")), taken = await b.value("presets[eyewright.preset].name");
		await b.value("eyewright.busy = true");  // the page itself draws no more
		for (let k = 0; k < names.length; k++)
			console.log(`frame ${names[k]} ${await b.value(frames(k, quick === "1" ? 1 : 3), 120000)}`);
		console.log(`starts ${taken}`);
		await b.value("eyewright.busy = false; eyewright.set_follow('wander'); eyewright.eyes.still = false; eyewright.changed()");
		await new Promise(r => setTimeout(r, quick === "1" ? 3000 : 8000));
		console.log(`fallback ${await b.value("presets[eyewright.preset].name")} ${await b.value("eyewright.frame_ms / 1000")}`);
	} finally {
		await b.end();
	}
})().catch(e => { console.log(`failed ${e.message}`); process.exit(1); });

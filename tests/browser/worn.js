"use strict";
/* What a character wears on the interactive page, in a headless Chromium: node worn.js PAGE
 * Prints red, green and blue (0..255) of the left third of the face's picture and of the right one, in the mean of what is not ground; or "fail WHY". */
const { pathToFileURL } = require("url");
const { Browser } = require("./browser.js");

(async () => {
	const b = await Browser.start();
	try {
		await b.size(600, 450);
		await b.send("Emulation.setEmulatedMedia", { features: [{ name: "prefers-reduced-motion", value: "reduce" }] });
		await b.open(pathToFileURL(process.argv[2]).href + "#gaze=0,0");
		await b.until("window.eyewright && eyewright.mode === 'face' && document.documentElement.dataset.settled", 120);
		console.log(await b.value(`(() => { const p = eyewright, gl = p.graphics.gl, w = gl.canvas.width, h = gl.canvas.height, px = new Uint8Array(4 * w * h);
			gl.bindFramebuffer(gl.FRAMEBUFFER, null);
			gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, px);
			const out = [];
			for (let side = 0; side < 2; side++) {
				const sum = [0, 0, 0];
				let n = 0;
				for (let y = 0; y < h; y++)
					for (let x = side ? w - (w / 3 | 0) : 0; x < (side ? w : w / 3); x++) {
						const at = 4 * (y * w + x);
						if (Math.max(px[at], px[at + 1], px[at + 2]) < 24)
							continue;
						for (let c = 0; c < 3; c++)
							sum[c] += px[at + c];
						n++;
					}
				out.push(...sum.map(s => (s / Math.max(n, 1)).toFixed(1)));
			}
			return out.join(" "); })()`));
	} catch (e) {
		console.log(`fail ${e.message} ${b.problems.join("; ")}`);
	} finally {
		await b.end();
	}
})();

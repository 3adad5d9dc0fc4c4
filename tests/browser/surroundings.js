"use strict";
/* Surroundings from files on the interactive page, in a headless Chromium: node surroundings.js PAGE
 * Prints "pass NAME" or "fail NAME: WHY" a line. The sky that is opened is linear in the direction, so that its irradiance is known:
 * over pi, of a plane with normal n, mean + 2/3 slope . n. */
const { pathToFileURL } = require("url");
const { Browser } = require("./browser.js");
const { MEAN, SLOPE, hdr, exr } = require("./sky.js");

const say = (ok, name, why) => console.log(ok ? `pass ${name}` : `fail ${name}: ${why}`);
/* Light below a film in three directions and between two of them, less what it is in closed form: the mean, and of the slope the mean over all
 * directions of 3 cos lobe(cos) over that of the lobe, cos (1 - F) (3 - cos') on the lit side. */
function below_film(wet, c, gain) {
	const F = u => { const t = Math.sqrt(1 - (1 - u * u) / 1.336 ** 2), s = (u - 1.336 * t) / (u + 1.336 * t), p = (1.336 * u - t) / (1.336 * u + t); return (s * s + p * p) / 2; };
	const mean = power => Array.from({ length: 4000 }, (_, i) => (i + 0.5) / 4000).reduce((s, u) => s + u ** power * (1 - F(u)) * (3 - Math.sqrt(1 - (1 - u * u) / 1.336 ** 2)) / 4000, 0);
	const slope = mean(2) / mean(1), w = wet.map(v => v[c]), right = n => gain * (MEAN[c] + slope * n.reduce((s, v, k) => s + v * SLOPE[c][k], 0)), r = Math.SQRT1_2;
	return [w[0] + w[3] - right([1, 0, 0]), w[1] + w[13] - right([0, 1, 0]), w[2] + w[17] - right([0, 0, 1]), r * (w[0] + w[1]) + (w[3] + w[4] + w[6] + w[9] + w[13]) / 4 - right([r, r, 0])];
}

async function give(b, name, bytes) {
	await b.value(`eyewright.open_surroundings(new File([Uint8Array.from(atob(${JSON.stringify(bytes.toString("base64"))}), c => c.charCodeAt(0))], ${JSON.stringify(name)}))`, 60000);
	return JSON.parse(await b.value(`JSON.stringify({ said: document.getElementById("busy").textContent, light: eyewright.light, lights: eyewright.eye.lights.map(l => l.name),
		own: (l => l && { quadric: l.quadric, wet: l.wet, sum: l.lights.reduce((s, v) => [0, 1, 2].map(c => s[c] + v[3 + c]), [0, 0, 0]), n: l.lights.length })(eyewright.eye.lights.find(l => l.opened)) })`));
}

(async () => {
	const b = await Browser.start();
	try {
		await b.size(800, 520);
		await b.send("Emulation.setEmulatedMedia", { features: [{ name: "prefers-reduced-motion", value: "reduce" }] });
		await b.open(pathToFileURL(process.argv[2]).href + "#gaze=0,0");
		await b.until("document.documentElement && document.documentElement.dataset.open", 60);
		const bundled = JSON.parse(await b.value("JSON.stringify(eyewright.eye.lights.map(l => l.name))"));
		say(["Studio", "Window", "Overcast sky"].every(n => bundled.includes(n)), "three surroundings are bundled", bundled.join());
		const gain = 1 / ((MEAN.reduce((s, v) => s + v) - 2 / 3 * SLOPE.reduce((s, v) => s + v[2], 0)) / 3);
		for (const [name, bytes] of [["a.hdr", hdr()], ["b.exr", exr(3)], ["c.exr", exr(0)]]) {
			const got = await give(b, name, bytes), off = got.own ? [0, 1, 2].flatMap(c => [...below_film(got.own.wet, c, gain), got.own.quadric[0][c] - gain * MEAN[c], got.own.sum[c] - 4 * gain * MEAN[c],
				...[0, 1, 2].map(k => got.own.quadric[1 + k][c] - 2 / 3 * gain * SLOPE[c][k]), ...got.own.quadric.slice(4).map(q => q[c])]) : [Infinity];
			say(got.said === "" && Math.max(...off.map(Math.abs)) < 0.01, `${name}: the light of a linear sky is known`, JSON.stringify(got));
			say(got.lights[got.light] === name[0] && got.lights.length === bundled.length + 1, `${name}: it is what the eye stands in, in place of the last file`, got.lights.join());
		}
		await b.until("document.documentElement.dataset.settled", 120);
		const whole = hdr(), bad = [["cut.hdr", whole.subarray(0, whole.length / 2), "cut off"], ["cut.exr", exr(3).subarray(0, 3000), ""], ["no.hdr", Buffer.from("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 8 +X 16\n"), "rgbe"],
			["wide.hdr", Buffer.from(whole.toString("latin1").replace("+X 128", "+X 999"), "latin1"), "twice as wide"], ["huge.hdr", Buffer.from("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 500000 +X 1000000\n"), "at most"],
			["piz.exr", exr(0, 4), "ZIP"], ["text.exr", Buffer.from("a text that is no picture"), "neither"], ["black.hdr", Buffer.concat([Buffer.from("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8 +X 16\n"), Buffer.alloc(512)]), "no light"],
			["bomb.exr", (f => { f.writeInt32LE(1 << 30, f.indexOf("dataWindow") + 11 + 6 + 4 + 8); return f; })(exr(0)), "px"]];
		for (const [name, bytes, why] of bad) {
			const got = await give(b, name, bytes);
			say(got.said.startsWith(`${name}: `) && got.said.includes(why) && got.lights[got.light] === "c", `${name} is refused in a line and changes nothing`, `${got.said} ${got.lights[got.light]}`);
		}
		say(!b.problems.length, "surroundings: no error on the console", b.problems.join("; "));
	} finally {
		await b.end();
	}
})().catch(e => { say(false, "surroundings on the page", e.message); process.exit(1); });

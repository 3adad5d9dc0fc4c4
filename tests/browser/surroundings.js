"use strict";
/* Surroundings from files on the interactive page, in a headless Chromium: node surroundings.js PAGE
 * Prints "pass NAME" or "fail NAME: WHY" a line. The sky that is opened is linear in the direction, so that its irradiance is known:
 * over pi, of a plane with normal n, mean + 2/3 slope . n. */
const zlib = require("zlib");
const { pathToFileURL } = require("url");
const { Browser } = require("./browser.js");

const say = (ok, name, why) => console.log(ok ? `pass ${name}` : `fail ${name}: ${why}`);
const W = 128, H = 64, MEAN = [2, 1.5, 1], SLOPE = [[0.8, -0.6, -0.5], [0.2, -0.5, -0.3], [-0.3, 0.1, -0.4]];  // of each colour: x right, y down, z forward

function sky(x, y) {
	const polar = (y + 0.5) / H * Math.PI, turn = ((x + 0.5) / W - 0.5) * 2 * Math.PI;
	const d = [-Math.sin(polar) * Math.sin(turn), -Math.cos(polar), -Math.sin(polar) * Math.cos(turn)];
	return MEAN.map((m, c) => m + SLOPE[c].reduce((sum, v, k) => sum + v * d[k], 0));
}

/* Radiance, each row's planes as runs of single values and of repeated ones. */
function hdr() {
	const parts = [Buffer.from(`#?RADIANCE\n# a linear sky\nFORMAT=32-bit_rle_rgbe\n\n-Y ${H} +X ${W}\n`)];
	for (let y = 0; y < H; y++) {
		const planes = [[], [], [], []], row = [2, 2, W >> 8, W & 255];
		for (let x = 0; x < W; x++) {
			const rgb = sky(x, y), e = Math.ceil(Math.log2(Math.max(...rgb) + 1e-9) + 1e-9);
			rgb.forEach((v, c) => planes[c].push(Math.min(255, Math.floor(v / Math.pow(2, e) * 256))));
			planes[3].push(e + 128);
		}
		for (const p of planes)
			for (let x = 0; x < W;) {
				let n = 1;
				while (x + n < W && n < 127 && p[x + n] === p[x])
					n++;
				row.push(...(n > 2 ? [128 + n, p[x]] : [1, p[x]]));
				x += n > 2 ? n : 1;
			}
		parts.push(Buffer.from(row));
	}
	return Buffer.concat(parts);
}

function half(v) {
	const e = Math.floor(Math.log2(v)), m = Math.round((v / Math.pow(2, e) - 1) * 1024);
	return (e + 15 << 10) + m;
}

/* OpenEXR by scan lines, channels B, G, R: half floats compressed by ZIP (3), or floats as they are (0). */
function exr(compression, method) {
	const i32 = v => { const b = Buffer.alloc(4); b.writeInt32LE(v); return b; }, z = text => Buffer.from(text + "\0"), type = compression === 3 ? 1 : 2;
	const attribute = (name, kind, value) => Buffer.concat([z(name), z(kind), i32(value.length), value]);
	const channel = name => Buffer.concat([z(name), i32(type), i32(0), i32(1), i32(1)]), box = Buffer.concat([i32(0), i32(0), i32(W - 1), i32(H - 1)]);
	const head = Buffer.concat([Buffer.from([0x76, 0x2f, 0x31, 1, 2, 0, 0, 0]), attribute("channels", "chlist", Buffer.concat([..."BGR"].map(channel).concat(Buffer.alloc(1)))),
		attribute("compression", "compression", Buffer.from([method === undefined ? compression : method])), attribute("dataWindow", "box2i", box), attribute("displayWindow", "box2i", box),
		attribute("lineOrder", "lineOrder", Buffer.alloc(1)), Buffer.alloc(1)]);
	const lines = compression === 3 ? 16 : 1, blocks = [];
	for (let top = 0; top < H; top += lines) {
		const list = [];
		for (let y = top; y < Math.min(top + lines, H); y++)
			for (const c of [2, 1, 0])
				for (let x = 0; x < W; x++) {
					const b = Buffer.alloc(type === 1 ? 2 : 4);
					type === 1 ? b.writeUInt16LE(half(sky(x, y)[c])) : b.writeFloatLE(sky(x, y)[c]);
					list.push(b);
				}
		let data = Buffer.concat(list);
		if (compression === 3) {
			const apart = Buffer.concat([data.filter((_, i) => i % 2 === 0), data.filter((_, i) => i % 2)]);
			data = zlib.deflateSync(Buffer.from(apart.map((v, i) => i ? v - apart[i - 1] + 128 + 256 : v)));
		}
		blocks.push(Buffer.concat([i32(top), i32(data.length), data]));
	}
	const table = Buffer.alloc(8 * blocks.length);
	let at = head.length + table.length;
	blocks.forEach((b, i) => { table.writeBigUInt64LE(BigInt(at), 8 * i); at += b.length; });
	return Buffer.concat([head, table, ...blocks]);
}

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

"use strict";
/* The page as a tool, in a headless Chromium: node tool.js PAGE FACE WITHOUT OUT
 * WITHOUT: a face's page that leaves out its .glb. OUT: a folder for what is kept (keep_*.conf, lines for capture.conf) and for pictures.
 * Prints "pass NAME" or "fail NAME: WHY" a line. */
const fs = require("fs");
const path = require("path");
const { pathToFileURL } = require("url");
const { Browser } = require("./browser.js");
const { hdr, exr } = require("./sky.js");

const [, , page, face, without, out] = process.argv;
const say = (ok, name, why) => console.log(ok ? `pass ${name}` : `fail ${name}: ${why}`);
const settled = "document.documentElement && document.documentElement.dataset.settled";
const press = text => `[...document.querySelectorAll("#controls button")].find(e => e.textContent === ${JSON.stringify(text)}).click()`;
const pixels = `(() => { const gl = eyewright.graphics.gl, c = gl.canvas, px = new Uint8Array(4 * c.width * c.height);
	gl.bindFramebuffer(gl.FRAMEBUFFER, null); gl.readPixels(0, 0, c.width, c.height, gl.RGBA, gl.UNSIGNED_BYTE, px); return px; })()`;
const sum = `(px => { let h = 0; for (let i = 0; i < px.length; i += 4) h = (h * 31 + px[i] * 65536 + px[i + 1] * 256 + px[i + 2]) % 4294967291; return h; })(${pixels})`;

async function open(b, file, hash) {
	await b.open("about:blank");
	await b.until("location.href === 'about:blank'", 20);
	await b.open(pathToFileURL(file).href + (hash || ""));
	await b.until("document.documentElement && document.documentElement.dataset.open", 60);
}

/* The picture of this moment, quickly drawn. */
const look = b => b.value(`(() => { const p = eyewright; p.busy = true; p.scene.restart(); p.draw(presets[presets.length - 1]); p.busy = false; return ${sum}; })()`, 60000);

/* A slider that was moved has its line, or is named as one that has none; nothing is told with an exponent. */
async function keep(b, file, mode, name) {
	for (const [end, to] of [["low", "c.lo"], ["high", "c.hi"], ["little", "c.value > c.lo ? c.lo + 1.3e-9 * (c.hi - c.lo) : c.lo + 0.011 * (c.hi - c.lo)"]]) {
		await open(b, file, `#gaze=12,-7&view=${mode}`);
		const got = JSON.parse(await b.value(`(() => {
			const p = eyewright, shown = p.controls.filter(c => (document.getElementById("s-" + c.key) || { checkVisibility: () => false }).checkVisibility());
			p.busy = true;
			for (const c of shown)
				p.set(c.key, ${to});
			const moved = shown.filter(c => p.moved(c)), kept = document.getElementById("lines").value, note = document.getElementById("not-kept").textContent;
			p.busy = false;
			return JSON.stringify({ kept, note, n: moved.length, lost: moved.filter(c => !c.pigment && !note.includes(c.label) && !(c.keep && kept.includes(c.keep(p.values[c.key], p).key + " = "))).map(c => c.key),
				rows: shown.filter(c => !c.keep && !c.pigment && !/looked at only/.test(document.getElementById("s-" + c.key).closest(".row").textContent)).map(c => c.key),
				text: document.body.innerText + [...document.querySelectorAll("[aria-valuetext], [title], [aria-label]")].map(e => ["aria-valuetext", "title", "aria-label"].map(a => e.getAttribute(a)).join(" ")).join(" ") + kept + document.getElementById("said").textContent + location.hash });
		})()`, 60000));
		const bad = got.text.match(/.{0,30}([0-9]e[+-]?[0-9]|held_by).{0,30}/g);
		say(got.n > 8 && !got.lost.length && !got.rows.length, `${name}, ${end}: each slider has its line, or is said to have none`, `${got.n}; ${got.lost}; ${got.rows}; ${got.note}`);
		say(!bad, `${name}, ${end}: plain digits everywhere`, String(bad && bad.slice(0, 3)));
		say(got.kept.includes(mode === "face" ? "render.gaze = 12 -7" : "render.three_quarter_deg = 12 -7"), `${name}, ${end}: a typed gaze is kept`, got.kept);
		fs.writeFileSync(path.join(out, `keep_${name}_${end}.conf`), got.kept + "\n");
	}
	await b.value("eyewright.reset()");
	say(await b.value("eyewright.keep_box.hidden"), `${name}: as fitted there is nothing to keep`, await b.value("eyewright.kept.value + eyewright.keep_note.textContent"));
}

/* What was done is undone and done again, by buttons and keys: values and pictures. */
async function steps(b) {
	await open(b, page, "#gaze=0,0");
	const values = "JSON.stringify(['pupil', 'R'].map(k => Number(eyewright.values[k].toFixed(4))))", buttons = "eyewright.undoing.map(e => e.disabled).join()", seen = [], hash = [];
	const note = async () => { await b.value("eyewright.remember()"); seen.push(await look(b)); hash.push(await b.value(values)); };
	await note();
	say(await b.value(buttons) === "true,true", "at first there is nothing to undo", await b.value(buttons));
	await b.value("eyewright.set('pupil', 3)");
	await note();
	await b.value("eyewright.set('R', 8.5)");
	await note();
	const back = [];
	for (const how of [press("Undo"), "document.getElementById('view').dispatchEvent(new KeyboardEvent('keydown', { key: 'z', ctrlKey: true, bubbles: true, cancelable: true }))"]) {
		await b.value(how);
		back.push([await b.value(values), await look(b), await b.value(buttons)]);
	}
	say(back[0][0] === hash[1] && back[1][0] === hash[0] && back[0][2] === "false,false" && back[1][2] === "true,false", "undo goes back step by step", JSON.stringify([hash, back]));
	const forth = [];
	for (const how of [press("Redo"), "document.getElementById('view').dispatchEvent(new KeyboardEvent('keydown', { key: 'z', ctrlKey: true, shiftKey: true, bubbles: true, cancelable: true }))"]) {
		await b.value(how);
		forth.push([await b.value(values), await look(b), await b.value(buttons)]);
	}
	say(forth[0][0] === hash[1] && forth[1][0] === hash[2] && forth[1][2] === "false,true", "redo goes forth again", JSON.stringify([hash, forth]));
	say(back[0][1] === seen[1] && back[1][1] === seen[0] && forth[1][1] === seen[2] && new Set(seen).size === 3, "and so do the pictures", JSON.stringify([seen, back, forth]));
	// What is done after an undo takes the place of what was undone.
	await b.value(press("Undo"));
	await b.value("eyewright.set('pupil', 2.2)");
	await b.value("eyewright.remember()");
	say(await b.value(buttons) === "false,true", "a new step forgets what was undone", await b.value(buttons));
}

/* Two settings, each as it was left. */
async function two(b) {
	await open(b, page, "#gaze=0,0");
	const first = await look(b), read = "['pupil', 'stroma_eu'].map(k => eyewright.values[k].toFixed(3)).join()", begin = await b.value(read);
	await b.value(press("Setting B"));
	await b.value("eyewright.set('pupil', 3.5); eyewright.set('stroma_eu', 0.2)");
	const second = await look(b), set = await b.value(read);
	await b.value(press("Setting A"));
	const a = [await b.value(read), await look(b), await b.value("eyewright.slot_buttons.map(e => e.getAttribute('aria-pressed')).join()")];
	await b.value(press("Setting B"));
	const c = [await b.value(read), await look(b)];
	say(a[0] === begin && a[1] === first && a[2] === "true,false" && c[0] === set && c[1] === second && first !== second, "settings A and B change places, each as it was left", JSON.stringify([begin, a, set, c]));
}

async function presets_of(b) {
	await open(b, page, "#gaze=0,0");
	const first = await look(b), names = JSON.parse(await b.value("JSON.stringify(Tools.PRESETS.map(p => p[0]))")), same = [];
	for (const name of names.slice(1)) {
		await b.value(press(name));
		const wanted = await b.value(`Object.entries(Object.fromEntries(Tools.PRESETS)[${JSON.stringify(name)}]).every(([k, v]) => Math.abs(eyewright.values[k] - v) < 1e-9)`), lids = await b.value(`Object.keys(Object.fromEntries(Tools.PRESETS)[${JSON.stringify(name)}]).every(k => k === "aperture")`);
		if (!wanted || !lids && await look(b) === first)
			same.push(name);
		await b.value(press(names[0]));
		if (await look(b) !== first)
			same.push(`after ${name}`);
	}
	say(names.length > 3 && !same.length, "each preset sets what it says and is seen; the first brings back what was fitted", same.join());
}

/* A stop is twice the light; highlights bend as on film, middle grey stays. */
async function exposed(b) {
	await open(b, page, "#gaze=0,0");
	const off = JSON.parse(await b.value(`(() => {
		const p = eyewright, at = (exposure, tone) => { p.values.exposure = exposure; p.values.tone = tone; p.scene.restart(); p.draw(presets[presets.length - 1]); return ${pixels}; };
		p.busy = true;
		const [plain, up, down, film, bright, burnt] = [at(0, 0), at(1, 0), at(-1, 0), at(0, 1), at(2.5, 1), at(2.5, 0)], { width, height } = p.graphics.gl.canvas;
		at(0, 0);
		p.busy = false;
		const line = v => v <= 10.31 ? v / 3294.6 : Math.pow((v / 255 + 0.055) / 1.055, 2.4), code = c => 255 * (c <= 0.0031308 ? 12.92 * c : 1.055 * Math.pow(c, 1 / 2.4) - 0.055);
		const curve = c => Math.min(1, 0.8 * c * (2.51 * 0.8 * c + 0.03) / (0.8 * c * (2.43 * 0.8 * c + 0.59) + 0.14));
		const worst = { up: 0, down: 0, film: 0 }, share = { bright: 0, burnt: 0 };
		let n = 0;
		// Inside the eye, where nothing of the background shows.
		for (let y = Math.round(0.35 * height); y < 0.65 * height; y++)
			for (let x = Math.round(width / 2 - 0.15 * height); x < width / 2 + 0.15 * height; x++)
				for (let c = 0; c < 3; c++) {
					const i = 4 * (y * width + x) + c, v = line(plain[i]);
					n++;
					share.bright += bright[i] === 255;
					share.burnt += burnt[i] === 255;
					if (v > 0.05 && v < 0.45) {
						worst.up = Math.max(worst.up, Math.abs(up[i] - code(2 * v)));
						worst.down = Math.max(worst.down, Math.abs(down[i] - code(v / 2)));
						worst.film = Math.max(worst.film, Math.abs(film[i] - code(curve(v))));
					}
				}
		return JSON.stringify({ worst, bright: share.bright / n, burnt: share.burnt / n });
	})()`, 120000));
	// Steps of 8 bits, half a step of noise before and after: a step is at most 1.4 steps wide at twice the light, 1.6 under the curve's steepest place.
	say(off.worst.up < 2.6 && off.worst.down < 2 && off.worst.film < 3, "a stop is twice or half the light, and the film's curve is what it says", JSON.stringify(off));
	say(off.burnt > 0.2 && off.bright < 0.8 * off.burnt, "as on film, highlights that would burn out do not", JSON.stringify(off));
}

/* Light that glows is moved, not made: the picture's mean stays, and the pupil's middle gets what octaves of Gaussians bring there (lib/draw/bloom.h: level k of its
 * pyramid is blurred by a binomial at every level down and up, of the variance (4^k - 1) / 2). */
async function glows(b) {
	await open(b, page, "#gaze=0,0");
	const got = JSON.parse(await b.value(`(() => {
		const p = eyewright, was = p.values.bloom, at = bloom => { p.values.exposure = -1.5; p.values.bloom = bloom; p.scene.restart(); p.draw(presets[presets.length - 1]); return ${pixels}; };
		p.busy = true;
		const [sharp, soft] = [at(0), at(0.5)], { width, height } = p.graphics.gl.canvas, line = v => v <= 10.31 ? v / 3294.6 : Math.pow((v / 255 + 0.055) / 1.055, 2.4);
		p.values.exposure = 0;
		at(was);
		p.busy = false;
		const mean = (px, half) => {
			let sum = 0, n = 0;
			for (let y = 0; y < height; y++)
				for (let x = 0; x < width; x++)
					if (!half || Math.hypot(x - width / 2, y - height / 2) < half) {
						n++;
						sum += line(px[4 * (y * width + x) + 1]);
					}
			return sum / n;
		};
		const side = Math.min(width, height), octaves = [];
		for (let k = 1; side >> k >= 8; k++)
			if (side >> k <= 256) {
				let sum = 0, weight = 0;
				for (let y = 0; y < height; y++)
					for (let x = 0; x < width; x++) {
						const w = Math.exp(-(((x + 0.5 - width / 2) ** 2 + (y + 0.5 - height / 2) ** 2) / (4 ** k - 1)));
						sum += w * line(sharp[4 * (y * width + x) + 1]);
						weight += w;
					}
				octaves.push(sum / weight);
			}
		const glow = octaves.reduce((a, v) => a + v, 0) / octaves.length, pupil = [mean(sharp, height / 100), mean(soft, height / 100)];
		return JSON.stringify({ all: [mean(sharp), mean(soft)], pupil, want: 0.5 * pupil[0] + 0.5 * glow });
	})()`, 120000));
	say(Math.abs(got.all[1] / got.all[0] - 1) < 0.02, "a glow keeps the light that there is", JSON.stringify(got));
	say(Math.abs(got.pupil[1] - got.want) < 0.1 * (got.want - got.pupil[0] / 2) + 2e-4, "and brings as much into the pupil as its octaves say", JSON.stringify(got));
}

/* What a button saves. */
const saved = (b, button, seconds) => b.value(`(async () => {
	const kept = new Promise((done, late) => { Tools.download = (blob, name) => done([blob, name]); setTimeout(() => late(new Error("nothing saved")), ${1000 * seconds}); });
	${press(button)};
	const [blob, name] = await kept, bytes = new Uint8Array(await blob.arrayBuffer());
	let text = "";
	for (let i = 0; i < bytes.length; i += 32768)
		text += String.fromCharCode(...bytes.subarray(i, i + 32768));
	return JSON.stringify([name, blob.type, btoa(text)]);
})()`, 1000 * seconds + 10000).then(JSON.parse).then(([name, type, base64]) => ({ name, type, base64, bytes: Buffer.from(base64, "base64") }));

/* As fine as a picture at rest, 3840 px wide at most, and of what is seen. */
async function picture(b) {
	await b.size(2300, 230);  // a low, broad window: few rows at 3840 px
	await open(b, page, "#gaze=0,0&field=9");
	await b.until(settled, 180);
	const small = await saved(b, "Save picture", 120), large = await saved(b, "Save picture, 4k", 240);
	const size = p => p.bytes.readUInt32BE(0) === 0x89504e47 ? [p.bytes.readUInt32BE(16), p.bytes.readUInt32BE(20)] : [0, 0], [s, l] = [size(small), size(large)];
	fs.writeFileSync(path.join(out, "tool_picture.png"), small.bytes);
	fs.writeFileSync(path.join(out, "tool_picture_4k.png"), large.bytes);
	say(small.type === "image/png" && s[0] > 500 && s[1] > 200, "a picture is saved as it stands on the screen", s.join());
	say(Math.max(...l) === 3840 && Math.abs(l[0] / l[1] - s[0] / s[1]) < 0.01, "and 3840 px wide", l.join());
	const off = await b.value(`(async () => {
		const at = async base64 => { const p = new Image(); p.src = "data:image/png;base64," + base64; await p.decode(); const c = element("canvas", { width: 200, height: 60 }), d = c.getContext("2d"); d.imageSmoothingQuality = "high"; d.drawImage(p, 0, 0, 200, 60); return d.getImageData(0, 0, 200, 60).data; };
		const [a, c] = [await at("${small.base64}"), await at("${large.base64}")];
		let sum = 0, low = 255, high = 0;
		a.forEach((v, i) => { sum += Math.abs(v - c[i]); if (i % 4 === 1) { low = Math.min(low, c[i]); high = Math.max(high, c[i]); } });
		return [sum / a.length, high - low].join();
	})()`, 60000);
	say(Number(off.split(",")[0]) < 3 && Number(off.split(",")[1]) > 100, "both of the same view", off);
	await b.size(800, 500);
}

/* Elements of a WebM's clusters: how many frames it has. */
function frames(bytes) {
	let n = 0;
	for (let at = bytes.indexOf(Buffer.from([0x1f, 0x43, 0xb6, 0x75])); at >= 0; at = bytes.indexOf(Buffer.from([0x1f, 0x43, 0xb6, 0x75]), at)) {
		at += 4;
		at += Math.clz32(bytes[at]) - 23;  // over its length, told or not
		while (at < bytes.length && [0xe7, 0xa3, 0xa0, 0xab, 0xec].includes(bytes[at])) {
			n += bytes[at] === 0xa3 || bytes[at] === 0xa0;
			const width = Math.clz32(bytes[at + 1]) - 23;
			let size = bytes[at + 1] & (1 << 8 - width) - 1;
			for (let i = 1; i < width; i++)
				size = 256 * size + bytes[at + 1 + i];
			at += 1 + width + size;
		}
	}
	return n;
}

async function film(b) {
	await b.size(700, 240);
	await open(b, page, "#gaze=0,0");
	await b.until(settled, 180);
	const f = await saved(b, "Save turntable", 120), n = frames(f.bytes);
	say(f.name === "eyewright.webm" && /^video\/webm/.test(f.type) && f.bytes.readUInt32BE(0) === 0x1a45dfa3 && n >= 10, "a turntable is saved as a film", `${f.name} ${f.type} ${f.bytes.length} bytes, ${n} frames`);
	say(await b.value("eyewright.orbit.join()") === "0,0", "and the eye stands again as it stood", await b.value("eyewright.orbit.join()"));
	await b.size(800, 500);
}

async function whole_screen(b) {
	await open(b, page, "#gaze=0,0");
	const box = JSON.parse(await b.value(`(e => { e.scrollIntoView({ block: "center" }); return JSON.stringify(e.getBoundingClientRect()); })([...document.querySelectorAll("#controls button")].find(e => e.textContent === "Full screen"))`));
	for (const type of ["mousePressed", "mouseReleased"])
		await b.mouse(type, box.x + box.width / 2, box.y + box.height / 2);
	await b.until("document.fullscreenElement", 10).catch(() => 0);
	const share = "Math.round(document.getElementById('view').getBoundingClientRect().width / innerWidth * 100)";
	await b.until(`${share} === 100`, 60).catch(() => 0);  // the next picture is as large
	const shown = await b.value(`document.fullscreenElement && document.fullscreenElement.id + ${share}`);
	say(shown === "stage100", "the picture takes the whole screen", shown);
	await b.value("eyewright.full_screen()");
	await b.until("!document.fullscreenElement", 10).catch(() => 0);
	say(await b.value("!document.fullscreenElement"), "and gives it back", "");
}

/* Files dropped on the picture by a hand. */
async function dropped(b) {
	await open(b, page, "#gaze=0,0");
	const first = await look(b), box = JSON.parse(await b.value("JSON.stringify(document.getElementById('view').getBoundingClientRect())")), x = box.x + box.width / 2, y = box.y + box.height / 2;
	for (const [name, bytes] of [["sky.hdr", hdr()], ["sky-2.exr", exr(3)]]) {
		const file = path.resolve(out, name), data = { items: [], files: [file], dragOperationsMask: 1 };
		fs.writeFileSync(file, bytes);
		for (const type of ["dragEnter", "dragOver", "drop"])
			await b.send("Input.dispatchDragEvent", { type, x, y, data });
		await b.until(`eyewright.eye.lights.some(l => l.file === "${name}") && eyewright.eye.lights[eyewright.light].file === "${name}"`, 60).catch(() => 0);
		const got = await b.value(`[(eyewright.eye.lights[eyewright.light] || {}).file, document.getElementById("busy").textContent].join()`);
		say(got === `${name},` && await look(b) !== first, `${name} dropped on the picture lights it`, got);
		const kept = await b.value("document.getElementById('lines').value + '|' + document.getElementById('not-kept').textContent");
		say(name.endsWith("exr") ? kept.includes("render.environment = sky-2.exr") && /Copy sky-2\.exr/.test(kept) : !kept.includes("render.environment =") && /OpenEXR only/.test(kept), `${name}: what keeps it is said`, kept);
		fs.writeFileSync(path.join(out, "keep_sky.conf"), kept.split("|")[0].split("\n").filter(l => l.startsWith("render.environment")).join("\n") + "\n");
	}
}

/* A driver that is lost and comes back: the page opens again as it was. */
async function lost(b, file, name, hash) {
	await open(b, file, hash);
	await b.until(settled, 180);
	const before = await look(b), at = await b.value("location.hash");
	await b.value("window.before = 1; window.lose = eyewright.graphics.gl.getExtension('WEBGL_lose_context'); lose.loseContext()");
	await b.until("eyewright.graphics.gl.isContextLost()", 10);
	await new Promise(r => setTimeout(r, 500));
	say(await b.value("document.getElementById('stills').hidden"), `${name}: for a lost driver is waited`, "it gives up");
	await b.value("lose.restoreContext()");
	// While a page goes and comes an expression may find neither: it is asked again.
	for (const end = Date.now() + 120000; Date.now() < end; await new Promise(r => setTimeout(r, 100)))
		if (await b.value("!!(window.before === undefined && document.documentElement && document.documentElement.dataset.open)").catch(() => false))
			break;
	const after = await b.value("window.before === undefined && window.eyewright ? location.hash : 'not opened again'");
	say(after === at && await look(b) === before, `${name}: a driver that was lost and comes back shows the same picture again`, `${at} ${after}`);
}

async function left_out(b) {
	await open(b, without, "#gaze=0,0");
	const button = await b.value("[...document.querySelectorAll('#controls button')].some(e => /glb/.test(e.textContent))"), note = await b.value("(document.getElementById('no-glb') || {}).textContent");
	say(!button && /work\/render\/made\.glb has [0-9.]+ MiB, .* 0\.5 MiB at most \(render\.page_glb_mib\)/.test(note), "a .glb too large for the page is not left out in silence", `${button} ${note}`);
	await open(b, face, "#gaze=0,0");
	say(await b.value("!document.getElementById('no-glb') && [...document.querySelectorAll('#controls button')].some(e => e.textContent === 'Save .glb as set')"), "one that is carried is offered", "");
}

(async () => {
	const b = await Browser.start();
	try {
		await b.size(800, 500);
		await b.send("Emulation.setEmulatedMedia", { features: [{ name: "prefers-reduced-motion", value: "reduce" }] });
		await keep(b, page, "eye", "eye");
		await keep(b, face, "face", "face");
		await steps(b);
		await two(b);
		await presets_of(b);
		await exposed(b);
		await glows(b);
		await whole_screen(b);
		await dropped(b);
		await left_out(b);
		await lost(b, page, "the eye", "#gaze=10,5&pupil=3&orbit=20,0&tone=0.5");
		await lost(b, face, "the face", "#gaze=5,0&aperture=0.8");
		b.problems = b.problems.filter(p => !/CONTEXT_LOST|context lost/i.test(p));  // the browser's own word on what was asked of it
		await picture(b);
		await film(b);
		say(!b.problems.length, "the tool: no error on the console", b.problems.slice(0, 3).join("; "));
	} finally {
		await b.end();
	}
})().catch(e => { say(false, "the page as a tool", e.message); process.exit(1); });

"use strict";
/* The interactive page in a headless Chromium. Called by tests/chain/viewer.sh: node viewer.js PAGE FRONT.png TURNED.png SHOTS
 * FACE RIG.npz TOOLS
 * Prints "pass NAME" or "fail NAME: WHY" a line. */
const fs = require("fs");
const path = require("path");
const { pathToFileURL } = require("url");
const { execFileSync } = require("child_process");
const { Browser } = require("./browser.js");

const [, , page, front, turned, shots, face, rig, tools] = process.argv;
let url = pathToFileURL(page).href;
const say = (ok, name, why) => console.log(ok ? `pass ${name}` : `fail ${name}: ${why}`);
const opened = "document.getElementById('stills') && (!document.getElementById('stills').hidden || document.documentElement.dataset.open)";
const settled = "document.documentElement.dataset.settled";
/* The eye's middle on the page, and what the page shows, as one number. */
const sum = `(() => { const p = eyewright, gl = p.graphics.gl, c = gl.canvas, px = new Uint8Array(4 * c.width * c.height);
	gl.bindFramebuffer(gl.FRAMEBUFFER, null); gl.readPixels(0, 0, c.width, c.height, gl.RGBA, gl.UNSIGNED_BYTE, px);
	let h = 0; for (let i = 0; i < px.length; i += 4) h = (h * 31 + px[i] * 65536 + px[i + 1] * 256 + px[i + 2]) % 4294967291; return h; })()`;

async function open(b, hash) {
	await b.open("about:blank");
	await b.open(url + (hash || ""));
	await b.until(opened, 60);
	const stills = await b.value("window.eyewright && document.getElementById('stills').hidden ? '' : document.getElementById('why').textContent");
	if (stills && !b.bare)
		throw new Error(stills);
}

/* The page's own picture of a view against one of the C renderer's, both as shown: mean relative difference of luminance
 * inside the iris and in the sclera, silhouettes left out, and the share of pixels that differ by more than 5 %. */
async function compare(b, png, yaw, pitch) {
	return JSON.parse(await b.value(`(async () => {
		const p = eyewright, s = p.scene, gl = p.graphics.gl, picture = new Image();
		picture.src = "data:image/png;base64,${fs.readFileSync(png).toString("base64")}";
		await picture.decode();
		const n = picture.width, canvas = document.createElement("canvas"), flat = canvas.getContext("2d");
		canvas.width = canvas.height = gl.canvas.width = gl.canvas.height = n;
		flat.drawImage(picture, 0, 0);
		const want = flat.getImageData(0, 0, n, n).data, got = new Uint8Array(4 * n * n);
		s.resize(n, n);
		s.restart();
		const view = { yaw: ${yaw} * Math.PI / 180, pitch: ${pitch} * Math.PI / 180, orbit: [0, 0], pan: [0, 0], field: 27, closure: 0 };
		for (let i = 0; i < 4; i++)
			s.add({ ...p.state(), aperture: null }, view, presets[0], [(i % 2) / 2 - 0.25, (i >> 1) / 2 - 0.25]);
		s.show(n, n, p.eye.eye.exposure, true, 0, data.bloom);
		gl.readPixels(0, 0, n, n, gl.RGBA, gl.UNSIGNED_BYTE, got);
		p.changed();
		const line = v => v <= 10.31 ? v / 3294.6 : Math.pow((v / 255 + 0.055) / 1.055, 2.4);
		const lum = (px, i) => 0.2126 * line(px[i]) + 0.7152 * line(px[i + 1]) + 0.0722 * line(px[i + 2]);
		const radius = n * p.eye.eye.limbus[0] / 27, yy = ${yaw} * Math.PI / 180, pp = ${pitch} * Math.PI / 180;
		const cx = n / 2 + n / 27 * 8.5 * Math.sin(yy), cy = n / 2 - n / 27 * 8.5 * Math.sin(pp) * Math.cos(yy);
		const out = { iris: [0, 0, 0, 0], white: [0, 0, 0, 0] };
		for (let y = 0; y < n; y++)
			for (let x = 0; x < n; x++) {
				const off = Math.hypot(x - n / 2, y - n / 2) / (n / 27);
				if (off > 11.5)
					continue;
				const a = lum(want, 4 * (y * n + x)), c = lum(got, 4 * ((n - 1 - y) * n + x));
				const part = Math.hypot((x - cx) / Math.cos(yy), (y - cy) / Math.cos(pp)) < 0.95 * radius ? out.iris : out.white;
				part[0] += Math.abs(c - a);
				part[1] += a;
				part[2] += Math.abs(c - a) > 0.05 * a + 0.01;
				part[3]++;
			}
		const of = v => ({ mean: v[0] / v[1], off: v[2] / v[3] });
		return JSON.stringify({ iris: of(out.iris), white: of(out.white) });
	})()`, 120000));
}

async function agreement(b) {
	// 8 bits a channel of maps and pictures, half floats, and light that C has linear over tiles of eight texels: 0.58 % on average
	// in the iris straight on, 0.66 % from the side; 0.23 and 0.32 % in the white.
	for (const [name, png, yaw, pitch] of [["front", front, 0, 0], ["three-quarter", turned, 38, -10]]) {
		const d = await compare(b, png, yaw, pitch), text = JSON.stringify(d);
		console.log(`# ${name}: ${text}`);
		say(d.iris.mean < 0.01 && d.iris.off < 0.005, `${name}: the iris agrees with the C renderer's`, text);
		say(d.white.mean < 0.005 && d.white.off < 0.005, `${name}: the white agrees with the C renderer's`, text);
	}
	const worst = await b.value(`(() => { const t = eyewright.eye.tissue, o = tissue.optics(t, t.fitted); let worst = 0;
		t.optics.forEach((v, k) => [o.extinction[0][k], o.source[0][k], o.extinction[1][k], o.source[1][k]].forEach((w, i) => {
			worst = Math.max(worst, Math.abs(w / v[i] - 1)); })); return worst; })()`);
	say(worst < 1e-6, "tissue: all orders of scattering as in C", `differs by ${worst}`);
}

/* Without motion: eyes that do not drift show the same picture twice. */
async function calm(b, on) {
	await b.send("Emulation.setEmulatedMedia", { features: [{ name: "prefers-reduced-motion", value: on ? "reduce" : "no-preference" }] });
}

async function hands(b) {
	await calm(b, true);
	await open(b, "#gaze=0,0");
	await b.until(settled, 180);
	await b.screenshot(path.join(shots, "opened.png"));
	const first = await b.value(sum), box = JSON.parse(await b.value("JSON.stringify(document.getElementById('view').getBoundingClientRect())"));
	const x = box.x + box.width / 2, y = box.y + box.height / 2;
	await b.mouse("mousePressed", x, y, true);
	for (let i = 1; i <= 6; i++)
		await b.mouse("mouseMoved", x + 15 * i, y + 4 * i, true);
	await b.mouse("mouseReleased", x + 90, y + 24);
	await b.until("location.hash.includes('orbit=')", 60);
	await b.until(settled, 180);
	say(await b.value(sum) !== first, "a drag turns the view", "the picture has not changed");
	await b.value("eyewright.reset()");
	await b.value("document.getElementById('gaze-0').value = 0; document.getElementById('gaze-0').dispatchEvent(new Event('input'))");
	await b.until(settled, 180);
	say(await b.value(sum) === first, "reset brings the same picture back", "it differs");

	await b.value("document.getElementById('s-stroma_eu').focus()");
	for (let i = 0; i < 12; i++)
		await b.key("ArrowRight");
	await b.until(settled, 180);
	await b.screenshot(path.join(shots, "slider.png"));
	say(await b.value(sum) !== first, "a pigment slider moved by keys changes the iris", "the picture has not changed");
	const lines = await b.value("document.getElementById('lines').value");
	say(/^pigment\.prior_stroma_melanin = [0-9.]+ 0\.01\npigment\.prior_stroma_ratio = [0-9.]+ 0\.005$/.test(lines), "the value is offered as lines for capture.conf", lines);
	fs.writeFileSync(path.join(shots, "lines.conf"), lines + "\n");
	const hash = await b.value("location.hash"), value = await b.value("eyewright.values.stroma_eu");
	await open(b, hash);
	say(Math.abs(await b.value("eyewright.values.stroma_eu") / value - 1) < 1e-4, "the address restores the view", hash);
}

/* What need not be done is not: pictures with only the light changed trace no ray, shade what the others traced, and show what
 * tracing all again shows; what must be done is counted by the page itself. */
async function skips(b) {
	await calm(b, true);
	await open(b, "#gaze=0,0");
	const counts = JSON.parse(await b.value(`(() => {
		const p = eyewright, g = p.graphics, out = {};
		p.busy = true;
		const look = () => { p.scene.restart(); p.draw(presets[1]); return ${sum}; }, of = change => { g.counts = {}; change(); const shown = look(); return { shown, ...g.counts }; };
		look();
		out.found = of(() => { p.values.light_yaw = 20; });
		out.moved = of(() => { p.values.light_yaw = 40; });
		out.strength = of(() => { p.values.light_gain = 0.5; });
		p.scene.seen = {};
		out.again = of(() => {});
		out.gaze = of(() => { p.eyes.eye = [10, 0]; });
		const pupil = p.values.pupil;
		out.pupil = of(() => { p.values.pupil = 0.8 * pupil; });
		p.values.pupil = pupil;
		p.values.light_yaw = 0;
		p.values.light_gain = 1;
		p.busy = false;
		return JSON.stringify(out);
	})()`, 120000));
	const { found, moved, strength, again, gaze, pupil } = counts, n = again.traced, text = JSON.stringify(counts);
	say(n > 0 && found.traced === n && found.shaded === n && !moved.traced && !moved.fielded && moved.shaded === n && moved.solved === n, "while only a light moves, no ray is traced again", text);
	say(!strength.traced && !strength.solved && strength.marched === n, "and while it only brightens, its ways stay", text);
	say(again.shown === strength.shown && gaze.traced === n && gaze.shown !== again.shown, "what is only shaded again is the same picture", text);
	say(gaze.marched === n && !gaze.horizons && pupil.horizons > 0 && pupil.marched === n, "the relief's horizons stand until the pupil changes", text);
}

/* Lids shut over an eye: nothing of it is drawn or lit; a wink hides one. */
async function shut(b) {
	const counts = JSON.parse(await b.value(`(() => {
		const p = eyewright, g = p.graphics, look = (open, gaze) => { p.values.aperture = open[0]; p.values.wink_left = open[1]; p.eyes.eye = gaze; g.counts = {}; p.scene.restart(); p.draw(presets[presets.length - 1]); return g.counts; };
		p.busy = true;
		const out = { open: look([1, 0], [0, 0]), shut: look([0, 0], [3, 2]), wink: look([1, 1], [5, 0]) };
		p.values.wink_left = 0;
		p.values.aperture = 1;
		p.eyes.eye = [0, 0];
		p.busy = false;
		return JSON.stringify(out);
	})()`, 120000)), text = JSON.stringify(counts);
	say(!counts.shut.traced && !counts.shut.solved && !counts.shut.marched && !counts.shut.fielded && counts.shut.hidden === 2, "of shut eyes nothing is drawn", text);
	say(counts.wink.hidden === 1 && counts.wink.traced === 1, "of a wink one eye is", text);
}

/* Every slider: its fitted value is marked, moving it changes the picture, its own reset brings the first back. */
async function sliders(b) {
	await calm(b, true);
	await open(b, "#gaze=0,0");
	const said = JSON.parse(await b.value(`(() => {
		const p = eyewright, gl = p.graphics.gl, of = key => document.getElementById("s-" + key), out = { all: [], stuck: [], bare: [], unsure: [], mute: [] };
		p.busy = true;
		const look = () => { p.scene.restart(); p.draw(presets[presets.length - 1]); return ${sum}; };
		const first = look();
		for (const c of p.controls.filter(c => of(c.key))) {
			const row = of(c.key).closest(".row");
			out.all.push(c.key);
			p.set(c.key, c.value - c.lo > c.hi - c.value ? c.lo : c.hi);
			const moved = look();
			row.querySelector(".reset").click();
			if (moved === first || look() !== first || p.values[c.key] !== c.value)
				out.stuck.push(c.key);
			if (!row.querySelector(".fit"))
				out.bare.push(c.key);
			if (!row.querySelector(".sigma"))
				out.unsure.push(c.key);
			if (!/^(fitted|configured|chosen|at rest|learnt from the video|from the literature): \\S/.test(row.querySelector(".fitted").textContent))
				out.mute.push(c.key);
		}
		p.busy = false;
		return JSON.stringify(out);
	})()`, 120000));
	const wanted = ["pupil", "tear", "abl_eu", "abl_pheo", "stroma_eu", "stroma_pheo", "thickness_scale", "R", "p", "n", "light_yaw", "light_pitch", "light_gain"];
	say(wanted.every(k => said.all.includes(k)), "sliders for pupil, tears, pigments, thickness, cornea and light", said.all.join());
	say(!said.stuck.length, "each slider changes the picture, and its reset brings it back", said.stuck.join());
	say(!said.bare.length, "each slider marks its fitted value", said.bare.join());
	say(["pupil", "abl_eu", "abl_pheo", "stroma_eu", "stroma_pheo", "thickness_scale", "R", "p"].every(k => !said.unsure.includes(k)), "what is uncertain shows how much", said.unsure.join());
	say(!said.mute.length, "each slider says where its value comes from", said.mute.join());
}

/* The picture's own keys, and what a screen reader is told. */
async function keys(b) {
	await calm(b, true);
	await open(b, "#gaze=0,0");
	const press = (key, shift) => b.value(`document.getElementById("view").dispatchEvent(new KeyboardEvent("keydown", { key: "${key}", shiftKey: ${!!shift}, bubbles: true, cancelable: true }))`);
	await press("ArrowRight");
	await press("ArrowUp");
	say(await b.value("eyewright.eyes.target.join()") === "2,2", "arrow keys turn the gaze", await b.value("eyewright.eyes.target.join()"));
	const told = await b.value("document.getElementById('said').textContent + document.getElementById('said').getAttribute('aria-live')");
	say(/2 degrees.*left, 2 up.*polite/.test(told), "and a screen reader is told", told);
	await press("ArrowLeft", true);
	await press("+");
	say(await b.value("eyewright.orbit[0] < 0 && eyewright.values.field < 30 && location.hash.includes('field=') && location.hash.includes('gaze=2.0,2.0')"), "with shift they turn the view, + zooms, the address keeps it", await b.value("location.hash"));
	await press("0");
	say(await b.value("eyewright.orbit.join() + eyewright.values.field + eyewright.eyes.target.join()") === "0,0300,0", "0 goes back", await b.value("eyewright.orbit.join()"));
	await b.value("document.getElementById('s-pupil').focus()");
	say(/^[0-9.]+ mm; Fitted/.test(await b.value("document.activeElement.getAttribute('aria-valuetext')")), "a slider says its value and the fitted one", await b.value("document.activeElement.getAttribute('aria-valuetext')"));
}

async function eyes(b) {
	await calm(b, false);
	await open(b);
	const box = JSON.parse(await b.value("JSON.stringify(document.getElementById('view').getBoundingClientRect())"));
	await b.mouse("mouseMoved", box.x + box.width * 0.75, box.y + box.height * 0.35);
	await b.until("eyewright.eyes.saccades > 0", 60);
	await b.until("Math.hypot(eyewright.eyes.target[0] - eyewright.eyes.eye[0], eyewright.eyes.target[1] - eyewright.eyes.eye[1]) < 1.5", 60);
	const eye = JSON.parse(await b.value("JSON.stringify(eyewright.eyes.eye)"));
	say(eye[0] > 5 && eye[1] > 2, "the eye follows the pointer by saccades", JSON.stringify(eye));
	// The main sequence as the configuration states it: 10 degrees in 21 + 22 ms, at 1.65 times the mean velocity.
	const s = JSON.parse(await b.value(`(() => { const c = eyewright.eyes.conf, s = motion.saccade(10, c); let peak = 0;
		for (let t = 0; t < s.duration; t += 1e-4) peak = Math.max(peak, 10 * (s.at(t + 1e-4) - s.at(t)) / 1e-4); return JSON.stringify({ d: s.duration, peak }); })()`));
	say(Math.abs(s.d - 0.043) < 1e-6 && Math.abs(s.peak - 16.5 / 0.043) < 8, "saccades keep to the main sequence", JSON.stringify(s));
	// A target that moves steadily is followed at the configured gain, once the delay and some time constants have passed.
	const pursued = await b.value(`(() => { const e = new motion.Eyes(eyewright.eyes.conf); e.blinking = false; let at = 0;
		for (let t = 1; t < 2.5; t += 1 / 60) { e.target = [10 * (t - 1), 0]; e.step(t); if (t < 2.1) { at = e.pursuit[0]; } }
		return at / 10; })()`);
	say(Math.abs(pursued - await b.value("eyewright.eyes.conf.pursuit_gain")) < 0.02, "pursuit follows a steady target at its gain", `${pursued}`);
	const slow = await b.value("(() => { const e = new motion.Eyes(eyewright.eyes.conf); e.target = [20, 0]; for (let t = 1; t < 4; t += 0.4) { e.step(t); } return e.eye[0]; })()");
	say(Math.abs(slow - 20) < 2, "at two pictures a second eyes still move", `${slow}`);
	const shut = await b.value("(() => { const k = motion.blink(0, 40, eyewright.eyes.conf); let m = 0; for (let t = 0; t < k.end; t += 1e-3) m = Math.max(m, k.closure(t)); return [m, k.closure(k.end), k.end].join(); })()");
	say(/^1,0,0\.2/.test(shut), "a full blink shuts the eye and opens it again", shut);
	await b.value("eyewright.set_follow('wander')");
	await b.until("document.getElementById('time').textContent.includes('ms a frame')", 60);
	console.log(`# ${await b.value("document.getElementById('time').textContent")} at ${await b.value("eyewright.graphics.gl.canvas.width + ' x ' + eyewright.graphics.gl.canvas.height")}, ${await b.value("eyewright.graphics.name")}`);
	const before = 1;
	await b.value("eyewright.preset = 1; eyewright.automatic = true; eyewright.times = []; for (let i = 0; i < 12; i++) eyewright.took(100)");
	say(await b.value("eyewright.preset") > before, "slow frames lower the quality", "they do not");
}

async function everyone(b) {
	await open(b, "#pupil=%3Cimg%20src=x%3E&orbit=NaN,1e99&field=-5&gaze=999,x&light=1e9&eye=-1&R=Infinity&n=1e30");
	const v = JSON.parse(await b.value("JSON.stringify({ ...eyewright.values, orbit: eyewright.orbit })"));
	say(v.field >= 8 && v.n <= 1.5 && v.R < 10 && v.orbit.every(Number.isFinite), "a hostile address is kept within bounds", JSON.stringify(v));
	const nameless = await b.value(`[...document.querySelectorAll("button, input, select, textarea, canvas, img:not([hidden])")].filter(e => !(e.textContent.trim() || e.getAttribute("aria-label") || e.alt || e.labels && e.labels.length)).map(e => e.outerHTML.slice(0, 80)).join()`);
	say(nameless === "", "every control has a name", nameless);
	say(await b.value("!document.querySelector('img[src=x], main b, #panel b, script[src]')"), "names are text, never elements", "an element was found");
	await b.size(390, 844, true);
	await open(b);
	await b.until(settled, 180);
	await b.screenshot(path.join(shots, "phone.png"));
	say(await b.value("document.documentElement.scrollWidth <= 390 && document.getElementById('view').clientHeight > 250"), "it fits a phone", "it does not");
	await calm(b, true);
	await open(b);
	say(await b.value("eyewright.eyes.still && !eyewright.eyes.blinking"), "reduced motion is respected", "it is not");
	say(!b.problems.length, "no error on the console", b.problems.join("; "));
	const outside = b.requests.filter(r => !/^(file|data|blob|about|chrome):/.test(r));
	say(!outside.length, "nothing is fetched", outside.join());
}

async function beside(b) {
	await open(b, "#view=beside");
	await b.until(settled, 180);
	await b.screenshot(path.join(shots, "beside.png"));
	say(await b.value("!document.getElementById('photo').hidden && document.getElementById('photo').naturalWidth > 100"), "the photograph stands beside the rendering", "it does not");
}

/* A character without a photograph: its lids, its clip, its size. */
async function character(b) {
	url = pathToFileURL(face).href;
	await calm(b, true);
	await open(b, "#gaze=0,0");
	await b.until(settled, 180);
	await b.screenshot(path.join(shots, "face.png"));
	const open_eyes = await b.value(sum);
	await b.value("eyewright.set('aperture', 0)");
	await b.until(settled, 180);
	await b.screenshot(path.join(shots, "shut.png"));
	say(await b.value("eyewright.mode") === "face" && await b.value(sum) !== open_eyes, "a character's lids close", "the picture has not changed");
	await posed(b);
	const wink = JSON.parse(await b.value(`(() => { const f = eyewright.face.poser, take = open => { f.pose([[0, 0], [0, 0]], open); return f.read(f.at); };
		const open = take([1, 1]), left = take([0, 1]), right = take([1, 0]), out = [[0, 0], [0, 0]];
		for (let i = 0; i < f.base; i++) {
			const x = f.in_head(f.rest.subarray(3 * i, 3 * i + 3))[0], side = x > 0 ? 0 : 1;
			if (Math.abs(x) < 10)
				continue;
			[left, right].forEach((to, k) => { out[k][side] = Math.max(out[k][side], Math.hypot(...[0, 1, 2].map(c => to[4 * i + c] - open[4 * i + c]))); });
		}
		return JSON.stringify(out); })()`));
	say(wink[0][0] > 1 && wink[1][1] > 1 && wink[0][1] < 0.05 && wink[1][0] < 0.05, "either eye winks by itself", JSON.stringify(wink));
	await b.value("eyewright.reset(); eyewright.set('wink_left', 1)");
	await b.until(settled, 180);
	await b.screenshot(path.join(shots, "wink.png"));
	await b.value("eyewright.reset()");
	for (const [k, name] of [[0, "As recorded"], [1, "Cut-scene"]]) {
		await b.value(`eyewright.eyes.eye = [0, 0]; eyewright.play(${k})`);
		await b.until("eyewright.eyes.eye.some(v => v !== 0)", 60);
		const first = await b.value("eyewright.eyes.eye.join()");
		await b.until(`eyewright.eyes.eye.join() !== "${first}"`, 60);
		say(await b.value(`data.face.clips[${k}].name`) === name && await b.value("eyewright.began") !== null && await b.value(`location.hash.includes("play=${k}")`), `a clip plays: ${name}`, await b.value(`data.face.clips[${k}].name + location.hash`));
	}
	await b.value("eyewright.play(null)");
	await shut(b);
	await expressions(b);
	// Either eye turned to one place: 62 mm apart they turn by 2 atan(31 / 200) against each other at 20 cm.
	const turned = await b.value(`(() => { const v = eyewright; v.values.near = 5; const g = v.gazes(0, 0), x = data.face.globes; v.values.near = 0;
		return (g[1][0] - g[0][0]) - 2 * Math.atan((x[0][0] - x[1][0]) / 2 / 200) * 180 / Math.PI; })()`);
	say(Math.abs(turned) < 0.2, "near things are looked at with both eyes", `off by ${turned} degrees`);
	const dry = await b.value(`(() => { eyewright.reset(); eyewright.set("field", 16); return 1; })()`);
	await b.until(settled, 180);
	await b.screenshot(path.join(shots, "close.png"));
	await tears(b);
	const with_tears = await b.value(sum);
	await b.value("eyewright.set('tear', 0)");
	await b.until(settled, 180);
	say(dry === 1 && await b.value(sum) !== with_tears, "the tear line follows its slider", "the picture has not changed");
	await b.screenshot(path.join(shots, "dry.png"));
	const compiled = await b.value("eyewright.graphics.compiled.join()");
	say(/skin/.test(compiled) && /lids/.test(compiled) && !/eye(,|$)/.test(compiled), "a face compiles its own eye and no other", compiled);
	say(!b.problems.length, "the face: no error on the console", b.problems.join("; "));
	say(fs.statSync(face).size < 20e6, "with a face the page is below 20 MB", `${fs.statSync(face).size}`);
}

/* What the page's shaders make of the rig, against lib/rig/deform/deform.c: positions to a millionth of the face's width (a few units in
 * the last place of what stands in single precision), normals of what does not always stand still. Of a wink either side's lids
 * are as with both eyes opened so; what lies between them is neither's. */
async function posed(b) {
	const cases = ["0 0 0 0 1 1 0 0", "20 -15 18 -15 1 1 0 0", "-30 20 -30 20 0.5 0.5 0 0", "0 0 0 0 0 1 0 0", "10 5 8 5 1.4 0.2 0.7 0.3", "-40 -25 -40 -25 0.05 0 1 1"];
	const floats = bytes => new Float32Array(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length));
	const want = floats(execFileSync(path.join(tools, "posed"), [rig], { input: cases.flatMap(c => [4, 5].map(k => c.split(" ").map((w, i) => i === 4 || i === 5 ? c.split(" ")[k] : w).join(" "))).join("\n") + "\n", maxBuffer: 1 << 28 }));
	const rows = JSON.parse(await b.value("JSON.stringify(Array.from(new Int32Array(data.face.rig.rows.buffer)))")), n = want.length / cases.length / 12;
	const share = JSON.parse(await b.value("JSON.stringify(Array.from({ length: eyewright.face.poser.base }, (_, i) => eyewright.face.poser.share(i)))"));
	const posed = await b.value("eyewright.face.poser.posed"), worst = [0, 0], low = [0, 1, 2].map(() => 1e9), high = low.map(() => -1e9);
	let moved = 0;
	const step = await b.value("eyewright.face.poser.maps.settle_step");
	await b.value("eyewright.face.poser.maps.settle_step = 0");  // lids as they were learnt: settled() tells how they are shown
	for (let k = 0; k < cases.length; k++) {
		const v = cases[k].split(" ").map(Number), got = floats(Buffer.from(await b.value(`(() => { const f = eyewright.face.poser;
			f.pose([[${v[0]}, ${v[1]}], [${v[2]}, ${v[3]}]], [${v[4]}, ${v[5]}], [${v.slice(6)}]);
			const bytes = new Uint8Array(32 * f.base);
			[f.at, f.normals].forEach((r, i) => bytes.set(new Uint8Array(f.read(r).buffer, 0, 16 * f.base), 16 * f.base * i));
			let text = ""; for (let i = 0; i < bytes.length; i += 32768) text += String.fromCharCode(...bytes.subarray(i, i + 32768));
			return btoa(text); })()`), "base64"));
		rows.forEach((row, i) => { for (const c of v[4] === v[5] || [0, 1].includes(share[i]) ? [0, 1, 2] : []) {
			const from = 6 * n * (2 * k + (share[i] < 0.5 ? 1 : 0)) + 3 * row + c, at = want[from];
			low[c] = Math.min(low[c], at);
			high[c] = Math.max(high[c], at);
			moved = Math.max(moved, Math.abs(at - want[3 * row + c]));
			worst[0] = Math.max(worst[0], Math.abs(got[4 * i + c] - at));
			if (i < posed)
				worst[1] = Math.max(worst[1], Math.abs(got[4 * (rows.length + i) + c] - want[from + 3 * n]));
		} });
	}
	await b.value(`eyewright.face.poser.maps.settle_step = ${step}`);
	const size = Math.max(...high.map((h, c) => h - low[c])), off = worst[0] / size, text = `${(1000 * worst[0]).toPrecision(2)} um of ${size.toFixed(0)} mm: ${off.toPrecision(2)}; normals ${worst[1].toPrecision(2)}`;
	console.log(`# the shader's deformation is off by ${text}`);
	say(moved > 3 && off < 1e-6 && worst[1] < 2e-3, "the shader deforms the skin as C does, to a millionth of the face", text);
}

/* The field from which the page draws tears and the dark under lids, pixel by pixel: the distance to the nearest pixel of skin as the definition has it, among all
 * within reach, by looking at each. */
async function tears(b) {
	const off = JSON.parse(await b.value(`(() => {
		const f = eyewright.face, was = f.field_of_lids, out = { seen: 0, worst: 0, missed: 0, beyond: 0, reach: 0 };
		f.field_of_lids = function (side, key, per_mm, s) {
			this.fielded[side] = "";
			was.call(this, side, key, per_mm, s);
			const { gl } = this.g, { width, height } = this.frame, box = gl.getParameter(gl.SCISSOR_BOX), mask = new Float32Array(4 * width * height), field = new Float32Array(4 * width * height);
			this.g.target(this.frame);
			gl.readPixels(0, 0, width, height, gl.RGBA, gl.FLOAT, mask);
			this.g.target(this.fields[1]);
			gl.readPixels(0, 0, width, height, gl.RGBA, gl.FLOAT, field);
			if (gl.getError() !== gl.NO_ERROR)
				out.error = true;
			const reach = Math.min(64, Math.ceil(1.2 * per_mm * Math.max(this.data.shadow_mm, this.data.lake * this.data.tear_mm * s.tear)) + 2);
			out.reach = reach;
			for (let y = Math.max(box[1] + reach, 0); y < Math.min(box[1] + box[3] - reach, height); y++)
				for (let x = Math.max(box[0] + reach, 0); x < Math.min(box[0] + box[2] - reach, width); x++) {
					let best = Infinity;
					for (let v = Math.max(y - reach, 0); v <= Math.min(y + reach, height - 1); v++)
						for (let u = Math.max(x - reach, 0); u <= Math.min(x + reach, width - 1); u++)
							if (mask[4 * (v * width + u) + 3] > 0.995)
								best = Math.min(best, (u - x) ** 2 + (v - y) ** 2);
					const got = field[4 * (y * width + x) + 2], want = Math.sqrt(best);
					if (want > 0 && want <= reach) {
						out.seen++;
						out.worst = Math.max(out.worst, Math.abs(got - want) / want);
						out.missed += got >= 1e3;
					} else if (want > reach)
						out.beyond += got < reach;
				}
		};
		eyewright.set("tear", eyewright.values.tear + 0.01);
		window.tears_off = out;
		return JSON.stringify(out);
	})()`));
	await b.until("window.tears_off.seen > 0", 60);
	const found = JSON.parse(await b.value("delete eyewright.face.field_of_lids, JSON.stringify(window.tears_off)"));
	await b.value("eyewright.set('tear', eyewright.values.tear - 0.01)");
	await b.until(settled, 180);
	// Half floats: ten bits.
	say(!off.error && found.seen > 500 && found.worst < 2e-3 && !found.missed && !found.beyond, "the distance to the lids is exact, pixel by pixel", JSON.stringify(found));
}

/* Vertices between rest and an expression in full, and back; wrinkles fold with theirs alone. */
async function expressions(b) {
	const off = JSON.parse(await b.value(`(() => {
		const f = eyewright.face.poser, take = s => { f.pose([[0, 0], [0, 0]], [1, 1], s); return f.read(f.at); };
		const rest = take([0, 0]), full = take([1, 0]), both = take([1, 1]), again = take([0, 0]), far = (a, b) => a.reduce((m, v, i) => Math.max(m, Math.abs(v - b[i])), 0);
		return JSON.stringify({ first: far(full, rest), second: far(both, full), back: far(again, rest) });
	})()`));
	say(off.first > 0.5 && off.second > 0.1 && off.back === 0, "expressions move the face, and go", JSON.stringify(off));
	const seen = JSON.parse(await b.value(`(() => {
		const p = eyewright;
		p.busy = true;
		p.eyes.eye = p.eyes.target = [0, 0];
		const look = (au0, au1, flat) => { p.values.au0 = au0; p.values.au1 = au1; p.scene.restart(); if (flat) p.face.folds = () => ({ ...fold(), folds: 0 }); p.draw(presets[presets.length - 1]); delete p.face.folds; return ${sum}; };
		const fold = p.face.folds.bind(p.face);
		const out = { brow: look(1, 0) !== look(1, 0, true), squint: look(0, 1) !== look(0, 1, true), rest: look(0, 0) !== look(0, 0, true) };
		look(0, 0);
		p.busy = false;
		return JSON.stringify(out);
	})()`, 120000));
	say(seen.brow && !seen.squint && !seen.rest, "skin folds with the expression that folds it", JSON.stringify(seen));
	// Lids that stay where they are leave the eye its light: the middles of both globes, 3 mm round, with expressions and without.
	const lit = JSON.parse(await b.value(`(() => {
		const p = eyewright, gl = p.graphics.gl, n = gl.canvas.width, rows = gl.canvas.height, px = new Uint8Array(4 * n * rows);
		p.busy = true;
		const look = (au0, au1) => {
			p.values.au0 = au0; p.values.au1 = au1; p.scene.restart(); p.draw(presets[0]);
			gl.bindFramebuffer(gl.FRAMEBUFFER, null); gl.readPixels(0, 0, n, rows, gl.RGBA, gl.UNSIGNED_BYTE, px);
			const v = p.view(), f = FaceScene.DISTANCE * rows / v.field(rows) / FaceScene.DISTANCE;
			let sum = 0, count = 0;
			for (const [x, y] of data.face.globes)
				for (let i = -3; i <= 3; i += 0.25)
					for (let j = -3; j <= 3; j += 0.25, count++)
						sum += px[4 * (Math.round(rows / 2 + f * (y + i)) * n + Math.round(n / 2 + f * (x + j))) + 1];
			return sum / count;
		};
		const out = [look(1, 0), look(0, 1), look(0, 0)];
		p.busy = false;
		return JSON.stringify(out);
	})()`, 120000));
	say(lit[2] > 20 && Math.abs(lit[0] / lit[2] - 1) < 0.05 && Math.abs(lit[1] / lit[2] - 1) < 0.05, "an expression does not dim the eyes", JSON.stringify(lit));
	say(await b.value("!!document.getElementById('s-au0') && !!document.getElementById('s-au1')"), "each expression has a slider", "one is missing");
}

async function without(b) {
	await open(b);
	await b.screenshot(path.join(shots, "without.png"));
	const why = await b.value("document.getElementById('why').textContent"), shown = await b.value("!document.getElementById('stills').hidden && [...document.querySelectorAll('#stills img')].every(i => i.naturalWidth > 100)");
	const room = await b.value("document.getElementById('stills').clientHeight / innerHeight");
	say(shown && room > 0.99 && /WebGL 2/.test(why), "without WebGL 2 there are stills, and why", `${why} ${room}`);
}

(async () => {
	const b = await Browser.start();
	try {
		await b.size(800, 500);
		await open(b);
		const start = await b.value("Math.round(performance.now())");
		console.log(`# opened after ${start} ms, ${(fs.statSync(page).size / 1e6).toFixed(1)} MB`);
		say(fs.statSync(page).size < 10e6, "the page is below 10 MB", `${fs.statSync(page).size}`);
		// An eye alone: no skin, no lids, no tears, neither sent nor compiled.
		const compiled = await b.value("eyewright.graphics.compiled.join()"), sent = await b.value("Object.keys(eyewright.graphics.shaders).join()");
		say(!/skin|lids|tear/.test(compiled + sent), "an eye alone compiles no skin and no tears", `${compiled}; ${sent}`);
		say(!(await b.value("eyewright.graphics.software")) || /(^|,)march(,|$)/.test(compiled.split("march+shadows")[0]), "a processor compiles the cheapest march first", compiled);
		await agreement(b);
		await hands(b);
		await skips(b);
		await sliders(b);
		await keys(b);
		await eyes(b);
		await beside(b);
		await everyone(b);
		if (face) {
			await b.size(800, 500);
			await character(b);
			url = pathToFileURL(page).href;
		}
	} finally {
		await b.end();
	}
	const bare = await Browser.start(["--disable-3d-apis"]);
	bare.bare = true;
	try {
		await without(bare);
	} finally {
		await bare.end();
	}
})().catch(e => { say(false, "the page in a browser", e.message); process.exit(1); });

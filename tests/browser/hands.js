"use strict";
/* What hands meet on the interactive page, in a headless Chromium: node hands.js PAGE FACE
 * Prints "pass NAME" or "fail NAME: WHY" a line. */
const fs = require("fs");
const path = require("path");
const { pathToFileURL } = require("url");
const { Browser } = require("./browser.js");

const [, , page, face] = process.argv;
const say = (ok, name, why) => console.log(ok ? `pass ${name}` : `fail ${name}: ${why}`);
const settled = "document.documentElement && document.documentElement.dataset.settled";
const shown = id => `(e => e && e.checkVisibility())(document.getElementById("${id}"))`;

async function open(b, file, hash) {
	await b.open("about:blank");
	await b.open(pathToFileURL(file).href + (hash || ""));
	await b.until("document.documentElement && document.documentElement.dataset.open", 60);
}

async function calm(b) {
	await b.send("Emulation.setEmulatedMedia", { features: [{ name: "prefers-reduced-motion", value: "reduce" }] });
}

const box_of = async (b, id) => JSON.parse(await b.value(`JSON.stringify(document.getElementById("${id}").getBoundingClientRect())`));

/* Whatever slider is shown changes the picture that is shown, in every view. */
async function sliders(b, file, mode) {
	await open(b, file, `#gaze=0,0&view=${mode}`);
	const stuck = await b.value(`(() => {
		const p = eyewright, gl = p.graphics.gl, px = new Uint8Array(4 * 2048 * 2048), out = [];
		p.busy = true;
		const look = () => { p.scene.restart(); p.draw(presets[presets.length - 1]); gl.bindFramebuffer(gl.FRAMEBUFFER, null);
			gl.readPixels(0, 0, gl.canvas.width, gl.canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, px);
			let h = 0; for (let i = 0; i < 4 * gl.canvas.width * gl.canvas.height; i += 4) h = (h * 31 + px[i] * 65536 + px[i + 1] * 256 + px[i + 2]) % 4294967291; return h; };
		const first = look(), seen = p.controls.filter(c => (document.getElementById("s-" + c.key) || { checkVisibility: () => false }).checkVisibility());
		for (const c of seen) {
			p.set(c.key, c.value - c.lo > c.hi - c.value ? c.lo : c.hi);
			if (look() === first)
				out.push(c.key);
			p.set(c.key, c.value);
		}
		p.busy = false;
		return seen.length + ": " + out.join();
	})()`, 120000);
	say(/^[1-9][0-9]+: $/.test(stuck), `every slider that the ${mode} view shows changes it`, stuck);
}

async function beside(b) {
	await open(b, page, "#view=beside");
	const lost = await b.value(`[${["gaze-0", "s-field"].map(shown)}].join()`);
	say(lost === "false,false", "beside the photograph nothing is offered that turns or moves the eye", lost);
	const box = await box_of(b, "view"), y = box.y + box.height / 2;
	await b.mouse("mousePressed", box.x + 0.5 * box.width, y, true);
	await b.mouse("mouseMoved", box.x + 0.4 * box.width, y, true);
	await b.mouse("mouseMoved", box.x + 0.2 * box.width, y, true);
	await b.mouse("mouseReleased", box.x + 0.2 * box.width, y);
	const at = [Number(await b.value("document.getElementById('wipe').value")), parseFloat(await b.value("getComputedStyle(document.getElementById('bar')).left")) / box.width * 100];
	say(at.every(v => Math.abs(v - 20) < 1.5), "the bar between rendering and photograph is dragged in the picture", at.join());
	say(await b.value("eyewright.orbit.join()") === "0,0", "and turns nothing", await b.value("eyewright.orbit.join()"));
	await b.value("eyewright.set('pupil', 3); eyewright.reset()");
	say(await b.value("eyewright.light") === 1, "reset leaves the photograph's light beside the photograph", await b.value("eyewright.light"));
	await b.size(390, 844, true);
	await b.until(settled, 120);
	const [text, slider] = [await box_of(b, "time"), await box_of(b, "wipe-box")];
	say(text.top >= slider.bottom || text.right <= slider.left, "on a phone the readout and the slider stand apart", JSON.stringify([text.top, slider.bottom]));
	await b.size(1000, 640);
}

async function address(b) {
	await open(b, page, "#pupil=3&gaze=10,5&orbit=20,0&light=1");
	const read = "[eyewright.values.pupil, eyewright.follow, eyewright.eyes.target.join('/'), Math.round(eyewright.orbit[0] * 100), eyewright.light].join()";
	const first = await b.value(read);
	say(first === "3,typed,10/5,35,1", "an address opens its view", first);
	await b.value("eyewright.reset()");
	const typed = await b.value("document.getElementById('gaze-0').value + document.getElementById('gaze-1').value");
	say(typed === "00", "reset empties the typed gaze", typed);
	await b.value("location.hash = 'pupil=3&view=beside'");
	await b.until("eyewright.values.pupil === 3 && eyewright.beside", 10);
	await b.value("location.hash = 'R=8'");
	await b.until("eyewright.values.R === 8", 10);
	const left = await b.value("[eyewright.values.pupil === eyewright.controls.find(c => c.key === 'pupil').value, eyewright.mode, eyewright.light].join()");
	say(left === "true,eye,0", "another address leaves nothing of the last", left);
}

async function touch(b) {
	await b.size(390, 844, true);
	await open(b, page, "#gaze=0,0");
	const box = await box_of(b, "view"), x = box.x + box.width / 2, y = box.y + box.height / 2;
	const fingers = (type, apart) => b.send("Input.dispatchTouchEvent", { type, touchPoints: apart === null ? [] : [{ x: x - apart, y, id: 0 }, { x: x + apart, y, id: 1 }] });
	await fingers("touchStart", 40);
	for (const d of [45, 60, 70, 80])
		await fingers("touchMove", d);
	await fingers("touchEnd", null);
	await b.until("eyewright.values.field < 25", 20).catch(() => 0);
	const field = await b.value("eyewright.values.field"), orbit = await b.value("eyewright.orbit.join()");
	say(Math.abs(field - 15) < 0.1 && orbit === "0,0", "two fingers twice as far apart zoom to twice the size and turn nothing", `${field} ${orbit}`);
	for (const [type, dx] of [["touchStart", 0], ["touchMove", 0.05], ["touchMove", 0.1], ["touchEnd", null]])
		await b.send("Input.dispatchTouchEvent", { type, touchPoints: dx === null ? [] : [{ x: x - 40 + dx * box.height, y, id: 0 }, { x: x + 40 + dx * box.height, y, id: 1 }] });
	await b.until("Math.abs(eyewright.pan[0] - 0.1) < 0.01", 20).catch(() => 0);
	const pan = await b.value("[eyewright.pan.map(v => v.toFixed(2)), eyewright.orbit].join()");
	say(pan === "0.10,0.00,0,0", "two fingers that move together move the picture and turn nothing", pan);
	await b.size(1000, 640);
}

/* What is tapped is 44 px or more each way, and nothing runs over. */
async function fingers(b) {
	await b.size(390, 844, true);
	await b.send("Emulation.setTouchEmulationEnabled", { enabled: true });
	for (const [file, name] of [[page, "an eye"], [face, "a face"]]) {
		await open(b, file, "#gaze=0,0&pupil=3");
		const got = JSON.parse(await b.value(`JSON.stringify({ small: [...document.querySelectorAll("a, button, input, select, textarea")].filter(e => e.checkVisibility() && !e.matches(".skip")).map(e => [e.textContent || e.id, e.getBoundingClientRect()])
			.filter(([, r]) => r.width < 44 || r.height < 44).map(([t, r]) => [t, r.width, r.height]), wide: [document.documentElement.scrollWidth, document.getElementById("panel").scrollWidth] })`));
		say(!got.small.length && got.wide.every(w => w <= 390), `on a phone the controls of ${name} fit, each large enough for a finger`, JSON.stringify(got));
	}
	await b.send("Emulation.setTouchEmulationEnabled", { enabled: false });
	await b.size(1000, 640);
}

/* Asked for, the readout has the graphics processor's own time beside the frame's; where the driver tells none, it is not offered. */
async function timed(b) {
	await open(b, page, "#gaze=0,0");
	const press = () => b.value("[...document.querySelectorAll('button')].find(e => e.textContent === 'Time the graphics processor').click()");
	const told = "document.getElementById('time').textContent", offered = await b.value("[...document.querySelectorAll('button')].some(e => e.textContent === 'Time the graphics processor' && !e.disabled)");
	if (!offered) {
		say(await b.value("eyewright.graphics.timer === null"), "no time of a graphics processor is offered that tells none", "");
		return;
	}
	await press();
	await b.until(`/ms of them on the graphics processor/.test(${told})`, 60).catch(() => 0);
	const ms = await b.value("[eyewright.gpu_ms > 0, eyewright.gpu_ms < 60000].join()"), text = await b.value(told);
	await press();
	say(ms === "true,true" && !/processor/.test(await b.value(told)), "the graphics processor's time is told when asked for, and no longer", `${ms} ${text}`);
}

/* The picture is moved, not turned: its brightness, row by row, is the same so many columns aside. */
async function moved(b, file, mode) {
	await open(b, file, `#gaze=0,0&view=${mode}`);
	const off = await b.value(`(() => {
		const p = eyewright, gl = p.graphics.gl, px = new Uint8Array(4 * 2048 * 2048);
		p.busy = true;
		const look = () => { p.scene.restart(); p.draw(presets[presets.length - 1]); gl.bindFramebuffer(gl.FRAMEBUFFER, null);
			gl.readPixels(0, 0, gl.canvas.width, gl.canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, px);
			return Float32Array.from({ length: gl.canvas.width * gl.canvas.height }, (_, i) => px[4 * i + 1]); };
		const first = look(), w = gl.canvas.width, h = gl.canvas.height, by = Math.round(0.1 * h);
		p.pan_to([by / h, 0]);
		const second = look(), off = [[], []];
		p.busy = false;
		for (let y = Math.round(0.3 * h); y < 0.7 * h; y += 3)
			for (let x = Math.round(w / 2 - 0.2 * h); x < w / 2 + 0.2 * h; x += 3) {
				off[0].push(Math.abs(second[y * w + x + by] - first[y * w + x]));
				off[1].push(Math.abs(second[y * w + x] - first[y * w + x]));
			}
		return off.map(list => (list.reduce((s, v) => s + v, 0) / list.length).toFixed(2)).join();
	})()`, 120000), [moved_by, stayed] = off.split(",").map(Number);
	say(moved_by < 2 && stayed > 5 * moved_by, `a picture of the ${mode} is moved as a whole`, off);
	const box = await box_of(b, "view"), at = [box.x + box.width / 2, box.y + box.height / 2];
	await b.value("eyewright.reset()");
	const drag = (type, x) => b.send("Input.dispatchMouseEvent", { type, x, y: at[1], button: "right", buttons: 2, clickCount: 1 });
	await drag("mousePressed", at[0]);
	await drag("mouseMoved", at[0] + 0.1 * box.height);
	await drag("mouseMoved", at[0] + 0.2 * box.height);
	await drag("mouseReleased", at[0] + 0.2 * box.height);
	const got = await b.value("[eyewright.pan.map(v => v.toFixed(2)), eyewright.orbit, /pan=/.test(location.hash)].join()");
	say(got === "0.20,0.00,0,0,true", `the right button moves the ${mode}, and the address keeps it`, got);
}

async function character(b) {
	await open(b, face, "#gaze=0,0&view=eye");
	const of = `[${["s-aperture", "s-au0"].map(shown)}].join()`;
	say(await b.value(of) === "false,false", "lids and expressions are not offered for an eye without them", await b.value(of));
	await b.value("eyewright.set_mode('face')");
	say(await b.value(of) === "true,true", "they are for the face", await b.value(of));
	// As the model's own record has it: the first two inputs of either eye.
	const inputs = JSON.parse(fs.readFileSync(path.join(path.dirname(face), "../skin/model.json"))).inputs;
	const far = [0, 1].flatMap(k => [Math.min(inputs[k].low, inputs[5 + k].low), Math.max(inputs[k].high, inputs[5 + k].high)]), looked = JSON.parse(await b.value("JSON.stringify(data.face.looked)"));
	say(far.every((v, k) => Math.abs(v - looked[k]) < 1e-3), "the page knows how far eyes looked in the video", `${far} ${looked}`);
	const box = await box_of(b, "view");
	const follow = async mode => {
		await b.value(`eyewright.set_mode("${mode}"); eyewright.set_follow("pointer")`);
		await b.mouse("mouseMoved", box.x + 5, box.y + 5);
		await b.mouse("mouseMoved", box.x + 2, box.y + box.height - 2);
		return JSON.parse(await b.value("JSON.stringify(eyewright.eyes.target)"));
	};
	const [alone, lidded] = [await follow("eye"), await follow("face")];
	say(alone[0] < -29 && alone[1] < -29 && lidded[0] >= 1.3 * far[0] - 1e-3 && lidded[1] >= 1.3 * far[2] - 1e-3 && lidded[0] < 0 && lidded[1] < 0,
		"after the pointer a face's eyes turn no further than its lids are known", JSON.stringify([alone, lidded, far]));
	await b.value("eyewright.set_follow('typed')");
	await b.until(settled, 120);
	await b.value("window.most = 0; const step = eyewright.eyes.step.bind(eyewright.eyes); eyewright.eyes.step = t => { const moved = step(t); window.most = Math.max(window.most, eyewright.eyes.closure); return moved; }; eyewright.eyes.conf.blink_hold_ms = 3000; eyewright.blink()");
	await b.until("window.most > 0.9", 120).catch(() => 0);
	say(await b.value("window.most > 0.9 && eyewright.eyes.still"), "who wants little motion still gets the blink he asks for", await b.value("window.most"));
}

(async () => {
	const b = await Browser.start();
	try {
		await b.size(1000, 640);
		await calm(b);
		await sliders(b, page, "eye");
		await sliders(b, page, "beside");
		await sliders(b, face, "face");
		await beside(b);
		await address(b);
		await touch(b);
		await fingers(b);
		await timed(b);
		await moved(b, page, "eye");
		await moved(b, face, "face");
		await character(b);
		say(!b.problems.length, "hands: no error on the console", b.problems.join("; "));
	} finally {
		await b.end();
	}
})().catch(e => { say(false, "hands on the page", e.message); process.exit(1); });

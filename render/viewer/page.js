/* The page: controls, pointer and keys, what is drawn when. */
(() => {
	const by_id = id => document.getElementById(id), data = JSON.parse(by_id("data").textContent);
	const calm = matchMedia("(prefers-reduced-motion: reduce)");
	const said = text => { by_id("said").textContent = text; };

	function give_up(why) {
		by_id("stage").hidden = by_id("panel").hidden = true;
		by_id("stills").hidden = false;
		by_id("why").textContent = `No live picture: ${why}. These are still ones.`;
	}

	/* Melanin by kind: volume fractions; one sigma of the product from those of its factors. */
	function pigments(t) {
		const out = {};
		for (const layer of ["abl", "stroma"]) {
			const m = t.fitted[layer + "_melanin"], b = t.fitted[layer + "_ratio"];
			const im = t.interval[layer + "_melanin"], ib = t.interval[layer + "_ratio"];
			const sm = im ? (im[1] - im[0]) / 2 : 0, sb = ib ? (ib[1] - ib[0]) / 2 : 0;
			out[layer + "_eu"] = { value: m * b, sigma: im ? Math.hypot(b * sm, m * sb) : 0 };
			out[layer + "_pheo"] = { value: m * (1 - b), sigma: im ? Math.hypot((1 - b) * sm, m * sb) : 0 };
		}
		return out;
	}

	/* Everything a hand can move. value: as fitted or assumed. power: how the slider is bent. conf: what capture.conf calls it. */
	function sliders(eye) {
		const e = eye.eye, t = eye.tissue, p = pigments(t), scale = t.interval.thickness_scale, per_cent = v => `${(100 * v).toPrecision(3)} %`;
		const degrees = v => `${v.toFixed(0)}°`, mm = n => v => `${v.toFixed(n)} mm`;
		const melanin = key => ({ key, lo: 0, hi: 0.6, power: 3, show: per_cent, ...p[key] });
		return [
			["Eye", [
				{ key: "aperture", label: "Lids: how far open", lo: 0, hi: 1.6, value: 1, show: v => `${(100 * v).toFixed(0)} %`, lids: true },
				{ key: "pupil", label: "Pupil, radius", lo: 0.7, hi: 4.2, value: e.pupil[2], show: mm(2) },
				{ key: "tear", label: "Tears", lo: 0, hi: 2, value: 1, show: v => `${(100 * v).toFixed(0)} %` },
				{ key: "field", label: "Zoom: height shown", lo: 8, hi: 60, value: 30, power: 2, show: mm(1) },
			]],
			["Pigment of the iris", [
				{ ...melanin("abl_eu"), label: "Anterior border layer: eumelanin" },
				{ ...melanin("abl_pheo"), label: "Anterior border layer: pheomelanin" },
				{ ...melanin("stroma_eu"), label: "Stroma: eumelanin" },
				{ ...melanin("stroma_pheo"), label: "Stroma: pheomelanin" },
				{ key: "thickness_scale", label: "Stroma: optical over anatomical thickness", lo: 0.02, hi: 2.5, power: 2, value: t.fitted.thickness_scale,
					sigma: scale ? (scale[1] - scale[0]) / 2 : 0, show: v => v.toFixed(3) },
				{ key: "detail", label: "Of the photograph beyond the model", lo: 0, hi: 1, value: e.detail, show: v => `${(100 * v).toFixed(0)} %` },
			]],
			["Cornea", [
				{ key: "R", label: "Apical radius R", lo: 6.5, hi: 9.5, value: e.R, sigma: 0.27, show: mm(2), conf: "eye.cornea_radius_mm", assumed: true },
				{ key: "p", label: "Asphericity p", lo: 0.3, hi: 1.2, value: e.p, sigma: 0.12, show: v => v.toFixed(3), conf: "eye.cornea_asphericity", assumed: true },
				{ key: "n", label: "Index of refraction", lo: 1, hi: 1.5, value: e.n, show: v => v.toFixed(4), conf: "eye.index", assumed: true },
			]],
			["Light", [
				{ key: "light_yaw", label: "Round", lo: -180, hi: 180, value: 0, show: degrees },
				{ key: "light_pitch", label: "Up and down", lo: -80, hi: 80, value: 0, show: degrees },
				{ key: "light_gain", label: "Strength", lo: 0.1, hi: 3, power: 2, value: 1, show: v => `${(100 * v).toFixed(0)} %` },
			]],
		];
	}

	function element(tag, attributes, ...children) {
		const out = document.createElement(tag);
		for (const [key, value] of Object.entries(attributes || {}))
			key in out && key !== "list" ? out[key] = value : out.setAttribute(key, value);
		out.append(...children);
		return out;
	}

	class Page {
		constructor(graphics) {
			this.graphics = graphics;
			this.eyes = new motion.Eyes(motion.configuration(data.motion));
			this.preset = graphics.software ? 2 : 0;
			this.automatic = true;
			this.times = [];
			this.orbit = [0, 0];
			this.follow = "pointer";
			this.mode = "";
			this.playing = null;
			this.rested = 0;
			this.light = 0;
			const calmed = () => { this.eyes.still = calm.matches; this.eyes.blinking = !calm.matches; };
			calm.addEventListener("change", calmed);
			calmed();
		}

		async open(index) {
			by_id("busy").textContent = "Opening…";
			this.index = index;
			this.eye = data.eyes[index];
			this.scene = new EyeScene(this.graphics, this.eye);
			await this.scene.load();
			if (data.face)
				await this.open_face();
			this.mode = this.mode || "eye";
			this.groups = sliders(this.eye);
			this.controls = this.groups.flatMap(g => g[1]);
			this.values = {};
			for (const c of this.controls)
				this.values[c.key] = c.value;
			this.build();
			this.from_hash();
			by_id("busy").textContent = "";
			this.changed();
		}

		/* The character, with each eye on its own side, or the only one on both. */
		async open_face() {
			this.face = this.face || new FaceScene(this.graphics, data.face);
			this.pair = [];
			for (const side of ["left", "right"]) {
				const k = data.eyes.findIndex(e => e.side === side);
				if (k < 0 || k === this.index)
					this.pair.push(this.scene);
				else {
					this.others = this.others || {};
					if (!this.others[k]) {
						this.others[k] = new EyeScene(this.graphics, data.eyes[k]);
						await this.others[k].load();
					}
					this.pair.push(this.others[k]);
				}
			}
			this.scene.has_lids = true;
			this.mode = this.mode || "face";
		}

		/* ---- what the shader is told */
		state() {
			const v = this.values, ratio = (eu, pheo) => eu + pheo > 0 ? eu / (eu + pheo) : 0.5;
			return { ...v, light: this.light, abl_melanin: Math.min(v.abl_eu + v.abl_pheo, 1), abl_ratio: ratio(v.abl_eu, v.abl_pheo),
				stroma_melanin: Math.min(v.stroma_eu + v.stroma_pheo, 1), stroma_ratio: ratio(v.stroma_eu, v.stroma_pheo) };
		}

		view() {
			const p = this.eye.photo, rad = Math.PI / 180, [h, v] = [0, 1].map(k => this.eyes.eye[k] + this.eyes.drift[k]);
			if (this.beside && p)
				return { pose: p.cam_from_eye, slip: p.slip, camera: p.camera, window: p.window, rows: p.height };
			if (this.mode === "face")
				return { face: this.face, eyes: this.pair, gaze: [h, v], open: this.values.aperture * (this.playing === null ? 1 - this.eyes.closure : this.clip_open), orbit: this.orbit,
					field: height => this.face.field * height / this.scene.target.width * this.values.field / 30 };
			return { yaw: h * rad, pitch: v * rad, orbit: this.orbit, field: this.values.field };
		}

		/* ---- controls */
		build() {
			const box = by_id("controls");
			box.replaceChildren();
			if (data.eyes.length > 1)
				box.append(element("div", { className: "buttons", role: "group", ariaLabel: "Eye" }, ...data.eyes.map((e, i) =>
					this.button(`${e.side} eye`, () => this.open(i), i === this.index))));
			const modes = [["face", "Face", this.face], ["eye", "Eye", true], ["beside", "Beside the photograph", this.eye.photo]].filter(m => m[2]);
			this.modes = modes.map(([mode, text]) => ({ mode, button: this.button(text, () => this.set_mode(mode), mode === this.mode) }));
			if (modes.length > 1)
				box.append(element("div", { className: "buttons", role: "group", ariaLabel: "View" }, ...this.modes.map(m => m.button)));
			box.append(this.gaze_controls());
			for (const [title, list] of this.groups) {
				const set = element("fieldset", {}, element("legend", { textContent: title }));
				if (title === "Light")
					set.append(this.light_choice());
				if (title === "Cornea")
					set.append(element("p", { className: "note", textContent: "As configured; the band is the spread between people (R ± 0.27 mm, p ± 0.12)." }));
				for (const c of list)
					if (!c.lids || this.scene.has_lids)
						set.append(this.slider(c));
				if (title === "Cornea")
					set.append(this.keeping());
				box.append(set);
			}
			box.append(this.machine());
		}

		button(text, on, pressed) {
			const b = element("button", { type: "button", textContent: text });
			if (pressed !== undefined)
				b.setAttribute("aria-pressed", pressed);
			b.addEventListener("click", on);
			return b;
		}

		gaze_controls() {
			const number = (label, k) => {
				const input = element("input", { type: "number", min: -45, max: 45, step: 1, value: 0, id: `gaze-${k}` });
				input.addEventListener("input", () => {
					const v = Number(input.value);
					if (Number.isFinite(v)) {
						this.set_follow("typed");
						this.eyes.target[k] = Math.min(45, Math.max(-45, v));
						this.to_hash();
						this.wake();
					}
				});
				this.typed = this.typed || [];
				this.typed[k] = input;
				return element("label", { textContent: label }, input);
			};
			this.following = ["pointer", "typed", "wander"].map(mode => this.button({ pointer: "Follow the pointer", typed: "Look where typed", wander: "Look about" }[mode], () => this.set_follow(mode), mode === this.follow));
			const blink = this.button("Blink", () => this.blink());
			this.players = (this.face && data.face.clips || []).map((clip, i) => this.button(`▶ ${clip.name}`, () => this.play(this.playing === i ? null : i), false));
			return element("fieldset", {}, element("legend", { textContent: "Gaze" }), element("div", { className: "buttons", role: "group", ariaLabel: "What the eye follows" }, ...this.following, ...(this.scene.has_lids ? [blink] : []), ...this.players),
				element("div", { className: "numbers" }, number("To the person's left, degrees", 0), number("Up, degrees", 1)));
		}

		light_choice() {
			this.light_buttons = this.eye.lights.map((l, i) => this.button(l.name, () => { this.set_light(i); this.to_hash(); }, i === this.light));
			return element("div", { className: "buttons", role: "group", ariaLabel: "Surroundings" }, ...this.light_buttons);
		}

		slider(c) {
			const id = `s-${c.key}`, power = c.power || 1, t_of = v => Math.pow(Math.min(Math.max((v - c.lo) / (c.hi - c.lo), 0), 1), 1 / power);
			const input = element("input", { type: "range", id, min: 0, max: 1000, step: 1 }), output = element("output", { htmlFor: id });
			const reset = this.button("↺", () => { this.set(c.key, c.value); input.focus(); });
			reset.className = "reset";
			reset.setAttribute("aria-label", `${c.label}: back to ${c.show(c.value)}`);
			reset.title = "Back";
			const at = t => `calc(${t} * (100% - 16px) + 8px)`, track = element("span", { className: "track" });
			if (c.sigma) {
				const a = t_of(c.value - c.sigma), b = t_of(c.value + c.sigma), band = element("span", { className: "sigma" });
				band.style.left = at(a);
				band.style.width = `calc(${Math.max(b - a, 0.005)} * (100% - 16px))`;
				track.append(band);
			}
			const tick = element("span", { className: "fit" });
			tick.style.left = at(t_of(c.value));
			track.append(tick, input);
			const row = element("div", { className: "row" }, element("label", { htmlFor: id, textContent: c.label }), output, reset, track);
			const plus = c.sigma ? ` ± ${c.show(c.sigma)}` : "";
			row.title = `${c.assumed ? "Configured" : "Fitted"}: ${c.show(c.value)}${plus}`;
			c.update = () => {
				const v = this.values[c.key];
				input.value = Math.round(1000 * t_of(v));
				output.textContent = c.show(v);
				input.setAttribute("aria-valuetext", `${c.show(v)}; ${row.title}`);
				row.classList.toggle("moved", Math.abs(v - c.value) > 1e-9);
			};
			input.addEventListener("input", () => {
				const v = c.lo + (c.hi - c.lo) * Math.pow(input.value / 1000, power);
				this.set(c.key, input.value === String(Math.round(1000 * t_of(c.value))) ? c.value : v, true);
			});
			c.update();
			return row;
		}

		set(key, value, from_hand) {
			const c = this.controls.find(o => o.key === key);
			this.values[key] = Math.min(Math.max(value, c.lo), c.hi);
			c.update();
			this.lines();
			this.to_hash();
			this.changed();
			if (!from_hand)
				said(`${c.label}: ${c.show(this.values[key])}`);
		}

		keeping() {
			this.kept = element("textarea", { readOnly: true, id: "lines", spellcheck: false });
			const copy = this.button("Copy", async () => {
				this.kept.select();
				try {
					await navigator.clipboard.writeText(this.kept.value);
				} catch {
					document.execCommand("copy");
				}
				said("Copied");
			});
			this.keep_box = element("div", { hidden: true }, element("p", { className: "note" }, element("label", { htmlFor: "lines", textContent: "Keep these values: put the lines into capture.conf and run make again." })), this.kept, element("div", { className: "buttons" }, copy));
			return this.keep_box;
		}

		/* capture.conf lines for what was moved: a narrow prior holds a pigment where it was put. */
		lines() {
			const v = this.state(), out = [], moved = key => Math.abs(this.values[key] - this.controls.find(c => c.key === key).value) > 1e-9;
			for (const layer of ["abl", "stroma"])
				if (moved(layer + "_eu") || moved(layer + "_pheo")) {
					out.push(`pigment.prior_${layer}_melanin = ${Math.max(v[layer + "_melanin"], 1e-4).toPrecision(4)} 0.01`);
					out.push(`pigment.prior_${layer}_ratio = ${v[layer + "_ratio"].toFixed(4)} 0.005`);
				}
			if (moved("thickness_scale"))
				out.push(`pigment.prior_scale = ${v.thickness_scale.toFixed(4)} 0.01`);
			for (const c of this.controls)
				if (c.conf && moved(c.key))
					out.push(`${c.conf} = ${this.values[c.key].toFixed(4)}`);
			this.kept.value = out.join("\n");
			this.keep_box.hidden = !out.length;
		}

		machine() {
			const quality = element("select", { id: "quality" }, element("option", { value: "auto", textContent: "automatic" }), ...presets.map((p, i) => element("option", { value: i, textContent: p.name })));
			quality.addEventListener("change", () => {
				this.automatic = quality.value === "auto";
				this.preset = this.automatic ? this.preset : Number(quality.value);
				this.times = [];
				this.changed();
			});
			const copy = this.button("Copy the address of this view", async () => {
				this.to_hash();
				try {
					await navigator.clipboard.writeText(location.href);
					said("Copied");
				} catch {
					said("The address is in the address bar");
				}
			});
			return element("fieldset", {}, element("legend", { textContent: "Page" }), element("div", { className: "row" }, element("label", { htmlFor: "quality", textContent: "Quality while moving" }), quality),
				element("div", { className: "buttons" }, copy, this.button("Reset all", () => this.reset())));
		}

		reset() {
			for (const c of this.controls)
				this.values[c.key] = c.value;
			this.orbit = [0, 0];
			this.eyes.target = [0, 0];
			this.set_light(0);
			for (const c of this.controls)
				c.update && c.update();
			this.lines();
			this.to_hash();
			this.changed();
			said("Everything as fitted");
		}

		set_follow(mode) {
			if (this.playing !== null)
				this.play(null);
			this.follow = mode;
			["pointer", "typed", "wander"].forEach((m, i) => this.following[i].setAttribute("aria-pressed", m === mode));
			this.wake();
		}

		set_light(i) {
			this.light = i;
			this.light_buttons.forEach((b, k) => b.setAttribute("aria-pressed", k === i));
			this.changed();
		}

		set_mode(mode) {
			const photo = by_id("photo"), on = mode === "beside", was = this.beside;
			this.mode = mode;
			if (mode !== "face" && this.playing !== null)
				this.play(null);
			this.modes.forEach(m => m.button.setAttribute("aria-pressed", m.mode === mode));
			if (on) {
				photo.src = this.eye.photo.uri;
				photo.alt = `Photograph ${this.eye.photo.name}`;
			}
			photo.hidden = by_id("bar").hidden = by_id("wipe-box").hidden = !on;
			if (on !== was)
				this.set_light(on && this.eye.lights.length > 1 ? 1 : 0);
			this.to_hash();
			this.changed();
		}

		get beside() {
			return this.mode === "beside";
		}

		blink() {
			this.eyes.blink_now(performance.now() / 1000);
			this.wake();
		}

		/* ---- the address */
		to_hash() {
			const parts = [];
			for (const c of this.controls)
				if (Math.abs(this.values[c.key] - c.value) > 1e-9)
					parts.push(`${c.key}=${Number(this.values[c.key].toPrecision(6))}`);
			if (this.orbit[0] || this.orbit[1])
				parts.push(`orbit=${this.orbit.map(v => (v * 180 / Math.PI).toFixed(1)).join(",")}`);
			if (this.follow === "typed")
				parts.push(`gaze=${this.eyes.target.map(v => v.toFixed(1)).join(",")}`);
			if (this.light)
				parts.push(`light=${this.light}`);
			if (this.mode !== (this.face ? "face" : "eye"))
				parts.push(`view=${this.mode}`);
			if (this.index)
				parts.push(`eye=${this.index}`);
			history.replaceState(null, "", parts.length ? `#${parts.join("&")}` : location.pathname + location.search);
		}

		from_hash() {
			const q = new URLSearchParams(location.hash.slice(1)), pair = key => {
				const v = (q.get(key) || "").split(",").map(Number);
				return v.length === 2 && v.every(Number.isFinite) ? v : null;
			};
			for (const c of this.controls) {
				const v = Number(q.get(c.key));
				if (q.has(c.key) && Number.isFinite(v))
					this.values[c.key] = Math.min(Math.max(v, c.lo), c.hi);
			}
			const orbit = pair("orbit"), gaze = pair("gaze"), light = Number(q.get("light"));
			if (orbit)
				this.orbit = [Math.max(-Math.PI, Math.min(Math.PI, orbit[0] * Math.PI / 180)), Math.max(-1.2, Math.min(1.2, orbit[1] * Math.PI / 180))];
			if (gaze) {
				this.set_follow("typed");
				this.eyes.target = gaze.map(v => Math.min(45, Math.max(-45, v)));
				this.eyes.eye = [...this.eyes.target];
				this.eyes.last = [...this.eyes.target];
				this.typed.forEach((input, k) => { input.value = this.eyes.target[k]; });
			}
			const mode = q.get("view");
			if (mode && this.modes.some(m => m.mode === mode))
				this.set_mode(mode);
			if (!this.beside && Number.isInteger(light) && light > 0 && light < this.eye.lights.length)
				this.set_light(light);
			for (const c of this.controls)
				c.update && c.update();
			this.lines();
		}

		/* ---- drawing: only when something has changed; then finer and finer */
		changed() {
			if (this.scene)
				this.scene.restart();
			this.rested = 0;
			this.wake();
		}

		wake() {
			if (!this.awake) {
				this.awake = true;
				requestAnimationFrame(t => this.tick(t));
			}
		}

		/* A recorded clip or a cut-scene, over and over; null: live again. */
		play(i) {
			this.playing = i;
			this.began = null;
			this.players.forEach((b, k) => b.setAttribute("aria-pressed", k === i));
			this.eyes.time = null;
			this.eyes.now = null;
			this.eyes.pending = null;
			if (i !== null)
				this.set_mode("face");
			this.changed();
		}

		/* The clip's gaze and lids at time t, between its frames. */
		clip_at(t) {
			const rows = data.face.clips[this.playing].rows, last = rows[rows.length - 1][0];
			this.began = this.began === null ? t : this.began;
			const at = last > 0 ? (t - this.began) % (last + 0.5) : 0;
			let i = 0, j = rows.length - 1;
			while (j - i > 1) {
				const k = i + j >> 1;
				if (rows[k][0] <= at)
					i = k;
				else
					j = k;
			}
			const a = rows[i], b = rows[j], u = b[0] > a[0] ? Math.min(1, Math.max(0, (at - a[0]) / (b[0] - a[0]))) : 0;
			const v = [1, 2, 3].map(k => a[k] + u * (b[k] - a[k]));
			this.eyes.eye = [v[0], v[1]];
			this.eyes.target = [v[0], v[1]];
			this.eyes.drift = [0, 0];
			this.eyes.closure = 0;
			this.clip_open = v[2];
		}

		wander(t) {
			if (!(t < this.wander_until)) {
				this.wander_until = t + 0.6 + 1.8 * Math.random();
				this.eyes.target = [(Math.random() - 0.5) * 44, (Math.random() - 0.5) * 24];
			}
		}

		size(scale) {
			const frame = by_id("frame"), stage = by_id("stage"), p = this.eye.photo;
			const room = stage.getBoundingClientRect();
			let w = room.width, h = room.height;
			if (this.beside && p) {
				const k = Math.min(w / p.width, h / p.height);
				w = p.width * k;
				h = p.height * k;
			}
			frame.style.width = `${w}px`;
			frame.style.height = `${h}px`;
			const dense = Math.min(devicePixelRatio || 1, 2) * scale, most = 2048 / Math.max(w * dense, h * dense, 1);
			return [w, h].map(v => Math.max(16, Math.round(v * dense * Math.min(1, most))));
		}

		draw(preset) {
			const canvas = by_id("view"), [w, h] = this.size(preset.scale);
			if (canvas.width !== w || canvas.height !== h) {
				canvas.width = w;
				canvas.height = h;
			}
			this.scene.resize(w, h);
			const n = this.scene.count, halton = (i, b) => {
				let f = 1, r = 0;
				for (; i > 0; i = Math.floor(i / b))
					r += (f /= b) * (i % b);
				return r;
			};
			const jitter = n ? [halton(n, 2) - 0.5, halton(n, 3) - 0.5] : [0, 0];
			this.scene.add(this.state(), { ...this.view(), closure: this.eyes.closure }, preset, jitter);
			this.scene.show(w, h, this.beside ? 1 : this.mode === "face" ? data.face.gain : this.eye.eye.exposure, false);
		}

		/* How long a picture takes, from asking for it until the driver says it is done. */
		watch(counts) {
			const gl = this.graphics.gl, begin = performance.now(), fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
			gl.flush();
			this.busy = true;
			const ask = () => {
				const status = gl.clientWaitSync(fence, 0, 0);
				if (status === gl.TIMEOUT_EXPIRED && performance.now() - begin < 20000) {
					setTimeout(ask, 1);
					return;
				}
				gl.deleteSync(fence);
				this.busy = false;
				if (counts && this.warm)
					this.took(performance.now() - begin);
				this.warm = true;  // the first picture waits for the driver's compiler
			};
			setTimeout(ask, 0);
		}

		/* Too slow for a while, or far too slow once: a cheaper preset. */
		took(ms) {
			this.times.push(ms);
			if (this.times.length > 24)
				this.times.shift();
			const sorted = [...this.times].sort((a, b) => a - b);
			this.frame_ms = sorted[sorted.length >> 1];
			if (this.automatic && this.preset + 1 < presets.length && (ms > 250 || this.times.length > 5 && this.frame_ms > 40)) {
				this.preset++;
				this.times = [];
				said(`Quality lowered to ${presets[this.preset].name}: a frame took ${ms.toFixed(0)} ms`);
			}
			by_id("time").textContent = `${this.frame_ms.toFixed(1)} ms a frame, ${presets[this.preset].name} quality while moving`;
		}

		tick(t) {
			const now = t / 1000;
			this.awake = true;
			if (this.busy) {
				requestAnimationFrame(u => this.tick(u));
				return;
			}
			if (this.follow === "wander")
				this.wander(now);
			if (this.playing !== null)
				this.clip_at(now);
			const moves = this.playing !== null || !this.beside && this.eyes.step(now);
			const settled = Math.hypot(this.eyes.target[0] - this.eyes.eye[0], this.eyes.target[1] - this.eyes.eye[1]) < this.eyes.conf.saccade_threshold_deg;
			const slow = this.frame_ms > 40 || this.preset > 1, finest = slow ? 4 : 16;
			if (moves || this.rested === 0) {
				this.scene.restart();
				this.draw(presets[this.preset]);
				this.watch(true);
				this.rested = 1;
				this.rest_from = t;
			} else if (t - this.rest_from > (slow ? 350 : 60) && this.scene.count <= finest) {
				if (this.stilled !== this.rest_from) {
					this.scene.restart();
					this.stilled = this.rest_from;
				}
				if (this.scene.count < finest) {
					this.draw(presets[0]);
					this.watch(false);
				}
			}
			const idle = settled && this.scene.count >= finest && this.follow !== "wander" && (this.eyes.still || this.beside || !this.scene.has_lids);
			this.awake = false;
			if (idle)
				document.documentElement.dataset.settled = "1";
			else {
				delete document.documentElement.dataset.settled;
				this.awake = true;
				requestAnimationFrame(u => this.tick(u));
			}
		}

		/* ---- hands */
		listen() {
			const canvas = by_id("view");
			let drag = null;
			canvas.addEventListener("pointerdown", e => {
				drag = { x: e.clientX, y: e.clientY, orbit: [...this.orbit], moved: false };
				canvas.setPointerCapture(e.pointerId);
			});
			canvas.addEventListener("pointermove", e => {
				const box = canvas.getBoundingClientRect();
				if (drag) {
					const dx = e.clientX - drag.x, dy = e.clientY - drag.y;
					drag.moved = drag.moved || Math.hypot(dx, dy) > 4;
					if (!drag.moved || this.beside)
						return;
					this.orbit = [drag.orbit[0] + 3 * dx / box.height, Math.max(-1.2, Math.min(1.2, drag.orbit[1] - 3 * dy / box.height))];
					this.changed();
				} else if (this.follow === "pointer" && !this.beside) {
					this.look_at(e, box);
				}
			});
			const end = e => {
				if (drag && !drag.moved && this.follow === "pointer" && e.type === "pointerup")
					this.look_at(e, canvas.getBoundingClientRect());
				if (drag && drag.moved)
					this.to_hash();
				drag = null;
			};
			canvas.addEventListener("pointerup", end);
			canvas.addEventListener("pointercancel", end);
			canvas.addEventListener("wheel", e => {
				e.preventDefault();
				if (!this.beside)
					this.set("field", this.values.field * Math.exp(e.deltaY / 900), true);
			}, { passive: false });
			canvas.addEventListener("keydown", e => this.key(e));
			by_id("wipe").addEventListener("input", e => by_id("frame").style.setProperty("--at", `${e.target.value}%`));
			new ResizeObserver(() => this.changed()).observe(by_id("stage"));
			addEventListener("hashchange", () => { this.from_hash(); this.changed(); });
			canvas.addEventListener("webglcontextlost", e => { e.preventDefault(); give_up("the graphics driver was lost; load the page again"); });
		}

		look_at(e, box) {
			const x = (e.clientX - box.left) / box.height - 0.5 * box.width / box.height, y = (e.clientY - box.top) / box.height - 0.5;
			this.eyes.target = [Math.max(-40, Math.min(40, 60 * x)), Math.max(-30, Math.min(30, -60 * y))];
			this.wake();
		}

		key(e) {
			const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[e.key];
			if (step && e.shiftKey)
				this.orbit = [this.orbit[0] + 0.1 * step[0], Math.max(-1.2, Math.min(1.2, this.orbit[1] + 0.1 * step[1]))];
			else if (step) {
				this.set_follow("typed");
				this.eyes.target = this.eyes.target.map((v, k) => Math.min(45, Math.max(-45, Math.round(v + 2 * step[k]))));
				this.typed.forEach((input, k) => { input.value = this.eyes.target[k]; });
				said(`Looks ${this.eyes.target[0]} degrees to the person's left, ${this.eyes.target[1]} up`);
			} else if (e.key === "+" || e.key === "=" || e.key === "-")
				this.set("field", this.values.field * (e.key === "-" ? 1.1 : 1 / 1.1));
			else if (e.key === "b" || e.key === "B")
				this.blink();
			else if (e.key === "0")
				this.reset();
			else
				return;
			e.preventDefault();
			this.to_hash();
			this.changed();
		}
	}

	async function start() {
		const canvas = by_id("view"), shaders = {};
		for (const name of ["look", "common", "decode", "paths", "eye", "present", "skin", "skin_vert", "copy"])
			shaders[name] = by_id(`shader-${name}`).textContent;
		try {
			if (!data.eyes.length)
				throw new Error("no eye of this folder has been fitted");
			const page = new Page(new Graphics(canvas, shaders));
			window.eyewright = page;
			const wanted = Number(new URLSearchParams(location.hash.slice(1)).get("eye"));
			await page.open(Number.isInteger(wanted) && wanted > 0 && wanted < data.eyes.length ? wanted : 0);
			page.listen();
			document.documentElement.dataset.open = "1";
		} catch (e) {
			give_up(e.message);
		}
	}
	start();
})();

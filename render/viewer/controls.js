/* Controls. */
function element(tag, attributes, ...children) {
	const out = document.createElement(tag);
	for (const [key, value] of Object.entries(attributes || {}))
		key in out && key !== "list" ? out[key] = value : out.setAttribute(key, value);
	out.append(...children);
	return out;
}

class Controls extends Address {
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
			for (const c of list)
				if (!c.lids || this.scene.has_lids)
					set.append(this.slider(c));
			box.append(set);
		}
		box.append(this.keeping(), this.machine(), this.tools());
		this.show_controls();
	}

	/* Only what changes the view that is shown. */
	show_controls() {
		const shown = { lids: this.mode === "face", gaze: !this.beside, alone: !this.beside };
		for (const e of document.querySelectorAll("#controls [data-of]"))
			e.hidden = !shown[e.dataset.of];
		for (const set of document.querySelectorAll("#controls fieldset"))
			if (set.querySelector(".row"))
				set.hidden = ![...set.querySelectorAll(".row")].some(row => !row.hidden);
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
		const lids = [this.button("Blink", () => this.blink()), ...["left", "right"].map((side, k) => this.button(`Wink ${side}`, () => this.wink(k)))];
		lids.forEach(b => { b.dataset.of = "lids"; });
		this.players = (this.face && data.face.clips || []).map((clip, i) => this.button(`▶ ${clip.name}`, () => this.play(this.playing === i ? null : i), false));
		const set = element("fieldset", {}, element("legend", { textContent: "Gaze" }), element("div", { className: "buttons", role: "group", ariaLabel: "What the eye follows" }, ...this.following, ...(this.scene.has_lids ? lids : []), ...this.players),
			element("div", { className: "numbers" }, number("To the person's left, degrees", 0), number("Up, degrees", 1)));
		set.dataset.of = "gaze";
		if (this.face) {
			const [right, left, down, up] = data.face.looked.map(v => `${Math.abs(v).toFixed(0)}°`), note = element("p", { className: "note", textContent: `The video shows gazes to ${left} left and ${right} right, ${up} up and ${down} down; further out lids follow only a little more.` });
			note.dataset.of = "lids";
			set.append(note);
		}
		return set;
	}

	light_choice() {
		const file = element("input", { type: "file", accept: ".hdr,.exr", hidden: true, ariaLabel: "Surroundings from a file" });
		file.addEventListener("change", () => { this.open_surroundings(file.files[0]); file.value = ""; });
		this.light_buttons = this.eye.lights.map((l, i) => this.button(l.name, () => { this.set_light(i); this.to_hash(); }, i === this.light));
		const open = this.button("Open…", () => file.click());
		open.title = "Surroundings from a file: latitude and longitude, Radiance HDR or OpenEXR; or drop it on the picture";
		return element("div", { className: "buttons", role: "group", ariaLabel: "Surroundings" }, ...this.light_buttons, open, file);
	}

	/* The eye stands in the surroundings of a file. It stays on this machine. */
	async open_surroundings(file) {
		if (!file)
			return;
		by_id("busy").textContent = "Opening…";
		try {
			const light = panorama.made(await panorama.read(file), file.name.replace(/\.[^.]*$/, ""), this.eye.lights[0], this.eye.constants.wet_lobe);
			light.sharp_map = this.graphics.light(light.sharp);
			light.rough_map = this.graphics.light(light.rough);
			const scenes = [this.scene, ...Object.values(this.others || {})];
			for (const list of new Set([...data.eyes.map(e => e.lights), ...scenes.map(s => s.lights)])) {
				const at = list.findIndex(l => l.opened);
				list.splice(at < 0 ? list.length : at, 1, light);
			}
			for (const s of scenes)
				s.solved = {};
			this.build();
			this.set_light(this.eye.lights.indexOf(light));
			said(`Surroundings: ${light.name}`);
			by_id("busy").textContent = "";
		} catch (e) {
			by_id("busy").textContent = `${file.name}: ${e.message}`;
		}
	}

	slider(c) {
		const id = `s-${c.key}`, power = c.power || 1, t_of = v => Math.pow(Math.min(Math.max((v - c.lo) / (c.hi - c.lo), 0), 1), 1 / power);
		const input = element("input", { type: "range", id, min: 0, max: 1000, step: 1 }), output = element("output", { htmlFor: id });
		const reset = this.button("↺", () => { this.set(c.key, c.value); input.focus(); });
		reset.className = "reset";
		reset.setAttribute("aria-label", `${c.label}: back to ${c.show(c.value)}`);
		reset.title = "Back";
		const at = t => `calc(${t} * (100% - 16px) + 8px)`, track = element("span", { className: "track" });
		const ends = c.band || (c.sigma ? [c.value - c.sigma, c.value + c.sigma] : null);
		if (ends) {
			const [a, b] = ends.map(t_of), band = element("span", { className: "sigma" });
			band.style.left = at(a);
			band.style.width = `calc(${Math.max(b - a, 0.005)} * (100% - 16px))`;
			track.append(band);
		}
		const tick = element("span", { className: "fit" });
		tick.style.left = at(t_of(c.value));
		track.append(tick, input);
		const origin = `${c.from}: ${c.show(c.value)}${c.sigma ? ` ± ${(c.show_sigma || c.show)(c.sigma)}` : ""}`, fitted = element("span", { className: "fitted", textContent: c.why ? `${origin}, ${c.why}` : origin });
		const row = element("div", { className: "row" }, element("label", { htmlFor: id, textContent: c.label }), output, reset, track, fitted);
		if (c.lids || c.alone || c.key === "field")
			row.dataset.of = c.lids ? "lids" : c.alone ? "alone" : "gaze";
		row.title = origin[0].toUpperCase() + origin.slice(1);
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
		this.keep_box = element("fieldset", { hidden: true }, element("legend", { textContent: "Keep" }), element("p", { className: "note" }, element("label", { htmlFor: "lines", textContent: "Keep these values: put the lines into capture.conf and run make again." })), this.kept, element("div", { className: "buttons" }, copy));
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
		const clock = this.button("Time the graphics processor", () => {
			this.times_gpu = !this.times_gpu;
			this.gpu_times = [];
			this.gpu_ms = undefined;
			clock.setAttribute("aria-pressed", this.times_gpu);
			this.show_time();
			this.changed();
		}, !!this.times_gpu);
		clock.disabled = !this.graphics.timer;
		clock.title = clock.disabled ? "This browser does not tell how long its graphics processor takes" : "Shown beside the time of a frame";
		return element("fieldset", {}, element("legend", { textContent: "Page" }), element("div", { className: "row" }, element("label", { htmlFor: "quality", textContent: "Quality while moving" }), quality),
			element("div", { className: "buttons" }, copy, clock, this.button("Reset all", () => this.reset())));
	}

	reset() {
		for (const c of this.controls)
			this.values[c.key] = c.value;
		if (this.playing !== null)
			this.play(null);
		this.orbit = [0, 0];
		this.pan = [0, 0];
		this.eyes.target = [0, 0];
		this.typed.forEach(input => { input.value = 0; });
		this.set_light(this.own_light());
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
		by_id("frame").classList.toggle("beside", on);
		photo.hidden = by_id("bar").hidden = by_id("wipe-box").hidden = !on;
		if (on !== was)
			this.set_light(this.own_light());
		this.show_controls();
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

	/* side: left 0, right 1. */
	wink(side) {
		if (this.playing !== null)
			this.play(null);
		this.eyes.wink_now(performance.now() / 1000, side);
		this.wake();
	}
}

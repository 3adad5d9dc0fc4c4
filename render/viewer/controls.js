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
					this.lines();
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
			const [right, left, down, up] = data.face.looked.map(v => `${Math.abs(v).toFixed(0)}°`), note = element("p", { className: "note", textContent: `The video shows gazes to ${left} left and ${right} right, ${up} up and ${down} down; further out upper lids go with the eye, all else follows only a little more.` });
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
			light.file = file.name;
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
		const origin = `${c.from}: ${c.show(c.value)}${c.sigma ? ` ± ${(c.show_sigma || c.show)(c.sigma)}` : ""}`, fitted = element("span", { className: "fitted", textContent: [c.why ? `${origin}, ${c.why}` : origin, ...(c.keep || c.pigment ? [] : ["looked at only, no key keeps it"])].join("; ") });
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
		this.keep_lines = element("div", {}, element("p", { className: "note" }, element("label", { htmlFor: "lines", textContent: "Keep these values: put the lines into capture.conf and run make again." })), this.kept, element("div", { className: "buttons" }, copy));
		this.keep_note = element("p", { className: "note", id: "not-kept" });
		this.keep_box = element("fieldset", { hidden: true }, element("legend", { textContent: "Keep" }), this.keep_lines, this.keep_note);
		return this.keep_box;
	}

	moved(c) {
		return Math.abs(this.values[c.key] - c.value) > 1e-9;
	}

	/* capture.conf lines for what was moved: a narrow prior holds a pigment where it was put. What no key keeps is named. */
	lines() {
		const v = this.state(), out = [], only = [], notes = [], moved = key => this.moved(this.controls.find(c => c.key === key));
		for (const layer of ["abl", "stroma"])
			if (moved(layer + "_eu") || moved(layer + "_pheo")) {
				out.push(`pigment.prior_${layer}_melanin = ${plain(Math.max(v[layer + "_melanin"], 1e-4), 4)} 0.01`);
				out.push(`pigment.prior_${layer}_ratio = ${v[layer + "_ratio"].toFixed(4)} 0.005`);
			}
		if (moved("thickness_scale"))
			out.push(`pigment.prior_scale = ${v.thickness_scale.toFixed(4)} 0.01`);
		for (const c of this.controls.filter(o => !o.pigment && this.moved(o))) {
			const line = c.keep ? c.keep(this.values[c.key], this) : null, value = line && Math.min(Math.max(line.value, line.lo), line.hi);
			if (!line) {
				only.push(c.label);
				continue;
			}
			out.push(`${line.key} = ${plain(value, 6)}`);
			if (value !== line.value)
				notes.push(`${line.key} goes from ${line.lo} to ${line.hi}: its line has the nearest.`);
		}
		this.keep_gaze(out);
		this.keep_light(out, only, notes);
		if (only.length)
			notes.unshift(`Looked at only, no key of capture.conf keeps it: ${only.join(", ")}.`);
		this.kept.value = out.join("\n");
		this.keep_note.textContent = notes.join(" ");
		this.keep_lines.hidden = !out.length;
		this.keep_note.hidden = !notes.length;
		this.keep_box.hidden = !out.length && !notes.length;
	}

	/* Where a typed gaze looks: of a face in its still, of an eye alone in its three-quarter view. */
	keep_gaze(out) {
		const target = this.eyes.target;
		if (this.follow === "typed" && !this.beside && target.some(a => a))
			out.push(`${this.mode === "face" ? "render.gaze" : "render.three_quarter_deg"} = ${target.map(a => plain(a, 4)).join(" ")}`);
	}

	/* Surroundings of the stills are a file of the capture. */
	keep_light(out, only, notes) {
		const light = this.eye.lights[this.light] || {}, name = light.file;
		if (this.light === this.own_light())
			return;
		if (!name)
			only.push(`Surroundings: ${light.name}`);
		else if (!/\.exr$/i.test(name))
			notes.push(`Surroundings of ${name}: render.environment takes OpenEXR only.`);
		else if (!/^[\w.-]+$/.test(name) || name.startsWith("."))
			notes.push(`Surroundings of ${name}: to be kept the file needs a name of letters, digits, - and _ alone.`);
		else {
			out.push(`render.environment = ${name}`);
			notes.push(`Copy ${name} into the capture's folder, too.`);
		}
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
		this.lines();
		["pointer", "typed", "wander"].forEach((m, i) => this.following[i].setAttribute("aria-pressed", m === mode));
		this.wake();
	}

	set_light(i) {
		this.light = i;
		this.light_buttons.forEach((b, k) => b.setAttribute("aria-pressed", k === i));
		this.lines();
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
		this.lines();
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

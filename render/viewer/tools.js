/* What a tool has: undo and redo, two settings side by side, presets, pictures and films to keep, the whole screen. The address tells
 * all of a view (address.js): what is done and undone are addresses. */
class Tools extends Controls {
	static LONGEST = 3840;   // of a saved picture, px
	static PRESETS = [
		["As fitted", {}], ["Close", { field: 12 }], ["Bright sun", { pupil: 1.1, light_gain: 1.6 }], ["Evening", { pupil: 3.2, light_gain: 0.5, exposure: 0.5 }],
		["Tired", { aperture: 0.7, tear: 1.5 }], ["Wide awake", { aperture: 1.25 }],
	];

	tools() {
		this.done = [location.hash];
		this.at = 0;
		this.slots = [location.hash, location.hash];
		this.slot = 0;
		this.undoing = [this.button("Undo", () => this.step(-1)), this.button("Redo", () => this.step(1))];
		this.slot_buttons = ["A", "B"].map((name, i) => this.button(`Setting ${name}`, () => this.swap(i), i === this.slot));
		const group = (name, ...list) => element("div", { className: "buttons", role: "group", ariaLabel: name }, ...list);
		const set = element("fieldset", {}, element("legend", { textContent: "Tools" }),
			group("Undo and redo", ...this.undoing, ...this.slot_buttons),
			group("Presets", ...Tools.PRESETS.map(([name, values]) => this.button(name, () => this.preset_to(name, values)))),
			group("Keep", this.button("Save picture", () => this.save_picture(0)), this.button("Save picture, 4k", () => this.save_picture(Tools.LONGEST)),
				this.button("Save turntable", () => this.save_turntable()), ...(this.carried() ? [this.button("Save .glb as set", () => this.save_glb())] : []), this.button("Full screen", () => this.full_screen())), ...(this.carried() ? [] : [element("p", { className: "note", id: "no-glb", textContent: this.why_not_carried() })]));
		this.show_steps();
		return set;
	}

	/* Why there is no .glb to be saved as set. */
	why_not_carried() {
		const { file, mib, most } = data.left;
		if (file)
			return `No "Save .glb as set" here: ${file} has ${mib.toFixed(1)} MiB, and this page carries files of ${plain(most, 3)} MiB at most (render.page_glb_mib). The file itself stands in the capture's folder, its face at rest.`;
		return data.face ? "No \"Save .glb as set\" here: this character's .glb has not been made." : "No \"Save .glb as set\" here: the eye has not been exported (export.make = yes in capture.conf, or quality = review, does).";
	}

	/* ---- back and forth */
	to_hash() {
		super.to_hash();
		if (!this.done || this.stepping)
			return;
		clearTimeout(this.pause);
		this.pause = setTimeout(() => this.remember(), 400);  // a slider that is dragged is one step
	}

	remember() {
		clearTimeout(this.pause);
		if (location.hash === this.done[this.at])
			return;
		this.done = [...this.done.slice(Math.max(0, this.at - 200), this.at + 1), location.hash];
		this.at = this.done.length - 1;
		this.show_steps();
	}

	go(hash) {
		this.stepping = true;
		history.replaceState(null, "", hash || location.pathname + location.search);
		this.from_hash();
		this.changed();
		this.stepping = false;
	}

	step(by) {
		this.remember();
		const to = this.at + by;
		if (!(to in this.done))
			return;
		this.at = to;
		this.go(this.done[to]);
		this.show_steps();
		said(by < 0 ? "Undone" : "Done again");
	}

	show_steps() {
		this.undoing.forEach((b, i) => { b.disabled = !((i ? this.at + 1 : this.at - 1) in this.done); });
	}

	/* The other of two settings, as it was left. */
	swap(i) {
		this.slots[this.slot] = location.hash;
		this.slot = i;
		this.slot_buttons.forEach((b, k) => b.setAttribute("aria-pressed", k === i));
		this.go(this.slots[i]);
		this.remember();
		said(`Setting ${"AB"[i]}`);
	}

	preset_to(name, values) {
		for (const c of this.controls) {
			this.values[c.key] = c.key in values ? Math.min(Math.max(values[c.key], c.lo), c.hi) : c.value;
			c.update && c.update();
		}
		this.lines();
		this.to_hash();
		this.changed();
		said(name);
	}

	/* ---- to keep */
	static download(blob, name) {
		const link = element("a", { href: URL.createObjectURL(blob), download: name });
		link.click();
		setTimeout(() => URL.revokeObjectURL(link.href), 10000);
	}

	/* longest: px of its longer side; 0: as it stands on the screen. Returns the picture, a PNG: the pose of this moment, as fine as a
	 * picture at rest. */
	async picture(longest) {
		this.longest = longest;
		this.scene.restart();
		for (let i = 0; i < (this.graphics.software ? 4 : 16); i++)
			this.draw(presets[0]);
		const kept = new Promise(done => by_id("view").toBlob(done, "image/png"));
		this.longest = 0;
		this.changed();
		return kept;
	}

	async save_picture(longest) {
		by_id("busy").textContent = "Drawing…";
		Tools.download(await this.picture(longest), "eyewright.png");
		by_id("busy").textContent = "";
		said("Picture saved");
	}

	/* Once round in six seconds. */
	save_turntable() {
		const stream = by_id("view").captureStream(30), film = new MediaRecorder(stream, { videoBitsPerSecond: 16e6 }), pieces = [], from = [...this.orbit], began = performance.now();
		film.ondataavailable = e => pieces.push(e.data);
		film.onstop = () => Tools.download(new Blob(pieces, { type: film.mimeType }), "eyewright.webm");
		film.start();
		const turn = () => {
			const t = (performance.now() - began) / 6000;
			this.orbit = [from[0] + 0.6 * Math.sin(2 * Math.PI * t), from[1]];
			this.changed();
			if (t < 1)
				requestAnimationFrame(turn);
			else {
				film.stop();
				this.orbit = from;
				this.changed();
				said("Film saved");
			}
		};
		turn();
	}

	async full_screen() {
		if (document.fullscreenElement)
			await document.exitFullscreen();
		else
			await by_id("stage").requestFullscreen();
	}
}

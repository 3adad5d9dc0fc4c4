/* The page: what it opens with, pointer and keys. */
class Page extends Live {
	constructor(graphics) {
		super();
		this.graphics = graphics;
		this.eyes = new motion.Eyes(motion.configuration(data.motion));
		this.preset = graphics.software ? presets.length - 1 : 0;  // a processor shows the first picture sooner so
		graphics.first = presets[this.preset];
		this.automatic = true;
		this.times = [];
		this.orbit = [0, 0];
		this.pan = [0, 0];  // of the picture, in its heights: right, down
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
		// Programs first: they compile while maps are decoded.
		if (data.face && !this.face) {
			await FaceScene.unpack(data.face);
			this.face = new FaceScene(this.graphics, data.face);
		} else if (!data.face) {
			this.scene.start();
		}
		await Promise.all([this.scene.load(), this.face ? this.face.load() : null]);
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

	/* ---- hands */
	listen() {
		const canvas = by_id("view"), fingers = new Map();  // where each pointer that is down stands
		const two = () => [...fingers.values()], apart = () => fingers.size > 1 ? Math.hypot(...[0, 1].map(k => two()[0][k] - two()[1][k])) : 0;
		const middle = () => [0, 1].map(k => (two()[0][k] + two()[1][k]) / 2);
		let drag = null;
		canvas.addEventListener("pointerdown", e => {
			fingers.set(e.pointerId, [e.clientX, e.clientY]);
			canvas.setPointerCapture(e.pointerId);
			if (this.beside)
				this.wipe_to(e, canvas.getBoundingClientRect());
			drag = { x: e.clientX, y: e.clientY, orbit: [...this.orbit], pan: [...this.pan], pans: e.button > 0 || e.altKey, moved: fingers.size > 1, apart: this.beside ? 0 : apart(), field: this.values.field };
			if (drag.apart > 0)
				[drag.x, drag.y] = middle();
		});
		canvas.addEventListener("pointermove", e => {
			const box = canvas.getBoundingClientRect();
			if (fingers.has(e.pointerId))
				fingers.set(e.pointerId, [e.clientX, e.clientY]);
			if (drag && this.beside)
				this.wipe_to(e, box);
			else if (drag && drag.apart > 0) {
				if (apart() > 0) {
					const [x, y] = middle();
					this.pan_to([drag.pan[0] + (x - drag.x) / box.height, drag.pan[1] + (y - drag.y) / box.height]);
					this.set("field", drag.field * drag.apart / apart(), true);
				}
			} else if (drag) {
				const dx = e.clientX - drag.x, dy = e.clientY - drag.y;
				drag.moved = drag.moved || Math.hypot(dx, dy) > 4;
				if (!drag.moved)
					return;
				if (drag.pans)
					this.pan_to([drag.pan[0] + dx / box.height, drag.pan[1] + dy / box.height]);
				else
					this.orbit = [drag.orbit[0] + 3 * dx / box.height, Math.max(-1.2, Math.min(1.2, drag.orbit[1] - 3 * dy / box.height))];
				this.changed();
			} else if (this.follow === "pointer" && !this.beside) {
				this.look_at(e, box);
			}
		});
		const end = e => {
			fingers.delete(e.pointerId);
			if (!drag || fingers.size)
				return;  // the finger that is left does not turn what two have zoomed
			if (!drag.moved && this.follow === "pointer" && !this.beside && e.type === "pointerup")
				this.look_at(e, canvas.getBoundingClientRect());
			if (drag.moved)
				this.to_hash();
			drag = null;
		};
		canvas.addEventListener("contextmenu", e => e.preventDefault());
		canvas.addEventListener("pointerup", end);
		canvas.addEventListener("pointercancel", end);
		canvas.addEventListener("wheel", e => {
			e.preventDefault();
			if (!this.beside)
				this.set("field", this.values.field * Math.exp(e.deltaY / 900), true);
		}, { passive: false });
		const stage = by_id("stage");
		stage.addEventListener("dragover", e => e.preventDefault());
		stage.addEventListener("drop", e => { e.preventDefault(); this.open_surroundings(e.dataTransfer.files[0]); });
		canvas.addEventListener("keydown", e => this.key(e));
		by_id("wipe").addEventListener("input", e => by_id("frame").style.setProperty("--at", `${e.target.value}%`));
		new ResizeObserver(() => this.changed()).observe(by_id("stage"));
		addEventListener("hashchange", () => { this.from_hash(); this.changed(); });
		canvas.addEventListener("webglcontextlost", e => { e.preventDefault(); this.lost = setTimeout(() => give_up("the graphics driver was lost; load the page again"), 15000); });
		// The address has all that was set: the page opens again as it was.
		canvas.addEventListener("webglcontextrestored", () => { clearTimeout(this.lost); location.reload(); });
	}

	/* Never so far that nothing is left in the picture. */
	pan_to(pan) {
		this.pan = pan.map(v => Math.max(-0.6, Math.min(0.6, v)));
	}

	/* The bar between rendering and photograph follows the pointer. */
	wipe_to(e, box) {
		const wipe = by_id("wipe");
		wipe.value = 100 * (e.clientX - box.left) / box.width;
		wipe.dispatchEvent(new Event("input"));
	}

	look_at(e, box) {
		const x = (e.clientX - box.left) / box.height - 0.5 * box.width / box.height, y = (e.clientY - box.top) / box.height - 0.5;
		const [right, left, down, up] = this.range();
		this.eyes.target = [Math.max(right, Math.min(left, 60 * x)), Math.max(down, Math.min(up, -60 * y))];
		this.wake();
	}

	key(e) {
		if ((e.ctrlKey || e.metaKey) && /^[zy]$/i.test(e.key)) {
			e.preventDefault();
			this.step(e.key.toLowerCase() === "y" || e.shiftKey ? 1 : -1);
			return;
		}
		const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[e.key];
		if (step && e.ctrlKey)
			this.pan_to([this.pan[0] + 0.05 * step[0], this.pan[1] - 0.05 * step[1]]);
		else if (step && e.shiftKey)
			this.orbit = [this.orbit[0] + 0.1 * step[0], Math.max(-1.2, Math.min(1.2, this.orbit[1] + 0.1 * step[1]))];
		else if (step) {
			this.set_follow("typed");
			this.eyes.target = this.eyes.target.map((v, k) => Math.min(45, Math.max(-45, Math.round(v + 2 * step[k]))));
			this.typed.forEach((input, k) => { input.value = this.eyes.target[k]; });
			this.lines();
			said(`Looks ${this.eyes.target[0]} degrees to the person's left, ${this.eyes.target[1]} up`);
		} else if (e.key === "+" || e.key === "=" || e.key === "-")
			this.set("field", this.values.field * (e.key === "-" ? 1.1 : 1 / 1.1));
		else if (e.key === "b" || e.key === "B")
			this.blink();
		else if (e.key === "l" || e.key === "L" || e.key === "r" || e.key === "R")
			this.wink(e.key.toLowerCase() === "l" ? 0 : 1);
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
	for (const text of document.querySelectorAll("script[id^=shader-]"))
		shaders[text.id.slice(7)] = text.textContent;
	try {
		if (!data.eyes.length)
			throw new Error("no eye of this folder has been fitted");
		const c = data.eyes[0].constants;
		const page = new Page(new Graphics(graphics_context(canvas), shaders, { LIGHTS: EyeScene.LIGHTS, TILES: EyeScene.LIGHTS + 1, DIRECTIONS: EyeScene.DIRECTIONS, SEARCH: EyeScene.SEARCH, GRID: c.grid, SIDE: c.coarse, BESIDE: c.beside, ...(data.face ? { WIDE: FacePose.WIDE, LIT: FacePose.LIT, PROBE: FaceScene.PROBE } : {}) }));
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

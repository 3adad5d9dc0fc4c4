/* What is drawn when: only what has changed; then finer and finer. */
class Live extends Leaving {
	static BEYOND = 1.3;

	/* ---- state for the shaders */
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
			return { face: this.face, eyes: this.pair, gazes: this.gazes(h, v), closer: this.eye.side === "left" ? 0 : 1, close: Math.min(1, Math.max(0, (30 - this.values.field) / 12)), recorded: this.playing === null ? null : this.clip_controls,
				expressions: this.playing === null ? data.face.expressions.map((e, k) => this.values[`au${k}`]) : this.clip_controls.slice(10),
				open: this.lids(), orbit: this.orbit, pan: this.pan,
				field: height => this.face.field * height / this.scene.target.width * this.values.field / 30 };
		return { yaw: h * rad, pitch: v * rad, orbit: this.orbit, pan: this.pan, field: this.values.field };
	}

	/* How far eyes turn after what they follow, degrees: right, left, down, up. A face's lids are known as far as the video shows them,
	 * and a little further. */
	range() {
		return this.mode === "face" ? data.face.looked.map(v => Live.BEYOND * v) : [-40, 40, -30, 30];
	}

	/* Of either eye, degrees: a clip's own; else both look at one place, so far away. */
	gazes(h, v) {
		if (this.playing !== null)
			return this.clip_gazes;
		return data.face.globes.map(g => [h - Math.atan(g[0] * this.values.near / 1000) * 180 / Math.PI, v]);
	}

	/* How far the left lids are open, and the right ones; 1: as people open them at that gaze, or as a clip has them. */
	lids() {
		const v = this.values, shut = [v.wink_left, v.wink_right];
		return shut.map((s, k) => v.aperture * (1 - s) * (this.playing === null ? 1 - Math.max(this.eyes.closure, this.eyes.winking[k]) : 1));
	}

	/* ---- drawing: only when something has changed; then finer and finer */
	changed() {
		if (this.scene)
			this.scene.restart();
		this.rested = 0;
		delete document.documentElement.dataset.settled;
		this.wake();
	}

	wake() {
		if (!this.awake) {
			this.awake = true;
			requestAnimationFrame(t => this.run(t));
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
		this.to_hash();
		this.changed();
	}

	/* The clip's controls at time t, between its frames. */
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
		const c = a.map((x, k) => x + u * (b[k] - x)).slice(1);
		this.clip_controls = c;
		this.clip_gazes = [c.slice(0, 3), c.slice(5, 8)];
		this.eyes.eye = [(c[0] + c[5]) / 2, (c[1] + c[6]) / 2];
		this.eyes.target = [...this.eyes.eye];
		this.eyes.drift = [0, 0];
		this.eyes.closure = 0;
	}

	wander(t) {
		if (!(t < this.wander_until)) {
			this.wander_until = t + 0.6 + 1.8 * Math.random();
			const [right, left, down, up] = this.range();
			this.eyes.target = [[Math.max(-22, right), Math.min(22, left)], [Math.max(-12, down), Math.min(12, up)]].map(([a, b]) => a + Math.random() * (b - a));
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
		if (this.longest)  // a picture to keep
			return [w, h].map(v => Math.max(16, Math.round(v * this.longest / Math.max(w, h))));
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
		const exposure = this.beside ? 1 : (this.mode === "face" ? data.face.gain : this.eye.eye.exposure) * 2 ** this.values.exposure;
		// In the photograph's own light its colour, beside the photograph its brightness, too.
		const white = this.mode !== "face" && (this.eye.lights[this.light] || {}).white || [1, 1, 1], bright = this.beside ? 1 : 0.2126 * white[0] + 0.7152 * white[1] + 0.0722 * white[2];
		this.scene.show(w, h, white.map(v => exposure * v / bright), false, this.values.tone, this.beside ? 0 : this.values.bloom);
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
			this.first_picture = this.first_picture || performance.now();
			this.warm = true;  // the first picture waits for the driver's compiler
		};
		setTimeout(ask, 0);
	}

	/* Chooses a cheaper preset when pictures were too slow for a while, or far too slow once. */
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
		this.show_time();
	}

	/* The graphics processor's own clock, a median of the last frames. */
	gpu_took(ms) {
		this.gpu_times = [...(this.gpu_times || []), ms].slice(-24);
		this.gpu_ms = [...this.gpu_times].sort((a, b) => a - b)[this.gpu_times.length >> 1];
		this.show_time();
	}

	show_time() {
		const gpu = this.times_gpu && this.gpu_ms !== undefined ? `, ${this.gpu_ms.toFixed(2)} ms of them on the graphics processor` : "";
		by_id("time").textContent = `${(this.frame_ms || 0).toFixed(1)} ms a frame${gpu}, ${presets[this.preset].name} quality while moving`;
	}

	/* A driver may report a shader that it refuses only when it is used. */
	run(t) {
		try {
			this.tick(t);
		} catch (e) {
			give_up(e.message);
			throw e;
		}
	}

	tick(t) {
		const now = t / 1000;
		this.awake = true;
		if (this.busy) {
			requestAnimationFrame(u => this.run(u));
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
			if (this.times_gpu)
				this.graphics.timed(() => this.draw(presets[this.preset]), ms => this.gpu_took(ms));
			else
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
		const idle = settled && this.scene.count >= finest && this.follow !== "wander" && (this.eyes.still && !this.eyes.lids_move(now) || this.beside || !this.scene.has_lids);
		this.awake = false;
		if (idle)
			document.documentElement.dataset.settled = "1";
		else {
			delete document.documentElement.dataset.settled;
			this.awake = true;
			requestAnimationFrame(u => this.run(u));
		}
	}
}

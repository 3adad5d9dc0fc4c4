/* The address (URL fragment) keeps the view: every value that differs from the one the page opens with. */
class Address {
	/* The light a view opens with: beside the photograph the photograph's own. */
	own_light() {
		return this.beside ? Math.max(0, this.eye.lights.findIndex(l => l.photographed)) : 0;
	}

	to_hash() {
		const parts = [];
		for (const c of this.controls)
			if (Math.abs(this.values[c.key] - c.value) > 1e-9)
				parts.push(`${c.key}=${plain(this.values[c.key], 6)}`);
		if (this.orbit[0] || this.orbit[1])
			parts.push(`orbit=${this.orbit.map(v => (v * 180 / Math.PI).toFixed(1)).join(",")}`);
		if (this.pan[0] || this.pan[1])
			parts.push(`pan=${this.pan.map(v => v.toFixed(3)).join(",")}`);
		if (this.follow === "typed")
			parts.push(`gaze=${this.eyes.target.map(v => v.toFixed(1)).join(",")}`);
		if (this.light !== this.own_light() && !this.eye.lights[this.light].opened)  // a file is not in the address
			parts.push(`light=${this.light}`);
		if (this.mode !== (this.face ? "face" : "eye"))
			parts.push(`view=${this.mode}`);
		if (this.index)
			parts.push(`eye=${this.index}`);
		if (this.playing !== null)
			parts.push(`play=${this.playing}`);
		history.replaceState(null, "", parts.length ? `#${parts.join("&")}` : location.pathname + location.search);
	}

	from_hash() {
		const q = new URLSearchParams(location.hash.slice(1)), pair = key => {
			const v = (q.get(key) || "").split(",").map(Number);
			return v.length === 2 && v.every(Number.isFinite) ? v : null;
		};
		for (const c of this.controls) {
			const v = Number(q.get(c.key));
			this.values[c.key] = q.has(c.key) && Number.isFinite(v) ? Math.min(Math.max(v, c.lo), c.hi) : c.value;
		}
		const orbit = pair("orbit") || [0, 0], pan = pair("pan") || [0, 0], gaze = pair("gaze"), light = Number(q.get("light"));
		this.orbit = [Math.max(-Math.PI, Math.min(Math.PI, orbit[0] * Math.PI / 180)), Math.max(-1.2, Math.min(1.2, orbit[1] * Math.PI / 180))];
		this.pan_to(pan);
		if (gaze) {
			this.set_follow("typed");
			this.eyes.target = gaze.map(v => Math.min(45, Math.max(-45, v)));
			this.eyes.eye = [...this.eyes.target];
			this.eyes.last = [...this.eyes.target];
			this.typed.forEach((input, k) => { input.value = this.eyes.target[k]; });
		} else if (this.follow === "typed")
			this.set_follow("pointer");
		const mode = this.modes.some(m => m.mode === q.get("view")) ? q.get("view") : this.face ? "face" : "eye";
		if (mode !== this.mode)
			this.set_mode(mode);
		const clip = Number(q.get("play"));
		if (q.has("play") && this.players[clip] && this.playing !== clip)
			this.play(clip);
		else if (!q.has("play") && this.playing !== null)
			this.play(null);
		if (q.has("light") && Number.isInteger(light) && light >= 0 && light < this.eye.lights.length)
			this.set_light(light);
		for (const c of this.controls)
			c.update && c.update();
		this.lines();
	}
}

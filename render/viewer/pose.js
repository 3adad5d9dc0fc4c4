/* The rig on the page: controls to components, and the passes of pose.glsl that make vertices of them. Positions, normals and
 * light stand in buffers of four floats each, which the skin is drawn from, and in maps of the same, which later passes read. */
class FacePose {
	static WIDE = 1024;
	static LIT = 40;
	static TERMS = 28;
	static PIN = 12;
	static BRIDGE = 12;  // mm over which lids of one eye end at the bridge of the nose
	static HAIR_LIGHT = Math.sqrt(0.8 / 3);

	constructor(g, data) {
		const rig = data.rig, floats = bytes => new Float32Array(bytes.buffer);
		Object.assign(this, { g, data, rig, key: "", n: data.n, base: rig.levels[0][2], posed: rig.levels[0][1] });
		this.rest = floats(rig.rest);
		this.deform = g.feedback("DEFORM", ["at_now", "light_now"]);
		this.normal = g.feedback("NORMAL", ["normal_now"]);
		this.between = g.feedback("BETWEEN", ["at_now", "normal_now", "light_now"]);
		this.hair = g.feedback("HAIR", ["at_now"]);
		for (const name of ["at", "normals", "light"])
			this[name] = this.room();
		this.maps_of_rig();
		this.shapes(floats);
		this.begin();
	}

	/* A buffer of a vec4 for each vertex, and its map. */
	room() {
		const { gl } = this.g, rows = Math.ceil(this.n / FacePose.WIDE), buffer = gl.createBuffer();
		gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
		gl.bufferData(gl.ARRAY_BUFFER, 16 * FacePose.WIDE * rows, gl.DYNAMIC_COPY);
		return { buffer, map: this.g.plain(FacePose.WIDE, rows, gl.RGBA32F) };
	}

	/* Skull, globes, light of all poses. */
	maps_of_rig() {
		const { gl } = this.g, { rig, data, posed } = this, [, , step, w, h] = rig.skull.grid, side = rig.globe.cells + 1;
		const { light } = data, poses = posed ? light.length / 3 / posed : 0, rows = Math.ceil(posed / FacePose.WIDE), padded = new Uint8Array(3 * FacePose.WIDE * rows * poses);
		for (let k = 0; k < poses; k++)
			padded.set(light.subarray(3 * posed * k, 3 * posed * (k + 1)), 3 * FacePose.WIDE * rows * k);
		const lids = data.settle.n, { bytes } = data.settle, deep = Math.max(1, Math.ceil(lids / FacePose.WIDE)), many = lids ? bytes.length / 3 / lids : 1;
		const moved = new Uint8Array(3 * FacePose.WIDE * deep * many);
		for (let k = 0; k < many; k++)
			moved.set(bytes.subarray(3 * lids * k, 3 * lids * (k + 1)), 3 * FacePose.WIDE * deep * k);
		this.maps = { settle_map: this.g.plain(FacePose.WIDE, deep * many, gl.RGB8, gl.RGB, gl.UNSIGNED_BYTE, moved), settle_rows: deep, settle_step: data.settle.step, skull_map: this.g.plain(rig.skull.part[2], rig.skull.part[3], gl.RGB32F, gl.RGB, gl.FLOAT, Graphics.field(rig.skull.mm, rig.skull.part[2], rig.skull.part[3], 3)),
			globe_map: this.g.plain(side, 2 * side, gl.R32F, gl.RED, gl.FLOAT, Graphics.field(rig.globe.mm, side, 2 * side, 1)),
			pose_map: this.g.plain(FacePose.WIDE, Math.max(rows * poses, 1), gl.RGB8, gl.RGB, gl.UNSIGNED_BYTE, padded),
			skull_grid: [rig.skull.grid[0], rig.skull.grid[1], 1 / step], skull_most: [w - 1.001, h - 1.001], skull_part: rig.skull.part, cells: rig.globe.cells,
			globe_center: rig.globe.centers.flat(), lit_rows: rows, outward: rig.head_from_rig.slice(0, 3) };
	}

	/* The attributes of each vertex, in groups of four (or two) floats. */
	shape(list, ...sizes) {
		const { gl } = this.g, stride = 4 * sizes.reduce((a, b) => a + b, 0), shape = gl.createVertexArray();
		gl.bindVertexArray(shape);
		gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
		gl.bufferData(gl.ARRAY_BUFFER, list, gl.STATIC_DRAW);
		sizes.reduce((at, n, k) => {
			gl.enableVertexAttribArray(k);
			gl.vertexAttribPointer(k, n, gl.FLOAT, false, stride, at);
			return at + 4 * n;
		}, 0);
		gl.bindVertexArray(null);
		return shape;
	}

	shapes(floats) {
		const { gl } = this.g, { rig, base } = this, terms = floats(rig.terms), faces = new Uint32Array(rig.ring.buffer);
		for (let i = 0; i < this.posed; i++)
			terms[FacePose.TERMS * i + 7] = this.share(i);
		this.deform.shape = this.shape(terms, 4, 4, 4, 4, 4, 4, 4);
		const ring = new Float32Array(2 * base), at = new Uint32Array(base);
		for (const v of faces)
			ring[2 * v + 1]++;
		for (let i = 0, sum = 0; i < base; sum += ring[2 * i++ + 1])
			ring[2 * i] = at[i] = sum;
		const rows = Math.max(1, Math.ceil(faces.length / FacePose.WIDE)), pairs = new Float32Array(2 * FacePose.WIDE * rows);
		for (let f = 0; f < faces.length; f += 3)
			for (let k = 0; k < 3; k++)
				pairs.set([faces[f + (k + 1) % 3], faces[f + (k + 2) % 3]], 2 * at[faces[f + k]]++);
		this.maps.ring_map = this.g.plain(FacePose.WIDE, rows, gl.RG32F, gl.RG, gl.FLOAT, pairs);
		this.normal.shape = this.shape(ring, 2);
		this.ends = floats(rig.between);
		this.between.shape = this.shape(this.ends, 2);
		const pins = floats(rig.hairs);
		this.hairs = pins.length / FacePose.PIN;
		this.hair.shape = this.shape(pins, 4, 4, 4);
	}

	in_head(x) {
		return turns.apply(this.rig.head_from_rig, x.map((v, k) => v - this.rig.middle[k]));
	}

	/* Share with which a vertex follows the left eye's lids. */
	share(i) {
		return Math.min(1, Math.max(0, 0.5 + this.in_head(this.rest.subarray(3 * i, 3 * i + 3))[0] / FacePose.BRIDGE));
	}

	/* At rest, in the head's axes: of every vertex; hairs know none. */
	rest_in_head() {
		const out = new Float32Array(3 * this.n);
		for (let i = 0; i < this.base; i++)
			out.set(this.in_head([...this.rest.subarray(3 * i, 3 * i + 3)]), 3 * i);
		for (let i = 0; i < this.ends.length / 2; i++)
			for (let c = 0; c < 3; c++)
				out[3 * (this.base + i) + c] = 0.5 * (out[3 * this.ends[2 * i] + c] + out[3 * this.ends[2 * i + 1] + c]);
		return out;
	}

	/* The vertices that never move, once: the rig's own, and all that is made of them. */
	begin() {
		const { gl } = this.g, { n, base, hairs } = this, { still } = this.data, up = turns.apply(turns.transpose(this.rig.head_from_rig), [0, 0, 1]);
		const at = new Float32Array(4 * n), light = new Float32Array(4 * n), normals = new Float32Array(4 * n);
		for (let i = 0; i < base; i++) {
			at.set(this.rest.subarray(3 * i, 3 * i + 3), 4 * i);
			light.set([...still.subarray(3 * i, 3 * i + 3)].map(v => v / 255), 4 * i);
		}
		for (let i = n - hairs; i < n; i++) {
			light.fill(FacePose.HAIR_LIGHT, 4 * i, 4 * i + 3);
			normals.set(up, 4 * i);
		}
		for (const [room, list] of [[this.at, at], [this.light, light], [this.normals, normals]]) {
			gl.bindBuffer(gl.ARRAY_BUFFER, room.buffer);
			gl.bufferSubData(gl.ARRAY_BUFFER, 0, list);
		}
		gl.bindBuffer(gl.ARRAY_BUFFER, null);
		for (const room of [this.at, this.light])
			this.mapped(room, 0, base);
		this.surface(true);
	}

	/* From a buffer into its map: whole rows. */
	mapped(room, first, end) {
		const { gl } = this.g, from = Math.floor(first / FacePose.WIDE), rows = Math.ceil(end / FacePose.WIDE) - from;
		if (rows < 1)
			return;
		gl.bindBuffer(gl.PIXEL_UNPACK_BUFFER, room.buffer);
		gl.bindTexture(gl.TEXTURE_2D, room.map.texture);
		gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, from, FacePose.WIDE, rows, gl.RGBA, gl.FLOAT, 16 * FacePose.WIDE * from);
		gl.bindBuffer(gl.PIXEL_UNPACK_BUFFER, null);
	}

	/* Vertices first .. end of a pass whose own begin at `origin`, into buffers and maps. */
	run(program, values, origin, first, end, rooms) {
		if (end <= first)
			return;
		this.g.feed(program, { ...this.maps, at_map: this.at.map, normal_map: this.normals.map, light_map: this.light.map, first: origin, ...values }, program.shape, first - origin, end - first,
			rooms.map(r => [r.buffer, 16 * first]));
		for (const r of rooms)
			this.mapped(r, first, end);
	}

	/* Normals, what lies between, hairs; all of them or what does not stand still. */
	surface(all) {
		const { rig, base } = this;
		this.run(this.normal, {}, 0, 0, all ? base : this.posed, [this.normals]);
		for (const [first, posed, end] of rig.levels.slice(1))
			this.run(this.between, {}, base, first, all ? end : posed, [this.at, this.normals, this.light]);
		this.run(this.hair, {}, this.n - this.hairs, this.n - this.hairs, this.n, [this.at]);
	}

	/* Normalised aperture of a lid as people have it at a gaze, degrees (eq. 3.11). */
	usual(lid, gaze) {
		const [h, v, one] = this.rig.baseline[lid], known = known_gaze(this.rig.known, lid >> 1, [gaze[0], gaze[1], 0]);
		return h * known[0] + v * known[1] + one;
	}

	/* Adds what the lids of one eye, open by so much of what is usual, do with expressions: lib/model/express.h. */
	express(c, side, open) {
		const { expression_lids, aperture_px } = this.rig, at = 5 * side + 3, px = aperture_px.slice(2 * side, 2 * side + 2), share = Math.min(Math.max(open, 0), 1);
		const sum = a => px[0] * a[0] + px[1] * a[1], add = [0, 1].map(lid => expression_lids.reduce((all, by, k) => all + share * c[10 + k] * by[2 * side + lid], 0));
		const was = sum(c.slice(at, at + 2)), more = sum(add), room = more < 0 ? Math.min(was, 0) - was : Math.max(was, px[0] + px[1]) - was;
		const kept = Math.abs(more) > Math.abs(room) ? room / more : 1;
		add.forEach((a, lid) => { c[at + lid] += kept * a; });
	}

	/* g~ (lib/model/model.h) for eyes that look so and are opened by so much of what is usual there; strengths: of expressions, with which lids go.
	 * recorded: controls that the lids are taken from. */
	controls(gazes, open, strengths, recorded) {
		const c = new Float64Array(this.rig.inputs);
		gazes.forEach((gaze, side) => {
			c.set([gaze[0], gaze[1], gaze[2] || 0], 5 * side);
			for (const k of [0, 1])
				c[5 * side + 3 + k] = open[side] * (recorded ? recorded[5 * side + 3 + k] : this.usual(2 * side + k, gaze));
		});
		this.data.expressions.forEach((_, k) => { c[10 + k] = strengths && strengths[k] || 0; });
		for (const side of recorded ? [] : [0, 1])
			this.express(c, side, open[side]);
		return c;
	}

	/* e = W [g~; 1]. */
	components(controls) {
		const n = controls.length + 1, W = this.rig.W, c = controls.slice();
		for (const side of [0, 1])
			c.set(known_gaze(this.rig.known, side, [...c.subarray(5 * side, 5 * side + 3)]), 5 * side);
		return Array.from({ length: W.length / n }, (_, k) => c.reduce((sum, v, i) => sum + W[n * k + i] * v, W[n * k + n - 1]));
	}

	/* How far the lids of one eye are open, against what is usual with these expressions. */
	opened(c, side) {
		const at = 5 * side + 3, px = this.rig.aperture_px.slice(2 * side, 2 * side + 2), all = px[0] + px[1];
		const sum = c => (px[0] * c[at] + px[1] * c[at + 1]) / all, free = Float64Array.from(c);
		for (const k of [0, 1])
			free[at + k] = this.usual(2 * side + k, [c[5 * side], c[5 * side + 1]]);
		const usual = sum(free);
		this.express(free, side, 1);
		const now = sum(c), open = sum(free);
		return Math.min(1.4, Math.max(0, !(open > 0.05 && usual > 0.05) ? 1 : now > open ? 1 + (now - open) / usual : now / open));
	}

	/* Poses of a grid (of light: the data itself; of lids: data.settle) round these controls and their weights for either side; expressions beside the pose
	 * at rest, as far as the eye is open. */
	lit(c, d = this.data) {
		const opened = [0, 1].map(side => this.opened(c, side)), shown = opened.map(o => Math.min(1, o));
		const [ih, uh] = between(d.h, (c[0] + c[5]) / 2), [iv, uv] = between(d.v, (c[1] + c[6]) / 2), of = new Map();
		const add = (pose, left, right) => {
			const w = of.get(pose) || [0, 0];
			of.set(pose, [w[0] + left, w[1] + right]);
		};
		for (const side of [0, 1]) {
			const [ia, ua] = between(d.a, opened[side]);
			for (let k = 0; k < 8; k++) {
				const w = (k & 1 ? uh : 1 - uh) * (k & 2 ? uv : 1 - uv) * (k & 4 ? ua : 1 - ua);
				if (w > 0)
					add(ih + (k & 1) + d.h.length * (iv + (k >> 1 & 1) + d.v.length * (ia + (k >> 2))), side ? 0 : w, side ? w : 0);
			}
		}
		this.data.expressions.forEach((_, k) => {
			const s = c[10 + k];
			if (s > 0 && of.size < FacePose.LIT - 1) {
				add(d.h.length * d.v.length * d.a.length + k, s * shown[0], s * shown[1]);
				add(d.rest_pose, -s * shown[0], -s * shown[1]);
			}
		});
		return [...of].map(([pose, w]) => [pose, ...w]);
	}

	/* Vertices for eyes that look so, and so on; true where they are not those that stand there. Who winks is no example that
	 * the model has learnt from: each side is as with both eyes opened so. */
	pose(gazes, open, strengths, recorded) {
		const c = this.controls(gazes, open, strengths, recorded), key = c.join();
		if (key === this.key)
			return false;
		const sides = open[0] === open[1] ? [c, c] : open.map(a => this.controls(gazes, [a, a], strengths, recorded));
		const e = sides.flatMap(s => this.components(s)), lit = this.lit(c), settled = this.lit(c, this.data.settle), rad = Math.PI / 180;
		this.posed_as = c;
		this.g.counted("posed");
		const globes = [0, 1].flatMap(side => turns.multiply(turns.transpose(turns.fick(...c.slice(5 * side, 5 * side + 3).map(v => v * rad))), this.rig.head_from_rig));
		this.key = key;
		this.run(this.deform, { component: e, globe_from_rig: globes, lit: EyeScene.padded(lit.flat(), 3 * FacePose.LIT), n_lit: lit.length, settled: EyeScene.padded(settled.flat(), 3 * FacePose.LIT), n_settled: settled.length }, 0, 0, this.posed, [this.at, this.light]);
		this.surface(false);
		return true;
	}

	/* Reads a buffer back, four floats a vertex: for tests. */
	read(room) {
		const { gl } = this.g, out = new Float32Array(4 * this.n);
		gl.bindBuffer(gl.COPY_READ_BUFFER, room.buffer);
		gl.getBufferSubData(gl.COPY_READ_BUFFER, 0, out);
		gl.bindBuffer(gl.COPY_READ_BUFFER, null);
		return out;
	}
}

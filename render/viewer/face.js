/* A driven character: its mesh between the poses that the page carries, its eyes in it. Head's axes, mm. */
class FaceScene {
	static RECORD = 12;
	static DISTANCE = 900;
	static BRIDGE = 12;

	constructor(g, data) {
		const gl = g.gl, bytes = Graphics.bytes;
		Object.assign(this, { g, data, poses: bytes(data.poses), skies: bytes(data.sky), key: "" });
		this.skin(g.first);
		this.eye = g.program("eye", null, ["skin_look", "lids"]);
		this.tear = g.program("tear");
		this.copy = g.program("copy");
		const faces = new Uint32Array(bytes(data.faces).buffer), still = bytes(data.still);
		this.n_indices = faces.length;
		this.values = new Float32Array(9 * data.n);
		for (let i = 0; i < data.n; i++)
			this.put(i, FaceScene.decoded(still, i * FaceScene.RECORD, data.reach));
		const rest = new Float32Array(3 * data.n);
		for (let i = 0; i < data.n; i++)
			rest.set(this.values.subarray(9 * i, 9 * i + 3), 3 * i);
		this.shape = gl.createVertexArray();
		gl.bindVertexArray(this.shape);
		this.buffer = gl.createBuffer();
		gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer);
		gl.bufferData(gl.ARRAY_BUFFER, this.values, gl.DYNAMIC_DRAW);
		for (const k of [0, 1, 2]) {
			gl.enableVertexAttribArray(k);
			gl.vertexAttribPointer(k, 3, gl.FLOAT, false, 36, 12 * k);
		}
		const array = (at, list, n, type, normalised) => {
			gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
			gl.bufferData(gl.ARRAY_BUFFER, list, gl.STATIC_DRAW);
			gl.enableVertexAttribArray(at);
			gl.vertexAttribPointer(at, n, type, normalised, 0, 0);
		};
		array(3, bytes(data.skin), 4, gl.UNSIGNED_BYTE, true);
		array(4, rest, 3, gl.FLOAT, false);
		if (data.folds)
			array(5, new Float32Array(Array.from(new Uint16Array(bytes(data.folds.home).buffer), v => v / 16)), 2, gl.FLOAT, false);
		gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
		gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, faces, gl.STATIC_DRAW);
		gl.bindVertexArray(null);
		// Both eyes and some of what is beside them, mm across.
		this.field = 2.3 * Math.hypot(...[0, 1, 2].map(k => data.globes[0][k] - data.globes[1][k]));
		this.sky_map = g.texture(2 * data.sky_px, data.sky_px, gl.R8);
		this.still = this.values.slice();
		// Lids of one eye end at the bridge of the nose.
		this.left = Float32Array.from({ length: data.moving }, (_, i) => Math.min(1, Math.max(0, 0.5 + this.still[9 * i] / FaceScene.BRIDGE)));
		this.strengths = data.expressions.map(() => 0);
	}

	skin(preset) {
		return this.g.variant(preset.pores, "skin", "skin_vert", this.data.folds ? ["skin_look", "folds"] : ["skin_look"], "pores");
	}

	async load() {
		this.fold_map = this.data.folds ? await this.g.map(this.data.folds.map, 0) : null;
	}

	/* What an expression in full adds to its vertices. */
	expression(k) {
		const e = this.data.expressions[k];
		if (!e.delta) {
			const to = Graphics.bytes(e.to);
			e.at = new Uint32Array(Graphics.bytes(e.index).buffer);
			e.delta = new Float32Array(9 * e.at.length);
			e.at.forEach((v, i) => FaceScene.decoded(to, i * FaceScene.RECORD, this.data.reach).forEach((x, c) => { e.delta[9 * i + c] = x - this.still[9 * v + c]; }));
		}
		return e;
	}

	/* Expressions on top of what gaze and lids have made of the vertices; true where more than those have moved. */
	express(strengths) {
		const d = this.data, out = this.values, before = this.strengths;
		let any = false;
		strengths.forEach((s, k) => {
			if (s > 0 || before[k] > 0) {
				any = true;
				for (const v of this.expression(k).at)
					if (v >= d.moving)
						out.set(this.still.subarray(9 * v, 9 * v + 9), 9 * v);
			}
		});
		strengths.forEach((s, k) => {
			if (s > 0) {
				const { at, delta } = this.expression(k);
				for (let i = 0; i < at.length; i++)
					for (let c = 0, o = 9 * at[i]; c < 9; c++)
						out[o + c] += s * delta[9 * i + c];
			}
		});
		this.strengths = [...strengths];
		return any;
	}

	/* Of the skin's shader, where the model folds. */
	folds() {
		const f = this.data.folds, of = f ? f.follows.map(k => Math.min(1, this.strengths[k])) : [];
		return f ? { fold_map: this.fold_map, folds: of.length, fold_strength: EyeScene.padded(of, EyeScene.LIGHTS), fold_size: f.size, fold_scale: [f.subject_mm, f.px] } : {};
	}

	static decoded(b, at, reach) {
		const x = k => ((b[at + 2 * k] + 256 * b[at + 2 * k + 1]) / 65535 - 0.5) * 2 * reach;
		return [x(0), x(1), x(2), b[at + 6] / 127.5 - 1, b[at + 7] / 127.5 - 1, b[at + 8] / 127.5 - 1, b[at + 9] / 255, b[at + 10] / 255, b[at + 11] / 255];
	}

	put(i, v) {
		this.values.set(v, 9 * i);
	}

	/* The eight poses round these controls and their weights. */
	mixture(h, v, a) {
		const d = this.data, [ih, uh] = between(d.h, h), [iv, uv] = between(d.v, v), [ia, ua] = between(d.a, a), out = [];
		for (let k = 0; k < 8; k++) {
			const w = (k & 1 ? uh : 1 - uh) * (k & 2 ? uv : 1 - uv) * (k & 4 ? ua : 1 - ua);
			if (w > 0)
				out.push([w, ih + (k & 1) + d.h.length * (iv + (k >> 1 & 1) + d.v.length * (ia + (k >> 2)))]);
		}
		return out;
	}

	/* For either side its poses and, between them, both. */
	sides(h, v, open) {
		const [left, right] = open.map(a => this.mixture(h, v, a));
		return open[0] === open[1] ? () => left : share => share >= 1 ? left : share <= 0 ? right
			: [...left.map(([w, pose]) => [share * w, pose]), ...right.map(([w, pose]) => [(1 - share) * w, pose])];
	}

	/* h, v degrees; open: aperture of the left eye and the right, 1 as people open them at that gaze; strengths: of expressions. */
	pose(h, v, open, strengths) {
		strengths = this.strengths.map((s, k) => strengths && strengths[k] || 0);
		const key = [h, v, ...open, ...strengths].map(x => x.toFixed(2)).join(), gl = this.g.gl, d = this.data;
		if (key === this.key)
			return;
		this.key = key;
		const side = this.sides(h, v, open), b = this.poses, size = d.moving * FaceScene.RECORD, out = this.values, k16 = 2 * d.reach / 65535;
		for (let i = 0; i < d.moving; i++) {
			let x = 0, y = 0, z = 0, nx = 0, ny = 0, nz = 0, r = 0, g = 0, l = 0;
			for (const [w, pose] of side(this.left[i])) {
				const at = pose * size + i * FaceScene.RECORD;
				x += w * (b[at] + 256 * b[at + 1]);
				y += w * (b[at + 2] + 256 * b[at + 3]);
				z += w * (b[at + 4] + 256 * b[at + 5]);
				nx += w * b[at + 6];
				ny += w * b[at + 7];
				nz += w * b[at + 8];
				r += w * b[at + 9];
				g += w * b[at + 10];
				l += w * b[at + 11];
			}
			const o = 9 * i;
			out[o] = x * k16 - d.reach;
			out[o + 1] = y * k16 - d.reach;
			out[o + 2] = z * k16 - d.reach;
			out[o + 3] = nx / 127.5 - 1;
			out[o + 4] = ny / 127.5 - 1;
			out[o + 5] = nz / 127.5 - 1;
			out[o + 6] = r / 255;
			out[o + 7] = g / 255;
			out[o + 8] = l / 255;
		}
		const more = this.express(strengths);
		gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer);
		gl.bufferSubData(gl.ARRAY_BUFFER, 0, more ? out : out.subarray(0, 9 * d.moving));
		const n = 2 * d.sky_px * d.sky_px, sky = new Uint8Array(n);
		for (let i = 0; i < n; i++)
			sky[i] = side(i % (2 * d.sky_px) < d.sky_px ? 1 : 0).reduce((sum, [w, pose]) => sum + w * this.skies[pose * n + i], 0);
		gl.bindTexture(gl.TEXTURE_2D, this.sky_map.texture);
		gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
		gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, 2 * d.sky_px, d.sky_px, gl.RED, gl.UNSIGNED_BYTE, sky);
	}

	resize(width, height) {
		const gl = this.g.gl;
		if (this.frame && this.frame.width === width && this.frame.height === height)
			return;
		if (this.frame) {
			for (const t of [this.frame, ...this.fields])
				gl.deleteTexture(t.texture);
			gl.deleteRenderbuffer(this.frame.depth);
		}
		this.frame = this.g.texture(width, height, gl.RGBA16F);
		this.fields = [0, 1].map(() => this.g.texture(width, height, gl.RGBA16F));
		this.frame.depth = gl.createRenderbuffer();
		gl.bindRenderbuffer(gl.RENDERBUFFER, this.frame.depth);
		gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT24, width, height);
	}

	/* The camera before the face, turned round the middle of its eyes; field(height): mm of height shown. Close by (0..1) it is
	 * one eye that stands in the picture's middle. */
	camera(view, height) {
		const R = turns.multiply(turns.turned(view.orbit[0], view.orbit[1]), [1, 0, 0, 0, -1, 0, 0, 0, -1]), D = FaceScene.DISTANCE;
		const focal = D * height / view.field(height), p = turns.apply(R, this.data.globes[view.closer]), k = view.close * focal / (p[2] + D);
		return { R, focal, at: turns.apply(turns.transpose(R), [0, 0, -D]), aim: [-k * p[0], -k * p[1]] };
	}

	/* What the skin mirrors: neighbours, as they were cut, become one. */
	static fewer(list, n) {
		while (list.length > n)
			list = list.flatMap((a, i) => {
				const b = list[i + 1];
				if (i % 2 || !b)
					return i % 2 ? [] : [a];
				const wa = a[3] + a[4] + a[5], wb = b[3] + b[4] + b[5], d = [0, 1, 2].map(k => wa * a[k] + wb * b[k]), length = Math.hypot(...d) || 1;
				return [[...d.map(v => v / length), a[3] + b[3], a[4] + b[4], a[5] + b[5]]];
			});
		return list;
	}

	/* Depth of the near and far ends of what is drawn, as clip space has it. */
	static clip() {
		const near = FaceScene.DISTANCE - 200, far = FaceScene.DISTANCE + 200;
		return [(far + near) / (far - near), -2 * far * near / (far - near)];
	}

	/* The view of one eye in it, in the eye's own mm. */
	eye_view(eye_scene, s, view, side, width, height) {
		const c = this.camera(view, height), [x, y, z, scale] = this.data.globes[side], rad = Math.PI / 180;
		const h = view.gazes[side][0] * rad, v = view.gazes[side][1] * rad, ch = Math.cos(h), sh = Math.sin(h), cv = Math.cos(v), sv = Math.sin(v);
		// Fick: Ry(h) Rx(-v); the eye's y and z run the other way.
		const turn = [ch, -sh * sv, sh * cv, 0, cv, sv, -sh, -ch * sv, ch * cv], axes = turn.map((w, i) => i % 3 ? -w : w);
		const o = turns.apply(turns.transpose(axes), c.at.map((w, i) => (w - [x, y, z][i]) / scale));
		o[2] += eye_scene.sclera(s)[0];
		return { R: turns.multiply(c.R, axes), head_from_eye: turns.multiply([1, 0, 0, 0, -1, 0, 0, 0, -1], axes), lidded_from_eye: axes, origin: o, corner: [0, 0],
			lens: [c.focal, width / 2 + c.aim[0], height / 2 + c.aim[1], 1], pixel: FaceScene.DISTANCE / c.focal / scale, depth: [...FaceScene.clip(), scale], side };
	}

	/* How far it is to the lids, from the skin as drawn: along rows, then along columns. */
	field_of_lids(per_mm, s) {
		const { g } = this, gl = g.gl, reach = Math.min(64, Math.ceil(1.2 * per_mm * Math.max(this.data.shadow_mm, this.data.lake * this.data.tear_mm * s.tear)) + 2);
		gl.disable(gl.DEPTH_TEST);
		for (const rows of [0, 1]) {
			g.target(this.fields[rows]);
			g.draw(this.tear, { picture: rows ? this.fields[0] : this.frame, rows, reach });
		}
	}

	/* A picture of skin and eyes into frame. */
	draw(eye_scenes, s, view, preset, jitter) {
		const g = this.g, gl = g.gl, { width, height } = this.frame, c = this.camera(view, height), first = eye_scenes[0];
		this.pose(...[0, 1].map(k => (view.gazes[0][k] + view.gazes[1][k]) / 2), view.open, view.expressions);
		const light = first.lights[s.light] || first.lights[0], turn = turns.turned(s.light_yaw * Math.PI / 180, s.light_pitch * Math.PI / 180);
		const still = [1, 0, 0, 0, -1, 0, 0, 0, -1], env = turns.multiply(turns.transpose(turn), still), skies = FaceScene.fewer(light.skies, preset.skies);
		const views = [0, 1].map(side => this.eye_view(eye_scenes[side], s, view, side, width, height));
		views.forEach((v, side) => eye_scenes[side].solve(s, v, preset, `face${side}`));
		g.target(this.frame, 0, 0, this.frame.depth);
		gl.disable(gl.BLEND);
		gl.enable(gl.DEPTH_TEST);
		gl.enable(gl.CULL_FACE);
		gl.clearColor(0, 0, 0, 0);
		gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
		g.draw(this.skin(preset), { ...this.folds(), cam_from_head: c.R, camera: [2 * c.focal / width, 2 * c.focal / height, FaceScene.DISTANCE], clip_depth: FaceScene.clip(),
			shift: [2 * (c.aim[0] - jitter[0]) / width, 2 * (jitter[1] - c.aim[1]) / height], head_camera: c.at, env_from_head: env, still_from_head: still, skies: skies.length,
			sky_dir: EyeScene.padded(skies.flatMap(l => turns.apply(turns.transpose(env), l)), 3 * EyeScene.LIGHTS),
			sky_rgb: EyeScene.padded(skies.flatMap(l => l.slice(3).map(v => v * s.light_gain)), 3 * EyeScene.LIGHTS),
			globes: this.data.globes.flatMap(([x, y, z, scale], side) => [x, y, z, scale * eye_scenes[side].sclera(s)[1]]),
			quadric: light.quadric.flat().map(v => v * s.light_gain), still_quadric: first.lights[0].quadric.flat(),
			sharp_map: light.sharp_map || first.lights[0].sharp_map, rough_map: light.rough_map || first.lights[0].rough_map, mirror_on: light.sharp_map ? s.light_gain : 0,
			pores: !preset.pores ? 0 : Math.min(1, Math.max(0, (0.22 - FaceScene.DISTANCE / c.focal) / 0.1)) }, this.shape, this.n_indices);
		gl.disable(gl.CULL_FACE);
		gl.enable(gl.SCISSOR_TEST);
		views.forEach((v, side) => {
			// Only where the globe can be seen.
			const [x, y, z, scale] = this.data.globes[side], p = turns.apply(c.R, [x, y, z]), Z = p[2] + FaceScene.DISTANCE, r = 14.5 * scale * c.focal / Z;
			const cx = width / 2 + c.aim[0] + c.focal * p[0] / Z, cy = height / 2 - c.aim[1] - c.focal * p[1] / Z;
			gl.scissor(Math.floor(cx - r), Math.floor(cy - r), Math.ceil(2 * r), Math.ceil(2 * r));
			this.field_of_lids(c.focal / FaceScene.DISTANCE, s);
			g.target(this.frame, 0, 0, this.frame.depth);
			gl.enable(gl.DEPTH_TEST);
			eye_scenes[side].trace(s, v, preset, jitter, { side: v.side, lidded_from_eye: v.lidded_from_eye, depth: v.depth, sky_map: this.sky_map,
				lid_map: this.fields[1], tear_height: Math.max(this.data.tear_mm * s.tear, 1e-3), tear_absorb: this.data.tear_absorb,
				canthus: this.data.corners[side], skin_rgb: this.data.skin_rgb }, [width, height], this.eye);
		});
		gl.disable(gl.SCISSOR_TEST);
		gl.disable(gl.DEPTH_TEST);
	}

	/* Adds one picture to the mean in target. */
	add(target, count, eye_scenes, s, view, preset, jitter) {
		const g = this.g, gl = g.gl;
		this.resize(target.width, target.height);
		this.draw(eye_scenes, s, view, preset, jitter);
		if (count)
			gl.enable(gl.BLEND);
		gl.blendColor(0, 0, 0, 1 / (count + 1));
		gl.blendFunc(gl.CONSTANT_ALPHA, gl.ONE_MINUS_CONSTANT_ALPHA);
		g.target(target);
		g.draw(this.copy, { picture: this.frame });
		gl.disable(gl.BLEND);
	}
}

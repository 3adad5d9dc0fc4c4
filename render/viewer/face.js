/* A driven character: its mesh as the rig has it posed (pose.js), its eyes in it. Head's axes, mm. */
class FaceScene {
	static DISTANCE = 900;
	static PROBE = 16;
	static WIDE = 2.3;  // distances between the eyes that are shown across

	/* Bytes in place of what is packed, in all of the character's data, once. */
	static async unpack(data) {
		if (!window.DecompressionStream)
			throw new Error("this browser cannot unpack the face; one of 2023 or later can");
		await Promise.all(Object.entries(data).filter(([, v]) => v && typeof v === "object").map(async ([key, v]) => {
			if (v.deflate !== undefined)
				data[key] = await Graphics.unpacked(v);
			else if (!Array.isArray(v) && !ArrayBuffer.isView(v))
				await FaceScene.unpack(v);
		}));
	}

	constructor(g, data) {
		const gl = g.gl;
		Object.assign(this, { g, data, skies: data.sky, strengths: [] });
		this.skin(g.first);
		this.eye = g.program("eye", null, ["skin_look", "lids"]);
		this.probed = g.texture(FaceScene.PROBE, FaceScene.PROBE, gl.RGBA8);
		this.shut = [{}, {}];
		this.tear = g.program("tear");
		this.copy = g.program("copy");
		this.poser = new FacePose(g, data);
		const faces = new Uint32Array(data.faces.buffer);
		this.n_indices = faces.length;
		const first_hair = this.data.n - this.poser.hairs, solid = faces.findIndex(v => v >= first_hair);  // hairs come last
		this.n_solid = solid < 0 ? faces.length : solid - solid % 3;
		this.shape = gl.createVertexArray();
		gl.bindVertexArray(this.shape);
		const array = (at, buffer, n, type, normalised, stride) => {
			gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
			gl.enableVertexAttribArray(at);
			gl.vertexAttribPointer(at, n, type, normalised, stride, 0);
		};
		const still = list => {
			const buffer = gl.createBuffer();
			gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
			gl.bufferData(gl.ARRAY_BUFFER, list, gl.STATIC_DRAW);
			return buffer;
		};
		["at", "normals", "light"].forEach((name, k) => array(k, this.poser[name].buffer, 3, gl.FLOAT, false, 16));
		array(3, still(data.skin), 4, gl.UNSIGNED_BYTE, true, 0);
		array(4, still(this.poser.rest_in_head()), 3, gl.FLOAT, false, 0);
		if (data.folds)
			array(5, still(new Float32Array(Array.from(new Uint16Array(data.folds.home.buffer), v => v / 16))), 2, gl.FLOAT, false, 0);
		gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
		gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, faces, gl.STATIC_DRAW);
		gl.bindVertexArray(null);
		gl.bindBuffer(gl.ARRAY_BUFFER, null);  // what a pass writes to is bound to nothing else
		// Both eyes and some of what is beside them, mm across.
		this.field = FaceScene.WIDE * Math.hypot(...[0, 1, 2].map(k => data.globes[0][k] - data.globes[1][k]));
		this.sky_map = g.texture(2 * data.sky_px, data.sky_px, gl.RGBA8);
	}

	skin(preset) {
		return this.g.variant(preset.pores, "skin", "skin_vert", ["skin_look", ...(this.data.folds ? ["folds"] : []), ...(this.data.dress ? ["dress"] : [])], "pores");
	}

	async load() {
		this.dress_map = this.data.dress ? await this.g.map(this.data.dress.map, "srgb") : null;
		this.fold_map = this.data.folds ? await this.g.map(this.data.folds.map, 0) : null;
	}

	/* Of the skin's shader, where the model folds. */
	folds() {
		const f = this.data.folds, of = f ? f.follows.map(k => Math.min(1, this.strengths[k])) : [];
		return f ? { fold_map: this.fold_map, folds: of.length, fold_strength: EyeScene.padded(of, EyeScene.LIGHTS), fold_size: f.size, fold_scale: [f.subject_mm, f.px] } : {};
	}

	/* view: gazes (degrees), open (of what is usual), expressions; recorded: a clip's controls. */
	pose(view) {
		const gl = this.g.gl, d = this.data;
		if (!this.poser.pose(view.gazes, view.open, view.expressions, view.recorded))
			return;
		const c = this.poser.posed_as;
		this.strengths = [...c.slice(10)];
		const sky = this.sky(c);
		gl.bindTexture(gl.TEXTURE_2D, this.sky_map.texture);
		gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
		gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, 2 * d.sky_px, d.sky_px, gl.RGBA, gl.UNSIGNED_BYTE, sky);
	}

	/* Share of the sky that lids leave over places of both globes, of 255, and the direction of its middle: of the poses that light comes from, expressions too. */
	sky(controls) {
		const wide = 4 * 2 * this.data.sky_px, n = wide * this.data.sky_px, lit = this.poser.lit(controls);
		return Uint8ClampedArray.from({ length: n }, (_, i) => lit.reduce((sum, [pose, left, right]) => sum + (i % wide < wide / 2 ? left : right) * this.skies[pose * n + i], 0));
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
		this.fielded = ["", ""];
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
		return { R, focal, at: turns.apply(turns.transpose(R), [0, 0, -D]), aim: [view.pan[0] * height - k * p[0], view.pan[1] * height - k * p[1]] };
	}

	/* The lights that the skin mirrors: neighbours in the order in which they were split are joined. */
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
		const [h, v, t] = view.gazes[side], axes = turns.fick(h * rad, v * rad, (t || 0) * rad).map((w, i) => i % 3 ? -w : w);  // the eye's y and z run the other way
		const o = turns.apply(turns.transpose(axes), c.at.map((w, i) => (w - [x, y, z][i]) / scale));
		o[2] += eye_scene.sclera(s)[0];
		return { R: turns.multiply(c.R, axes), head_from_eye: turns.multiply([1, 0, 0, 0, -1, 0, 0, 0, -1], axes), lidded_from_eye: axes, origin: o, corner: [0, 0],
			lens: [c.focal, width / 2 + c.aim[0], height / 2 + c.aim[1], 1], pixel: FaceScene.DISTANCE / c.focal / scale, depth: [...FaceScene.clip(), scale], side };
	}

	/* Distance to the lids on the screen, from the skin as drawn: along rows, then along columns. */
	field_of_lids(side, key, per_mm, s) {
		if (this.fielded[side] === key)
			return;
		const { g } = this, gl = g.gl, reach = Math.min(64, Math.ceil(1.2 * per_mm * Math.max(this.data.shadow_mm, this.data.lake * this.data.tear_mm * s.tear)) + 2);
		gl.disable(gl.DEPTH_TEST);
		for (const rows of [0, 1]) {
			g.target(this.fields[rows]);
			g.draw(this.tear, { picture: rows ? this.fields[0] : this.frame, rows, reach });
		}
		this.fielded[side] = key;
		g.counted("fielded");
	}

	/* Whether shut lids leave as good as nothing of an eye's disc (middle and radius, px) to be seen in the frame: looked at once for
	 * each key. A character's lids may not quite meet: the crease between them is filled. */
	is_hidden(side, key, disc) {
		const { g } = this, gl = g.gl, n = FaceScene.PROBE, px = new Uint8Array(4 * n * n);
		if (this.shut[side].key !== key) {
			gl.disable(gl.DEPTH_TEST);
			gl.disable(gl.SCISSOR_TEST);
			g.target(this.probed);
			g.draw(g.variant(false, "probe", null, [], "crease"), { picture: this.frame, globe: disc });
			gl.readPixels(0, 0, n, n, gl.RGBA, gl.UNSIGNED_BYTE, px);
			gl.enable(gl.SCISSOR_TEST);
			this.shut[side] = { key, hidden: px.reduce((sum, v) => sum + v, 0) / 255 < 0.01 * px.length };
		}
		if (this.shut[side].hidden) {
			g.target(this.frame, 0, 0, this.frame.depth);
			gl.enable(gl.DEPTH_TEST);
			gl.depthFunc(gl.LEQUAL);  // only where nothing has been drawn
			g.draw(g.variant(true, "probe", null, [], "crease"), { globe: disc, skin_rgb: this.data.skin_rgb });
			gl.depthFunc(gl.LESS);
		}
		return this.shut[side].hidden;
	}

	/* A picture of skin and eyes into frame. */
	draw(eye_scenes, s, view, preset, jitter) {
		const g = this.g, gl = g.gl, { width, height } = this.frame, c = this.camera(view, height), first = eye_scenes[0];
		this.pose(view);
		const light = first.lights[s.light] || first.lights[0], turn = turns.turned(s.light_yaw * Math.PI / 180, s.light_pitch * Math.PI / 180);
		const still = [1, 0, 0, 0, -1, 0, 0, 0, -1], env = turns.multiply(turns.transpose(turn), still), skies = FaceScene.fewer(light.skies, preset.skies);
		g.target(this.frame, 0, 0, this.frame.depth);
		gl.disable(gl.BLEND);
		gl.enable(gl.DEPTH_TEST);
		gl.enable(gl.CULL_FACE);
		gl.clearColor(0, 0, 0, 0);
		gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
		const skin = { ...this.folds(), ...(this.data.dress ? { dress_map: this.dress_map, dress_place: this.data.dress.place } : {}), cam_from_head: c.R, head_from_rig: this.data.rig.head_from_rig, middle: this.data.rig.middle, camera: [2 * c.focal / width, 2 * c.focal / height, FaceScene.DISTANCE], clip_depth: FaceScene.clip(),
			shift: [2 * (c.aim[0] - jitter[0]) / width, 2 * (jitter[1] - c.aim[1]) / height], head_camera: c.at, env_from_head: env, still_from_head: still, skies: skies.length,
			sky_dir: EyeScene.padded(skies.flatMap(l => turns.apply(turns.transpose(env), l)), 3 * EyeScene.LIGHTS),
			sky_rgb: EyeScene.padded(skies.flatMap(l => l.slice(3).map(v => v * s.light_gain)), 3 * EyeScene.LIGHTS),
			globes: this.data.globes.flatMap(([x, y, z, scale], side) => [x, y, z, scale * eye_scenes[side].sclera(s)[1]]),
			quadric: light.quadric.flat().map(v => v * s.light_gain), still_quadric: first.lights[0].quadric.flat(),
			sharp_map: light.sharp_map || first.lights[0].sharp_map, rough_map: light.rough_map || first.lights[0].rough_map, mirror_on: light.sharp_map ? s.light_gain : 0,
			at_map: this.poser.at.map, first_hair: this.data.n - this.poser.hairs, hair_px: [c.focal, preset.hair],
			pores: !preset.pores ? 0 : Math.min(1, Math.max(0, (0.22 - FaceScene.DISTANCE / c.focal) / 0.1)) };
		g.draw(this.skin(preset), skin, this.shape, this.n_solid);
		gl.disable(gl.CULL_FACE);
		gl.enable(gl.SCISSOR_TEST);
		for (const side of [0, 1])
			this.draw_eye(side, eye_scenes[side], s, view, c, preset, jitter);
		gl.disable(gl.SCISSOR_TEST);
		this.draw_hairs(skin, preset);
		gl.disable(gl.DEPTH_TEST);
	}

	/* Hairs before what has been drawn, each hiding its share of it; alpha stays what it says of that. */
	draw_hairs(values, preset) {
		const gl = this.g.gl;
		gl.enable(gl.BLEND);
		gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ZERO, gl.ONE);
		gl.depthMask(false);
		this.g.draw(this.skin(preset), values, this.shape, this.n_indices - this.n_solid, this.n_solid);
		gl.depthMask(true);
		gl.disable(gl.BLEND);
	}

	/* One eye where its globe can be seen. */
	draw_eye(side, scene, s, view, c, preset, jitter) {
		const { g, data } = this, gl = g.gl, { width, height } = this.frame, [x, y, z, scale] = data.globes[side], p = turns.apply(c.R, [x, y, z]), Z = p[2] + FaceScene.DISTANCE;
		const r = 14.5 * scale * c.focal / Z, cx = width / 2 + c.aim[0] + c.focal * p[0] / Z, cy = height / 2 - c.aim[1] - c.focal * p[1] / Z;
		const box = [Math.floor(cx - r), Math.floor(cy - r), Math.ceil(2 * r), Math.ceil(2 * r)];
		gl.scissor(...box);
		if (!(view.open[side] > 0) && this.is_hidden(side, [width, height, ...c.R, ...c.aim, c.focal, this.poser.key].join(), [cx, cy, scene.sclera(s)[1] * scale * c.focal / Z])) {
			g.counted("hidden");
			return;
		}
		const v = this.eye_view(scene, s, view, side, width, height);
		gl.disable(gl.DEPTH_TEST);
		gl.disable(gl.SCISSOR_TEST);
		scene.solve(s, v, preset, `face${side}`);
		gl.enable(gl.SCISSOR_TEST);
		gl.scissor(...box);
		this.field_of_lids(side, [...box, ...c.R, ...c.aim, c.focal, ...jitter, s.tear, this.poser.key].join(), c.focal / FaceScene.DISTANCE, s);
		scene.trace(s, v, preset, jitter, { side: v.side, lidded_from_eye: v.lidded_from_eye, depth: v.depth, sky_map: this.sky_map,
			lid_map: this.fields[1], tear_height: Math.max(data.tear_mm * s.tear, 1e-3), tear_absorb: data.tear_absorb,
			canthus: data.corners[side], skin_rgb: data.skin_rgb }, [width, height], () => {
				g.target(this.frame, 0, 0, this.frame.depth);
				gl.enable(gl.DEPTH_TEST);
			}, () => this.eye, () => g.variant(true, "eye", null, ["skin_look", "lids"], "kept"));
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

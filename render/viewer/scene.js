/* One eye as the shaders see it: lib/draw/eye/scene.h with everything that a hand can change. Matrices are rows. */
const turns = {
	multiply: (a, b) => [0, 1, 2].flatMap(i => [0, 1, 2].map(j => a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j])),
	transpose: a => [a[0], a[3], a[6], a[1], a[4], a[7], a[2], a[5], a[8]],
	apply: (a, v) => [0, 1, 2].map(i => a[3 * i] * v[0] + a[3 * i + 1] * v[1] + a[3 * i + 2] * v[2]),
	/* Of scene_view_turned(): yaw, then pitch; radians. */
	turned(yaw, pitch) {
		const cy = Math.cos(yaw), sy = Math.sin(yaw), cp = Math.cos(pitch), sp = Math.sin(pitch);
		return [cy, 0, -sy, sp * sy, cp, sp * cy, cp * sy, -sp, cp * cy];
	},
	/* Of an eye in the head's axes: Ry(h) Rx(-v) Rz(t); radians. */
	fick(h, v, t) {
		const ch = Math.cos(h), sh = Math.sin(h), cv = Math.cos(v), sv = Math.sin(v), ct = Math.cos(t), st = Math.sin(t);
		return turns.multiply([ch, -sh * sv, sh * cv, 0, cv, sv, -sh, -ch * sv, ch * cv], [ct, -st, 0, st, ct, 0, 0, 0, 1]);
	},
};

/* Place between the knots of a list: index and share; held at the ends. */
function between(list, x) {
	let i = 0;
	while (i + 2 < list.length && x > list[i + 1])
		i++;
	return [i, Math.min(1, Math.max(0, (x - list[i]) / (list[i + 1] - list[i])))];
}

/* What costs time, dearest first. No more steps are taken than the model in the maps was made with: the photograph's own view
 * then shows the photograph. */
const presets = [
	{ name: "full", steps: 12, scale: 1, beams: 12, directions: 128, shadow: 0.25, apart: 0, skies: 8, pores: true, hair: 0.45 },
	{ name: "high", steps: 6, scale: 1, beams: 4, directions: 32, shadow: 0.5, apart: 0, skies: 8, pores: true, hair: 0.45 },
	{ name: "medium", steps: 3, scale: 0.66, beams: 4, directions: 8, shadow: 1, apart: 1, skies: 4, pores: true, hair: 0.6 },
	{ name: "low", steps: 3, scale: 0.66, beams: 4, directions: 4, shadow: 0, apart: 1, skies: 4, pores: false, hair: 0.6 },
	{ name: "least", steps: 2, scale: 0.4, beams: 2, directions: 2, shadow: 0, apart: 2, skies: 2, pores: false, hair: 0.6 },
];

class EyeScene {
	static LIGHTS = 12;       // beams at most; and the way to the camera
	static DIRECTIONS = 128;  // in all of them
	static NODES = 12;
	static SEARCH = 32;       // steps at most towards the relief

	constructor(g, data) {
		Object.assign(this, { g, data, count: 0, target: null });
		for (const name of ["paths", "present"])
			this[name] = g.program(name);
		this.marcher(g.first);
		this.path_maps = {};
		this.shades = {};
		this.horizons = [];  // of two eyes, the latest first
		this.seen = {};  // rays' ways, by name
	}

	marcher(preset) {
		return this.g.variant(preset.shadow > 0, "march", null, [], "shadows");
	}

	/* The eye alone; in a face the face's own program draws it, and this is never compiled. */
	start() {
		this.alone = this.alone || this.g.program("eye");
	}

	get eye() {
		this.start();
		return this.alone;
	}

	async load() {
		const { g, data } = this, m = data.maps;
		const [relief, colour, model, veins, film, tint, own] = await Promise.all([g.map(m.relief, 0), g.map(m.colour, "srgb"),
			g.map(m.model, "log"), g.map(m.veins, "log"), g.map(m.film, "plain"), g.map(m.tint, "log"), g.map(m.own, "log")]);
		this.maps = { relief_map: relief, colour_map: colour, model_map: model, vein_map: veins, film_map: film, tint_map: tint, own_map: own };
		this.lights = await Promise.all(data.lights.map(async l => l.opened ? l : ({ ...l,
			sharp_map: l.sharp ? await g.map(l.sharp, "log") : null, rough_map: l.rough ? await g.map(l.rough, "log") : null })));
	}

	static padded(list, n) {
		return [...list, ...new Array(n - list.length).fill(0)];
	}

	/* Depth of the sclera's centre: it follows a cornea that is made steeper or flatter. */
	sclera(s) {
		const e = this.data.eye, r2 = e.limbus[0] * e.limbus[0];
		const depth = r2 / (s.R + Math.sqrt(Math.max(s.R * s.R - s.p * r2, 0)));
		return [depth + Math.sqrt(Math.max(e.sclera[1] * e.sclera[1] - r2, 0)), e.sclera[1], e.sclera[2] / e.limbus[0]];
	}

	/* How light ends at the limbus: rim_shadow_of of lib/tissue/light/rim_shadow.h; the spread is that of the tissue as fitted. */
	rim(s) {
		const e = this.data.eye, r = e.limbus[0], root = Math.sqrt(Math.max(s.R * s.R - s.p * r * r, 0)), depth = r * r / (s.R + root);
		return [e.rim[0], r / Math.max(root, 1e-3), depth, e.rim[1]];
	}

	/* The camera: {rotation cam_from_eye, origin in the eye, lens, corner, mm a pixel on the iris}. view.pose: a photograph's. */
	camera(s, view, height) {
		const e = this.data.eye, z = this.sclera(s)[0];
		if (view.pose) {
			const p = view.pose, R = [p[0], p[1], p[2], p[4], p[5], p[6], p[8], p[9], p[10]], t = [p[3], p[7], p[11]];
			const scale = view.window[2] * view.rows / height;
			return { R, head_from_eye: R, origin: turns.apply(turns.transpose(R), t).map(v => -v), corner: [view.window[0], view.window[1]],
				lens: [...view.camera, scale], pixel: scale * (p[10] * e.iris_depth + t[2]) / view.camera[0] };
		}
		const head_from_eye = turns.turned(view.yaw, view.pitch), R = turns.multiply(turns.turned(view.orbit[0], view.orbit[1]), head_from_eye);
		const distance = 500, focal = distance * height / view.field, c = turns.apply(R, [0, 0, z]);
		const t = [-c[0], -c[1], distance + 0.1 * e.sclera[1] - c[2]];  // as scene_view_turned of the programs
		const away = R[8] * e.iris_depth + t[2];
		return { R, head_from_eye, origin: turns.apply(turns.transpose(R), t).map(v => -v), corner: [0, 0],
			lens: [focal, view.width / 2 + view.pan[0] * height, height / 2 + view.pan[1] * height, 1], pixel: away / focal };
	}

	/* The level of the maps whose texels are about as large as a pixel. */
	level(pixel) {
		const n = this.data.eye.map_px, per_mm = n / (2 * this.data.eye.extent);
		let k = 0;
		while (k + 1 < this.data.eye.levels && per_mm / (2 << k) * pixel > 0.8)
			k++;
		return k;
	}

	/* The level that the march begins from. */
	marched(pixel, preset) {
		const m = this.data.maps.model;
		return Math.min(Math.max(this.level(pixel) + this.data.eye.marched + preset.apart, m.from), this.data.eye.levels - 1);
	}

	tissue(s) {
		const key = [s.abl_melanin, s.abl_ratio, s.stroma_melanin, s.stroma_ratio, s.thickness_scale].join();
		if (this.tissue_key !== key) {
			const t = this.data.tissue, o = tissue.optics(t, s);
			this.tissue_key = key;
			this.optics = { source: o.source.flat(), extinction: o.extinction.flat(), band_rgb: [0, 1, 2].flatMap(c => t.bands.map(b => b[5 + c])).concat([0, 0, 0, 0]) };
		}
		return this.optics;
	}

	/* Places and weights of the march's steps in both layers, for tissue that fades light as this does: between the rules that
	 * lib/draw/eye/march/nodes.c makes. */
	nodes(steps, extinction) {
		const m = this.data.eye.march, all = Math.max(2, Math.min(steps, m.steps, EyeScene.NODES)), abl = Math.max(1, Math.floor(all / m.share)), out = { nodes: [abl, all - abl], node: [] };
		out.nodes.forEach((n, layer) => {
			const of = extinction.slice(4 * layer, 4 * layer + 4), c = m.ways * m.thickness[layer] * of.reduce((a, v) => a + v, 0) / of.length;
			const [i, u] = between(m.fade, c), a = m.rules[n - 1][i], b = m.rules[n - 1][i + 1];
			out.node.push(...EyeScene.padded(a.map((v, k) => v + u * (b[k] - v)), 2 * EyeScene.NODES));
		});
		return out;
	}

	resize(width, height) {
		if (this.target && this.target.width === width && this.target.height === height)
			return;
		if (this.target)
			this.g.gl.deleteTexture(this.target.texture);
		this.target = this.g.texture(width, height, this.g.gl.RGBA16F);
		this.count = 0;
		for (const t of this.glows || [])
			this.g.gl.deleteTexture(t.texture);
		this.glows = null;
	}

	/* The light that glows (bloom.frag), as lib/draw/bloom.c has it: a pyramid of the picture, summed up into its level of half the size. Returns how many octaves. */
	glow(gain) {
		const { g } = this, gl = g.gl, { width, height } = this.target, side = Math.min(width, height);
		let last = 0, first = 0;
		for (; last < 16 && side >> last + 1 >= 8; last++)
			first = first || (side >> last + 1 <= 256 ? last + 1 : 0);
		this.glower = this.glower || g.program("bloom");
		this.glows = this.glows || Array.from({ length: last + 1 }, (_, k) => g.plain(...[width, height].map(v => Math.ceil(v / 2 ** k)), gl.RGBA16F));
		const pass = (what, from, to) => {
			g.target(to);
			g.draw(this.glower, { picture: from, gain, what, size: [to.width, to.height] });
		};
		pass(0, this.target, this.glows[0]);
		for (let k = 1; k <= last; k++)
			pass(1, this.glows[k - 1], this.glows[k]);
		for (let k = last - 1; k > 0; k--) {
			if (k >= first)
				gl.enable(gl.BLEND);
			gl.blendFunc(gl.ONE, gl.ONE);
			pass(2, this.glows[k + 1], this.glows[k]);
			gl.disable(gl.BLEND);
		}
		return last - first + 1;
	}

	/* A target for the paths of all beams, on side x side points. */
	ways(side) {
		const { g } = this, size = [2 * side, (EyeScene.LIGHTS + 1) * side];
		return { ...g.texture(...size, g.gl.RGBA16F), also: g.texture(...size, g.gl.R16F) };
	}

	/* The light's ways into the eye as this camera has it, once for each change; kept by name. */
	solve(s, cam, preset, name) {
		const { g, data } = this, e = data.eye, c = data.constants, light = this.lights[s.light] || this.lights[0];
		const turn = turns.turned(s.light_yaw * Math.PI / 180, s.light_pitch * Math.PI / 180);
		const env_from_eye = turns.multiply(turns.transpose(turn), cam.head_from_eye);
		const in_eye = beams.turned(light.lights, turns.transpose(env_from_eye));
		const made = beams.made(in_eye, Math.min(preset.beams, light.beams, EyeScene.LIGHTS), Math.min(preset.directions, EyeScene.DIRECTIONS - 1));
		made.first.push(made.first[made.n] + 1);
		made.dir.push(0, 0, 0, 1);  // the way to the camera
		const key = [s.R, s.p, s.n, ...cam.origin, ...made.first, ...made.dir].join(), old = this.path_maps[name], map = old ? old.map : this.ways(c.grid);
		const values = { cornea_R: s.R, cornea_p: s.p, cornea_n: s.n, extent: e.extent, rim: e.limbus[0], limbus: e.limbus, path_bend: c.path_bend,
			light_dir: EyeScene.padded(made.dir, 4 * EyeScene.DIRECTIONS), first: EyeScene.padded(made.first, EyeScene.LIGHTS + 2), origin: cam.origin,
			beam_z: [e.iris_depth - e.tissue_range[1], e.iris_depth - e.tissue_range[0] + data.tissue.abl] };
		if (!old || old.key !== key) {
			this.solve_all(map, values, made);
			g.counted("solved");
		}
		this.path_maps[name] = { key, map };
		const beam_rgb = EyeScene.padded(made.rgb.map(v => v * s.light_gain), 3 * EyeScene.LIGHTS);
		const own = beams.likeness(in_eye, e.own_mean, c.own_width);
		this.solved = { ...this.solved, [name]: { ...values, key, path_map: map, down_map: map.also, env_from_eye, beams: made.n, beam_rgb, own, light } };
		this.march(s, cam, preset, name);
	}

	/* Light on the iris' texels, once for each change. */
	march(s, cam, preset, name) {
		const { g, data } = this, gl = g.gl, e = data.eye, solved = this.solved[name], level = this.marched(cam.pixel, preset), n = e.map_px >> level, m = data.maps.model;
		const own = { ...this.tissue(s), ...this.nodes(preset.steps, this.optics.extinction), pupil_now: s.pupil, detail: s.detail, shadow_grow: preset.shadow, level };
		const ground = { ...this.maps, extent: e.extent, rim: e.limbus[0], pupil: e.pupil, pupil_now: s.pupil, iris_depth: e.iris_depth, heights: e.heights, map_size: e.map_px, level };
		const key = solved.key + solved.beam_rgb.join() + solved.own + JSON.stringify(own), old = this.shades[name];
		if (old && old.key === key)
			return;
		if (old && old.map.width !== n)
			gl.deleteTexture(old.map.texture);
		const map = old && old.map.width === n ? old.map : g.texture(n, n, gl.RGBA16F);
		const horizon_map = preset.shadow > 0 ? this.horizon(ground, preset.shadow) : null;
		const lights = { ...solved, ...ground, rim_light: this.rim(s), rim_edge: e.rim[2] }, beside_map = this.beside(lights);
		g.target(map);
		g.draw(this.marcher(preset), { ...lights, ...own, sclera: this.sclera(s), beside_map, horizon_map, abl: data.tissue.abl, exposure: data.tissue.exposure, tissue_gain: e.gain, ratio_most: data.constants.ratio_most, ratio_chroma: data.constants.ratio_chroma, model_top: m.tops[level - m.from] });
		this.shades[name] = { key, map };
		g.counted("marched");
	}

	/* What light that spreads in the tissue changes: lib/draw/eye/march/beside.c. lights: what the march is given of them. Tissue that does not
	 * spread light: one texel of 1. */
	beside(lights) {
		const { g } = this, e = this.data.eye, n = this.data.constants.beside, per = n / (2 * e.extent);
		if (!(e.spread[1] > 0)) {
			this.nothing_beside = this.nothing_beside || g.plain(1, 1, g.gl.RGBA8, g.gl.RGBA, g.gl.UNSIGNED_BYTE, new Uint8Array([255, 255, 255, 255]));
			return this.nothing_beside;
		}
		const keep = e.spread.map(mm => 1 + 1 / Math.max((mm * per) ** 2, 1e-6)).map(a => a - Math.sqrt(a * a - 1));
		this.beside_of = this.beside_of || g.program("beside");
		this.beside_maps = this.beside_maps || [0, 1].map(() => g.texture(n, n, g.gl.RGBA16F));
		for (const part of [0, 1, 2]) {
			g.target(this.beside_maps[part % 2]);
			g.draw(this.beside_of, { ...lights, part, keep, lit_map: this.beside_maps[1 - part % 2] });
		}
		return this.beside_maps[0];
	}

	/* The horizon of the relief, once for each change of the pupil. */
	horizon(ground, shadow_grow) {
		const { g, horizons } = this, n = ground.map_size >> ground.level, key = [ground.pupil_now, ground.level, shadow_grow].join(), at = horizons.findIndex(h => h.key === key);
		if (at >= 0) {
			horizons.unshift(...horizons.splice(at, 1));
			return horizons[0].map;
		}
		const last = horizons.length > 1 ? horizons.pop() : null, fits = last && last.map.width === 2 * n;
		if (last && !fits)
			g.gl.deleteTexture(last.map.texture);
		const map = fits ? last.map : g.texture(2 * n, 2 * n, g.gl.RGBA16F);
		this.horizons_of = this.horizons_of || g.program("horizon");
		g.target(map);
		g.draw(this.horizons_of, { ...ground, shadow_grow });
		g.counted("horizons");
		horizons.unshift({ key, map });
		return map;
	}

	/* Several lights together are smooth: fewer points, and cubics between. */
	solve_all(map, values, made) {
		const { g } = this, gl = g.gl, { grid, coarse } = this.data.constants, side = made.each > 1 ? coarse : grid;
		this.coarse = this.coarse || (made.each > 1 ? this.ways(coarse) : null);
		const to = made.each > 1 ? this.coarse : map, part = n => gl.scissor(0, 0, 2 * n, (made.n + 1) * n);
		gl.disable(gl.BLEND);
		gl.enable(gl.SCISSOR_TEST);
		g.target(to);
		part(side);
		g.draw(this.paths, { ...values, side });
		if (to !== map) {
			g.target(map);
			part(grid);
			this.refine = this.refine || g.program("refine");
			g.draw(this.refine, { path_map: to, down_map: to.also });
		}
		gl.disable(gl.SCISSOR_TEST);
	}

	/* Every pixel of the target's ray, drawn by to(): program, or kept, which only shades what an earlier picture found. Where
	 * nothing but light has changed since the last one, the rays' ways are kept and no ray is traced again; extra: uniforms. */
	trace(s, cam, preset, jitter, extra, size, to, program, kept) {
		const { g, data } = this, e = data.eye, name = cam.side === undefined ? "eye" : `face${cam.side}`, solved = this.solved[name], light = solved.light;
		const ways = { cornea_R: s.R, cornea_p: s.p, cornea_n: s.n, extent: e.extent, rim: e.limbus[0], limbus: e.limbus, origin: cam.origin, eye_from_cam: turns.transpose(cam.R),
			lens: cam.lens, corner: cam.corner, size, jitter, slip: cam.slip ? [...cam.slip, 0, 0, 0] : [0, 0, 0, 0, 0, 0, 0, 0, 0], back: e.back, sclera: this.sclera(s),
			pupil: e.pupil, pupil_now: s.pupil, iris_depth: e.iris_depth, pixel: cam.pixel, heights: e.heights, search: Math.min(e.search, EyeScene.SEARCH),
			level: this.level(cam.pixel), map_size: e.map_px };
		const key = JSON.stringify(ways), seen = this.seen[name] = this.seen[name] || { key: "", found: "", map: null };
		const all = { ...solved, ...ways, ...this.maps, sclera_reach: data.constants.sclera_reach,
			sharp_map: light.sharp_map || this.lights[0].sharp_map, rough_map: light.rough_map || this.lights[0].rough_map,
			light_map: this.shades[name].map, detail: s.detail,
			wet_light: light.wet.flat().map(v => v * s.light_gain),
			mirror_on: light.sharp_map ? s.light_gain : 0, tear: s.tear, ...extra };
		const same = g.exact && !jitter[0] && !jitter[1] && (seen.key === key || seen.found === key);
		if (same && seen.found !== key)
			this.find(seen, key, all, size);
		to();
		g.counted(same ? "shaded" : "traced");
		g.draw(same ? kept() : program(), { ...all, kept_map: seen.map });
		seen.key = jitter[0] || jitter[1] ? seen.key : key;
	}

	/* A target for what all rays meet, in full precision. */
	find(seen, key, all, size) {
		const { g } = this, gl = g.gl;
		if (!seen.map || seen.map.width !== size[0] || seen.map.height !== size[1]) {
			if (seen.map)
				gl.deleteTexture(seen.map.texture);
			seen.map = g.plain(...size, gl.RGBA32F);
		}
		g.target(seen.map);
		g.counted("traced");
		g.draw(g.variant(true, "eye", null, [], "crossings"), all);
		seen.found = key;
	}

	/* Adds one picture to the mean of those since restart(). s: state; view: where from; jitter: px. */
	add(s, view, preset, jitter) {
		const { g } = this, gl = g.gl, { width, height } = this.target;
		if (view.face) {
			view.face.add(this.target, this.count++, view.eyes, s, view, preset, jitter);
			return;
		}
		const cam = { ...this.camera(s, { ...view, width }, height), slip: view.slip };
		this.solve(s, cam, preset, "eye");
		if (this.count)
			gl.enable(gl.BLEND);
		gl.blendColor(0, 0, 0, 1 / (this.count + 1));
		gl.blendFunc(gl.CONSTANT_ALPHA, gl.ONE_MINUS_CONSTANT_ALPHA);
		this.trace(s, cam, preset, jitter, {}, [width, height], () => g.target(this.target), () => this.eye, () => g.variant(true, "eye", null, [], "kept"));
		gl.disable(gl.BLEND);
		this.count++;
	}

	restart() {
		this.count = 0;
	}

	/* gain: of all channels, or of each; bare: without noise; tone: as film takes highlights, 0 to 1; bloom: share of light that glows. */
	show(width, height, gain, bare, tone, bloom) {
		const own = [0, 1, 2].map(c => Array.isArray(gain) ? gain[c] : gain), wide = bloom > 0 && Math.min(width, height) >= 16, octaves = wide ? this.glow(own) : 1;
		this.g.target(null, width, height);
		this.g.draw(this.present, { picture: this.target, glow: wide ? this.glows[1] : this.target, gain: own, bare: bare ? 1 : 0, tone: tone || 0, bloom: wide ? bloom : 0, octaves, size: [width, height] });
	}
}

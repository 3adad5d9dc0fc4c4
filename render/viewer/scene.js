/* One eye as the shaders see it: lib/eye/scene.h with everything that a hand can change. Matrices are rows. */
const turns = {
	multiply: (a, b) => [0, 1, 2].flatMap(i => [0, 1, 2].map(j => a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j])),
	transpose: a => [a[0], a[3], a[6], a[1], a[4], a[7], a[2], a[5], a[8]],
	apply: (a, v) => [0, 1, 2].map(i => a[3 * i] * v[0] + a[3 * i + 1] * v[1] + a[3 * i + 2] * v[2]),
	/* Of scene_view_turned(): yaw, then pitch; radians. */
	turned(yaw, pitch) {
		const cy = Math.cos(yaw), sy = Math.sin(yaw), cp = Math.cos(pitch), sp = Math.sin(pitch);
		return [cy, 0, -sy, sp * sy, cp, sp * cy, cp * sy, -sp, cp * cy];
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
	{ name: "full", steps: 12, scale: 1, lights: 8, shadow: 4, search: 8, march: true },
	{ name: "high", steps: 6, scale: 1, lights: 4, shadow: 2, search: 6, march: true },
	{ name: "medium", steps: 4, scale: 0.66, lights: 4, shadow: 0, search: 5, march: true },
	{ name: "low", steps: 3, scale: 0.66, lights: 4, shadow: 0, search: 4, march: false },
	{ name: "least", steps: 3, scale: 0.4, lights: 2, shadow: 0, search: 3, march: false },
];

class EyeScene {
	static LIGHTS = 8;
	static GRID = 48;
	static NODES = 12;

	constructor(g, data) {
		Object.assign(this, { g, data, count: 0, target: null });
		for (const name of ["paths", "present"])
			this[name] = g.program(name);
		this.path_maps = {};
	}

	/* The eye alone; in a face the face's own program draws it, and this is never compiled. */
	get eye() {
		return this.alone = this.alone || this.g.program("eye");
	}

	async load() {
		const { g, data } = this, m = data.maps;
		const [relief, colour, model, veins, film] = await Promise.all([g.map(m.relief, 0), g.map(m.colour, "srgb"),
			g.map(m.model, "log"), g.map(m.veins, "log-flat"), g.map(m.film, "plain")]);
		this.maps = { relief_map: relief, colour_map: colour, model_map: model, vein_map: veins, film_map: film };
		this.lights = await Promise.all(data.lights.map(async l => ({ ...l,
			sharp_map: l.sharp ? await g.map(l.sharp, "log-flat") : null, rough_map: l.rough ? await g.map(l.rough, "log-flat") : null })));
	}

	/* Neighbouring lights become one, as the median cut had them. */
	static merged(list, n) {
		list = list.map(l => [...l]);
		while (list.length > n) {
			const next = [];
			for (let i = 0; i < list.length; i += 2) {
				const a = list[i], b = list[i + 1];
				if (!b) {
					next.push(a);
					continue;
				}
				const wa = a[3] + a[4] + a[5], wb = b[3] + b[4] + b[5];
				const d = [0, 1, 2].map(k => wa * a[k] + wb * b[k]), len = Math.hypot(...d) || 1;
				next.push([...d.map(v => v / len), a[3] + b[3], a[4] + b[4], a[5] + b[5]]);
			}
			list = next;
		}
		return list;
	}

	/* Lights in the eye's frame that reach the iris: no path leads in from further than 99 degrees off the axis. */
	beams(light, eye_from_env, gain, n) {
		const dir = [], rgb = [];
		for (const l of EyeScene.merged(light.lights, n)) {
			const d = turns.apply(eye_from_env, l);
			if (d[2] <= 0.16) {
				dir.push(...d);
				rgb.push(l[3] * gain, l[4] * gain, l[5] * gain);
			}
		}
		return { n: dir.length / 3, dir: EyeScene.padded(dir, 3 * EyeScene.LIGHTS), rgb: EyeScene.padded(rgb, 3 * EyeScene.LIGHTS) };
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
		const distance = 500, aim = z - 0.1 * e.sclera[1], focal = distance * height / view.field, c = turns.apply(R, [0, 0, z]);
		const t = [-c[0], -c[1], distance + aim - c[2]];
		const away = R[8] * e.iris_depth + t[2];
		return { R, head_from_eye, origin: turns.apply(turns.transpose(R), t).map(v => -v), corner: [0, 0],
			lens: [focal, view.width / 2, height / 2, 1], pixel: away / focal };
	}

	/* The level of the maps whose texels are about as large as a pixel. */
	level(pixel) {
		const n = this.data.eye.map_px, per_mm = n / (2 * this.data.eye.extent);
		let k = 0;
		while (k < 5 && (n >> k) >= 64 && per_mm / (2 << k) * pixel > 0.8)
			k++;
		return k;
	}

	tissue(s) {
		const key = [s.abl_melanin, s.abl_ratio, s.stroma_melanin, s.stroma_ratio, s.thickness_scale].join();
		if (this.tissue_key !== key) {
			const t = this.data.tissue, o = tissue.optics(t, s);
			this.tissue_key = key;
			this.optics = { source: o.source.flat(), extinction: o.extinction.flat(), flat_rgb: tissue.flat(t, o, 0.48),
				band_rgb: [0, 1, 2].flatMap(c => t.bands.map(b => b[5 + c])).concat([0, 0, 0, 0]) };
		}
		return this.optics;
	}

	/* Places and weights of the march's steps in both layers, for tissue that fades light as this does: between the rules that
	 * lib/eye/scene_nodes.c makes. */
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
	}

	/* The light's ways into the eye as this camera has it, once for each change; kept by name. */
	solve(s, cam, preset, name) {
		const { g, data } = this, gl = g.gl, e = data.eye, light = this.lights[s.light] || this.lights[0];
		const turn = turns.turned(s.light_yaw * Math.PI / 180, s.light_pitch * Math.PI / 180);
		const env_from_eye = turns.multiply(turns.transpose(turn), cam.head_from_eye);
		const beams = this.beams(light, turns.transpose(env_from_eye), s.light_gain, Math.min(preset.lights, light.lights.length));
		const key = [s.R, s.p, s.n, beams.n, ...beams.dir].join(), old = this.path_maps[name];
		const values = { cornea_R: s.R, cornea_p: s.p, cornea_n: s.n, extent: e.extent, rim: e.limbus[0], limbus: e.limbus, beam_dir: beams.dir, path_bend: data.constants.path_bend,
			beam_z: [e.iris_depth - e.heights[1], e.iris_depth - e.heights[0] + data.tissue.abl + e.thickness_max] };
		const map = old ? old.map : g.texture(2 * EyeScene.GRID, EyeScene.LIGHTS * EyeScene.GRID, gl.RGBA16F);
		if (!old || old.key !== key) {
			gl.disable(gl.BLEND);
			g.target(map);
			gl.enable(gl.SCISSOR_TEST);
			gl.scissor(0, 0, 2 * EyeScene.GRID, Math.max(1, beams.n) * EyeScene.GRID);
			g.draw(this.paths, values);
			gl.disable(gl.SCISSOR_TEST);
		}
		this.path_maps[name] = { key, map };
		this.solved = { ...this.solved, [name]: { ...values, path_map: map, env_from_eye, beams: beams.n, beam_rgb: beams.rgb, light } };
	}

	/* Every pixel of the target's ray. */
	trace(s, cam, preset, jitter, extra, size, program) {
		const { g, data } = this, e = data.eye, solved = this.solved[cam.side === undefined ? "eye" : `face${cam.side}`], light = solved.light;
		g.draw(program || this.eye, {
			...solved, origin: cam.origin, eye_from_cam: turns.transpose(cam.R), lens: cam.lens, corner: cam.corner,
			size, jitter, slip: cam.slip ? [...cam.slip, 0, 0, 0] : [0, 0, 0, 0, 0, 0, 0, 0, 0],
			back: e.back, sclera: this.sclera(s), sclera_reach: data.constants.sclera_reach, pupil: e.pupil, pupil_now: s.pupil, iris_depth: e.iris_depth, pixel: cam.pixel,
			heights: e.heights, level: this.level(cam.pixel), map_size: e.map_px, ...this.maps,
			sharp_map: light.sharp_map || this.lights[0].sharp_map, rough_map: light.rough_map || this.lights[0].rough_map,
			...this.tissue(s), abl: data.tissue.abl, exposure: data.tissue.exposure,
			tissue_gain: e.gain, detail: s.detail, ...this.nodes(preset.steps, this.optics.extinction),
			search: preset.search, shadow_steps: preset.shadow, flat_iris: preset.march ? 0 : 1,
			quadric: light.quadric.flat().map(v => v * s.light_gain), even: light.even.map(v => v * s.light_gain),
			mirror_on: light.sharp_map ? s.light_gain : 0, tear: s.tear,
			...extra,
		});
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
		g.target(this.target);
		this.trace(s, cam, preset, jitter, {}, [width, height]);
		gl.disable(gl.BLEND);
		this.count++;
	}

	restart() {
		this.count = 0;
	}

	show(width, height, gain, bare) {
		this.g.target(null, width, height);
		this.g.draw(this.present, { picture: this.target, gain, bare: bare ? 1 : 0, size: [width, height] });
	}
}

/* What leaves the page: the .glb that it carries, with what is set: gaze as the eyes' turns, lids, expressions and pupil as weights of the
 * targets of those names, index and pigment in the materials. Nothing of it is read before it is asked for. */
const leaves = (() => {
	const LOOKS = [25, 20];  // degrees that the targets eyeLookOut and so on, and eyeLookUp and Down stand for (lib/rig/glb/poses.c)
	const WIDE = 0.3;        // what eyeWide opens beyond what is usual
	const padded = n => n + 3 & ~3;

	function open(text) {
		const bytes = Graphics.bytes(text), d = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength), n = d.getUint32(12, true);
		return { json: JSON.parse(new TextDecoder().decode(bytes.subarray(20, 20 + n))), bin: bytes.subarray(28 + n, 28 + n + d.getUint32(20 + n, true)) };
	}

	function close({ json, bin }) {
		const text = new TextEncoder().encode(JSON.stringify(json)), at = 20 + padded(text.length), out = new Uint8Array(at + 8 + padded(bin.length)), d = new DataView(out.buffer);
		[0x46546c67, 2, out.length, padded(text.length), 0x4e4f534a].forEach((v, i) => d.setUint32(4 * i, v, true));
		out.fill(32, 20, at);
		out.set(text, 20);
		d.setUint32(at, padded(bin.length), true);
		d.setUint32(at + 4, 0x004e4942, true);
		out.set(bin, at + 8);
		return out;
	}

	/* Quaternions x y z w. */
	const times = ([a, b, c, d], [e, f, g, h]) => [d * e + a * h + b * g - c * f, d * f - a * g + b * h + c * e, d * g + a * f - b * e + c * h, d * h - a * e - b * f - c * g];
	const about = (axis, deg) => [0, 1, 2].map(k => k === axis ? Math.sin(deg * Math.PI / 360) : 0).concat(Math.cos(deg * Math.PI / 360));
	const turned = ([h, v, t]) => times(times(about(1, h), about(0, -v)), about(2, t || 0));

	/* Weights by the targets' names. gazes, open: of the left and the right eye. */
	function face_weights(gazes, lids, expressions) {
		const out = {};
		["Left", "Right"].forEach((side, k) => {
			const [h, v] = [0, 1].map(i => gazes[k][i] / LOOKS[i]), out_of = k ? -h : h;
			Object.assign(out, { [`eyeBlink${side}`]: 1 - lids[k], [`eyeWide${side}`]: (lids[k] - 1) / WIDE, [`eyeLookOut${side}`]: out_of, [`eyeLookIn${side}`]: -out_of,
				[`eyeLookUp${side}`]: v, [`eyeLookDown${side}`]: -v });
		});
		for (const name of Object.keys(out))
			out[name] = Math.min(1, Math.max(0, out[name]));
		return Object.assign(out, expressions);
	}

	/* Weights of a mesh's targets that others drive, as its file says: "w v", "4 w (1 - w)" or "4 w (1 - w) v" (lib/rig/glb/bake.h). */
	function driven(mesh, weights) {
		return Object.fromEntries((mesh.extras.drivenTargets || []).map(d => {
			const w = weights[d.by] || 0, v = d.and ? weights[d.and] || 0 : 1;
			return [d.target, (d.weight.startsWith("4 w") ? 4 * w * (1 - w) : w) * v];
		}));
	}

	/* Of a pupil so wide (mm), whose mesh was made with one of `own`: towards 1 or 8 mm. */
	const pupil_weights = (own, wide) => wide < own ? { pupil_1mm: (own - wide) / (own - 1) } : { pupil_8mm: (wide - own) / (8 - own) };

	function weigh(json, weights, pupil) {
		for (const mesh of json.meshes) {
			const names = mesh.extras && mesh.extras.targetNames || [], own = mesh.extras && mesh.extras.pupil_mm, of = own ? pupil_weights(own, pupil) : weights;
			if (names.length) {
				const all = { ...of, ...driven(mesh, of) };
				mesh.weights = names.map(name => all[name] || 0);
			}
		}
	}

	/* The eyes of a face, or the one that is all there is. */
	function turn(json, gazes) {
		const eyes = ["eye_left", "eye_right"].map(name => json.nodes.find(n => n.name === name));
		if (eyes[0])
			eyes.forEach((node, k) => { node.rotation = times(node.rotation || [0, 0, 0, 1], turned(gazes[k])); });
		else
			json.nodes[json.scenes[0].nodes[0]].rotation = turned(gazes[0]);
	}

	function index(json, n) {
		for (const m of json.materials)
			if (m.name === "cornea")
				m.extensions.KHR_materials_ior.ior = n;
	}

	/* Paints the iris' albedo over: every texel by the ratio of the tissue's colour now to the fitted one. */
	async function repaint(file, ratio) {
		const { json } = file, linear = v => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4, coded = v => v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055;
		const lut = ratio.map(r => Uint8Array.from({ length: 256 }, (_, i) => Math.round(255 * Math.min(1, coded(r * linear(i / 255))))));
		const maps = new Set(json.materials.filter(m => m.name === "iris").map(m => json.textures[m.pbrMetallicRoughness.baseColorTexture.index].source));
		for (const i of maps) {
			const view = json.bufferViews[json.images[i].bufferView], from = view.byteOffset || 0;
			const picture = await createImageBitmap(new Blob([file.bin.slice(from, from + view.byteLength)], { type: "image/png" }), { colorSpaceConversion: "none" });
			const canvas = element("canvas", { width: picture.width, height: picture.height }), draw = canvas.getContext("2d", { willReadFrequently: true });
			draw.drawImage(picture, 0, 0);
			const image = draw.getImageData(0, 0, picture.width, picture.height), px = image.data;
			for (let k = 0; k < px.length; k += 4)
				for (let c = 0; c < 3; c++)
					px[k + c] = lut[c][px[k + c]];
			draw.putImageData(image, 0, 0);
			const png = new Uint8Array(await (await new Promise(done => canvas.toBlob(done, "image/png"))).arrayBuffer()), at = padded(file.bin.length), bin = new Uint8Array(at + png.length);
			bin.set(file.bin);
			bin.set(png, at);
			file.bin = bin;
			json.images[i].bufferView = json.bufferViews.push({ buffer: 0, byteOffset: at, byteLength: png.length }) - 1;
		}
		json.buffers[0].byteLength = file.bin.length;
	}

	return { open, close, face_weights, weigh, turn, index, repaint };
})();

class Leaving extends Tools {
	/* The element that holds the .glb of what is shown; null: the page has none. */
	carried() {
		return by_id("glb-face") || by_id(`glb-${this.index}`);
	}

	/* The tissue's mean colour with these melanins. */
	tissue_colour(values) {
		const t = this.eye.tissue, bands = tissue.colour(t, values);
		return [0, 1, 2].map(c => t.bands.reduce((sum, b, k) => sum + b[5 + c] * bands[k], 0));
	}

	/* The file as bytes, with what is set. */
	async leave() {
		const file = leaves.open(this.carried().textContent), { json } = file, s = this.state(), moved = key => Math.abs(this.values[key] - this.controls.find(c => c.key === key).value) > 1e-9;
		const [h, v] = [0, 1].map(k => this.eyes.eye[k]), gazes = data.face ? this.gazes(h, v) : [[h, v]];
		let weights = {};
		if (data.face) {
			const clip = this.playing === null ? null : this.clip_controls, lids = this.lids().map((open, k) => clip ? open * this.face.poser.opened(clip, k) : open);
			weights = leaves.face_weights(gazes, lids, Object.fromEntries(data.face.expressions.map((e, k) => [e.name, clip ? clip[10 + k] : this.values[`au${k}`]])));
		}
		leaves.turn(json, gazes);
		leaves.weigh(json, weights, 2 * s.pupil);
		leaves.index(json, s.n);
		if (["abl_eu", "abl_pheo", "stroma_eu", "stroma_pheo", "thickness_scale"].some(moved)) {
			const was = this.tissue_colour(this.eye.tissue.fitted);
			await leaves.repaint(file, this.tissue_colour(s).map((c, k) => c / was[k]));
		}
		const set = Object.fromEntries(this.controls.map(c => [c.key, this.values[c.key]]));
		json.asset.extras = { ...json.asset.extras, set, not_carried: ["R", "p", "detail", "tear"].filter(moved) };
		return leaves.close(file);
	}

	async save_glb() {
		by_id("busy").textContent = "Packing…";
		Tools.download(new Blob([await this.leave()], { type: "model/gltf-binary" }), `${data.face ? data.face.name : "eye"}.glb`);
		by_id("busy").textContent = "";
		said("glTF saved");
	}
}

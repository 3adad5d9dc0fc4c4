/* Surroundings from a file: a latitude-longitude picture, Radiance HDR or OpenEXR (half or float; not compressed, or RLE, ZIP), becomes what
 * lib/draw/web/light.c writes: the same sums as lib/image/envmap, in the same frame. A picture here: {width, height, rgb}. */
const panorama = (() => {
	const LONGEST = 8192, BYTES = 1 << 29, ROWS = 256, COARSE = 64, LOW = 32, ROUGH = 64;
	const need = (fine, why) => { if (!fine) throw new Error(why); };

	function sized(width, height) {
		need(width === 2 * height && height >= 8, `${width} × ${height} px: a latitude-longitude picture is twice as wide as high, 16 × 8 at least`);
		need(width <= LONGEST, `${width} × ${height} px: at most ${LONGEST} px wide`);
		return { width, height, rgb: new Float32Array(3 * width * height) };
	}

	/* ---- files */
	function hdr(bytes) {
		let at = 0;
		const line = () => {
			let text = "";
			for (; at < bytes.length && bytes[at] !== 10 && text.length < 2000; at++)
				text += String.fromCharCode(bytes[at]);
			at++;
			return text;
		};
		need(/^#\?/.test(line()), "not a Radiance picture");
		let format = "", text = line();
		for (let n = 0; text && n < 100; text = line(), n++)
			format = text.startsWith("FORMAT=") ? text.slice(7).trim() : format;
		need(format === "32-bit_rle_rgbe", `format ${format || "not told"}: only 32-bit_rle_rgbe is read`);
		const size = /^-Y (\d+) \+X (\d+)$/.exec(line());
		need(size, "only pictures that run down and to the right are read");
		const out = sized(Number(size[2]), Number(size[1])), w = out.width, row = new Uint8Array(4 * w), next = () => { need(at < bytes.length, "the file is cut off"); return bytes[at++]; };
		for (let y = 0; y < out.height; y++) {
			const runs = w >= 8 && w < 32768 && bytes[at] === 2 && bytes[at + 1] === 2 && bytes[at + 2] < 128;
			if (runs) {
				need((bytes[at + 2] << 8 | bytes[at + 3]) === w, "a row is not as wide as the picture");
				at += 4;
				for (let c = 0; c < 4; c++)
					for (let x = 0; x < w;) {
						const n = next(), run = n > 128, count = run ? n - 128 : n, value = run ? next() : 0;
						need(count > 0 && x + count <= w, "a row is longer than the picture");
						for (let k = 0; k < count; k++, x++)
							row[4 * x + c] = run ? value : next();
					}
			} else {
				need(at + 4 * w <= bytes.length, "the file is cut off");
				row.set(bytes.subarray(at, at += 4 * w));
			}
			for (let x = 0; x < w; x++)
				for (let c = 0; c < 3; c++)
					out.rgb[3 * (y * w + x) + c] = row[4 * x + 3] ? row[4 * x + c] * Math.pow(2, row[4 * x + 3] - 136) : 0;
		}
		return out;
	}

	function half(v) {
		const e = v >> 10 & 31, m = v & 1023, sign = v & 32768 ? -1 : 1;
		return sign * (e === 31 ? m ? NaN : Infinity : e ? Math.pow(2, e - 25) * (1024 + m) : Math.pow(2, -24) * m);
	}

	async function inflated(bytes, size) {
		const reader = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate")).getReader(), out = new Uint8Array(size);
		for (let at = 0;;) {
			const { done, value } = await reader.read();
			if (done) {
				need(at === size, "a block of the picture is cut off");
				return out;
			}
			if (at + value.length > size) {
				reader.cancel();
				need(false, "a block of the picture is larger than it says");
			}
			out.set(value, at);
			at += value.length;
		}
	}

	function unrolled(bytes, size) {
		const out = new Uint8Array(size);
		let to = 0;
		for (let at = 0; at < bytes.length;) {
			const n = bytes[at] << 24 >> 24, count = n < 0 ? -n : n + 1;
			need(to + count <= size && at + (n < 0 ? count : 1) < bytes.length, "a block of the picture is larger than it says");
			if (n < 0)
				out.set(bytes.subarray(at + 1, at + 1 + count), to);
			else
				out.fill(bytes[at + 1], to, to + count);
			at += n < 0 ? count + 1 : 2;
			to += count;
		}
		need(to === size, "a block of the picture is cut off");
		return out;
	}

	/* What OpenEXR does before it compresses, undone: differences, and the two halves of the bytes apart. */
	function joined(bytes) {
		const out = new Uint8Array(bytes.length), middle = bytes.length + 1 >> 1;
		for (let i = 1; i < bytes.length; i++)
			bytes[i] = bytes[i - 1] + bytes[i] - 128;
		for (let i = 0; i < bytes.length; i++)
			out[i] = bytes[i & 1 ? middle + (i >> 1) : i >> 1];
		return out;
	}

	async function exr(bytes) {
		const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength), kept = {};
		let at = 8;
		const text = () => {
			const from = at;
			while (at < bytes.length && bytes[at])
				at++;
			need(at < bytes.length && at - from < 256, "the file is cut off");
			return new TextDecoder("latin1").decode(bytes.subarray(from, at++));
		};
		need(!(view.getUint32(4, true) & 0x1a00), "tiles, layers apart and depths are not read: save it as one picture of scan lines");
		for (let name = text(), n = 0; name; name = text(), n++) {
			need(n < 200, "too many attributes");
			text();
			const size = view.getUint32(at, true);
			need(at + 4 + size <= bytes.length, "the file is cut off");
			kept[name] = [at + 4, size];
			at += 4 + size;
		}
		need(kept.channels && kept.compression && kept.dataWindow && kept.dataWindow[1] === 16, "a picture without channels, compression or size");
		const compression = bytes[kept.compression[0]], lines = [1, 1, 1, 16][compression], box = [0, 1, 2, 3].map(k => view.getInt32(kept.dataWindow[0] + 4 * k, true));
		need(lines, "compressed in a way that is not read: save it with ZIP, RLE or no compression");
		const out = sized(box[2] - box[0] + 1, box[3] - box[1] + 1), w = out.width, offsets = at, channels = [], end = kept.channels[0] + kept.channels[1];
		for (at = kept.channels[0]; at < end && bytes[at];) {
			const name = text(), type = view.getInt32(at, true);
			need(type >= 0 && type <= 2 && view.getInt32(at + 8, true) === 1 && view.getInt32(at + 12, true) === 1, `channel ${name} is not sampled at each pixel`);
			channels.push({ to: ["R", "G", "B"].indexOf(name), type, size: type === 1 ? 2 : 4 });
			at += 16;
		}
		need([0, 1, 2].every(c => channels.some(q => q.to === c && q.type)), "no channels R, G and B of floating-point numbers");
		const line = w * channels.reduce((sum, c) => sum + c.size, 0), blocks = Math.ceil(out.height / lines);
		need(offsets + 8 * blocks <= bytes.length, "the file is cut off");
		for (let b = 0; b < blocks; b++) {
			const from = Number(view.getBigUint64(offsets + 8 * b, true));
			need(from + 8 <= bytes.length, "a block lies beyond the file's end");
			const top = view.getInt32(from, true) - box[1], size = view.getInt32(from + 4, true), count = Math.min(lines, out.height - top);
			need(top >= 0 && count > 0 && size >= 0 && from + 8 + size <= bytes.length, "a block lies beyond the picture");
			const packed = bytes.subarray(from + 8, from + 8 + size), whole = count * line;
			const raw = size === whole ? packed : joined(compression === 1 ? unrolled(packed, whole) : await inflated(packed, whole)), values = new DataView(raw.buffer, raw.byteOffset, raw.byteLength);
			let p = 0;
			for (let y = top; y < top + count; y++)
				for (const c of channels) {
					for (let x = 0; x < w && c.to >= 0; x++)
						out.rgb[3 * (y * w + x) + c.to] = c.type === 1 ? half(values.getUint16(p + 2 * x, true)) : values.getFloat32(p + 4 * x, true);
					p += c.size * w;
				}
		}
		return out;
	}

	async function read(file) {
		need(file.size < BYTES, "the file is larger than 512 MB");
		const bytes = new Uint8Array(await file.arrayBuffer()), is = list => bytes.length > 16 && list.every((v, i) => bytes[i] === v);
		need(is([0x76, 0x2f, 0x31, 1]) || is([0x23, 0x3f]), "neither Radiance HDR nor OpenEXR");
		let out;
		try {
			out = bytes[0] === 0x76 ? await exr(bytes) : hdr(bytes);
		} catch (e) {
			throw e instanceof RangeError || e instanceof TypeError ? new Error("the file is damaged") : e;
		}
		out.rgb.forEach((v, i) => { if (!(v > 0 && v < 1e30)) out.rgb[i] = 0; });
		return out;
	}

	/* ---- lib/image/envmap */
	function direction(u, v) {
		const polar = v * Math.PI, turn = (u - 0.5) * 2 * Math.PI;
		return [-Math.sin(polar) * Math.sin(turn), -Math.cos(polar), -Math.sin(polar) * Math.cos(turn)];
	}

	const solid = (map, y) => (Math.cos(Math.PI * y / map.height) - Math.cos(Math.PI * (y + 1) / map.height)) * 2 * Math.PI / map.width;
	const lum = (map, i) => 0.2126 * map.rgb[3 * i] + 0.7152 * map.rgb[3 * i + 1] + 0.0722 * map.rgb[3 * i + 2];

	/* Means of equal areas of the grid: rows need not divide the picture's. */
	function coarse(map, rows) {
		if (map.height <= rows)
			return map;
		const out = { width: 2 * rows, height: rows, rgb: new Float32Array(6 * rows * rows) }, k = map.height / rows;
		for (let y = 0; y < rows; y++)
			for (let x = 0; x < 2 * rows; x++) {
				const y0 = Math.floor(y * k), y1 = Math.max(Math.floor((y + 1) * k), y0 + 1), x0 = Math.floor(x * k), x1 = Math.max(Math.floor((x + 1) * k), x0 + 1);
				for (let c = 0; c < 3; c++) {
					let sum = 0;
					for (let j = y0; j < y1; j++)
						for (let i = x0; i < x1; i++)
							sum += map.rgb[3 * (j * map.width + i) + c];
					out.rgb[3 * (y * out.width + x) + c] = sum / ((y1 - y0) * (x1 - x0));
				}
			}
		return out;
	}

	function energy(map, r) {
		let sum = 0;
		for (let y = r[1]; y < r[3]; y++) {
			let row = 0;
			for (let x = r[0]; x < r[2]; x++)
				row += lum(map, y * map.width + x);
			sum += row * solid(map, y);
		}
		return sum;
	}

	/* Across its longer side (in angle), at half of its energy. */
	function cut(map, r) {
		const width = (r[2] - r[0]) * Math.sin(Math.PI * 0.5 * (r[1] + r[3]) / map.height), across = width >= r[3] - r[1] && r[2] - r[0] > 1 || r[3] - r[1] < 2;
		const lo = across ? r[0] : r[1], hi = across ? r[2] : r[3], half_of = energy(map, r) / 2;
		let at = lo < hi ? lo + 1 : hi, sum = 0;
		for (let i = lo; i < hi - 1; i++) {
			sum += energy(map, across ? [i, r[1], i + 1, r[3]] : [r[0], i, r[2], i + 1]);
			at = i + 1;
			if (sum >= half_of)
				break;
		}
		return across ? [[r[0], r[1], at, r[3]], [at, r[1], r[2], r[3]]] : [[r[0], r[1], r[2], at], [r[0], at, r[2], r[3]]];
	}

	/* Direction and irradiance over pi of a region; null: it is black. */
	function light(map, r) {
		const dir = [0, 0, 0], rgb = [0, 0, 0];
		for (let y = r[1]; y < r[3]; y++)
			for (let x = r[0]; x < r[2]; x++) {
				const d = direction((x + 0.5) / map.width, (y + 0.5) / map.height), w = solid(map, y), i = y * map.width + x, l = lum(map, i);
				for (let c = 0; c < 3; c++) {
					dir[c] += d[c] * w * l;
					rgb[c] += w * map.rgb[3 * i + c] / Math.PI;
				}
			}
		const n = Math.hypot(...dir);
		return n > 0 ? [...dir.map(v => v / n), ...rgb] : null;
	}

	/* Regions of about equal energy times solid angle, or (even) of equal energy. */
	function lights(map, n, even) {
		const spread = r => {
			let angle = 0;
			for (let y = r[1]; y < r[3]; y++)
				angle += (r[2] - r[0]) * solid(map, y);
			return (r[2] - r[0]) * (r[3] - r[1]) > 1 ? (even ? 1 : angle) * energy(map, r) : 0;
		};
		const whole = [0, 0, map.width, map.height], regions = [{ r: whole, spread: spread(whole) }];
		while (regions.length < n) {
			const most = regions.reduce((a, b) => b.spread > a.spread ? b : a);
			if (!(most.spread > 0))
				break;
			regions.splice(regions.indexOf(most), 1, ...cut(map, most.r).map(r => ({ r, spread: spread(r) })));
		}
		return regions.map(q => light(map, q.r)).filter(l => l);
	}

	/* Irradiance over pi as a polynomial of the normal (Ramamoorthi and Hanrahan 2001). */
	function quadric(map) {
		const lobe = [1, 2 / 3, 2 / 3, 2 / 3, 0.25, 0.25, 0.25, 0.25, 0.25], sh = lobe.map(() => [0, 0, 0]);
		for (let y = 0; y < map.height; y++)
			for (let x = 0; x < map.width; x++) {
				const [a, b, d] = direction((x + 0.5) / map.width, (y + 0.5) / map.height), w = solid(map, y), i = 3 * (y * map.width + x);
				const h = [0.282094791773878, 0.48860251190292 * b, 0.48860251190292 * d, 0.48860251190292 * a, 1.092548430592079 * a * b, 1.092548430592079 * b * d,
					0.31539156525252 * (3 * d * d - 1), 1.092548430592079 * a * d, 0.54627421529604 * (a * a - b * b)];
				h.forEach((v, k) => { for (let c = 0; c < 3; c++) sh[k][c] += lobe[k] * v * w * map.rgb[i + c]; });
			}
		const factor = [0.282094791773878, 0.48860251190292, 0.48860251190292, 0.48860251190292, 1.092548430592079, 1.092548430592079, 0.94617469575756, 1.092548430592079, 0.54627421529604];
		const terms = [0, 3, 1, 2, 4, 5, 6, 7, 8].map((from, k) => sh[from].map((v, c) => factor[k] * v - (k ? 0 : 0.31539156525252 * sh[6][c])));
		return terms;
	}

	/* Light below a film of water, lib/image/envmap/envmap.c: the lobe round the normal as a polynomial of degree 4. */
	function wet(map, lobe) {
		const powers = [], key = k => k.join(), sum = {}, line = [0, 1, 2].map(() => [0, 0, 0]);
		for (let a = 4; a >= 0; a--)
			for (let b = 4 - a; b >= 0; b--)
				powers.push([a, b, 4 - a - b]);
		powers.forEach(k => { sum[key(k)] = [0, 0, 0]; });
		for (let y = 0; y < map.height; y++)
			for (let x = 0; x < map.width; x++) {
				const d = direction((x + 0.5) / map.width, (y + 0.5) / map.height), w = solid(map, y) / Math.PI, i = 3 * (y * map.width + x);
				for (let c = 0; c < 3; c++) {
					d.forEach((v, k) => { line[k][c] += v * w * map.rgb[i + c]; });
					powers.forEach(k => { sum[key(k)][c] += d[0] ** k[0] * d[1] ** k[1] * d[2] ** k[2] * w * map.rgb[i + c]; });
				}
			}
		const axes = [[2, 0, 0], [0, 2, 0], [0, 0, 2]], with_ = (k, s, e) => k.map((v, i) => v + s * e[i]), some = k => k.every(v => v >= 0);
		const moment = (k, c) => !some(k) ? 0 : k[0] + k[1] + k[2] < 4 ? axes.reduce((s, e) => s + moment(with_(k, 1, e), c), 0) : sum[key(k)][c];
		const factorial = [1, 1, 2, 6, 24], ways = k => some(k) ? factorial[k[0] + k[1] + k[2]] / k.reduce((p, v) => p * factorial[v], 1) : 0;
		return [...line.map(v => v.map(u => lobe[1] * u)), ...powers.map(k => [0, 1, 2].map(c => lobe[3] * ways(k) * sum[key(k)][c]
			+ axes.reduce((s, e) => s + lobe[2] * ways(with_(k, -1, e)) * moment(with_(k, -1, e), c), 0)
			+ (k.every(v => v % 2 === 0) ? lobe[0] * ways(k.map(v => v / 2)) * moment([0, 0, 0], c) : 0)))];
	}

	function level(map) {
		let sum = 0;
		for (let y = 0; y < map.height; y++)
			for (let x = 0; x < map.width; x++) {
				const i = 3 * (y * map.width + x);
				sum += Math.max(-direction((x + 0.5) / map.width, (y + 0.5) / map.height)[2], 0) * solid(map, y) * (map.rgb[i] + map.rgb[i + 1] + map.rgb[i + 2]) / (3 * Math.PI);
			}
		return sum;
	}

	/* Directions of the octahedron unfolded about -z. */
	function unfolded(n, of) {
		const out = new Float32Array(4 * n * n);
		for (let y = 0; y < n; y++)
			for (let x = 0; x < n; x++) {
				const u = (2 * x + 1) / n - 1, v = (2 * y + 1) / n - 1, z = 1 - Math.abs(u) - Math.abs(v);
				const a = z < 0 ? Math.sign(u) * (1 - Math.abs(v)) : u, b = z < 0 ? Math.sign(v) * (1 - Math.abs(u)) : v, l = Math.hypot(a, b, z);
				out.set(of([a / l, b / l, -z / l]), 4 * (y * n + x));
			}
		return { n, out };
	}

	function looked_up(map, d) {
		const w = map.width, h = map.height, x = (0.5 + Math.atan2(-d[0], -d[2]) / (2 * Math.PI)) * w - 0.5, y = Math.acos(Math.min(Math.max(-d[1], -1), 1)) / Math.PI * h - 0.5;
		const x0 = (Math.floor(x) + w) % w, x1 = (x0 + 1) % w, y0 = Math.max(Math.floor(y), 0), y1 = Math.min(Math.floor(y) + 1, h - 1), s = x - Math.floor(x), t = y - Math.floor(y);
		const at = (i, j, c) => map.rgb[3 * (j * w + i) + c];
		return [0, 1, 2].map(c => (1 - t) * ((1 - s) * at(x0, y0, c) + s * at(x1, y0, c)) + t * ((1 - s) * at(x0, y1, c) + s * at(x1, y1, c)));
	}

	/* Mean over a Gaussian lobe of six degrees. */
	function lobe(low, dirs, d) {
		const width = 6 * Math.PI / 180, k = 1 / (2 * width * width), sum = [0, 0, 0];
		let total = 0;
		dirs.forEach((e, i) => {
			const off = 2 - 2 * (d[0] * e[0] + d[1] * e[1] + d[2] * e[2]);
			if (off > 0.1)
				return;
			const w = solid(low, Math.floor(i / low.width)) * Math.exp(-k * off);
			total += w;
			for (let c = 0; c < 3; c++)
				sum[c] += w * low.rgb[3 * i + c];
		});
		return sum.map(v => total > 0 ? v / total : 0);
	}

	/* like: a light of the page, whose numbers of beams and directions are taken; lobe_of_wet: the page's constants.wet_lobe. */
	function made(picture, name, like, lobe_of_wet) {
		const map = coarse(picture, ROWS), few = coarse(map, COARSE), gain = 1 / level(few);
		need(Number.isFinite(gain), "no light comes from in front of the eye");
		for (const m of new Set([map, few]))
			m.rgb.forEach((v, i) => { m.rgb[i] = v * gain; });
		const low = coarse(few, LOW), dirs = Array.from({ length: low.width * low.height }, (_, i) => direction((i % low.width + 0.5) / low.width, (Math.floor(i / low.width) + 0.5) / low.height));
		return { name, opened: true, beams: like.beams, lights: lights(few, like.lights.length, false), skies: lights(few, 8, true), quadric: quadric(few), wet: wet(few, lobe_of_wet),
			sharp: unfolded(2 * map.height, d => looked_up(map, d)), rough: unfolded(ROUGH, d => lobe(low, dirs, d)) };
	}
	return { read, made };
})();

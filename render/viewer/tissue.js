"use strict";
/* The tissue of lib/tissue/tissue.c and tissue/forward.c: coefficients for the shader from melanin. Spectra come from there; a test
 * holds the results against it. */
const tissue = (() => {
	const VIEW = 5, LIGHT = 6, NODES = 7, ORDERS = 10, PLACES = [0, 1, 2, 3, 4, 5, 6];
	const gauss_node = [0.046910077030668, 0.230765344947158, 0.5, 0.769234655052842, 0.953089922969332];
	const gauss_weight = [0.118463442528095, 0.239314335249683, 0.284444444444444, 0.239314335249683, 0.118463442528095];

	const make = f => PLACES.map(i => PLACES.map(j => f(i, j)));
	const multiply = (a, b) => make((i, j) => PLACES.reduce((sum, k) => sum + a[i][k] * b[k][j], 0));

	/* (1 - a b)^-1 c, by elimination. */
	function between(a, b, c) {
		const m = multiply(a, b).map((row, i) => row.map((v, j) => (i === j ? 1 : 0) - v)), out = c.map(row => row.slice());
		for (const k of PLACES)
			for (const i of PLACES) {
				const f = i === k ? 0 : m[i][k] / m[k][k];
				for (let j = 0; j < NODES && i !== k; j++) {
					m[i][j] -= f * m[k][j];
					out[i][j] -= f * out[k][j];
				}
			}
		return out.map((row, i) => row.map(v => v / m[i][i]));
	}

	/* What a layer over a ground that reflects `below` sends back; the light that reaches the ground. */
	function add(r, t, below) {
		const down = between(r, below, t), through = multiply(t, multiply(below, down));
		return [make((i, j) => r[i][j] + through[i][j]), down];
	}

	function twice([r, t]) {
		const [sum, down] = add(r, t, r);
		return [sum, multiply(t, down)];
	}

	function nodes_of(g, cos_view, cos_light) {
		const mu = [...gauss_node, cos_view, cos_light], weight = [...gauss_weight, 1e-8, 1e-8], peak = Math.pow(g, ORDERS);
		const p = mu.map(m => {
			const of = [1, m];
			for (let l = 2; l < ORDERS; l++)
				of.push(((2 * l - 1) * m * of[l - 1] - (l - 1) * of[l - 2]) / l);
			return of;
		});
		const sum = sign => make((i, j) => p[i].reduce((all, v, l) => all + (l % 2 ? sign : 1) * (2 * l + 1) * (Math.pow(g, l) - peak) / (1 - peak) * v * p[j][l], 0));
		return { g, mu, weight, ahead: sum(1), back: sum(-1) };
	}

	/* A layer of reduced optical depth source and absorption depth absorb, doubled from one so thin that it scatters once. */
	function layer(n, source, absorb) {
		const peak = Math.pow(n.g, ORDERS), thin = 5e-4, scatter = source / (1 - n.g) * (1 - peak);
		const albedo = scatter + absorb > 0 ? scatter / (scatter + absorb) : 0;
		let depth = Math.min(scatter + absorb, 60), doublings = 0;
		for (; depth > thin; doublings++)
			depth /= 2;
		const into = j => 2 * n.mu[j] * n.weight[j] * albedo / 4, left = i => Math.exp(-depth / n.mu[i]);
		const passed = (i, j) => Math.abs(n.mu[i] - n.mu[j]) < 1e-6 ? depth / (n.mu[i] * n.mu[i]) * left(i) : (left(i) - left(j)) / (n.mu[i] - n.mu[j]);
		let both = [make((i, j) => into(j) * n.back[i][j] * (1 - Math.exp(-depth * (1 / n.mu[i] + 1 / n.mu[j]))) / (n.mu[i] + n.mu[j])),
			make((i, j) => into(j) * n.ahead[i][j] * passed(i, j) + (i === j ? left(i) : 0))];
		for (; doublings; doublings--)
			both = twice(both);
		return both;
	}

	function first_order(extinction, source, abl, stroma, cos_view, cos_light) {
		const path = 1 / cos_view + 1 / cos_light, through = Math.exp(-extinction[0] * abl * path);
		return (source[0] / extinction[0] * (1 - through)
			+ source[1] / extinction[1] * through * (1 - Math.exp(-extinction[1] * stroma * path))) / (4 * (cos_view + cos_light));
	}

	/* What the first order lacks, because the phase function was cut off. */
	function first_lacks(n, extinction, source, abl, stroma) {
		const TURNS = 16, g = n.g, peak = Math.pow(g, ORDERS), u = n.mu[VIEW], v = n.mu[LIGHT], across = Math.sqrt((1 - u * u) * (1 - v * v));
		let phase = 0;
		for (let i = 0; i < TURNS; i++)
			phase += (1 - g * g) / Math.pow(1 + g * g - 2 * g * (across * Math.cos(Math.PI * (i + 0.5) / TURNS) - u * v), 1.5) / TURNS;
		const scaled = source.map(s => s / (1 - g) * (1 - peak)), all = scaled.map((s, l) => s + extinction[l] - source[l]);
		return (phase / (1 - peak) - n.back[VIEW][LIGHT]) * first_order(all, scaled, abl, stroma, u, v);
	}

	/* All orders of scattering, one wavelength: stroma of no thickness, of `stroma`, and of twice that. */
	function reflectance(g, extinction, source, abl, stroma, cos_view, cos_light) {
		const n = nodes_of(g, cos_view, cos_light), seen = r => r[VIEW][LIGHT] / (2 * n.mu[LIGHT] * n.weight[LIGHT]);
		const [top_r, top_t] = layer(n, source[0] * abl, (extinction[0] - source[0]) * abl);
		const once = layer(n, source[1] * stroma, (extinction[1] - source[1]) * stroma);
		return [seen(top_r), seen(add(top_r, top_t, once[0])[0]), seen(add(top_r, top_t, twice(once)[0])[0])].map((r, i) => r + first_lacks(n, extinction, source, abl, i * stroma));
	}

	/* First-order coefficients that reflect what all orders do. */
	function effective(g, extinction, source, abl) {
		const cos_view = 0.95, cos_light = 0.85, absorb = extinction[1] - source[1];
		const h = Math.min(0.35, 2 / (Math.sqrt(3 * absorb * extinction[1]) + 1e-9));
		const path = 1 / cos_view + 1 / cos_light, front = 4 * (cos_view + cos_light);
		const r = reflectance(g, extinction, source, abl, h, cos_view, cos_light);
		const through = Math.exp(-extinction[0] * abl * path);
		const fade = Math.min(Math.max((r[2] - r[1]) / (r[1] - r[0]), 1e-6), 0.999), decay = -Math.log(fade) / (h * path);
		if (abl > 0)
			source[0] = front * r[0] * extinction[0] / (1 - through);
		source[1] = front * (r[1] - r[0]) * decay / (through * (1 - fade));
		extinction[1] = decay;
	}

	/* data: a tissue as the page carries it; value: {abl_melanin ...}. Returns extinction and source, [layer][wavelength]. */
	function optics(data, value) {
		const out = { extinction: [[], []], source: [[], []] };
		for (const [, eumelanin, pheomelanin, none, scatter] of data.bands) {
			const absorb = (c, b) => c * (b * eumelanin + (1 - b) * pheomelanin) + (1 - c) * none;
			const scale = [1, value.thickness_scale], source = scale.map(s => s * scatter);
			const extinction = [scatter + absorb(value.abl_melanin, value.abl_ratio),
				scale[1] * (scatter + absorb(value.stroma_melanin, value.stroma_ratio))];
			if (data.multiple)
				effective(data.anisotropy, extinction, source, data.abl);
			for (const l of [0, 1]) {
				out.extinction[l].push(extinction[l]);
				out.source[l].push(source[l]);
			}
		}
		return out;
	}
	/* What a stroma of middling thickness under its border layer sends back, for each wavelength. */
	function colour(data, value) {
		const o = optics(data, value), MIDDLING = 0.3;
		return data.bands.map((_, k) => first_order([0, 1].map(l => o.extinction[l][k]), [0, 1].map(l => o.source[l][k]), data.abl, MIDDLING, 0.95, 0.85));
	}
	return { optics, colour };
})();

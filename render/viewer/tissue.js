"use strict";
/* The tissue of lib/tissue/tissue.c and tissue/all.c: coefficients for the shader from melanin. Spectra come from there; a test
 * holds the results against it. */
const tissue = (() => {
	const CELLS_ABL = 4, CELLS_STROMA = 14, CELLS = CELLS_ABL + CELLS_STROMA;

	/* Third exponential integral (Abramowitz and Stegun 5.1.53, 5.1.56). */
	function e3(x) {
		if (x <= 0)
			return 0.5;
		if (x > 40)
			return 0;
		const e = Math.exp(-x);
		let e1;
		if (x < 1) {
			e1 = -Math.log(x) - 0.57721566
				+ x * (0.99999193 + x * (-0.24991055 + x * (0.05519968 + x * (-0.00976004 + x * 0.00107857))));
		} else {
			const p = 0.2677737343 + x * (8.6347608925 + x * (18.0590169730 + x * (8.5733287401 + x)));
			const q = 3.9584969228 + x * (21.0996530827 + x * (25.6329561486 + x * (9.5733223454 + x)));
			e1 = e * p / (q * x);
		}
		return (e * (1 - x) + x * x * e1) / 2;
	}

	function first_order(extinction, source, abl, stroma, cos_view, cos_light) {
		const path = 1 / cos_view + 1 / cos_light, through = Math.exp(-extinction[0] * abl * path);
		return (source[0] / extinction[0] * (1 - through)
			+ source[1] / extinction[1] * through * (1 - Math.exp(-extinction[1] * stroma * path))) / (4 * (cos_view + cos_light));
	}

	function cells(extinction, abl, stroma) {
		const edge = [0];
		const cut = (depth, n) => {
			const from = edge[edge.length - 1], power = 1 + 0.35 * Math.log1p(depth / 4);
			for (let i = 1; i <= n; i++)
				edge.push(from + depth * Math.pow(i / n, power));
		};
		cut(Math.min(Math.max(extinction[0] * abl, 1e-7), 30), CELLS_ABL);
		cut(Math.min(Math.max(extinction[1] * stroma, 1e-7), 30), CELLS_STROMA);
		return edge;
	}

	/* Mean over cell i of half the integral of E1 over cell j. */
	function kernel(edge) {
		const e = edge.map(a => edge.map(b => e3(Math.abs(b - a)))), out = [];
		for (let i = 0; i < CELLS; i++) {
			const depth = edge[i + 1] - edge[i];
			out.push([]);
			for (let j = 0; j < CELLS; j++) {
				const sum = i === j ? depth - 0.5 + e[i][i + 1]
					: (e[i < j ? i + 1 : i][i < j ? j : j + 1] - e[i][j] - e[i + 1][j + 1] + e[i < j ? i : i + 1][i < j ? j + 1 : j]) / 2;
				out[i].push(sum / depth);
			}
		}
		return out;
	}

	function solve(a, b) {
		for (let k = 0; k < CELLS; k++)
			for (let i = k + 1; i < CELLS; i++) {
				const f = a[i][k] / a[k][k];
				for (let j = k + 1; j < CELLS; j++)
					a[i][j] -= f * a[k][j];
				b[i] -= f * b[k];
			}
		for (let k = CELLS - 1; k >= 0; k--) {
			for (let j = k + 1; j < CELLS; j++)
				b[k] -= a[k][j] * b[j];
			b[k] /= a[k][k];
		}
	}

	/* All orders of scattering, one wavelength. */
	function reflectance(extinction, source, abl, stroma, cos_view, cos_light) {
		const edge = cells(extinction, abl, stroma), k = kernel(edge), first = [], rest = [], a = [];
		const layer = i => i < CELLS_ABL ? 0 : 1;
		for (let i = 0; i < CELLS; i++)
			first.push((Math.exp(-edge[i] / cos_light) - Math.exp(-edge[i + 1] / cos_light)) / (4 * (edge[i + 1] - edge[i])));
		for (let i = 0; i < CELLS; i++) {
			const albedo = source[layer(i)] / extinction[layer(i)];
			rest.push(0);
			a.push([]);
			for (let j = 0; j < CELLS; j++) {
				rest[i] += albedo * k[i][j] * first[j] * source[layer(j)] / extinction[layer(j)];
				a[i].push((i === j ? 1 : 0) - albedo * k[i][j]);
			}
		}
		solve(a, rest);
		let sum = first_order(extinction, source, abl, stroma, cos_view, cos_light);
		for (let i = 0; i < CELLS; i++)
			sum += rest[i] * (Math.exp(-edge[i] / cos_view) - Math.exp(-edge[i + 1] / cos_view));
		return sum;
	}

	/* First-order coefficients that reflect what all orders do. */
	function effective(extinction, source, abl) {
		const cos_view = 0.95, cos_light = 0.85, absorb = extinction[1] - source[1];
		const h = Math.min(0.35, 2 / (Math.sqrt(3 * absorb * extinction[1]) + 1e-9));
		const path = 1 / cos_view + 1 / cos_light, front = 4 * (cos_view + cos_light);
		const r = [0, 1, 2].map(i => reflectance(extinction, source, abl, i * h, cos_view, cos_light));
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
				effective(extinction, source, data.abl);
			for (const l of [0, 1]) {
				out.extinction[l].push(extinction[l]);
				out.source[l].push(source[l]);
			}
		}
		return out;
	}
	return { optics };
})();

"use strict";
/* What a shader costs at most, counted in its text: an operator is three floating-point operations (most are on three channels),
 * both sides of a branch count, a loop as often as it can run. Reads: textureLod and texelFetch. */
const BUILT_IN = { dot: 5, length: 6, distance: 9, normalize: 8, cross: 9, sqrt: 2, inversesqrt: 2, exp: 12, pow: 12, log: 6, sin: 2, cos: 2, atan: 24, asin: 24, refract: 24, reflect: 9, mix: 9, clamp: 6, min: 3, max: 3, abs: 0, fract: 3, floor: 3, step: 3, textureLod: 0, texelFetch: 0, texture: 0 };

/* From an opening bracket to behind the one that closes it. */
function closed(text, at) {
	const pair = { "{": "}", "(": ")" }[text[at]];
	for (let depth = 0, i = at; i < text.length; i++) {
		depth += text[i] === text[at] ? 1 : text[i] === pair ? -1 : 0;
		if (!depth)
			return i + 1;
	}
	return text.length;
}

/* What is left with these names defined. */
function chosen(source, defines) {
	const on = [true], out = [];
	for (const line of source.split("\n")) {
		const [, word, name] = /^\s*#(ifdef|ifndef|else|endif)\s*(\w*)/.exec(line) || [];
		if (word === "else")
			on.push(!on.pop());
		else if (word === "endif")
			on.pop();
		else if (word)
			on.push(defines.includes(name) === (word === "ifdef"));
		else if (on.every(v => v))
			out.push(line);
	}
	return out.join("\n");
}

class Count {
	/* limits: how often loops run whose bound has that name. */
	constructor(source, limits, defines) {
		this.text = chosen(source, defines).replace(/\/\/.*|\/\*[\s\S]*?\*\//g, "").replace(/^#.*$/gm, "");
		this.limits = limits;
		this.known = {};
		this.bodies = {};
		for (const m of this.text.matchAll(/^(?:void|float|bool|int|vec[234]|mat[34])\s+(\w+)\s*(?=\()/gm)) {
			const open = closed(this.text, m.index + m[0].length), brace = this.text.slice(open).search(/\S/) + open;
			if (this.text[brace] === "{")
				this.bodies[m[1]] = this.text.slice(brace + 1, closed(this.text, brace) - 1);
		}
	}

	static add(a, b, n) {
		return [a[0] + n * b[0], a[1] + n * b[1]];
	}

	/* [operations, reads] of a function. */
	of(name) {
		this.known[name] = this.known[name] || this.block(this.bodies[name]);
		return this.known[name];
	}

	/* of "int k = 0; k < n; k++". */
	turns(head) {
		const m = /=\s*(-?\w+)[\s\S]*;\s*\w+\s*(<=?)\s*(\w+)[\s\S]*;[\s\S]*?(?:\+=\s*(\d+)|\+\+)/.exec(head) || [], limit = this.limits[m[3]];
		const n = limit === undefined ? Math.floor((Number(m[3]) - Number(m[1]) - (m[2] === "<" ? 1 : 0)) / (m[4] || 1)) + 1 : limit;
		if (!Number.isFinite(n))
			throw new Error(`how often does "for (${head})" run?`);
		return n;
	}

	block(text) {
		const at = text.search(/\bfor\s*\(/);
		if (at < 0)
			return this.line(text);
		const open = text.indexOf("(", at), behind = closed(text, open), brace = behind + text.slice(behind).search(/\S/);
		const end = text[brace] === "{" ? closed(text, brace) : text[brace] === "f" ? text.length : text.indexOf(";", brace) + 1;
		const inside = this.block(text.slice(brace, end).replace(/^\{|\}$/g, ""));
		return Count.add(Count.add(this.line(text.slice(0, at)), inside, this.turns(text.slice(open + 1, behind - 1))), this.block(text.slice(end)), 1);
	}

	line(text) {
		let sum = [3 * (text.match(/[-+*/]=?/g) || []).length, 0];
		for (const [, name] of text.matchAll(/\b([a-z_]\w*)\s*\(/g)) {
			if (this.bodies[name])
				sum = Count.add(sum, this.of(name), 1);
			else
				sum = Count.add(sum, [BUILT_IN[name] || 0, /^tex/.test(name) ? 1 : 0], 1);
		}
		return sum;
	}
}
/* GPUs of 2015: operations (multiply and add) and bilinear texels a second, as their makers state them. */
const GPUS = {
	"GeForce GTX 960": { operations: 1024 * 2 * 1.127e9, texels: 64 * 1.127e9 },
	"HD Graphics 530": { operations: 24 * 16 * 1.15e9, texels: 12 * 1.15e9 },
};

/* Seconds on one: a third of what it can is reached, half floats are read half as fast, and reading waits for computing. */
function seconds_on(gpu, [operations, reads]) {
	return 3 * operations / gpu.operations + 3 * reads / (gpu.texels / 2);
}

/* [operations, reads] of one picture of width x height with a preset; every pixel counts as one that sees all there is.
 * text(name, parts): of a shader; directions: of the surroundings. */
function picture(text, preset, width, height, directions, grid, coarse, map, search, face) {
	const beams = preset.beams, all = Math.min(directions, preset.directions), nodes = Math.min(preset.steps, 3), pixels = width * height * preset.scale * preset.scale;
	// Newton's way from its closed start takes five steps; lids are looked for within 16 px; horizons stand with the pupil.
	const limits = { 40: 5, SEARCH: search, 14: 1, NODES: nodes, LIGHTS: beams, REACH: 12, first: all / beams, 64: 16, ACROSS: 4 };
	const main = (name, parts, own) => new Count(text(name, parts || []), { ...limits, ...own }, (parts || []).map(p => p.toUpperCase())).of("main");
	const eyes = face ? 2 : 1, several = all > beams, points = 2 * (several ? coarse : grid) ** 2;
	let sum = [0, 0];
	const add = (cost, n) => { sum = Count.add(sum, cost, n); };
	add(main("paths"), eyes * points * beams);
	if (several)
		add(main("refine"), eyes * 2 * grid * grid * (beams + 1));
	add(main("beside"), eyes * 3 * 64 * 64);
	add(main("march", preset.shadow > 0 ? ["shadows"] : []), eyes * (map >> 1 + preset.apart) ** 2);
	add(main("bloom"), 5 / 3 * pixels);
	add(main("present"), pixels);
	if (!face)
		add(main("eye"), pixels);
	else {
		// A face at rest: nothing folds. Both globes, each a sixth of the picture's width across.
		const globes = 2 * (width * preset.scale / 6) ** 2;
		add(main("skin", ["skin_look", ...(preset.pores ? ["pores"] : [])], { LIGHTS: preset.skies }), pixels);
		add(main("tear"), 2 * globes);
		add(main("eye", ["skin_look", "lids"]), globes);
		add(main("copy"), pixels);
	}
	return sum;
}
module.exports = { picture, seconds_on, GPUS };

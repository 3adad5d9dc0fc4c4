"use strict";
/* A sky that is linear in the direction, as files of surroundings: Radiance HDR, and OpenEXR of two kinds. */
const zlib = require("zlib");

const W = 128, H = 64, MEAN = [2, 1.5, 1], SLOPE = [[0.8, -0.6, -0.5], [0.2, -0.5, -0.3], [-0.3, 0.1, -0.4]];  // of each colour: x right, y down, z forward

function sky(x, y) {
	const polar = (y + 0.5) / H * Math.PI, turn = ((x + 0.5) / W - 0.5) * 2 * Math.PI;
	const d = [-Math.sin(polar) * Math.sin(turn), -Math.cos(polar), -Math.sin(polar) * Math.cos(turn)];
	return MEAN.map((m, c) => m + SLOPE[c].reduce((sum, v, k) => sum + v * d[k], 0));
}

/* Radiance, each row's planes as runs of single values and of repeated ones. */
function hdr() {
	const parts = [Buffer.from(`#?RADIANCE\n# a linear sky\nFORMAT=32-bit_rle_rgbe\n\n-Y ${H} +X ${W}\n`)];
	for (let y = 0; y < H; y++) {
		const planes = [[], [], [], []], row = [2, 2, W >> 8, W & 255];
		for (let x = 0; x < W; x++) {
			const rgb = sky(x, y), e = Math.ceil(Math.log2(Math.max(...rgb) + 1e-9) + 1e-9);
			rgb.forEach((v, c) => planes[c].push(Math.min(255, Math.floor(v / Math.pow(2, e) * 256))));
			planes[3].push(e + 128);
		}
		for (const p of planes)
			for (let x = 0; x < W;) {
				let n = 1;
				while (x + n < W && n < 127 && p[x + n] === p[x])
					n++;
				row.push(...(n > 2 ? [128 + n, p[x]] : [1, p[x]]));
				x += n > 2 ? n : 1;
			}
		parts.push(Buffer.from(row));
	}
	return Buffer.concat(parts);
}

function half(v) {
	const e = Math.floor(Math.log2(v)), m = Math.round((v / Math.pow(2, e) - 1) * 1024);
	return (e + 15 << 10) + m;
}

/* OpenEXR by scan lines, channels B, G, R: half floats compressed by ZIP (3), or floats as they are (0). */
function exr(compression, method) {
	const i32 = v => { const b = Buffer.alloc(4); b.writeInt32LE(v); return b; }, z = text => Buffer.from(text + "\0"), type = compression === 3 ? 1 : 2;
	const attribute = (name, kind, value) => Buffer.concat([z(name), z(kind), i32(value.length), value]);
	const channel = name => Buffer.concat([z(name), i32(type), i32(0), i32(1), i32(1)]), box = Buffer.concat([i32(0), i32(0), i32(W - 1), i32(H - 1)]);
	const head = Buffer.concat([Buffer.from([0x76, 0x2f, 0x31, 1, 2, 0, 0, 0]), attribute("channels", "chlist", Buffer.concat([..."BGR"].map(channel).concat(Buffer.alloc(1)))),
		attribute("compression", "compression", Buffer.from([method === undefined ? compression : method])), attribute("dataWindow", "box2i", box), attribute("displayWindow", "box2i", box),
		attribute("lineOrder", "lineOrder", Buffer.alloc(1)), Buffer.alloc(1)]);
	const lines = compression === 3 ? 16 : 1, blocks = [];
	for (let top = 0; top < H; top += lines) {
		const list = [];
		for (let y = top; y < Math.min(top + lines, H); y++)
			for (const c of [2, 1, 0])
				for (let x = 0; x < W; x++) {
					const b = Buffer.alloc(type === 1 ? 2 : 4);
					type === 1 ? b.writeUInt16LE(half(sky(x, y)[c])) : b.writeFloatLE(sky(x, y)[c]);
					list.push(b);
				}
		let data = Buffer.concat(list);
		if (compression === 3) {
			const apart = Buffer.concat([data.filter((_, i) => i % 2 === 0), data.filter((_, i) => i % 2)]);
			data = zlib.deflateSync(Buffer.from(apart.map((v, i) => i ? v - apart[i - 1] + 128 + 256 : v)));
		}
		blocks.push(Buffer.concat([i32(top), i32(data.length), data]));
	}
	const table = Buffer.alloc(8 * blocks.length);
	let at = head.length + table.length;
	blocks.forEach((b, i) => { table.writeBigUInt64LE(BigInt(at), 8 * i); at += b.length; });
	return Buffer.concat([head, table, ...blocks]);
}

module.exports = { MEAN, SLOPE, hdr, exr };

/* Which of the surroundings' directions go into the eye together: lib/draw/eye/march/beam_split.c. A light: {dir, rgb, share}, in the
 * eye's frame. */
const beams = (() => {
	const share_of = rgb => 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];

	/* Those that reach the iris: no path leads in from further than 99 degrees off the axis. list: direction, colour. */
	function turned(list, eye_from_env) {
		const out = [];
		for (const l of list) {
			const dir = turns.apply(eye_from_env, l), rgb = l.slice(3);
			if (dir[2] <= 0.16)
				out.push({ dir, rgb, share: share_of(rgb) });
		}
		return out;
	}

	/* How far lights spread across the axis: [the worse of two axes' measure, that axis, its mean]. */
	function spread(list) {
		const all = list.reduce((sum, l) => sum + l.share, 0);
		let most = [-1, 0, 0];
		for (const c of [0, 1]) {
			const first = list.reduce((sum, l) => sum + l.share * l.dir[c], 0);
			const off = list.reduce((sum, l) => sum + l.share * l.dir[c] * l.dir[c], 0) - first * first / all;
			most = off > most[0] ? [off, c, first / all] : most;
		}
		return most;
	}

	/* Splits the widest group in two, until there are n. */
	function split(list, n) {
		const groups = list.length ? [{ list, wide: list.length > 1 ? spread(list) : [0] }] : [];
		while (groups.length < n) {
			const at = groups.reduce((a, g) => g.wide[0] > a.wide[0] ? g : a, groups[0]);
			if (!at || !(at.wide[0] > 1e-6))
				break;
			const [, axis, mean] = at.wide, parts = [at.list.filter(l => !(l.dir[axis] > mean)), at.list.filter(l => l.dir[axis] > mean)];
			groups[groups.indexOf(at)] = { list: parts[0], wide: parts[0].length > 1 ? spread(parts[0]) : [0] };
			groups.push({ list: parts[1], wide: parts[1].length > 1 ? spread(parts[1]) : [0] });
		}
		return groups.map(g => g.list);
	}

	/* A group as one light. */
	function mean(list) {
		const rgb = [0, 1, 2].map(c => list.reduce((sum, l) => sum + l.rgb[c], 0));
		const d = [0, 1, 2].map(c => list.reduce((sum, l) => sum + l.share * l.dir[c], 0)), length = Math.hypot(...d) || 1;
		return { dir: d.map(v => v / length), rgb, share: share_of(rgb) };
	}

	/* At most `directions` lights in at most n beams: {n, each: most lights in one, rgb [n][3], first [n + 1], dir [direction, share]}. */
	function made(list, n, directions) {
		const lights = list.length > directions ? split(list, directions).map(mean) : list, out = { n: 0, each: 0, rgb: [], first: [0], dir: [] };
		for (const group of split(lights, n)) {
			const all = group.reduce((sum, l) => sum + l.share, 0);
			for (const l of group)
				out.dir.push(...l.dir, l.share / all);
			out.rgb.push(...mean(group).rgb);
			out.first.push(out.dir.length / 4);
			out.each = Math.max(out.each, group.length);
			out.n++;
		}
		return out;
	}
	/* How much a light is the photograph's own, by its mean direction: scene_own_light_share of lib/draw/eye/own_light.c. */
	function likeness(list, own_mean, width) {
		const all = list.reduce((sum, l) => sum + l.share, 0) || 1;
		const off = [0, 1, 2].map(c => list.reduce((sum, l) => sum + l.share * l.dir[c], 0) / all - own_mean[c]);
		return Math.exp(-0.5 * (off[0] * off[0] + off[1] * off[1] + off[2] * off[2]) / (width * width));
	}

	return { turned, made, likeness };
})();

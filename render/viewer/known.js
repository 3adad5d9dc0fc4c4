/* The gaze that drives the lids of an eye which looks so: lib/model/known.h. known: corners of either eye's hull, torsion, beyond; degrees. */
const known_gaze = (() => {
	const further = (distance, most) => most > 0 ? most * Math.tanh(distance / most) : 0;

	/* The hull's point nearest to x; null: x lies in the hull. */
	function nearest(corner, x) {
		let least = Infinity, p = null, inside = true, edges = false;
		for (let i = 0; i < corner.length; i += 2) {
			const k = (i + 2) % corner.length, e = [corner[k] - corner[i], corner[k + 1] - corner[i + 1]], d = [x[0] - corner[i], x[1] - corner[i + 1]];
			const square = e[0] * e[0] + e[1] * e[1], t = square > 0 ? Math.min(1, Math.max(0, (d[0] * e[0] + d[1] * e[1]) / square)) : 0;
			const q = [corner[i] + t * e[0], corner[i + 1] + t * e[1]], far = Math.hypot(x[0] - q[0], x[1] - q[1]);
			if (far < least)
				[least, p] = [far, q];
			edges = edges || square > 0;
			inside = inside && e[0] * d[1] - e[1] * d[0] >= 0;
		}
		return inside && edges || least === 0 ? null : p;
	}

	return (known, side, gaze) => {
		const corner = known.corner[side], [low, high] = known.torsion.slice(2 * side, 2 * side + 2), most = 0.5 * known.beyond * (high - low), p = nearest(corner, gaze);
		let [h, v, t] = gaze;
		if (p) {
			const d = [h - p[0], v - p[1]], far = Math.hypot(...d), along = [];
			for (let i = 0; i < corner.length; i += 2)
				along.push((corner[i] * d[0] + corner[i + 1] * d[1]) / far);
			const more = further(far, 0.5 * known.beyond * (Math.max(...along) - Math.min(...along))) / far;
			[h, v] = [p[0] + more * d[0], p[1] + more * d[1]];
		}
		if (t > high)
			t = high + further(t - high, most);
		else if (t < low)
			t = low - further(low - t, most);
		return [h, v, t];
	};
})();

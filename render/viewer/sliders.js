/* The data, and everything that a hand can move. */
const by_id = id => document.getElementById(id), data = JSON.parse(by_id("data").textContent);
const calm = matchMedia("(prefers-reduced-motion: reduce)");
const said = text => { by_id("said").textContent = text; };

function give_up(why) {
	by_id("stage").hidden = by_id("panel").hidden = true;
	by_id("stills").hidden = false;
	by_id("why").textContent = `No live picture: ${why}. These are still ones.`;
}

/* Melanin by kind: volume fractions; one sigma of the product from those of its factors. */
function pigments(t) {
	const out = {};
	for (const layer of ["abl", "stroma"]) {
		const m = t.fitted[layer + "_melanin"], b = t.fitted[layer + "_ratio"];
		const im = t.interval[layer + "_melanin"], ib = t.interval[layer + "_ratio"];
		const sm = im ? (im[1] - im[0]) / 2 : 0, sb = ib ? (ib[1] - ib[0]) / 2 : 0;
		out[layer + "_eu"] = { value: m * b, sigma: im ? Math.hypot(b * sm, m * sb) : 0 };
		out[layer + "_pheo"] = { value: m * (1 - b), sigma: im ? Math.hypot((1 - b) * sm, m * sb) : 0 };
	}
	return out;
}

/* A number in plain digits: so many that count, never an exponent. */
function plain(v, n) {
	if (!(Math.abs(v) > 1e-12))
		return "0";
	const text = v.toFixed(Math.min(12, Math.max(0, n - 1 - Math.floor(Math.log10(Math.abs(v))))));
	return text.includes(".") ? text.replace(/\.?0+$/, "") : text;
}

/* Everything a hand can move. value: as fitted or assumed; from: how it came about, in a word; why: more of that. sigma: of the
 * fit, or between people (show_sigma: finer than the value is shown); band: the same where it is not even. power: how the slider is bent. keep: what capture.conf calls it {key, value, lo, hi: what that takes}; not there: no line keeps
 * it, and it is looked at only. pigment: its lines are made of several. */
function sliders(eye) {
	const e = eye.eye, t = eye.tissue, p = pigments(t), scale = t.interval.thickness_scale, share = v => `${(100 * v).toFixed(0)} %`, per_cent = v => `${plain(100 * v, 3)} %`;
	const degrees = v => `${v.toFixed(0)}°`, mm = n => v => `${v.toFixed(n)} mm`, fitted = !!t.interval.abl_melanin, film = data.face ? data.face.tear_mm : 0;
	const as = (key, lo, hi, of) => v => ({ key, value: of ? of(v) : v, lo, hi });
	const melanin = key => ({ key, pigment: true, lo: 0, hi: 0.6, power: 3, show: per_cent, from: fitted ? "fitted" : "chosen", ...p[key] });
	return [
		["Eye", [
			{ key: "aperture", label: "Lids: how far open", lo: 0, hi: 1.6, value: 1, keep: as("render.aperture", 0, 2), show: share, lids: true, from: "learnt from the video", why: "as these lids follow the gaze; the spread between people is not known" },
			...["left", "right"].map(side => ({ key: `wink_${side}`, label: `Wink: ${side} lids shut`, lo: 0, hi: 1, value: 0, show: share, lids: true, from: "at rest" })),
			{ key: "near", label: "Both eyes on something near", lo: 0, hi: 10, value: 0, lids: true, from: "chosen",
				show: v => v > 0.05 ? `${(100 / v).toFixed(0)} cm away` : "far away" },
			{ key: "pupil", label: "Pupil, radius", lo: 0.7, hi: 4.2, value: e.pupil[2], sigma: e.pupil_sigma, show: mm(2), show_sigma: mm(3), from: eye.photo || e.filmed ? "fitted" : "chosen",
				why: eye.photo ? `in an iris taken as ${(2 * e.limbus[0]).toFixed(1)} mm across` : e.filmed ? "as wide as it mostly is in the video" : "no photograph tells it" },
			{ key: "tear", label: "Tears", lo: 0, hi: 2, value: 1, keep: film ? as("render.tear_mm", 0, 3, v => v * film) : null, show: share, from: "from the literature", band: film ? [0.2 / film, 0.35 / film] : null,
				why: film ? `${film.toFixed(2)} mm high; healthy eyes have 0.2 to 0.35 mm` : "a healthy eye's film" },
			{ key: "field", label: "Zoom", lo: 8, hi: 60, value: 30, power: 2, keep: (v, page) => page.mode === "face" ? { key: "render.face_field", value: FaceScene.WIDE * v / 30, lo: 1, hi: 6 } : { key: "render.field_mm", value: v, lo: 10, hi: 60 },
				 show: v => `${(3000 / v).toFixed(0)} %`, from: "chosen", why: "which shows 30 mm of an eye, or a face from brow to mouth" },
		]],
		...(data.face && data.face.expressions.length ? [["Expressions", data.face.expressions.map((x, k) => (
			{ key: `au${k}`, label: x.name.replace(/_/g, " "), lo: 0, hi: 1, value: 0, lids: true, show: share, from: "at rest", why: "100 % is the video's own peak" }))]] : []),
		["Pigment of the iris", [
			{ ...melanin("abl_eu"), label: "Anterior border layer: eumelanin" },
			{ ...melanin("abl_pheo"), label: "Anterior border layer: pheomelanin" },
			{ ...melanin("stroma_eu"), label: "Stroma: eumelanin" },
			{ ...melanin("stroma_pheo"), label: "Stroma: pheomelanin" },
			{ key: "thickness_scale", pigment: true, label: "Stroma: optical over anatomical thickness", lo: 0.02, hi: 2.5, power: 2, value: t.fitted.thickness_scale,
				sigma: scale ? (scale[1] - scale[0]) / 2 : 0, show: v => v.toFixed(3), from: fitted ? "fitted" : "chosen" },
			{ key: "detail", label: "Detail of the photograph beyond the model", lo: 0, hi: 1, value: e.detail, keep: as("render.detail", 0, 1), show: share, from: "configured", why: "0 % is the model alone" },
		]],
		["Cornea", [
			{ key: "R", label: "Apical radius R", lo: 6.5, hi: 9.5, value: e.R, sigma: 0.27, show: mm(2), keep: as("eye.cornea_radius_mm", 5, 12), from: "configured", why: "people's spread" },
			{ key: "p", label: "Asphericity p", lo: 0.3, hi: 1.2, value: e.p, sigma: 0.12, show: v => v.toFixed(3), keep: as("eye.cornea_asphericity", 0, 2), from: "configured", why: "people's spread" },
			{ key: "n", label: "Index of refraction", lo: 1, hi: 1.5, value: e.n, show: v => v.toFixed(4), keep: as("eye.index", 1, 2), from: "configured", why: "the literature's for the aqueous humour; photographs do not tell it" },
		]],
		["Light", [
			{ key: "light_yaw", label: "Turned sideways", lo: -180, hi: 180, value: 0, show: degrees, from: "chosen", why: "0° is where the lamps of these surroundings stand" },
			{ key: "light_pitch", label: "Turned up and down", lo: -80, hi: 80, value: 0, show: degrees, from: "chosen", why: "0° is where the lamps of these surroundings stand" },
			{ key: "light_gain", label: "Strength", lo: 0.1, hi: 3, power: 2, value: 1, show: share, from: eye.photo ? "fitted" : "chosen",
				why: eye.photo ? "100 % is the photograph's own exposure; its error goes into the pigments'" : "" },
			{ key: "exposure", alone: true, label: "Exposure of the picture", lo: -4, hi: 4, value: 0, show: v => `${v > 0 ? "+" : ""}${v.toFixed(1)} stops`, from: "chosen", why: "0 is as the photograph is exposed" },
			{ key: "tone", alone: true, label: "Highlights as on film", lo: 0, hi: 1, value: data.tone, keep: as("render.tone", 0, 1), show: share, from: "configured", why: "0 % cuts them off, as the measured comparison does" },
			{ key: "bloom", alone: true, label: "Glow of bright light", lo: 0, hi: 0.3, value: data.bloom, keep: as("render.bloom", 0, 1), show: v => `${(100 * v).toFixed(1)} %`, from: "configured", why: "of the light that a lens and the eye scatter" },
		]],
	];
}

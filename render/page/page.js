"use strict";
for (const slider of document.querySelectorAll(".slider")) {
	const range = slider.querySelector("input");
	const show = () => slider.style.setProperty("--at", range.value + "%");
	range.addEventListener("input", show);
	show();
}

/* The limbus drawn by hand: three grips on the photograph move an ellipse; its line for capture.conf stands beside. Coordinates are the
 * photograph's px; the angle is the longer axis', in degrees from +x towards +y. */
for (const box of document.querySelectorAll("details.hand")) {
	const svg = box.closest(".photo").querySelector("svg.hand"), line = box.querySelector(".line"), copy = box.querySelector("button");
	const outline = svg.querySelector("ellipse"), grips = [...svg.querySelectorAll("circle")], { width, height } = svg.viewBox.baseVal;
	let [cx, cy, a, b, angle] = svg.dataset.ellipse.split(" ").map(Number);
	const least = 8, most = Math.max(width, height), within = (v, lo, hi) => Math.min(Math.max(v, lo), hi);
	const axis = () => [Math.cos(angle * Math.PI / 180), Math.sin(angle * Math.PI / 180)];
	const ends = () => { const [c, s] = axis(); return [[cx, cy], [cx + a * c, cy + a * s], [cx - b * s, cy + b * c]]; };
	function show() {
		outline.setAttribute("rx", a);
		outline.setAttribute("ry", b);
		outline.setAttribute("transform", `translate(${cx} ${cy}) rotate(${angle})`);
		ends().forEach(([x, y], i) => { grips[i].setAttribute("cx", x); grips[i].setAttribute("cy", y); grips[i].setAttribute("r", 0.014 * most); });
		// The longer axis comes first, whichever grip is on it.
		const turned = b > a, n = v => v.toFixed(1);
		line.textContent = `photo.${svg.dataset.key}.limbus_px = ${n(cx)} ${n(cy)} ${n(Math.max(a, b))} ${n(Math.min(a, b))} ${n((((angle + (turned ? 90 : 0)) % 180) + 180) % 180)}`;
	}
	function move(i, x, y) {
		const dx = x - cx, dy = y - cy, [c, s] = axis();
		if (i === 0) {
			cx = within(x, 0, width);
			cy = within(y, 0, height);
		} else if (i === 1) {
			a = within(Math.hypot(dx, dy), least, most);
			angle = Math.atan2(dy, dx) * 180 / Math.PI;
		} else {
			b = within(Math.abs(c * dy - s * dx), least, most);
		}
		show();
	}
	grips.forEach((grip, i) => {
		grip.addEventListener("pointerdown", e => { grip.setPointerCapture(e.pointerId); e.preventDefault(); grip.focus(); });
		grip.addEventListener("pointermove", e => {
			if (!grip.hasPointerCapture(e.pointerId))
				return;
			const p = new DOMPoint(e.clientX, e.clientY).matrixTransform(svg.getScreenCTM().inverse());
			move(i, p.x, p.y);
		});
		grip.addEventListener("keydown", e => {
			const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[e.key];
			if (!step)
				return;
			e.preventDefault();
			const [x, y] = ends()[i], far = (e.shiftKey ? 10 : 1) * most / 1600;
			move(i, x + step[0] * far, y + step[1] * far);
		});
	});
	copy.addEventListener("click", async () => {
		try {
			await navigator.clipboard.writeText(line.textContent);
			copy.textContent = "Copied";
		} catch {
			getSelection().selectAllChildren(line);
		}
	});
	box.addEventListener("toggle", () => svg.toggleAttribute("hidden", !box.open));
	svg.toggleAttribute("hidden", !box.open);
	show();
}

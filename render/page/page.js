"use strict";
for (const slider of document.querySelectorAll(".slider")) {
	const range = slider.querySelector("input");
	const show = () => slider.style.setProperty("--at", range.value + "%");
	range.addEventListener("input", show);
	show();
}

/* Every picture opens large: what is in the page at once, its file as soon as that is read; where that is not there the page's own stays.
 * Without this script the links lead to the files. */
{
	const links = [...document.querySelectorAll("a.large")];
	const picture_of = a => a.querySelector("img") || a.closest(".likeness").querySelectorAll("img")[a.dataset.third];
	const make = (tag, attributes, ...children) => { const e = Object.assign(document.createElement(tag), attributes); e.append(...children); return e; };
	const button = (text, label, on) => { const b = make("button", { type: "button", textContent: text, title: label, ariaLabel: label }); b.addEventListener("click", on); return b; };
	const image = make("img", { alt: "" }), sheet = make("div", { className: "sheet" }, image), view = make("div", { className: "big", tabIndex: 0 }, sheet), words = make("p", { ariaLive: "polite" });
	const nearer = button("+", "Larger", () => zoom(!near));
	const dialog = make("dialog", { ariaLabel: "A picture, large" }, view, make("div", { className: "beside" }, button("‹", "The one before", () => show(at - 1)), button("›", "The next one", () => show(at + 1)), words, nearer, button("×", "Close", () => dialog.close())));
	let at = 0, near = false, size = [1, 1], down = null;
	/* Its width, px: so that all of it is seen; or near: its own pixels, at least twice as large. */
	function lay(near_now) {
		const fits = Math.min(view.clientWidth / size[0], view.clientHeight / size[1]);
		const k = near_now ? Math.max(1 / (devicePixelRatio || 1), 2 * fits) : fits;
		sheet.style.width = `${size[0] * k}px`;
		sheet.style.height = `${size[1] * k}px`;
	}
	/* x, y: what stays where it is, px of the window; the middle. */
	function zoom(on, x, y) {
		const box = sheet.getBoundingClientRect(), room = view.getBoundingClientRect();
		x = x ?? room.left + room.width / 2;
		y = y ?? room.top + room.height / 2;
		const u = (x - box.left) / box.width, v = (y - box.top) / box.height;
		near = on;
		view.classList.toggle("near", near);
		nearer.textContent = near ? "−" : "+";
		nearer.title = nearer.ariaLabel = near ? "All of it" : "Larger";
		lay(near);
		const now = sheet.getBoundingClientRect();
		view.scrollBy({ left: now.left + u * now.width - x, top: now.top + v * now.height - y, behavior: "instant" });
	}
	function show(i) {
		at = (i + links.length) % links.length;
		const link = links[at], own = picture_of(link), third = link.dataset.third;
		const [w, h] = own.hasAttribute("width") ? [own.width, own.height].map((_, k) => Number(own.getAttribute(k ? "height" : "width"))) : [own.naturalWidth || 3, own.naturalHeight || 2];
		size = [w, h];
		sheet.querySelector("svg")?.remove();
		const drawn = own.closest(".frame")?.querySelector("svg:not(.hand)");
		if (drawn)
			sheet.append(drawn.cloneNode(true));
		image.className = own.className === "plot" ? "plot" : "";
		image.style.objectPosition = "";
		image.src = own.src;
		image.alt = own.alt;
		words.textContent = `${own.alt} · ${at + 1} of ${links.length}`;
		dialog.dataset.whole = "";
		zoom(false);
		if (!link.hasAttribute("href"))
			return;
		const whole = new Image();
		whole.addEventListener("load", () => {
			if (links[at] !== link || !dialog.open)
				return;
			// Of a comparison a third is shown: it fills the height, and stands at the left, in the middle or at the right.
			size = third === undefined ? [whole.naturalWidth || w, whole.naturalHeight || h] : [whole.naturalHeight * w / h, whole.naturalHeight];
			image.style.objectPosition = third === undefined ? "" : `${50 * third}% 0`;
			image.src = whole.src;
			dialog.dataset.whole = "1";
			lay(near);
		});
		whole.src = link.href;
	}
	for (const link of links) {
		if (!link.hasAttribute("href")) {
			link.tabIndex = 0;
			link.setAttribute("role", "button");
		}
		link.setAttribute("aria-haspopup", "dialog");
		const open = e => {
			if (e.ctrlKey || e.metaKey || e.shiftKey || e.altKey)
				return;  // the browser's own: a tab of its own
			e.preventDefault();
			dialog.showModal();
			view.focus();
			show(links.indexOf(link));
		};
		link.addEventListener("click", open);
		link.addEventListener("keydown", e => { if (e.key === "Enter" && !link.hasAttribute("href") || e.key === " ") open(e); });
	}
	view.addEventListener("pointerdown", e => { down = { x: e.clientX, y: e.clientY, left: view.scrollLeft, top: view.scrollTop, mouse: e.pointerType === "mouse", moved: false }; });
	view.addEventListener("pointermove", e => {
		if (!down)
			return;
		down.moved = down.moved || Math.hypot(e.clientX - down.x, e.clientY - down.y) > 8;
		if (near && down.mouse && e.buttons & 1)
			view.scrollTo({ left: down.left + down.x - e.clientX, top: down.top + down.y - e.clientY, behavior: "instant" });
	});
	view.addEventListener("pointerup", e => {
		const dx = down && !near && !down.mouse ? e.clientX - down.x : 0;
		if (Math.abs(dx) > 50 && Math.abs(dx) > 2 * Math.abs(e.clientY - down.y))
			show(at + (dx < 0 ? 1 : -1));
	});
	view.addEventListener("click", e => {
		const moved = down && down.moved;
		down = null;
		if (moved)
			return;
		if (e.target.closest(".sheet"))
			zoom(!near, e.clientX, e.clientY);
		else
			dialog.close();
	});
	dialog.addEventListener("keydown", e => {
		const step = { ArrowLeft: -1, ArrowRight: 1 }[e.key];
		if (step && !near)
			show(at + step);
		else if (e.key === "+" || e.key === "=" || e.key === "-")
			zoom(e.key !== "-");
		else
			return;
		e.preventDefault();
	});
	dialog.addEventListener("close", () => { down = null; if (!dialog.open) image.removeAttribute("src"); });
	addEventListener("resize", () => { if (dialog.open) lay(near); });
	if (links.length)
		document.body.append(dialog);
}

/* The limbus drawn by hand: three grips on the photograph move an ellipse; its line for capture.conf stands beside. Coordinates are the
 * photograph's px; the angle is the longer axis', in degrees from +x towards +y. */
for (const box of document.querySelectorAll("details.hand")) {
	const svg = box.closest(".photo").querySelector("svg.hand"), line = box.querySelector(".line"), copy = box.querySelector("button");
	const outline = svg.querySelector("ellipse"), grips = [...svg.querySelectorAll("circle")], { x: left, y: top, width, height } = svg.viewBox.baseVal;
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
			cx = within(x, left, left + width);
			cy = within(y, top, top + height);
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

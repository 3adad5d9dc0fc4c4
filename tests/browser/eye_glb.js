"use strict";
/* Opens an exported eye in three.js in a headless Chromium and saves what it draws: EXPORT NPM OUT; OUT/three_DEG.npy, linear RGBA. */
const fs = require("fs");
const os = require("os");
const path = require("path");
const { Browser } = require("./browser.js");
const [, , folder, npm, out] = process.argv;

/* A NumPy array of float32 [size][size][4]. */
function npy(file, size, bytes) {
	let head = `{'descr': '<f4', 'fortran_order': False, 'shape': (${size}, ${size}, 4), }`;
	head += " ".repeat(63 - (10 + head.length) % 64) + "\n";
	const start = Buffer.from([0x93, 0x4e, 0x55, 0x4d, 0x50, 0x59, 1, 0, head.length & 255, head.length >> 8]);
	fs.writeFileSync(file, Buffer.concat([start, Buffer.from(head), bytes]));
}

(async () => {
	const dir = fs.mkdtempSync(path.join(os.tmpdir(), "eyewright-three-"));
	fs.writeFileSync(path.join(dir, "page.html"), fs.readFileSync(path.join(__dirname, "eye_glb.html"), "utf8").replaceAll("NPM", `file://${path.resolve(npm)}/node_modules`));
	fs.copyFileSync(path.join(__dirname, "eye_glb_page.js"), path.join(dir, "eye_glb_page.js"));
	const b = await Browser.start(["--allow-file-access-from-files"]);
	try {
		await b.size(512, 512);
		await b.open(`file://${dir}/page.html`);
		await b.until("window.ready", 30);
		for (const file of [...(process.argv[5] || "eye.glb eye_lod1.glb eye_lod2.glb").split(" ")]) {
			const says = await b.value(`open_eye(${JSON.stringify(`file://${path.resolve(folder)}`)}, "${file}")`, 120000), size = says.reference.px;
			for (const deg of [0, 30, 60])
				npy(path.join(out, `${file.replace(".glb", "")}_${String(deg).padStart(2, "0")}.npy`), size, Buffer.from(await b.value(`draw(${deg})`, 120000), "base64"));
			await b.screenshot(path.join(out, `${file}.png`));
		}
		for (const problem of b.problems)
			if (!/GPU stall|ReadPixels/.test(problem))
				console.log(`fail three.js says: ${problem}`);
		console.log("three.js: drawn");
	} catch (e) {
		console.log(`fail three.js: ${e.message} ${b.problems.join("; ")}`);
	} finally {
		await b.end();
		fs.rmSync(dir, { recursive: true, force: true });
	}
})();

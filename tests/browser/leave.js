"use strict";
/* What the page lets go, as its button gives it: PAGE CHARACTER NPM. The .glb with gaze, pupil, lids, an expression and pigment set, against what
 * each of them has to be in it; read by Khronos's validator where that is there. */
const path = require("path");
const { pathToFileURL } = require("url");
const { Browser } = require("./browser.js");
const [, , page, character, npm] = process.argv;
const say = (ok, name, why) => console.log(ok ? `pass ${name}` : `fail ${name}: ${why}`);
const near = (a, b, by) => Math.abs(a - b) < by;

const opened = bytes => JSON.parse(bytes.subarray(20, 20 + bytes.readUInt32LE(12)).toString());
const weight = (mesh, name) => mesh.weights[mesh.extras.targetNames.indexOf(name)];

/* Where a node's quaternion turns the way straight ahead. */
function ahead([x, y, z, w]) {
	return [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)];
}

async function valid(bytes, name) {
	let validator;
	try {
		validator = require(path.resolve(npm, "node_modules/gltf-validator"));
	} catch {
		return;
	}
	const { issues } = await validator.validateBytes(new Uint8Array(bytes));
	say(!issues.numErrors && !issues.numWarnings, `Khronos's validator on ${name}`, JSON.stringify(issues.messages.slice(0, 3)));
}

/* The file that the button saves, after `set` has been done on the page. */
async function saved(b, url, set) {
	await b.send("Emulation.setEmulatedMedia", { features: [{ name: "prefers-reduced-motion", value: "reduce" }] });
	await b.open("about:blank");
	await b.until("location.href === 'about:blank'", 20);
	await b.open(url);
	await b.until("document.documentElement && document.documentElement.dataset.open", 180);
	const text = await b.value(`(async () => {
		const kept = new Promise(done => { Tools.download = (blob, name) => done([blob, name]); });
		await (${set})(eyewright);
		[...document.querySelectorAll("button")].find(k => k.textContent === "Save .glb as set").click();
		const [blob, name] = await kept, bytes = new Uint8Array(await blob.arrayBuffer());
		let out = "";
		for (let i = 0; i < bytes.length; i += 32768)
			out += String.fromCharCode(...bytes.subarray(i, i + 32768));
		return JSON.stringify([name, btoa(out)]);
	})()`, 120000);
	const [name, base64] = JSON.parse(text);
	return { name, bytes: Buffer.from(base64, "base64") };
}

async function eye(b) {
	const url = pathToFileURL(page).href, plain = await saved(b, url, "p => { p.eyes.eye = [0, 0]; }");
	const { name, bytes } = await saved(b, url, `p => { p.eyes.eye = [20, 10]; p.set("pupil", 3); p.set("n", 1.4); p.set("R", 7); p.set("stroma_eu", 0.3); }`), j = opened(bytes), was = opened(plain.bytes);
	const iris = j.meshes.find(m => m.name === "iris"), own = iris.extras.pupil_mm, wide = (6 - own) / (8 - own);
	say(name === "eye.glb" && bytes.readUInt32LE(0) === 0x46546c67 && bytes.readUInt32LE(8) === bytes.length, "an eye leaves as a binary glTF", `${name}, ${bytes.length} bytes`);
	say(near(weight(iris, "pupil_8mm"), wide, 1e-6) && weight(iris, "pupil_1mm") === 0, "its pupil is as wide as set", JSON.stringify(iris.weights));
	const a = ahead(j.nodes[j.scenes[0].nodes[0]].rotation), rad = Math.PI / 180;
	say(near(a[0], Math.sin(20 * rad) * Math.cos(10 * rad), 1e-6) && near(a[1], Math.sin(10 * rad), 1e-6), "it looks where it looked", a.join());
	say(near(j.materials.find(m => m.name === "cornea").extensions.KHR_materials_ior.ior, 1.4, 1e-9), "its cornea has the index set", "");
	say(j.asset.extras.set.stroma_eu === 0.3 && j.asset.extras.not_carried.join() === "R", "it says what was set, and what of that is not in it", JSON.stringify(j.asset.extras));
	const image = m => m.images[m.textures[m.materials.find(n => n.name === "iris").pbrMetallicRoughness.baseColorTexture.index].source].bufferView;
	say(image(j) !== image(was) && image(was) < was.bufferViews.length && j.bufferViews.length === was.bufferViews.length + 1, "its iris is painted over, as the pigment is another", "");
	await valid(bytes, "an eye that has left the page");
	const bright = async file => b.value(`(async () => { const f = leaves.open("${file.toString("base64")}"), i = f.json.images[f.json.textures[f.json.materials.find(m => m.name === "iris").pbrMetallicRoughness.baseColorTexture.index].source], v = f.json.bufferViews[i.bufferView];
		const p = await createImageBitmap(new Blob([f.bin.slice(v.byteOffset, v.byteOffset + v.byteLength)], { type: "image/png" })), c = element("canvas", { width: p.width, height: p.height }), d = c.getContext("2d");
		d.drawImage(p, 0, 0);
		return d.getImageData(0, 0, p.width, p.height).data.reduce((s, x, k) => s + (k % 4 < 3 ? x : 0), 0) / (3 * p.width * p.height); })()`, 60000);
	const [dark, light] = [await bright(bytes), await bright(plain.bytes)];
	say(dark < 0.9 * light, "more melanin, a darker iris", `${dark} ${light}`);
}

async function face(b) {
	const { name, bytes } = await saved(b, pathToFileURL(character).href, `p => { p.eyes.eye = [10, -5]; p.set("wink_left", 1); p.set("aperture", 0.8); p.set("au0", 0.5); p.set("pupil", 1); }`), j = opened(bytes);
	const skin = j.meshes.find(m => m.extras && m.extras.targetNames.includes("eyeBlinkLeft")), of = n => weight(skin, n);
	say(name.endsWith(".glb") && of("eyeBlinkLeft") === 1 && near(of("eyeBlinkRight"), 0.2, 1e-6), "a face leaves with its lids", JSON.stringify(skin.weights));
	say(of("eyeBlinkLeft_half") === 0 && near(of("eyeBlinkRight_half"), 0.64, 1e-6), "with what they are between open and shut", JSON.stringify(skin.weights));
	say(near(of("eyeLookOutLeft"), 0.4, 1e-6) && near(of("eyeLookInRight"), 0.4, 1e-6) && of("eyeLookInLeft") === 0 && near(of("eyeLookDownLeft"), 0.25, 1e-6), "with its gaze", JSON.stringify(skin.weights));
	say(await b.value("data.face.expressions[0].name").then(n => near(of(n), 0.5, 1e-6)), "with its expression", JSON.stringify(skin.extras.targetNames));
	const expression = await b.value("data.face.expressions[0].name"), [left, right] = ["Left", "Right"].map(side => `eyeBlink${side}_${expression}`);
	say(!skin.extras.targetNames.includes(left) || near(of(left), 0.5, 1e-6) && near(of(right), 0.1, 1e-6), "and with what its blinks lack then", JSON.stringify(skin.extras.drivenTargets));
	say(near(of("eyeBlinkRight_down"), 0.2 * of("eyeLookDownRight"), 1e-6) && of("eyeBlinkRight_down") > 0, "looking down, too", JSON.stringify(skin.weights));
	const lashes = j.meshes.find(m => m.name === "lashes");
	say(!lashes || weight(lashes, "eyeBlinkLeft") === 1, "its lashes go with the lids", "");
	const was = opened(Buffer.from(await b.value("document.getElementById('glb-face').textContent.trim()"), "base64")), node = (of_file, side) => of_file.nodes.find(n => n.name === side);
	for (const side of ["eye_left", "eye_right"]) {
		const [a, c] = [node(j, side), node(was, side)].map(n => ahead(n.rotation)), turn = Math.acos(Math.min(1, a[0] * c[0] + a[1] * c[1] + a[2] * c[2])) * 180 / Math.PI;
		say(near(turn, Math.acos(Math.cos(10 * Math.PI / 180) * Math.cos(5 * Math.PI / 180)) * 180 / Math.PI, 0.01), `with its eyes turned: ${side}`, `${turn} degrees`);
	}
	const iris = j.meshes.find(m => m.name === "iris");
	say(weight(iris, "pupil_1mm") > 0 && weight(iris, "pupil_8mm") === 0, "with its pupil", JSON.stringify(iris.weights));
	await valid(bytes, "a face that has left the page");
}

(async () => {
	const b = await Browser.start();
	try {
		await b.size(800, 600);
		await eye(b);
		await face(b);
		say(!b.problems.length, "leaving: no error on the console", b.problems.join("; "));
	} catch (e) {
		say(false, "what leaves the page", e.message);
	} finally {
		await b.end();
	}
})();

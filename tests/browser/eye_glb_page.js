/* An exported eye in three.js, under the light and camera of render's own pictures: window.draw(folder, file, degrees) gives linear pixels. */
import * as THREE from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { EXRLoader } from "three/addons/loaders/EXRLoader.js";

function bytes(url) {
	return new Promise((resolve, reject) => {
		const r = new XMLHttpRequest();
		r.open("GET", url);
		r.responseType = "arraybuffer";
		r.onload = () => resolve(r.response);
		r.onerror = () => reject(new Error(url));
		r.send();
	});
}

/* The studio turned from our map (middle +z, right +x) to three.js's (u = 1/2 + atan2(z, x) / 2 pi), which is a quarter of its width. */
async function studio(url) {
	const loader = new EXRLoader().setDataType(THREE.FloatType), exr = loader.parse(await bytes(url)), w = exr.width, h = exr.height;
	const step = exr.data.length / (w * h), out = new Float32Array(4 * w * h);
	for (let y = 0; y < h; y++)
		for (let x = 0; x < w; x++)
			for (let c = 0; c < 4; c++)
				out[4 * (y * w + (x + w / 4) % w) + c] = c < 3 ? exr.data[step * (y * w + x) + c] : 1;
	const texture = new THREE.DataTexture(out, w, h, THREE.RGBAFormat, THREE.FloatType, THREE.EquirectangularReflectionMapping);
	texture.magFilter = texture.minFilter = THREE.LinearFilter;
	texture.needsUpdate = true;
	return texture;
}

let renderer, scene, camera, size, eye;

window.open_eye = async (folder, file) => {
	const says = JSON.parse(new TextDecoder().decode(await bytes(`${folder}/eye.json`))), view = says.reference;
	size = view.px;
	renderer = renderer || new THREE.WebGLRenderer({ antialias: true });
	renderer.setSize(size, size);
	renderer.toneMapping = THREE.NoToneMapping;
	document.body.append(renderer.domElement);
	scene = new THREE.Scene();
	scene.environment = await studio(`${folder}/studio.exr`);
	camera = new THREE.PerspectiveCamera(view.field_of_view_deg, 1, 0.3, 0.7);
	camera.position.z = view.camera_z_mm / 1000;
	eye = (await new GLTFLoader().parseAsync(await bytes(`${folder}/${file}`), "")).scene;
	scene.add(eye);
	return says;
};

/* Linear RGBA of the eye turned by deg, rows from the top; weights: of the iris' morph targets. */
window.draw = (deg, weights) => {
	eye.rotation.y = deg * Math.PI / 180;
	eye.traverse(o => { if (o.morphTargetInfluences && weights) weights.forEach((w, i) => { o.morphTargetInfluences[i] = w; }); });
	const target = new THREE.WebGLRenderTarget(size, size, { type: THREE.FloatType, samples: 4 }), px = new Float32Array(4 * size * size);
	renderer.setRenderTarget(target);
	renderer.setClearColor(0, 0);
	renderer.clear();
	renderer.render(scene, camera);
	renderer.readRenderTargetPixels(target, 0, 0, size, size, px);
	renderer.setRenderTarget(null);
	renderer.render(scene, camera);
	target.dispose();
	const out = new Float32Array(px.length);
	for (let y = 0; y < size; y++)
		out.set(px.subarray(4 * size * (size - 1 - y), 4 * size * (size - y)), 4 * size * y);
	let text = "";
	for (let i = 0, b = new Uint8Array(out.buffer); i < b.length; i += 32768)
		text += String.fromCharCode(...b.subarray(i, i + 32768));
	return btoa(text);
};
window.ready = true;

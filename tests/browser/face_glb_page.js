/* A driven face's .glb in three.js: window.open_face(file), then window.seen(...) counts what shows round one eye, window.show(...) draws it. */
import * as THREE from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { RoomEnvironment } from "three/addons/environments/RoomEnvironment.js";

const SIZE = 512, FIELD = 0.045;  // m across, round one eye

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

let renderer, scene, face, mixer, clip;
const hair = /^(lashes|brows)$/, wet = /^tears$/, eyes = {}, own = new Map(), flat = new Map();

/* A surface of one colour, lit by nothing: what is seen there. Red skin, blue where it is seen from behind, green eye, yellow hair, tears
 * of both red and blue. */
function mark(mesh, eye) {
	own.set(mesh, mesh.material);
	if (hair.test(mesh.name)) {
		flat.set(mesh, new THREE.MeshBasicMaterial({ color: new THREE.Color(1, 1, 0), side: THREE.DoubleSide, toneMapped: false }));
		return;
	}
	if (wet.test(mesh.name)) {
		flat.set(mesh, new THREE.MeshBasicMaterial({ color: new THREE.Color(1, 0, 1), side: THREE.FrontSide, toneMapped: false }));
		return;
	}
	const paint = (rgb, side) => new THREE.MeshBasicMaterial({ color: new THREE.Color(...rgb), side, toneMapped: false });
	flat.set(mesh, paint(eye ? [0, 1, 0] : [1, 0, 0], eye ? THREE.DoubleSide : THREE.FrontSide));
	if (eye)
		return;
	const behind = mesh.clone();
	behind.material = paint([0, 0, 1], THREE.BackSide);
	behind.morphTargetInfluences = mesh.morphTargetInfluences;
	behind.visible = false;
	behind.userData.behind = true;
	mesh.parent.add(behind);
}

window.open_face = async file => {
	renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
	renderer.setSize(SIZE, SIZE);
	document.body.append(renderer.domElement);
	scene = new THREE.Scene();
	scene.environment = new THREE.PMREMGenerator(renderer).fromScene(new RoomEnvironment(), 0.02).texture;
	const gltf = await new GLTFLoader().parseAsync(await bytes(file), "");
	face = gltf.scene;
	scene.add(face);
	clip = gltf.animations[0];
	mixer = new THREE.AnimationMixer(face);
	face.updateMatrixWorld(true);
	const meshes = [];
	face.traverse(o => {
		if (o.name === "eye_left" || o.name === "eye_right")
			eyes[o.name] = { node: o, rest: o.quaternion.clone() };
		if (o.isMesh)
			meshes.push(o);
	});
	for (const o of meshes)
		mark(o, /^eye_(left|right)_/.test(o.name));
	return { meshes: meshes.map(o => o.name), seconds: clip.duration };
};

function pose(weights, turn) {
	face.traverse(o => {
		if (!o.morphTargetDictionary)
			return;
		o.morphTargetInfluences.fill(0);
		for (const [name, w] of Object.entries(weights))
			if (name in o.morphTargetDictionary)
				o.morphTargetInfluences[o.morphTargetDictionary[name]] = w;
	});
	for (const e of Object.values(eyes))
		e.node.quaternion.copy(e.rest).multiply(new THREE.Quaternion().setFromEuler(new THREE.Euler(-turn[1] * Math.PI / 180, turn[0] * Math.PI / 180, 0, "YXZ")));
}

/* A camera before one eye, `aside` degrees to the person's left. */
function before(side, aside) {
	const at = new THREE.Vector3(), camera = new THREE.PerspectiveCamera(2 * Math.atan(FIELD / 2 / 0.5) * 180 / Math.PI, 1, 0.1, 2), a = aside * Math.PI / 180;
	eyes[side].node.getWorldPosition(at);
	camera.position.set(at.x + 0.5 * Math.sin(a), at.y, at.z + 0.5 * Math.cos(a));
	camera.lookAt(at);
	return camera;
}

function dress(marked, haired = true) {
	face.traverse(o => {
		if (o.userData.behind)
			o.visible = marked;
		else if (o.isMesh) {
			o.material = (marked ? flat : own).get(o);
			o.visible = haired || !hair.test(o.name) && !(marked && wet.test(o.name));
		}
	});
}

/* How many pixels of the eye's picture show the eye, skin, skin from behind, and nothing at all: without hairs and tears; and how many show
 * those. */
function counted(side, aside) {
	const all = pixels(side, aside, true);
	return { ...pixels(side, aside, false), hair: all.hair, tears: all.tears };
}

function pixels(side, aside, haired) {
	const target = new THREE.WebGLRenderTarget(SIZE, SIZE, { depthBuffer: true }), px = new Uint8Array(4 * SIZE * SIZE);
	dress(true, haired);
	const environment = scene.environment;
	scene.environment = null;
	renderer.setRenderTarget(target);
	renderer.setClearColor(0, 1);
	renderer.clear();
	renderer.render(scene, before(side, aside));
	renderer.readRenderTargetPixels(target, 0, 0, SIZE, SIZE, px);
	renderer.setRenderTarget(null);
	target.dispose();
	scene.environment = environment;
	dress(false);
	const n = { eye: 0, skin: 0, behind: 0, nothing: 0, hair: 0, tears: 0 };
	for (let i = 0; i < px.length; i += 4)
		n[px[i] > 127 && px[i + 1] > 127 ? "hair" : px[i] > 127 && px[i + 2] > 127 ? "tears" : px[i + 1] > 127 ? "eye" : px[i] > 127 ? "skin" : px[i + 2] > 127 ? "behind" : "nothing"]++;
	return n;
}

window.seen = (weights, turn, side, aside) => {
	pose(weights, turn);
	return counted(side, aside);
};

/* The same at a moment of the animation. */
window.seen_at = (time, side, aside) => {
	const action = mixer.clipAction(clip);
	pose({}, [0, 0]);
	action.play();
	mixer.setTime(time);
	const n = counted(side, aside);
	action.stop();
	return n;
};

window.show = (weights, turn, side, aside, marked = false) => {
	pose(weights, turn);
	dress(marked, !marked);
	renderer.setClearColor(0x606060, 1);
	renderer.render(scene, before(side, aside));
};
window.ready = true;

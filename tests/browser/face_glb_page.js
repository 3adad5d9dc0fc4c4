/* A driven face's .glb in three.js: window.open_face(file), then window.seen(...) counts what shows round one eye, window.show(...) draws it. */
import * as THREE from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { RoomEnvironment } from "three/addons/environments/RoomEnvironment.js";

const SIZE = 512, STEP = 16, FIELD = 0.045;  // m across, round one eye

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

/* How many pixels of the eye's picture show the eye, skin, skin from behind, and nothing at all within the head's outline: without hairs and
 * tears; how many show those; islands: skin and what else lies in the midst of the eye, joined to nothing beside it; through: eye that is joined
 * to no more of it than a speck, beside the largest patch. */
function counted(side, aside) {
	const all = pixels(side, aside, true);
	return { ...pixels(side, aside, false), hair: all.hair, tears: all.tears };
}

/* Marks the pixels of one picture that may be walked to from `from`, over those for which `over` holds; returns how many. */
function walk(marks, from, over) {
	const todo = from.filter(i => over(i) && !marks[i]);
	todo.forEach(i => { marks[i] = 1; });
	let n = todo.length;
	while (todo.length) {
		const i = todo.pop(), x = i % SIZE;
		for (const j of [x > 0 ? i - 1 : -1, x < SIZE - 1 ? i + 1 : -1, i - SIZE, i + SIZE])
			if (j >= 0 && j < SIZE * SIZE && !marks[j] && over(j)) {
				marks[j] = 1;
				todo.push(j);
				n++;
			}
	}
	return n;
}

const edge = [...Array(SIZE).keys()].flatMap(k => [k, SIZE * (SIZE - 1) + k, SIZE * k, SIZE * k + SIZE - 1]);

/* Of a picture of marks: background that the head encloses, islands in the eye, and patches of eye beside its largest. */
function patches(kind) {
	const outside = new Uint8Array(SIZE * SIZE), beside = new Uint8Array(SIZE * SIZE), eye = new Uint8Array(SIZE * SIZE), out = { nothing: 0, islands: 0, through: 0 };
	walk(outside, edge, i => kind[i] === "nothing");
	walk(beside, edge, i => kind[i] !== "eye");
	let largest = 0, all = 0;
	for (let i = 0; i < SIZE * SIZE; i++) {
		out.nothing += kind[i] === "nothing" && !outside[i];
		out.islands += kind[i] !== "eye" && !beside[i];
		if (kind[i] === "eye" && !eye[i]) {
			const n = walk(eye, [i], j => kind[j] === "eye");
			all += n;
			largest = Math.max(largest, n);
		}
	}
	out.through = all - largest;
	return out;
}

/* What each pixel of the eye's picture shows. */
function kinds_of(side, aside, haired) {
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
	const kind = [];
	for (let i = 0; i < px.length; i += 4)
		kind.push(px[i] > 127 && px[i + 1] > 127 ? "hair" : px[i] > 127 && px[i + 2] > 127 ? "tears" : px[i + 1] > 127 ? "eye" : px[i] > 127 ? "skin" : px[i + 2] > 127 ? "behind" : "nothing");
	return kind;
}

function pixels(side, aside, haired) {
	const kind = kinds_of(side, aside, haired), n = { eye: 0, skin: 0, behind: 0, nothing: 0, hair: 0, tears: 0 };
	for (const k of kind)
		n[k]++;
	return haired ? n : { ...n, ...patches(kind) };
}

window.seen = (weights, turn, side, aside) => {
	pose(weights, turn);
	return counted(side, aside);
};

/* How many surfaces of skin that look at the camera lie over each other in each pixel of an eye's picture from in front, before the eye's centre. */
function layers(side) {
	const target = new THREE.WebGLRenderTarget(SIZE, SIZE, { depthBuffer: false }), px = new Uint8Array(4 * SIZE * SIZE), camera = before(side, 0), was = new Map();
	const each = new THREE.MeshBasicMaterial({ color: new THREE.Color().setRGB(STEP / 255, 0, 0), blending: THREE.CustomBlending, blendSrc: THREE.OneFactor, blendDst: THREE.OneFactor,
		depthTest: false, depthWrite: false, transparent: true, toneMapped: false });
	camera.far = 0.5;
	camera.updateProjectionMatrix();
	face.traverse(o => {
		if (!o.isMesh)
			return;
		was.set(o, [o.visible, o.material]);
		o.visible = !o.userData.behind && !hair.test(o.name) && !wet.test(o.name) && !/^eye_(left|right)_/.test(o.name);
		o.material = each;
	});
	renderer.setRenderTarget(target);
	renderer.setClearColor(0, 1);
	renderer.clear();
	renderer.render(scene, camera);
	renderer.readRenderTargetPixels(target, 0, 0, SIZE, SIZE, px);
	renderer.setRenderTarget(null);
	target.dispose();
	each.dispose();
	was.forEach(([visible, material], o) => Object.assign(o, { visible, material }));
	return Array.from({ length: SIZE * SIZE }, (_, i) => Math.round(px[4 * i] / STEP));
}

/* How far a pose's lids lie over each other where an open eye is seen, mm: the mean over that opening's columns. */
window.over = (weights, side) => {
	pose({}, [0, 0]);
	const open = kinds_of(side, 0, false), mm = 1000 * FIELD / SIZE;
	pose(weights, [0, 0]);
	const n = layers(side), columns = new Set();
	let twice = 0;
	open.forEach((kind, i) => {
		if (kind === "eye") {
			columns.add(i % SIZE);
			twice += n[i] > 1;
		}
	});
	return mm * twice / columns.size;
};

/* How far out an eye's surface is from its centre, by direction: a grid over the plane before it (gnomonic), the outermost of sclera and cornea. Of the
 * node's own unit of length. */
const GRID = 251, REACH = 2.5;
function surface_of(node) {
	const far = new Float32Array(GRID * GRID), at = [0, 1, 2].map(() => new THREE.Vector3()), e1 = new THREE.Vector3(), e2 = new THREE.Vector3(), d = new THREE.Vector3();
	const column = v => (v / REACH + 1) / 2 * (GRID - 1);
	node.traverse(mesh => {
		if (!mesh.isMesh || !/(sclera|cornea)$/.test(mesh.name))
			return;
		const position = mesh.geometry.attributes.position, index = mesh.geometry.index;
		const to = new THREE.Matrix4().copy(node.matrixWorld).invert().multiply(mesh.matrixWorld);
		for (let f = 0; f < index.count; f += 3) {
			at.forEach((v, k) => v.fromBufferAttribute(position, index.getX(f + k)).applyMatrix4(to));
			if (at.some(v => v.z <= 0))
				continue;
			const x = at.map(v => column(v.x / v.z)), y = at.map(v => column(v.y / v.z));
			const normal = e1.subVectors(at[1], at[0]).clone().cross(e2.subVectors(at[2], at[0])), off = normal.dot(at[0]);
			const area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
			for (let j = Math.max(0, Math.ceil(Math.min(...y))); j <= Math.min(GRID - 1, Math.max(...y)); j++)
				for (let i = Math.max(0, Math.ceil(Math.min(...x))); i <= Math.min(GRID - 1, Math.max(...x)); i++) {
					const b = ((i - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (j - y[0])) / area, c = ((x[1] - x[0]) * (j - y[0]) - (i - x[0]) * (y[1] - y[0])) / area;
					if (!(b >= -1e-6 && c >= -1e-6 && b + c <= 1 + 1e-6))
						continue;
					d.set((2 * i / (GRID - 1) - 1) * REACH, (2 * j / (GRID - 1) - 1) * REACH, 1);
					far[j * GRID + i] = Math.max(far[j * GRID + i], d.length() * off / normal.dot(d));
				}
		}
	});
	return p => {
		if (p.z <= 0)
			return NaN;
		const x = column(p.x / p.z), y = column(p.y / p.z), i = Math.floor(x), j = Math.floor(y), u = x - i, v = y - j;
		if (!(i >= 0 && j >= 0 && i + 1 < GRID && j + 1 < GRID))
			return NaN;
		const of = [[0, 0, (1 - u) * (1 - v)], [1, 0, u * (1 - v)], [0, 1, (1 - u) * v], [1, 1, u * v]];
		return of.some(([a, b]) => !far[(j + b) * GRID + i + a]) ? NaN : of.reduce((sum, [a, b, w]) => sum + w * far[(j + b) * GRID + i + a], 0);
	};
}

/* Where skin is in a pose: vertices, then the middles of edges and faces, of those faces near an eye; in the eye's frame. */
function samples_of(mesh, node, near) {
	const { position } = mesh.geometry.attributes, { index } = mesh.geometry, targets = mesh.geometry.morphAttributes.position, weights = mesh.morphTargetInfluences;
	const to = new THREE.Matrix4().copy(node.matrixWorld).invert().multiply(mesh.matrixWorld), d = new THREE.Vector3();
	const place = i => {
		const v = new THREE.Vector3().fromBufferAttribute(position, i);
		weights.forEach((w, k) => w && v.addScaledVector(d.fromBufferAttribute(targets[k], i), w));
		return v.applyMatrix4(to);
	};
	near.faces ??= [...Array(index.count / 3).keys()].map(f => [0, 1, 2].map(k => index.getX(3 * f + k))).filter(f => f.every(i => {
		const v = place(i);
		return v.z > 0 && v.length() < 1.5 * near.radius;
	}));
	const at = new Map();
	for (const i of near.faces.flat())
		at.has(i) || at.set(i, place(i));
	const out = [...at.values()];
	for (const [a, b, c] of near.faces.map(f => f.map(i => at.get(i))))
		out.push(a.clone().add(b).divideScalar(2), b.clone().add(c).divideScalar(2), c.clone().add(a).divideScalar(2), a.clone().add(b).add(c).divideScalar(3));
	return out;
}

/* How deep in an eye skin lies on the way of a blink, mm, that is outside at both of its ends: at weights 0.25, 0.5, 0.75 of the blink's target, by
 * itself and with the one that goes with it. along: a target that goes with all of it, a look of an eye turned up by v degrees or an expression, whose name
 * in those of what the blink lacks then is `way`; then what counts is skin outside the eye that looks ahead, open and shut, and open: how deep it is without the blink. */
window.depths = (side, along = null, way = "", v = 0) => {
	const eye = eyes[`eye_${side}`], which = side === "left" ? "Left" : "Right", name = `eyeBlink${which}`, out = { alone: [0, 0, 0], both: [0, 0, 0], open: 0, n: 0 };
	const with_it = along ? { [along]: 1 } : {}, and = w => along ? { [`${name}_${way}`]: w, [`${name}_${way}_half`]: 4 * w * (1 - w) } : {};
	pose({}, [0, 0]);
	face.updateMatrixWorld(true);
	const surface = surface_of(eye.node), mm = 1000 * eye.node.getWorldScale(new THREE.Vector3()).x;
	face.traverse(mesh => {
		if (!mesh.morphTargetDictionary || !(name in mesh.morphTargetDictionary) || hair.test(mesh.name) || wet.test(mesh.name) || mesh.userData.behind)
			return;
		const near = { radius: surface({ x: 0, y: 0, z: 1 }) }, off = (w, turn) => {
			pose(w, [0, turn]);
			face.updateMatrixWorld(true);
			return samples_of(mesh, eye.node, near).map(p => mm * (p.length() - surface(p)));
		};
		const ends = [off({}, 0), off({ [name]: 1 }, 0)], outside = ends[0].map((d, i) => Math.min(d, ends[1][i]) > -0.03 && Math.min(d, ends[1][i]) < 5);
		out.n += outside.filter(o => o).length;
		const deepest = (weights, was) => off({ ...with_it, ...weights }, v).reduce((most, d, i) => outside[i] && -d > most ? -d : most, was);
		out.open = deepest({}, out.open);
		[0.25, 0.5, 0.75].forEach((w, k) => {
			out.alone[k] = deepest({ [name]: w }, out.alone[k]);
			out.both[k] = deepest({ [name]: w, [`${name}_half`]: 4 * w * (1 - w), ...and(w) }, out.both[k]);
		});
	});
	pose({}, [0, 0]);
	return out;
};

/* What is seen at a moment of the animation. */
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

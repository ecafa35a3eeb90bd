// The 3D view of a report: turns, plays, and shares its time with the curves. Uses three.js (r111 or later).
(function () {
"use strict";
const at = id => document.getElementById(id);
const scene = JSON.parse(at("scene").textContent);
const count = scene.ids.length, frames = scene.time.length;
const first = scene.time[0], last = scene.time[frames - 1];
const poses = unpack(scene.poses), base = unpack(scene.base);
const POSE = 7;
// Vertices x, y, z in the axes of the block, one after the other; faces counterclockwise from outside.
for (const shape of scene.shapes)
  shape.edges = shape.faces.flatMap(face => face.map((a, i) => [a, face[(i + 1) % face.length]])).filter(([a, b]) => a < b);
const shapes = scene.shape.map(number => scene.shapes[number]);
// Where the numbers of the vertices of each block begin, and the end of the last.
const begin = [0];
for (const { vertices } of shapes)
  begin.push(begin[begin.length - 1] + vertices.length);
const BEYOND = new THREE.Color("#9467bd"), PRESCRIBED = new THREE.Color("#9aa3ad"), UNMOVED = new THREE.Color("#d9d9d9");
const palette = scene.palette.map(text => new THREE.Color(text));
const state = { time: scene.start, playing: false, enlarge: 1, quantity: 0 };

function unpack(text) {
  const bytes = Uint8Array.from(atob(text), letter => letter.charCodeAt(0));
  return new Float32Array(bytes.buffer);
}

// --- where the blocks are ---

// Position and unit quaternion of item `k` of `size` at a time between two frames.
function poseAt(numbers, size, k, frame, share) {
  const from = (frame * size + k) * POSE, to = (Math.min(frame + 1, frames - 1) * size + k) * POSE;
  const result = new Array(POSE);
  let dot = 0;
  for (let i = 3; i < POSE; ++i)
    dot += numbers[from + i] * numbers[to + i];
  for (let i = 0; i < POSE; ++i)
    result[i] = (1 - share) * numbers[from + i] + (i < 3 || dot >= 0 ? share : -share) * numbers[to + i];
  const norm = Math.hypot(result[3], result[4], result[5], result[6]);
  for (let i = 3; i < POSE; ++i)
    result[i] /= norm;
  return result;
}

function frameAt(time) {
  let low = 0, high = frames - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (scene.time[middle] <= time) low = middle; else high = middle;
  }
  const length = scene.time[high] - scene.time[low];
  return [low, length > 0 ? Math.min(1, Math.max(0, (time - scene.time[low]) / length)) : 0];
}

function place(vertices, [x, y, z, w, a, b, c], to, offset) {
  const axes = [[1 - 2 * (b * b + c * c), 2 * (a * b + w * c), 2 * (a * c - w * b)],
                [2 * (a * b - w * c), 1 - 2 * (a * a + c * c), 2 * (b * c + w * a)],
                [2 * (a * c + w * b), 2 * (b * c - w * a), 1 - 2 * (a * a + b * b)]];
  for (let i = 0; i < vertices.length; i += 3) {
    const u = vertices[i], v = vertices[i + 1], s = vertices[i + 2];
    to[offset + i] = x + u * axes[0][0] + v * axes[1][0] + s * axes[2][0];
    to[offset + i + 1] = y + u * axes[0][1] + v * axes[1][1] + s * axes[2][1];
    to[offset + i + 2] = z + u * axes[0][2] + v * axes[1][2] + s * axes[2][2];
  }
}

const [corners, start, dashed] = [0, 1, 2].map(() => new Float32Array(begin[count])), values = [new Float64Array(count), new Float64Array(count)];
for (let k = 0; k < count; ++k)
  place(shapes[k].vertices, poseAt(poses, count, k, 0, 0), start, begin[k]);

// Takes points of block `k`, from one number to another, along with its base.
function follow(k, points, from, to, frame, share) {
  const [x, y, z, w, a, b, c] = poseAt(base.subarray(scene.bases[k] * frames * POSE), 1, 0, frame, share);
  const turn = new THREE.Quaternion(a, b, c, w), shift = new THREE.Vector3(x, y, z), corner = new THREE.Vector3();
  for (let i = from; i < to; i += 3)
    corner.fromArray(points, i).applyQuaternion(turn).add(shift).toArray(points, i);
}

// Corners, displacements and rotations now. A block that was erased has no corners: not numbers.
function move() {
  const [frame, share] = frameAt(state.time);
  for (let k = 0; k < count; ++k) {
    const now = poseAt(poses, count, k, frame, share), then = poseAt(poses, count, k, 0, 0);
    place(shapes[k].vertices, now, corners, begin[k]);
    values[0][k] = Math.hypot(now[0] - then[0], now[1] - then[1], now[2] - then[2]);
    const cosine = Math.min(1, Math.abs(now[3] * then[3] + now[4] * then[4] + now[5] * then[5] + now[6] * then[6]));
    values[1][k] = 2 * Math.acos(cosine);
  }
  for (let i = 0; i < corners.length; ++i)
    corners[i] = start[i] + state.enlarge * (corners[i] - start[i]);
  dashed.set(start);
  for (let k = 0; at("moving").checked && k < count; ++k)
    for (const points of [corners, dashed])
      follow(k, points, begin[k], begin[k + 1], frame, share);
}

// --- what is drawn ---

function refuse(text) {
  at("no-view").textContent = text;
  at("no-view").hidden = false;
}

let renderer;
try {
  renderer = new THREE.WebGLRenderer({ canvas: at("canvas"), antialias: true, preserveDrawingBuffer: true });
} catch (error) {
  refuse("This browser draws no 3D view: it has no WebGL. The curves and pictures below do not need it.");
  return;
}
renderer.setPixelRatio(window.devicePixelRatio || 1);
renderer.setClearColor(0xeef1f5);
const world = new THREE.Scene(), camera = new THREE.PerspectiveCamera(35, 1, 0.01, 1000);
camera.up.set(0, 0, 1);
world.add(new THREE.AmbientLight(0xffffff, 0.62));
const sun = new THREE.DirectionalLight(0xffffff, 0.5);
world.add(sun);

// Each face has corners of its own and is a fan of triangles; `owner` is the block of each triangle.
const index = [], owner = [];
let placed = 0, sides = 0;
for (const [k, { faces, edges }] of shapes.entries()) {
  for (const face of faces) {
    for (let i = 2; i < face.length; ++i) {
      index.push(placed, placed + i - 1, placed + i);
      owner.push(k);
    }
    placed += face.length;
  }
  sides += edges.length;
}
const positions = new THREE.BufferAttribute(new Float32Array(3 * placed), 3);
const colours = new THREE.BufferAttribute(new Float32Array(3 * placed), 3);
const lines = new THREE.BufferAttribute(new Float32Array(6 * sides), 3);
const solid = new THREE.BufferGeometry(), outline = new THREE.BufferGeometry(), ghost = new THREE.BufferGeometry();
const attribute = (geometry, name, data) => (geometry.setAttribute || geometry.addAttribute).call(geometry, name, data);
attribute(solid, "position", positions);
attribute(solid, "color", colours);
solid.setIndex(index);
attribute(outline, "position", lines);
const box = new THREE.Mesh(solid, new THREE.MeshPhongMaterial({
  vertexColors: THREE.VertexColors || true, flatShading: true, shininess: 0, specular: 0, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 }));
const edges = new THREE.LineSegments(outline, new THREE.LineBasicMaterial({ color: 0x333a44 }));
const firstShape = new THREE.LineSegments(ghost, new THREE.LineBasicMaterial({ color: 0xaab2bd }));
for (const one of [box, edges, firstShape])
  one.frustumCulled = false;
world.add(box, edges, firstShape);

function fillEdges(from, free, to) {
  let next = 0;
  for (let k = 0; k < count; ++k)
    for (const [a, b] of shapes[k].edges)
      for (const corner of [a, b])
        for (let i = 0; i < 3; ++i, ++next) {
          const value = from[begin[k] + 3 * corner + i];
          to[next] = isFinite(value) && (scene.free[k] || !free) ? value : 0;
        }
}
attribute(ghost, "position", new THREE.BufferAttribute(new Float32Array(lines.array.length), 3));

function colourOf(k) {
  if (!scene.free[k])
    return PRESCRIBED;
  const { most } = scene.quantities[state.quantity], share = values[state.quantity][k] / most;
  if (!(most > 0))
    return UNMOVED;
  return share > 1.0001 ? BEYOND : shade(share);
}

// A band around each joint with mortar that has cracked, in the colour of its mean damage. Its corners are lower and upper ones in turns.
const bands = scene.joints || [], damage = unpack(scene.damage || ""), CRACKED = 0.02;
const bandAt = bands.map(() => 0), bandIndex = [];
let bandSize = 0;
for (const [j, { vertices }] of bands.entries()) {
  bandAt[j] = bandSize;
  const size = vertices.length / 3;
  for (let i = 0; i < size; i += 2) {
    const [a, b, c, d] = [i, i + 1, (i + 3) % size, (i + 2) % size].map(corner => bandSize / 3 + corner);
    bandIndex.push(a, b, c, a, c, d);
  }
  bandSize += vertices.length;
}
const bandPlaces = new THREE.BufferAttribute(new Float32Array(bandSize), 3), bandColours = new THREE.BufferAttribute(new Float32Array(bandSize), 3);
const bandSolid = new THREE.BufferGeometry(), bandFirst = new Float32Array(bandSize);
attribute(bandSolid, "position", bandPlaces);
attribute(bandSolid, "color", bandColours);
bandSolid.setIndex(bandIndex);
const bandMesh = new THREE.Mesh(bandSolid, new THREE.MeshBasicMaterial({ vertexColors: THREE.VertexColors || true, side: THREE.DoubleSide }));
bandMesh.frustumCulled = false;
world.add(bandMesh);
for (const [j, { block, vertices }] of bands.entries())
  place(vertices, poseAt(poses, count, block, 0, 0), bandFirst, bandAt[j]);
at("has-cracks").hidden = !bands.length;

function shade(share) {
  const place = share * (palette.length - 1), low = Math.min(Math.floor(place), palette.length - 2);
  return palette[low].clone().lerp(palette[low + 1], place - low);
}

function fillBands() {
  const [frame, share] = frameAt(state.time), to = Math.min(frame + 1, frames - 1), places = bandPlaces.array;
  bandMesh.visible = at("cracks").checked;
  for (const [j, { block, vertices }] of bands.entries()) {
    const cracked = (1 - share) * damage[frame * bands.length + j] + share * damage[to * bands.length + j];
    const colour = shade(Math.min(1, cracked)), now = poseAt(poses, count, block, frame, share);
    place(vertices, now, places, bandAt[j]);
    for (let i = bandAt[j]; i < bandAt[j] + vertices.length; ++i)
      places[i] = cracked >= CRACKED && isFinite(now[0]) ? bandFirst[i] + state.enlarge * (places[i] - bandFirst[i]) : 0;
    if (at("moving").checked)
      follow(block, places, bandAt[j], bandAt[j] + vertices.length, frame, share);
    for (let i = bandAt[j]; i < bandAt[j] + vertices.length; i += 3)
      colour.toArray(bandColours.array, i);
  }
  bandPlaces.needsUpdate = bandColours.needsUpdate = true;
}

function fill() {
  move();
  fillBands();
  let next = 0;
  for (let k = 0; k < count; ++k) {
    const colour = colourOf(k), there = isFinite(corners[begin[k]]);
    for (const face of shapes[k].faces)
      for (const corner of face) {
        for (let i = 0; i < 3; ++i)
          positions.array[next + i] = there ? corners[begin[k] + 3 * corner + i] : 0;
        colours.array[next] = colour.r;
        colours.array[next + 1] = colour.g;
        colours.array[next + 2] = colour.b;
        next += 3;
      }
  }
  fillEdges(corners, false, lines.array);
  fillEdges(dashed, true, ghost.attributes.position.array);
  positions.needsUpdate = colours.needsUpdate = lines.needsUpdate = ghost.attributes.position.needsUpdate = true;
}

// --- the camera: turns about a target ---

const bounds = new THREE.Box3();
for (let k = 0; k < count; ++k)
  for (let i = begin[k]; scene.free[k] && i < begin[k + 1]; i += 3)
    bounds.expandByPoint(new THREE.Vector3().fromArray(start, i));
const middle = bounds.getCenter(new THREE.Vector3()), radius = bounds.getSize(new THREE.Vector3()).length() / 2;
const front = Math.atan2(scene.front[1], scene.front[0]);
const VIEWS = { front: [front, 0.06], side: [front + Math.PI / 2, 0.06], top: [front, Math.PI / 2 - 1e-3], oblique: [front + 0.5, 0.35] };
const eye = { target: middle.clone(), azimuth: VIEWS.oblique[0], height: VIEWS.oblique[1], distance: 1 };

function look(view) {
  [eye.azimuth, eye.height] = VIEWS[view];
  eye.target.copy(middle);
  const half = camera.fov * Math.PI / 360;
  eye.distance = 1.12 * radius / Math.sin(Math.min(half, Math.atan(Math.tan(half) * camera.aspect)));
}

function aim() {
  const flat = Math.cos(eye.height);
  camera.position.set(Math.cos(eye.azimuth) * flat, Math.sin(eye.azimuth) * flat, Math.sin(eye.height)).multiplyScalar(eye.distance).add(eye.target);
  camera.near = eye.distance / 100;
  camera.far = eye.distance + 100 * radius;
  camera.lookAt(eye.target);
  camera.updateProjectionMatrix();
  camera.updateMatrixWorld();
  sun.position.set(Math.cos(eye.azimuth - 0.6), Math.sin(eye.azimuth - 0.6), 1.2);
}

function triad() {
  const back = camera.matrixWorldInverse.getInverse ? new THREE.Matrix4().getInverse(camera.matrixWorld) : camera.matrixWorld.clone().invert();
  at("triad").innerHTML = ["x", "y", "z"].map((name, k) => {
    const axis = new THREE.Vector3().setComponent(k, 1).transformDirection(back), x = 26 * axis.x, y = -26 * axis.y;
    return `<line x2="${x}" y2="${y}" stroke="#333" stroke-width="1.5"/><text x="${1.35 * x}" y="${1.35 * y + 4}" text-anchor="middle">${name}</text>`;
  }).join("");
}

let asked = false;
function draw() {
  if (asked)
    return;
  asked = true;
  requestAnimationFrame(now => {
    asked = false;
    advance(now);
    fill();
    firstShape.visible = at("ghost").checked;
    aim();
    renderer.render(world, camera);
    triad();
    show();
    if (state.playing)
      draw();
  });
}

function resize() {
  const { clientWidth, clientHeight } = at("stage");
  renderer.setSize(clientWidth, clientHeight, false);
  camera.aspect = clientWidth / clientHeight;
  draw();
}

// --- time ---

let shownAt = null;
function advance(now) {
  if (state.playing && shownAt !== null) {
    state.time += (now - shownAt) / 1000 * Number(at("speed").value);
    if (state.time >= last) {
      state.time = last;
      play(false);
    }
  }
  shownAt = state.playing ? now : null;
}

function play(on) {
  if (on && state.time >= last)
    state.time = first;
  state.playing = on;
  shownAt = null;
  at("play").textContent = on ? "Pause" : "Play";
  draw();
}

function go(time) {
  state.time = Math.min(last, Math.max(first, time));
  draw();
}

function show() {
  at("time").value = state.time;
  at("now").textContent = `${state.time.toFixed(3)} s`;
  for (const figure of document.querySelectorAll("svg.over-time"))
    for (const line of figure.querySelectorAll(".cursor"))
      line.setAttribute("transform", `translate(${(state.time - figure.dataset.start) * figure.dataset.rate} 0)`);
  describe();
}

// --- the block that was clicked ---

let picked = null;
function describe() {
  at("picked").hidden = picked === null;
  if (picked === null)
    return;
  const sizes = scene.sizes[picked].map(x => Number(x.toPrecision(4))).join(" × ");
  const numbers = scene.quantities.map((one, k) => `${one.name} ${(one.factor * values[k][picked]).toPrecision(4)} ${one.unit}`).join(", ");
  at("picked").textContent = `Block ${scene.ids[picked]}${scene.free[picked] ? "" : " (prescribed)"}: ${sizes} m; ${numbers}`;
}

function pick(event) {
  const area = at("canvas").getBoundingClientRect(), ray = new THREE.Raycaster();
  ray.setFromCamera(new THREE.Vector2(2 * (event.clientX - area.left) / area.width - 1, 1 - 2 * (event.clientY - area.top) / area.height), camera);
  solid.computeBoundingSphere();
  const [hit] = ray.intersectObject(box);
  picked = hit ? owner[hit.faceIndex] : null;
  draw();
}

// --- what the reader does ---

const touches = new Map();
let travelled = 0;
const canvas = at("canvas");
canvas.addEventListener("pointerdown", event => {
  canvas.setPointerCapture(event.pointerId);
  touches.set(event.pointerId, event);
  travelled = 0;
});
canvas.addEventListener("pointermove", event => {
  const before = touches.get(event.pointerId);
  if (!before)
    return;
  const dx = event.clientX - before.clientX, dy = event.clientY - before.clientY;
  travelled += Math.abs(dx) + Math.abs(dy);
  if (touches.size === 2) {
    const [other] = [...touches.values()].filter(one => one.pointerId !== event.pointerId);
    const apart = one => Math.hypot(one.clientX - other.clientX, one.clientY - other.clientY);
    eye.distance *= apart(before) / Math.max(1, apart(event));
  } else if (before.button === 2 || event.shiftKey) {
    const scale = 2 * eye.distance * Math.tan(camera.fov * Math.PI / 360) / canvas.clientHeight;
    eye.target.addScaledVector(new THREE.Vector3().setFromMatrixColumn(camera.matrixWorld, 0), -dx * scale);
    eye.target.addScaledVector(new THREE.Vector3().setFromMatrixColumn(camera.matrixWorld, 1), dy * scale);
  } else {
    eye.azimuth -= 0.008 * dx;
    eye.height = Math.min(Math.PI / 2 - 1e-3, Math.max(-Math.PI / 2 + 1e-3, eye.height + 0.008 * dy));
  }
  touches.set(event.pointerId, { clientX: event.clientX, clientY: event.clientY, pointerId: event.pointerId, button: before.button });
  draw();
});
canvas.addEventListener("pointerup", event => {
  touches.delete(event.pointerId);
  if (travelled < 4 && event.button === 0)
    pick(event);
});
canvas.addEventListener("pointercancel", event => touches.delete(event.pointerId));
canvas.addEventListener("contextmenu", event => event.preventDefault());
canvas.addEventListener("wheel", event => {
  event.preventDefault();
  eye.distance = Math.min(100 * radius, Math.max(0.05 * radius, eye.distance * Math.exp(0.001 * event.deltaY)));
  draw();
}, { passive: false });
window.addEventListener("resize", resize);
document.addEventListener("keydown", event => {
  if (event.code === "Space" && !["BUTTON", "INPUT", "SELECT", "SUMMARY"].includes(event.target.tagName)) {
    event.preventDefault();
    play(!state.playing);
  }
});
for (const figure of document.querySelectorAll("svg.over-time"))
  figure.addEventListener("click", event => {
    const place = new DOMPoint(event.clientX, event.clientY).matrixTransform(figure.getScreenCTM().inverse());
    play(false);
    go(Number(figure.dataset.start) + (place.x - figure.dataset.left) / figure.dataset.rate);
  });
at("play").addEventListener("click", () => play(!state.playing));
at("time").min = first;
at("time").max = last;
at("time").addEventListener("input", () => { play(false); go(Number(at("time").value)); });
for (const button of document.querySelectorAll("[data-view]"))
  button.addEventListener("click", () => { look(button.dataset.view); draw(); });
at("enlarge").value = state.enlarge = scene.enlarge;
at("enlarge").addEventListener("input", () => {
  state.enlarge = Math.max(1, Number(at("enlarge").value) || 1);
  draw();
});
at("moving").addEventListener("change", draw);
at("ghost").addEventListener("change", draw);
at("cracks").addEventListener("change", draw);

function legend() {
  const { name, unit, factor, most, beyond } = scene.quantities[state.quantity];
  at("bar").style.background = `linear-gradient(to right, ${scene.palette.join(", ")})`;
  at("crack-bar").style.background = at("bar").style.background;
  at("least").textContent = "0";
  at("label").textContent = `${name} (${unit})${beyond ? "; purple: beyond the scale, fallen" : ""}`;
  at("most").textContent = Number((factor * most).toPrecision(3));
  draw();
}
for (const [k, { name }] of scene.quantities.entries())
  at("quantity").add(new Option(name, k));
at("quantity").addEventListener("change", () => { state.quantity = Number(at("quantity").value); legend(); });

resize();
look("oblique");
legend();
window.masonryReport = { go, play, look: view => { look(view); draw(); }, state };
}());

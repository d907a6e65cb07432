import {Viewer} from './viewer.mjs';

/** The numbers of a block of base64, little-endian. */
function numbers(block, Kind) {
  const text = atob(block.textContent);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < bytes.length; i++) bytes[i] = text.charCodeAt(i);
  return new Kind(bytes.buffer);
}

/** Normals of vertices: the sums of those of their faces, weighted by area. */
function vertexNormals(positions, faces) {
  const sums = new Float64Array(positions.length);
  for (let f = 0; f < faces.length; f += 3) {
    const [a, b, c] = [3 * faces[f], 3 * faces[f + 1], 3 * faces[f + 2]];
    const [ux, uy, uz] = [positions[b] - positions[a], positions[b + 1] - positions[a + 1], positions[b + 2] - positions[a + 2]];
    const [vx, vy, vz] = [positions[c] - positions[a], positions[c + 1] - positions[a + 1], positions[c + 2] - positions[a + 2]];
    const [x, y, z] = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
    for (const corner of [a, b, c]) {
      sums[corner] += x;
      sums[corner + 1] += y;
      sums[corner + 2] += z;
    }
  }
  for (let v = 0; v < sums.length; v += 3) {
    const length = Math.hypot(sums[v], sums[v + 1], sums[v + 2]) || 1;
    for (let k = 0; k < 3; k++) sums[v + k] /= length;
  }
  return Float32Array.from(sums);
}

/** A mesh for the viewer, from its block of the page. */
function meshIn(block) {
  const positions = numbers(block.querySelector('.positions'), Float32Array);
  const faces = numbers(block.querySelector('.faces'), Uint32Array);
  const fields = new Map();
  for (const values of block.querySelectorAll('.field')) fields.set(values.dataset.name, numbers(values, Float64Array));
  return {title: block.dataset.title, arrays: {positions, faces, normals: vertexNormals(positions, faces)}, fields};
}

/** In a notebook the page is as light or dark as what surrounds it, elsewhere as the system prefers. */
function followSurroundings(root) {
  for (let at = window.frameElement; at; at = at.parentElement) {
    const [red, green, blue, alpha = 1] = getComputedStyle(at).backgroundColor.match(/[\d.]+/g).map(Number);
    root.dataset.theme = alpha > 0 && red + green + blue < 384 ? 'dark' : 'light';
    if (alpha > 0) return;
  }
}

/** Position and values of a vertex in each mesh that has it. */
function describe(vertex, meshes, center) {
  const lines = meshes.filter(({arrays}) => vertex >= 0 && 3 * vertex < arrays.positions.length).map(({title, arrays, fields}) => {
    const place = center.map((c, k) => readable(c + arrays.positions[3 * vertex + k], 6)).join(', ');
    const values = [...fields].map(([name, list]) => `${name} ${readable(list[vertex], 6)}`);
    return [`${title}: vertex ${vertex} at (${place})`, ...values].join(' · ');
  });
  return lines.join('\n');
}

function show() {
  const part = Object.fromEntries([...document.querySelectorAll('[data-part]')].map((e) => [e.dataset.part, e]));
  const {field, up, center} = document.body.dataset;
  followSurroundings(document.documentElement);
  if (!Renderer) {
    part.words.textContent = 'The meshes cannot be drawn: this browser has no WebGL 2.';
    return;
  }
  part.words.textContent = '';
  const meshes = [...document.querySelectorAll('.mesh')].map(meshIn);
  const middle = center.split(' ').map(Number);
  const maps = Object.fromEntries([...document.querySelectorAll('.map')].map((block) => [block.dataset.name, numbers(block, Uint8Array)]));
  const viewer = new Viewer(part.panels, maps, (vertex) => {
    part.words.textContent = describe(vertex, meshes, middle);
  });
  viewer.camera = new Camera(30, 20, up === 'z');
  const names = new Set(meshes.flatMap(({fields}) => [...fields.keys()]));
  for (const name of names) part.field.append(element('option', {value: name}, name));
  part.field.append(element('option', {value: ''}, 'nothing'));
  part.field.value = field ?? '';
  part.field.addEventListener('input', () => viewer.change({field: part.field.value || null}));
  for (const key of ['lines', 'wire', 'flat']) {
    part[key].addEventListener('input', () => viewer.change({[key]: part[key].checked}));
  }
  for (const colored of document.querySelectorAll('.colored')) colored.hidden = !names.size;
  part.reset.addEventListener('click', () => {
    viewer.camera.reset();
    viewer.redraw();
  });
  viewer.show(meshes);
  viewer.change({field: field ?? null});
  document.documentElement.dataset.ready = '1';
}

show();

import {Camera} from './camera.mjs';
import {colorMaps} from './colors.mjs';
import {element, readable} from './dom.mjs';
import {normals} from './geometry.mjs';
import {Renderer} from './renderer.mjs';
import {Viewer} from './viewer.mjs';

/** The numbers of a block of base64, little-endian. */
function numbers(block, Kind) {
  const text = atob(block.textContent);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < bytes.length; i++) bytes[i] = text.charCodeAt(i);
  return new Kind(bytes.buffer);
}

/** A mesh for the viewer, from its block of the page. */
function meshIn(block) {
  const positions = numbers(block.querySelector('.positions'), Float32Array);
  const faces = numbers(block.querySelector('.faces'), Uint32Array);
  const fields = new Map();
  for (const values of block.querySelectorAll('.field')) fields.set(values.dataset.name, numbers(values, Float64Array));
  return {title: block.dataset.title, arrays: {positions, faces, normals: normals(positions, faces)}, fields};
}

/**
 * In a notebook the page is as light or dark as its surroundings, elsewhere as the system prefers.
 */
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
  const camera = new Camera(30, 20, up === 'z');
  const viewer = new Viewer(part.panels, colorMaps(), (vertex) => {
    part.words.textContent = describe(vertex, meshes, middle);
  }, {camera});
  const names = new Set(meshes.flatMap(({fields}) => [...fields.keys()]));
  for (const name of names) part.field.append(element('option', {value: name}, name));
  part.field.append(element('option', {value: ''}, 'nothing'));
  part.field.value = field ?? '';
  for (const colored of document.querySelectorAll('.colored')) colored.hidden = !names.size;
  viewer.follow(part);
  viewer.state.field = field ?? null;
  viewer.show(meshes);
  document.documentElement.dataset.ready = '1';
}

show();

import {bytesOf} from './bytes.mjs';
import {Camera} from './camera.mjs';
import {colorMaps} from './colors.mjs';
import {Renderer} from './renderer.mjs';
import {Viewer} from './viewer.mjs';

/** The numbers of a block of base64, little-endian. */
function numbers(block, Kind) {
  return new Kind(bytesOf(block.textContent).buffer);
}

/** A mesh for the viewer, from its block of the page, where positions are relative to a centre. */
function meshIn(block, center) {
  const positions = Float64Array.from(numbers(block.querySelector('.positions'), Float32Array), (x, i) => x + center[i % 3]);
  const faces = numbers(block.querySelector('.faces'), Uint32Array);
  const fields = new Map();
  for (const values of block.querySelectorAll('.field')) fields.set(values.dataset.name, numbers(values, Float64Array));
  return {title: block.dataset.title, arrays: {positions, faces}, fields};
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

function show() {
  const words = document.querySelector('[data-part="words"]');
  const {field, up, center} = document.body.dataset;
  followSurroundings(document.documentElement);
  if (!Renderer) {
    words.textContent = 'The meshes cannot be drawn: this browser has no WebGL 2.';
    return;
  }
  words.textContent = '';
  const middle = center.split(' ').map(Number);
  const meshes = [...document.querySelectorAll('.mesh')].map((block) => meshIn(block, middle));
  const camera = new Camera(30, 20, up === 'z');
  const onPick = (vertex) => { words.textContent = vertex < 0 ? '' : viewer.describe(vertex); };
  const viewer = new Viewer(colorMaps(), {onPick, camera, digits: 5});
  words.before(viewer.controls, viewer.root);
  viewer.state.field = field ?? null;
  viewer.show(meshes);
  document.documentElement.dataset.ready = '1';
}

show();

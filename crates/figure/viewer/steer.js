'use strict';

/** What can be done with a picture. */
const HOW = 'Drag to turn, Shift-drag to move, click a vertex for its values; the wheel zooms once the picture has been clicked.';

/**
 * Lets pointer, wheel and keys move a camera over a canvas. Told of it are `moved` (by hand), `stepped` (by key),
 * `rested`, `picked` with the place in parts of width and height, and `next` with 1 or −1.
 */
function steer(canvas, camera, {moved, stepped, rested, picked, next}) {
  const fingers = new Map();
  let travelled = 0;
  let spread = 0;
  canvas.addEventListener('pointerdown', (e) => {
    canvas.setPointerCapture(e.pointerId);
    canvas.focus({preventScroll: true});
    fingers.set(e.pointerId, [e.clientX, e.clientY]);
    travelled = 0;
    spread = 0;
  });
  canvas.addEventListener('pointermove', (e) => {
    const before = fingers.get(e.pointerId);
    if (!before) return;
    const [dx, dy] = [e.clientX - before[0], e.clientY - before[1]];
    travelled += Math.abs(dx) + Math.abs(dy);
    fingers.set(e.pointerId, [e.clientX, e.clientY]);
    if (fingers.size === 2) {
      const [a, b] = [...fingers.values()];
      const apart = Math.hypot(a[0] - b[0], a[1] - b[1]);
      if (spread) camera.zoom(spread / apart);
      spread = apart;
    } else if (e.shiftKey || e.buttons & 6) {
      const size = canvas.clientHeight;
      camera.move((0.65 * dx) / size, (-0.65 * dy) / size);
    } else {
      camera.turn(0.45 * dx, 0.45 * dy);
    }
    moved();
  });
  const lift = (e) => {
    if (fingers.delete(e.pointerId) && e.type === 'pointerup' && travelled < 4) {
      const box = canvas.getBoundingClientRect();
      picked((e.clientX - box.left) / box.width, (e.clientY - box.top) / box.height);
    }
    rested();
  };
  canvas.addEventListener('pointerup', lift);
  canvas.addEventListener('pointercancel', lift);
  canvas.addEventListener('wheel', (e) => {
    // The page must scroll past a picture that nobody has touched.
    if (document.activeElement !== canvas && !e.ctrlKey) return;
    e.preventDefault();
    camera.zoom(Math.exp(e.deltaY * 0.001));
    moved();
    rested();
  }, {passive: false});
  canvas.addEventListener('keydown', (e) => {
    const arrows = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]};
    const arrow = arrows[e.key];
    if (arrow && e.shiftKey) camera.move(0.02 * arrow[0], -0.02 * arrow[1]);
    else if (arrow) camera.turn(6 * arrow[0], 6 * arrow[1]);
    else if (e.key === '+' || e.key === '=') camera.zoom(0.9);
    else if (e.key === '-') camera.zoom(1 / 0.9);
    else if (e.key === '0' || e.key === 'Home') camera.reset();
    else if (e.key === 'Enter') picked(0.5, 0.5);
    else if (e.key === 'n' || e.key === 'p') next(e.key === 'n' ? 1 : -1);
    else return;
    e.preventDefault();
    stepped();
    rested();
  });
}

/** Rings a place of a picture. */
function ring(target, [x, y], pixel) {
  for (const [color, width] of [['#fff', 4], ['#111', 1.8]]) {
    target.beginPath();
    target.arc(x, y, 6 * pixel, 0, 2 * Math.PI);
    target.strokeStyle = color;
    target.lineWidth = width * pixel;
    target.stroke();
  }
}

/** What is drawn at most once a frame; `draw` looks at `moving`. */
class Drawn {
  /** Draws coarsely while the camera moves, and once more when it rests. */
  turnTo() {
    this.moving = true;
    clearTimeout(this.rest);
    this.rest = setTimeout(() => {
      this.moving = false;
      this.redraw();
    }, 180);
    this.redraw();
  }

  /** Draws once, however often it is asked for until then. */
  redraw() {
    this.waiting ??= requestAnimationFrame(() => {
      this.waiting = null;
      this.draw();
    });
  }
}

/** A canvas that pointer and keys steer. */
function steeredCanvas(alt) {
  const canvas = element('canvas', {
    tabindex: 0,
    role: 'img',
    'aria-label': `${alt} Arrow keys turn, plus and minus zoom, Enter picks the vertex in the middle, n and p the next and the previous one.`,
  });
  canvas.title = HOW;
  return canvas;
}

/** Gives a canvas as many pixels as its place has. */
function fitCanvas(canvas, pixel) {
  const box = canvas.getBoundingClientRect();
  const [width, height] = [box.width, box.height].map((x) => Math.round(x * pixel));
  if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
}

/** Of the face that is seen at a place, given in parts of width and height, the nearest vertex; −1 beside the mesh. */
function vertexAt(scene, canvas, place, x, y) {
  const [px, py] = [Math.floor(x * canvas.width), Math.floor(y * canvas.height)];
  const face = Renderer.faceAt(scene, canvas.width, canvas.height, px, py);
  let [best, found] = [Infinity, -1];
  for (const v of face < 0 ? [] : scene.mesh.faces.subarray(3 * face, 3 * face + 3)) {
    const [vx, vy] = place(v);
    const far = Math.hypot(vx - px, vy - py);
    if (far < best) [best, found] = [far, v];
  }
  return found;
}

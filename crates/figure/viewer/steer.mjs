import {element} from './dom.mjs';

/** Help on the keys and gestures of a picture. */
const HOW = 'Drag to turn, Shift-drag to move, click a vertex for its values; the wheel zooms once the picture has been clicked.';

/**
 * Lets pointer, wheel and keys move a camera over a canvas. Calls `moved` (by hand), `stepped` (by
 * key), `rested`, `picked` with the place as fractions of width and height, and `next` with 1 or
 * −1.
 */
export function steer(canvas, camera, {moved, stepped, rested, picked, next}) {
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
    // The page scrolls past a picture without focus.
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

/** A canvas that pointer and keys steer. */
export function steeredCanvas(alt) {
  const canvas = element('canvas', {
    tabindex: 0,
    role: 'img',
    'aria-label': `${alt} Arrow keys turn, plus and minus zoom, Enter picks the vertex in the middle, n and p the next and the previous one.`,
  });
  canvas.title = HOW;
  return canvas;
}

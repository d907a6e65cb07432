import {colorBar} from './bar.mjs';
import {element} from './dom.mjs';
import {Renderer} from './renderer.mjs';
import {steer, steeredCanvas} from './steer.mjs';

/** Milliseconds for which a camera that was moved may still be moving. */
const REST = 180;

/** A mesh in a panel: a title, its canvas, a line of facts and a colour bar. */
export class Picture {
  constructor(title, alt) {
    this.canvas = steeredCanvas(alt);
    this.target = this.canvas.getContext('2d');
    this.title = element('p', {class: 'title'}, title);
    this.facts = element('p', {class: 'facts-line', hidden: true});
    this.bar = element('div', {class: 'bar'});
    this.panel = element('div', {class: 'panel', hidden: !Renderer}, this.title, this.canvas, this.facts, this.bar);
  }

  /** Shows a colour bar, described as for `colorBar`, or none. */
  explain(colors) {
    const across = this.panel.clientWidth || undefined;
    this.bar.replaceChildren(...(colors ? [colorBar({...colors, across})] : []));
  }
}

/**
 * Pictures under one camera, drawn by the renderer. A kind of them has `camera`, `picked` (a vertex
 * or −1), `choose`, which takes a picked vertex, and `scene`, which returns what the renderer draws
 * of a picture, without camera and pixel, or null if there is nothing yet. A picture may have
 * `over`, which draws over it.
 */
export class Pictures {
  constructor() {
    this.shown = [];
    this.pixel = 1;
    this.fit = new ResizeObserver(() => this.draw());
    document.addEventListener('fairing-redraw', () => this.redraw());
  }

  /** Takes a picture over. */
  add(picture) {
    this.shown.push(picture);
    this.fit.observe(picture.canvas);
    steer(picture.canvas, this.camera, {
      moved: () => this.turnTo(),
      stepped: () => this.redraw(),
      rested: () => this.remember(),
      picked: (x, y) => this.pick(picture, x, y),
      next: (by) => this.step(picture, by),
    });
  }

  /** Stores the state; kinds of pictures with a place for it override this. */
  remember() {}

  whole(picture) {
    const scene = this.scene(picture);
    return scene && {...scene, camera: this.camera, pixel: this.pixel};
  }

  /** Picks the vertex at a place given in parts of width and height, and returns it. */
  pick(picture, x, y) {
    const vertex = this.vertexAt(picture, x, y);
    this.choose(vertex);
    return vertex;
  }

  /** Picks the next vertex, or the previous one. */
  step(picture, by) {
    const count = this.scene(picture)?.mesh.vertices;
    if (count) this.choose((Math.max(this.picked, by > 0 ? -1 : 0) + by + count) % count);
  }

  /** Of the face that is seen at a place the nearest vertex; −1 beside the mesh. */
  vertexAt(picture, x, y) {
    const {width, height} = picture.canvas;
    const [px, py] = [Math.floor(x * width), Math.floor(y * height)];
    const scene = this.whole(picture);
    const face = scene ? Renderer.faceAt(scene, width, height, px, py) : -1;
    let [best, found] = [Infinity, -1];
    for (const v of face < 0 ? [] : scene.mesh.faces.subarray(3 * face, 3 * face + 3)) {
      const [vx, vy] = this.place(picture, v);
      const far = Math.hypot(vx - px, vy - py);
      if (far < best) [best, found] = [far, v];
    }
    return found;
  }

  /** Where a vertex is seen, in pixels of the canvas. */
  place(picture, v) {
    const {canvas} = picture;
    const point = this.scene(picture).shape.points.subarray(4 * v, 4 * v + 3);
    return this.camera.place(point, canvas.width, canvas.height);
  }

  /** Draws coarsely while the camera moves, and once more when it rests. */
  turnTo() {
    this.moving = true;
    clearTimeout(this.rest);
    this.rest = setTimeout(() => {
      this.moving = false;
      this.redraw();
    }, REST);
    this.redraw();
  }

  /** Draws with the next frame, once however often it is asked for until then. */
  redraw() {
    this.waiting ??= requestAnimationFrame(() => {
      this.waiting = null;
      this.draw();
    });
  }

  draw() {
    this.pixel = Math.min(window.devicePixelRatio || 1, 2);
    const seen = this.shown.filter(({panel}) => !panel.hidden);
    const drawn = seen.map((picture) => {
      fitCanvas(picture.canvas, this.pixel);
      return {picture, target: picture.target, scene: this.whole(picture)};
    }).filter(({scene}) => scene);
    if (this.moving) Renderer.drawMoving(drawn, 0.5);
    for (const {picture, target, scene} of drawn) {
      if (!this.moving) Renderer.draw(target, scene);
      picture.over?.(picture);
      const {picked} = this;
      if (picked >= 0 && picked < scene.mesh.vertices) ring(target, this.place(picture, picked), this.pixel);
    }
  }
}

/** Rings a place of a picture. */
export function ring(target, [x, y], pixel) {
  for (const [color, width] of [['#fff', 4], ['#111', 1.8]]) {
    target.beginPath();
    target.arc(x, y, 6 * pixel, 0, 2 * Math.PI);
    target.strokeStyle = color;
    target.lineWidth = width * pixel;
    target.stroke();
  }
}

/** Gives a canvas as many pixels as its place has. */
function fitCanvas(canvas, pixel) {
  const box = canvas.getBoundingClientRect();
  const [width, height] = [box.width, box.height].map((x) => Math.round(x * pixel));
  if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
}

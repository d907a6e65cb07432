'use strict';

/** A canvas of a playground: a mesh, what it is coloured by, and what is drawn over it. */
class Stage {
  constructor(owner, title, alt) {
    this.owner = owner;
    this.canvas = steeredCanvas(alt);
    this.target = this.canvas.getContext('2d');
    this.title = element('p', {class: 'title'}, title);
    this.bar = element('div', {class: 'bar'});
    this.panel = element('div', {class: 'panel', hidden: !Renderer}, this.title, this.canvas, this.bar);
    this.scene = null;
    steer(this.canvas, owner.camera, {
      moved: () => owner.turnTo(),
      stepped: () => owner.redraw(),
      rested: () => owner.remember(),
      picked: (x, y) => owner.pick(this, x, y),
      next: (by) => owner.step(by),
    });
  }

  /** What is shown; `colors` has `values`, `range`, `map`, `name` and `unit`. */
  show(positions, faces, ball, {colors = null, flat = false, over = null} = {}) {
    if (this.mesh?.faces !== faces) {
      const vertices = positions.length / 3;
      this.mesh = {faces, vertices, zeros: new Float32Array(vertices)};
    }
    this.scene = {
      mesh: this.mesh,
      shape: Geometry.shape(positions, faces, ball, null),
      values: colors ? Float32Array.from(colors.values) : null,
      lookup: colors ? lookupOf(this.owner.maps[colors.map]) : lookupOf(this.owner.maps.viridis),
      range: colors?.range ?? [0, 1],
      camera: this.owner.camera,
      flat,
    };
    this.over = over;
    this.bar.replaceChildren(...(colors ? [colorBar({...colors, lookup: this.scene.lookup, across: this.panel.clientWidth || undefined})] : []));
  }

  place(v) {
    const point = this.scene.shape.points.subarray(4 * v, 4 * v + 3);
    return this.owner.camera.place(point, this.canvas.width, this.canvas.height);
  }

  /** Lines over the picture, through points that are scaled to the ball. */
  line(points, color, width, dashes = []) {
    const {target, owner} = this;
    target.beginPath();
    points.forEach((p, i) => target[i ? 'lineTo' : 'moveTo'](...owner.camera.place(p, this.canvas.width, this.canvas.height)));
    target.strokeStyle = color;
    target.lineWidth = width * owner.pixel;
    target.setLineDash(dashes.map((x) => x * owner.pixel));
    target.stroke();
    target.setLineDash([]);
  }

  /** Fits the canvas to its place; what there is to draw, or null. */
  fit(pixel) {
    if (!Renderer || !this.scene) return null;
    fitCanvas(this.canvas, pixel);
    return {target: this.target, scene: {...this.scene, pixel}};
  }

  /** What goes over the picture. */
  finish(pixel) {
    this.over?.(this);
    const {picked} = this.owner;
    if (picked >= 0 && picked < this.mesh.vertices) ring(this.target, this.place(picked), pixel);
  }

  vertexAt(x, y) {
    return vertexAt({...this.scene, pixel: this.owner.pixel}, this.canvas, (v) => this.place(v), x, y);
  }
}

/**
 * Something to play with. A kind of playground has `build`, which returns its elements and fills `inputs` (what is
 * remembered in the address) and `stages`, and `show`, which shows `now`. Where the module computes it also has
 * `preview`, which shows what there is before the module has loaded, `compute`, which makes `now`, and perhaps `refine`,
 * which adds to it what takes longer, until `isStale`.
 */
class Playground extends Drawn {
  static kinds = new Map();

  static of(figure, maps) {
    const kind = Playground.kinds.get(figure.dataset.play);
    if (!kind) throw new Error(`there is no playground ${figure.dataset.play}`);
    return new kind(figure, maps);
  }

  constructor(figure, maps) {
    super();
    this.figure = figure;
    this.id = figure.id;
    this.maps = maps;
    this.camera = new Camera(35, 20, true);
    this.inputs = [];
    this.stages = [];
    this.picked = -1;
    this.pixel = 1;
    this.wanted = '';
    this.now = null;
  }

  /** Builds the controls and shows the first state; once. */
  open() {
    this.opened ??= this.begin();
    return this.opened;
  }

  async begin() {
    const made = this.build();
    this.words = element('output', {class: 'picked', 'aria-live': 'polite'});
    const hint = element('p', {class: 'hint', hidden: !Renderer || !this.stages.length}, this.words);
    this.figure.querySelector('.stage').replaceChildren(...made, hint);
    this.figure.classList.add('open');
    if (this.wanted) this.recall();
    this.result.textContent = 'Computing …';
    this.preview();
    const fit = new ResizeObserver(() => this.draw());
    for (const {canvas} of this.stages) fit.observe(canvas);
    this.draw();
    await this.settle();
  }

  preview() {}

  async compute() {}

  async refine() {}

  /** Computes and shows what is chosen; of the changes meanwhile the last one counts. */
  settle() {
    this.isStale = true;
    this.settling ??= this.follow();
    return this.settling;
  }

  async follow() {
    try {
      while (this.isStale) {
        this.isStale = false;
        await this.compute();
        this.present();
        if (!this.isStale) await this.refine();
      }
    } catch (error) {
      this.result.textContent = `This could not be computed: ${error.message}.`;
    } finally {
      this.settling = null;
    }
  }

  present() {
    this.show();
    this.figure.classList.add('done');
    if (this.words && this.picked >= 0) this.words.textContent = `Vertex ${this.picked}. ${this.about(this.picked)}`;
    this.draw();
  }

  stage(title, alt) {
    const made = new Stage(this, title, alt);
    this.stages.push(made);
    return made;
  }

  slider(label, attributes, read) {
    const made = sliderRow(label, attributes, read, () => this.change());
    this.inputs.push(made);
    return made;
  }

  choice(label, options) {
    const input = element('select', {'aria-label': label}, ...options.map(([value, text]) => element('option', {value}, text)));
    input.addEventListener('input', () => this.change());
    this.inputs.push({input, say: () => {}});
    return {label: element('label', {}, `${label} `, input), value: () => input.value};
  }

  change() {
    this.settle();
    this.remember();
  }

  draw() {
    this.pixel = Math.min(window.devicePixelRatio || 1, 2);
    const pictures = this.stages.map((stage) => stage.fit(this.pixel));
    if (pictures.some((picture) => !picture)) return;
    if (this.moving) Renderer.drawMoving(pictures, 0.5);
    else for (const {target, scene} of pictures) Renderer.draw(target, scene);
    for (const stage of this.stages) stage.finish(this.pixel);
  }

  pick(stage, x, y) {
    if (!this.now) return;
    this.picked = stage.vertexAt(x, y);
    this.say();
  }

  step(by) {
    const count = this.stages[0].mesh?.vertices;
    if (!count || !this.now) return;
    this.picked = (Math.max(this.picked, by > 0 ? -1 : 0) + by + count) % count;
    this.say();
  }

  say() {
    this.words.textContent = this.picked < 0 ? '' : `Vertex ${this.picked}. ${this.about(this.picked)}`;
    this.draw();
  }

  remember() {
    document.dispatchEvent(new CustomEvent('fairing-state', {detail: this}));
  }

  toText() {
    return this.opened ? this.inputs.map(({input}) => input.value).join('~') : this.wanted;
  }

  fromText(text) {
    this.wanted = text;
    if (!this.opened) return null;
    this.recall();
    return this.settle();
  }

  /** What the address says; values out of range become the nearest in range, as sliders have it. */
  recall() {
    this.wanted.split('~').forEach((text, i) => {
      const at = this.inputs[i];
      if (!at || text === '') return;
      const {input} = at;
      if (input.tagName === 'SELECT' ? [...input.options].some((o) => o.value === text) : Number.isFinite(Number(text))) input.value = text;
      at.say();
    });
  }
}

const lookups = new WeakMap();

/** 1024 colours of a map. */
function lookupOf(map) {
  if (!lookups.has(map)) {
    const colors = new Uint8Array(3 * 1024);
    for (let i = 0; i < 1024; i++) {
      const k = 3 * Math.round((i / 1023) * (map.length / 3 - 1));
      colors.set(map.subarray(k, k + 3), 3 * i);
    }
    lookups.set(map, colors);
  }
  return lookups.get(map);
}

import {Camera} from '../../figure/viewer/camera.mjs';
import {lookupOf} from '../../figure/viewer/colors.mjs';
import {element} from '../../figure/viewer/dom.mjs';
import {normals, shape} from '../../figure/viewer/geometry.mjs';
import {Picture, Pictures} from '../../figure/viewer/pictures.mjs';
import {Renderer} from '../../figure/viewer/renderer.mjs';
import {sliderRow} from './plots.mjs';

/** A picture of a playground: a mesh, what it is coloured by, and what is drawn over it. */
class Stage extends Picture {
  constructor(owner, title, alt) {
    super(title, alt);
    this.owner = owner;
    this.scene = null;
  }

  /** Shows a mesh; `colors` has `values`, `range`, `map`, `name` and `unit`. */
  show(positions, faces, ball, {colors = null, flat = false, over = null} = {}) {
    if (this.mesh?.faces !== faces) this.mesh = {faces, vertices: positions.length / 3};
    const lookup = lookupOf(this.owner.maps[colors?.map ?? 'viridis']);
    this.scene = {
      mesh: this.mesh,
      shape: shape(positions, normals(positions, faces), ball),
      values: colors && Float32Array.from(colors.values),
      lookup,
      range: colors?.range ?? [0, 1],
      flat,
    };
    this.over = over;
    this.explain(colors && {...colors, lookup});
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
}

/**
 * Something to play with. A kind of playground has `build`, which returns its elements and fills
 * `inputs` (what is remembered in the address) and the pictures, and `show`, which shows `now`.
 * Where the module computes it also has `preview`, which shows what there is before the module has
 * loaded, `compute`, which makes `now`, and perhaps `refine`, which adds to it what takes longer,
 * until `isStale`.
 */
export class Playground extends Pictures {
  constructor(figure, maps) {
    super();
    this.figure = figure;
    this.id = figure.id;
    this.maps = maps;
    this.camera = new Camera(35, 20, true);
    this.inputs = [];
    this.picked = -1;
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
    const hint = element('p', {class: 'hint', hidden: !Renderer || !this.shown.length}, this.words);
    this.figure.querySelector('.stage').replaceChildren(...made, hint);
    this.figure.classList.add('open');
    if (this.wanted) this.recall();
    this.result.textContent = 'Computing …';
    this.preview();
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
    this.add(made);
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

  /** A button that draws other noise, of the next `seed`. */
  seeds() {
    this.seed = 1;
    const button = element('button', {type: 'button'}, 'draw noise again');
    button.addEventListener('click', () => {
      this.seed += 1;
      this.change();
    });
    return button;
  }

  change() {
    this.settle();
    this.remember();
  }

  scene(stage) {
    return stage.scene;
  }

  choose(vertex) {
    if (!this.now) return;
    this.picked = vertex;
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

  /** Restores the state in the address; sliders clamp values to their range. */
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

import {stopOf, viewIn} from './data.mjs';
import {fieldsOf} from './derived.mjs';
import {Camera} from '../../figure/viewer/camera.mjs';
import {rangeOf} from '../../figure/viewer/colors.mjs';
import {element, readable, reveal} from '../../figure/viewer/dom.mjs';
import {ballOf, boxOf} from '../../figure/viewer/geometry.mjs';
import {LiveFlows} from './live.mjs';
import {ModeSum} from './modes.mjs';
import {sliderRow} from './plots.mjs';
import {Viewer} from '../../figure/viewer/viewer.mjs';

/** A view of the article: a viewer whose meshes follow sliders. The address holds its state. */
export class View extends Viewer {
  constructor(figure, maps) {
    super(maps, {camera: new Camera(30, 20), labelled: (name) => [name, this.fields?.get(name)?.unit ?? '']});
    this.figure = figure;
    this.id = figure.id;
    this.stage = figure.querySelector('.stage');
    this.wanted = '';
  }

  /** Unpacks the data and builds the controls; once. */
  open() {
    this.opened ??= this.build();
    return this.opened;
  }

  async build() {
    // A canvas in a closed fold has no size.
    reveal(this.figure);
    const view = await viewIn(this.figure);
    const {panels, sliders, truth} = view;
    this.description = view;
    this.live = LiveFlows.of(panels, truth, () => this.liveChanged());
    this.meshes = [...panels, ...(this.live?.panels ?? [])];
    for (const mesh of this.meshes) mesh.drawn = {faces: mesh.faces, vertices: mesh.vertices};
    this.sum = ModeSum.of(panels, () => this.changed());
    this.fields = fieldsOf(this);
    const [first] = this.fields.keys();
    const hasValues = this.sum || panels.some(({fields}) => fields.length);
    const stops = view.start.length ? view.start : sliders.map(() => 0);
    const flat = panels.some((panel) => panel.stops.length > 1);
    Object.assign(this.state, {stops, flat, field: view.color ?? (hasValues ? first : null)});
    this.home = structuredClone(this.state);
    const box = boxOf(panels.map((panel) => panel.stops[0]));
    const [azimuth, elevation] = anglesOf(box, view.zUp);
    Object.assign(this.camera, {zUp: view.zUp, home: {...this.camera.home, azimuth, elevation}});
    this.camera.reset();
    this.words = element('output', {class: 'picked', 'aria-live': 'polite'});
    this.stage.replaceChildren(this.controls, this.root, ...this.sliderRows(), element('p', {class: 'hint'}, this.words));
    this.figure.classList.add('open');
    this.homeSum = this.sum?.toText();
    this.show(this.meshes, ballOf(panels.map((panel) => panel.stops[0])));
    if (this.wanted) this.recall();
    await this.asked;
  }

  picture(mesh) {
    const picture = super.picture(mesh);
    picture.canvas.setAttribute('aria-label', `${this.description.alt} ${picture.canvas.getAttribute('aria-label')}`);
    picture.facts.hidden = !this.meshes.some((m) => m.facts?.length || (m.flow && this.description.truth));
    picture.panel.hidden = Boolean(mesh.flow);
    return picture;
  }

  sliderRows() {
    this.sliders = this.description.sliders.map(({name, stops}, which) => {
      const range = {min: 0, max: stops.length - 1, step: 1, value: this.state.stops[which]};
      const slider = sliderRow(name, range, (stop) => `${name} = ${stops[stop]}`, () => (
        this.change({stops: this.state.stops.with(which, slider.value())})));
      return {...slider, name, stops};
    });
    this.measured = element('div', {class: 'sliders'}, ...this.sliders.map(({row}) => row));
    return [this.measured, ...(this.sum?.controls() ?? []), ...(this.live?.controls() ?? [])];
  }

  /**
   * The live flows have been computed, or put away: they take the place of the panel that the
   * sliders move.
   */
  liveChanged() {
    for (const {mesh, title, panel} of this.shown) {
      panel.hidden = mesh.flow ? !this.live.on : this.live.on && mesh.stops.length > 1;
      if (mesh.flow) title.textContent = this.live.titleOf(mesh.flow);
    }
    this.measured.hidden = this.live.on;
    this.changed();
  }

  /** Everything as the page shows it first. */
  reset() {
    this.camera.reset();
    this.sum?.recall(this.homeSum);
    this.live?.reset();
    this.change(structuredClone(this.home));
  }

  change(what) {
    super.change(what);
    this.remember();
  }

  changed() {
    this.change({});
  }

  /** The combination of stops that is chosen; the last slider runs fastest. */
  combination() {
    return this.description.sliders.reduce((at, {stops}, i) => at * stops.length + this.state.stops[i], 0);
  }

  /** The panels that are seen, each with a combination of stops: the chosen one, or every one. */
  moments(every) {
    const seen = this.shown.filter(({panel}) => !panel.hidden).map(({mesh}) => mesh);
    const count = this.description.sliders.reduce((product, {stops}) => product * stops.length, 1);
    const all = every && !this.live?.on ? [...Array(count).keys()] : [this.combination()];
    return seen.flatMap((mesh) => all.map((at) => [mesh, at]));
  }

  names() {
    return [...this.fields.keys()];
  }

  /** The field that is chosen. */
  chosen() {
    return this.fields.get(this.state.field);
  }

  values(mesh) {
    return this.chosen()?.values(mesh, this.combination()) ?? null;
  }

  positions(mesh, at = this.combination()) {
    if (mesh.flow) return this.live.drawn(mesh.flow);
    return mesh.modes ? this.sum.positions() : stopOf(mesh.stops, at);
  }

  /** The range of the values at all stops. */
  ends() {
    const chosen = this.chosen();
    if (!chosen || chosen.fixed) return chosen?.fixed ?? [0, 1];
    if (this.live?.on || !chosen.range) {
      const lists = new Set(this.moments(true).map(([mesh, at]) => chosen.values(mesh, at)));
      chosen.range = rangeOf([...lists].filter(Boolean), chosen.signed);
    }
    return chosen.range;
  }

  /**
   * Computes what the colours need, at all stops since they share a range, and the values of a
   * picked vertex; settles again if there is something new.
   */
  async ask() {
    const chosen = this.chosen();
    const wanted = this.picked < 0 ? [chosen] : [...this.fields.values()];
    const fields = wanted.filter((field) => field?.ask);
    const asked = fields.flatMap((field) => this.moments(field === chosen).map(([mesh, at]) => field.ask(mesh, at)));
    const found = await Promise.all(asked);
    if (!found.includes(true)) return;
    for (const field of fields) field.range = null;
    this.settle();
  }

  settle() {
    this.asked = this.ask().catch((error) => { this.words.textContent = `This could not be computed: ${error.message}.`; });
    this.sliders.forEach(({input, say}, i) => {
      input.value = this.state.stops[i];
      say();
    });
    for (const {facts, mesh} of this.shown) facts.replaceChildren(...this.facts(mesh));
    this.sum?.settle();
    this.words.textContent = this.picked < 0 ? '' : this.describe(this.picked);
    super.settle();
  }

  /** The measured facts of a panel at this combination of stops. */
  facts(mesh) {
    const angle = this.live?.results[mesh.flow]?.angle;
    const live = Number.isFinite(angle) ? [{name: 'normal error', unit: '°', values: [angle]}] : [];
    return (mesh.facts ?? live).flatMap(({name, unit, values}) => {
      const value = stopOf(values, this.combination());
      const text = `${readable(value, 2)}${spaced(unit)}`;
      return value === null ? [] : [element('span', {class: 'fact'}, `${name} `, element('b', {}, text))];
    });
  }

  valuesAt(mesh, vertex) {
    return [...this.fields].flatMap(([name, field]) => {
      const x = field.values(mesh, this.combination())?.[vertex];
      if (x === undefined || field.isError) return [];
      const unit = spaced(field.unit);
      const exact = mesh.fields.find((own) => own.name === name)?.exact?.[vertex];
      if (exact !== undefined) {
        return [`${name}: exact ${readable(exact)}, estimate ${readable(x)}, error ${readable(x - exact)}${unit}`];
      }
      return [`${name} ${Number.isFinite(x) ? `${readable(x)}${unit}` : 'undefined'}`];
    });
  }

  remember() {
    document.dispatchEvent(new CustomEvent('fairing-state', {detail: this}));
  }

  /** Camera, stops, field, switches, vertex, live flow and number of modes. */
  toText() {
    const {state} = this;
    if (!this.shown.length) return this.wanted;
    const switches = ['wire', 'lines', 'flat'].filter((key) => state[key]).join('~');
    const sum = this.sum ? [this.sum.toText()] : [];
    return [this.camera.toText(), state.stops.join('~'), state.field ?? 'nothing', switches || 'none', state.picked, this.live?.toText() ?? '', ...sum].join('!');
  }

  fromText(text) {
    this.wanted = text;
    if (this.shown.length) this.recall();
  }

  /** Shows what the address wants; parts that are empty or out of range stay as they are. */
  recall() {
    const [camera, stops = '', field, switches, picked, live, sum] = this.wanted.split('!');
    const {state} = this;
    const whole = (text, below, otherwise) => (/^\d+$/.test(text) && Number(text) < below ? Number(text) : otherwise);
    this.camera.fromText(camera);
    const chosen = stops.split('~');
    const change = {
      stops: this.sliders.map((slider, i) => whole(chosen[i], slider.stops.length, state.stops[i])),
      picked: whole(picked, Math.max(...this.meshes.map(({vertices}) => vertices)), -1),
    };
    if (field === 'nothing') change.field = null;
    else if (this.fields.has(field)) change.field = field;
    if (switches) for (const key of ['wire', 'lines', 'flat']) change[key] = switches.split('~').includes(key);
    if (sum) this.sum?.recall(sum);
    super.change(change);
    this.live?.recall(live);
  }
}

/** A unit as it follows a number. */
function spaced(unit) {
  return unit === '°' || !unit ? unit : ` ${unit}`;
}

/**
 * Azimuth and elevation at which a view begins, in degrees: almost face on for nearly flat meshes,
 * from above for low ones, a little from the side and above for others.
 */
function anglesOf({low, high}, zUp) {
  const size = low.map((x, k) => high[k] - x);
  const [across, up, deep] = zUp ? [size[0], size[2], size[1]] : size;
  const thin = 0.05 * Math.hypot(...size);
  if (across < thin) return [70, 15];
  if (up < thin) return [20, 65];
  if (deep < thin) return [20, 20];
  return [30, up < 0.45 * Math.min(across, deep) ? 40 : 20];
}

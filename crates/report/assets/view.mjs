import {Block, decodeView} from './data.mjs';
import {Camera} from '../../figure/viewer/camera.mjs';
import {COLORS, lookupAt, lookupOf, rangeOf} from '../../figure/viewer/colors.mjs';
import {fieldsOf} from './derived.mjs';
import {element, readable} from '../../figure/viewer/dom.mjs';
import {normals, shape} from '../../figure/viewer/geometry.mjs';
import {LiveFlows} from './live.mjs';
import {ModeSum} from './modes.mjs';
import {Picture, Pictures} from '../../figure/viewer/pictures.mjs';

/**
 * One interactive view: panels side by side under one camera, with controls.
 *
 * What is chosen is kept in `state`; `settle` brings everything seen into line
 * with it.
 */
export class View extends Pictures {
  constructor(figure, maps) {
    super();
    this.figure = figure;
    this.id = figure.id;
    this.maps = maps;
    this.description = JSON.parse(figure.querySelector('script.about').textContent);
    const {angles, zUp, sliders, fields} = this.description;
    this.fields = fields;
    this.camera = new Camera(angles[0], angles[1], zUp);
    this.state = {
      stops: this.description.start ?? sliders.map(() => 0),
      field: this.description.color ?? (fields.length ? 0 : null),
      map: null,
      range: null,
      wire: false,
      lines: false,
      even: false,
      flat: this.description.flat,
      picked: -1,
    };
    this.home = structuredClone(this.state);
    this.live = null;
    this.stage = figure.querySelector('.stage');
  }

  /** Unpacks the data and builds the controls; once. */
  open() {
    this.opened ??= this.build();
    return this.opened;
  }

  async build() {
    // What is folded away has no size to be drawn in.
    for (let at = this.figure.closest('details'); at; at = at.parentElement.closest('details')) at.open = true;
    const block = await Block.unpack(this.figure.querySelector('script.data').textContent);
    const panels = decodeView(this.description, block);
    this.truth = block.truth;
    this.live = LiveFlows.of(panels, this.truth, () => this.liveChanged());
    this.meshes = [...panels, ...(this.live?.panels ?? [])].map((panel) => ({
      ...panel,
      shapes: new Map(),
    }));
    this.sum = ModeSum.of(this.meshes, () => this.settleSum());
    this.fields = [...this.description.fields, ...fieldsOf(this.description, this.meshes)];
    if (this.sum) this.fields.unshift(this.sum.field());
    for (const state of [this.state, this.home]) {
      // A view or an address may name its field.
      if (typeof state.field === 'string') state.field = this.fields.findIndex((f) => f.name === state.field);
      // A mesh with modes is shown with the mode that is being added, others as they are unless
      // they bring values.
      state.field ??= this.sum || this.description.fields.length ? 0 : -1;
      if (state.field >= this.fields.length) state.field = -1;
    }
    this.stage.replaceChildren(...this.controls(), this.panels(), ...this.sliderRows(), this.readout());
    this.figure.classList.add('open');
    this.homeSum = this.sum?.toText();
    this.settle();
    this.live?.recall(this.wantedLive);
    if (this.sum && this.wantedSum) this.settleSum(this.wantedSum);
    await this.asked;
  }

  /** Another number of modes. */
  settleSum(text) {
    if (text) this.sum.recall(text);
    this.settle();
    if (!text) this.remember();
  }

  // What is built.

  controls() {
    const row = element('div', {class: 'controls', role: 'group', 'aria-label': 'display'});
    const {fields} = this;
    // What is seldom needed is folded.
    const more = element('div', {});
    const chooser = (place, label, options, change) => {
      const select = element('select', {'aria-label': label});
      options.forEach(([value, text]) => select.append(element('option', {value}, text)));
      select.addEventListener('input', () => change(select.value));
      place.append(element('label', {}, `${label} `, select));
      return select;
    };
    if (fields.length) {
      const names = fields.map((f, i) => [i, f.unit ? `${f.name} (${f.unit})` : f.name]);
      this.fieldChoice = chooser(row, 'colour by', [...names, [-1, 'nothing']], (value) => {
        this.change({field: Number(value), range: null, map: null});
      });
      this.mapChoice = chooser(more, 'colours', Object.keys(this.maps).map((m) => [m, m]), (map) => {
        this.change({map});
      });
      this.rangeEnds = ['from', 'to'].map((end, k) => {
        const input = element('input', {type: 'number', step: 'any', 'aria-label': `colours ${end}`});
        input.addEventListener('change', () => {
          const range = [...this.range()];
          range[k] = Number(input.value);
          if (input.value !== '' && range[0] < range[1]) this.change({range});
          else this.settle();
        });
        more.append(element('label', {}, `${end} `, input));
        return input;
      });
    }
    this.switches = {};
    const names = {even: 'equalise', lines: 'isolines', wire: 'edges', flat: 'flat'};
    for (const [key, label] of Object.entries(names)) {
      if (!fields.length && (key === 'even' || key === 'lines')) continue;
      const box = element('input', {type: 'checkbox'});
      box.addEventListener('input', () => this.change({[key]: box.checked}));
      more.append(element('label', {}, box, ` ${label}`));
      this.switches[key] = box;
    }
    const home = element('button', {type: 'button'}, 'reset');
    home.addEventListener('click', () => this.reset());
    row.append(home, element('details', {class: 'more'}, element('summary', {}, 'more'), more));
    return [row];
  }

  panels() {
    const measured = this.meshes.some((m) => m.facts?.length || (m.flow && this.truth));
    for (const mesh of this.meshes) {
      const picture = Object.assign(new Picture(mesh.title, `${mesh.title}. ${this.description.alt}`), {mesh});
      picture.facts.hidden = !measured;
      picture.panel.hidden = Boolean(mesh.flow);
      this.add(picture);
    }
    return element('div', {class: 'panels'}, ...this.shown.map(({panel}) => panel));
  }

  sliderRows() {
    this.sliders = this.description.sliders.map(({name, stops}, which) => {
      const input = element('input', {type: 'range', min: 0, max: stops.length - 1, step: 1, 'aria-label': name});
      const words = element('output', {});
      input.addEventListener('input', () => {
        this.change({stops: this.state.stops.map((stop, i) => (i === which ? Number(input.value) : stop))});
      });
      return {name, stops, input, words};
    });
    const rows = this.sliders.map(({input, words}) => element('div', {class: 'slider'}, words, input));
    this.measured = element('div', {class: 'sliders'}, ...rows);
    return [this.measured, ...(this.sum?.controls() ?? []), ...(this.live?.controls() ?? [])];
  }

  readout() {
    this.words = element('output', {class: 'picked', 'aria-live': 'polite'});
    return element('p', {class: 'hint'}, this.words);
  }

  // What happens.

  /**
   * The live flows have been computed, or put away: they take the place of the panel that the
   * sliders move.
   */
  liveChanged() {
    for (const {mesh, title, panel} of this.shown) {
      if (mesh.flow) {
        title.textContent = this.live.titleOf(mesh.flow);
        panel.hidden = !this.live.on;
      } else {
        panel.hidden = this.live.on && mesh.stops.length > 1;
      }
    }
    this.measured.hidden = this.live.on;
    this.settle();
    this.remember();
  }

  /** Everything as the page shows it first. */
  reset() {
    this.camera.reset();
    this.sum?.recall(this.homeSum);
    this.live?.reset();
    this.change(structuredClone(this.home));
  }

  change(what) {
    Object.assign(this.state, what);
    this.settle();
    this.remember();
  }

  get picked() {
    return this.state.picked;
  }

  choose(picked) {
    this.change({picked});
  }

  // What is shown.

  /** The combination of stops that is chosen; the last slider runs fastest. */
  combination() {
    const {sliders} = this.description;
    return sliders.reduce((at, {stops}, i) => at * stops.length + this.state.stops[i], 0);
  }

  stopOf(list) {
    return Math.min(this.combination(), list.length - 1);
  }

  chosen() {
    return this.fields[this.state.field];
  }

  /** Values of a field that a panel brings along. */
  valuesOf(field) {
    return field.stops[this.stopOf(field.stops)];
  }

  /**
   * The values of a field at the vertices of a panel; null where it has none. Those that are
   * computed are kept.
   */
  valuesBy(field, mesh) {
    if (!field) return null;
    if (!field.derived) {
      const own = mesh.fields.find((f) => f.name === field.name);
      return own ? this.valuesOf(own) : null;
    }
    const key = `${this.combination()},${this.sum?.k ?? ''},${this.live?.version() ?? ''}`;
    field.kept ??= new Map();
    const kept = field.kept.get(mesh);
    if (kept?.key === key) return kept.values;
    const values = field.derived(this, mesh);
    field.kept.set(mesh, {key, values});
    return values;
  }

  values(mesh) {
    return this.valuesBy(this.chosen(), mesh);
  }

  /**
   * The range of the colours: that which was chosen, or the 2nd to the 98th
   * percentile of all panels and stops, about zero for a signed field.
   */
  range() {
    if (this.state.range) return this.state.range;
    const chosen = this.chosen();
    if (!chosen) return [0, 1];
    if (chosen.fixed) return chosen.fixed;
    // What is computed from live results has a range for each of them.
    const key = chosen.derived && this.live?.on ? this.live.version() : '';
    if (chosen.rangeKey !== key) [chosen.rangeKey, chosen.range] = [key, this.percentiles(chosen)];
    return chosen.range;
  }

  /** Calls `see` at each combination of stops. */
  atAllStops(see) {
    const {stops} = this.state;
    const counts = this.description.sliders.map((slider) => slider.stops.length);
    const all = counts.reduce((product, count) => product * count, 1);
    for (let at = 0; at < all; at++) {
      let rest = at;
      this.state.stops = counts.map((count) => {
        const stop = rest % count;
        rest = Math.floor(rest / count);
        return stop;
      });
      see();
    }
    this.state.stops = stops;
  }

  percentiles(chosen) {
    const lists = [];
    const now = () => lists.push(...this.visible().map((mesh) => this.valuesBy(chosen, mesh)));
    if (!chosen.derived) lists.push(...this.meshes.flatMap((mesh) => mesh.fields.find((f) => f.name === chosen.name)?.stops ?? []));
    else if (this.live?.on) now();
    else this.atAllStops(now);
    return rangeOf(lists.filter(Boolean), chosen.signed);
  }

  /** The panels that are seen. */
  visible() {
    return this.shown.filter(({panel}) => !panel.hidden).map(({mesh}) => mesh);
  }

  mapName() {
    const chosen = this.chosen();
    return this.state.map ?? (chosen?.signed ? 'coolwarm' : 'viridis');
  }

  /** Colours along the range, 1024 of them, with the histogram equalised if asked. */
  lookup() {
    const map = this.maps[this.mapName()];
    if (!this.state.even) return lookupOf(map);
    const [low, high] = this.range();
    const key = [this.mapName(), low, high, this.combination(), this.sum?.k, this.state.field].join();
    if (this.lookupKey === key) return this.lookupColors;
    const places = this.shares(low, high, COLORS);
    [this.lookupKey, this.lookupColors] = [key, lookupAt(map, (i) => places[i])];
    return this.lookupColors;
  }

  /**
   * The different values in range that are shown, if there are at most `most`; null if there are
   * more.
   */
  distinct(low, high, most = 16) {
    const found = new Set();
    for (const mesh of this.visible()) {
      for (const x of this.values(mesh) ?? []) {
        if (x >= low && x <= high) found.add(x);
        if (found.size > most) return null;
      }
    }
    return [...found].sort((a, b) => a - b);
  }

  shares(low, high, size) {
    const few = this.distinct(low, high);
    if (few?.length) return this.sharesOf(few, low, high, size);
    const counts = new Float64Array(size);
    let total = 0;
    for (const mesh of this.visible()) {
      for (const x of this.values(mesh) ?? []) {
        const bin = Math.floor(((x - low) / (high - low)) * size);
        if (x === high) counts[size - 1] += 1;
        else if (bin >= 0 && bin < size) counts[bin] += 1;
        else continue;
        total += 1;
      }
    }
    let below = 0;
    return counts.map((count, i) => {
      below += count;
      return total ? (below - 0.5 * count) / total : i / (size - 1);
    });
  }

  /**
   * Equalised colours of a few values: each has the middle of its ranks, and the bar shows no
   * others.
   */
  sharesOf(few, low, high, size) {
    const counts = few.map(() => 0);
    for (const mesh of this.visible()) {
      for (const x of this.values(mesh) ?? []) {
        const at = few.indexOf(x);
        if (at >= 0) counts[at] += 1;
      }
    }
    const total = counts.reduce((a, b) => a + b, 0);
    let below = 0;
    const middles = counts.map((count) => {
      below += count;
      return (below - 0.5 * count) / total;
    });
    return Float64Array.from({length: size}, (_, i) => {
      const x = low + ((high - low) * (i + 0.5)) / size;
      let nearest = 0;
      few.forEach((y, k) => {
        if (Math.abs(y - x) < Math.abs(few[nearest] - x)) nearest = k;
      });
      return middles[nearest];
    });
  }

  /** Where the vertices of a panel are. */
  positions(mesh) {
    if (mesh.flow) return this.live.drawn(mesh.flow);
    return mesh.modes ? this.sum.positions() : mesh.stops[this.stopOf(mesh.stops)];
  }

  /** Points and normals of a panel, scaled to the ball of the camera. */
  shape(mesh) {
    const positions = this.positions(mesh);
    if (mesh.shapes.has(positions)) return mesh.shapes.get(positions);
    const made = shape(positions, normals(positions, mesh.faces), this.description.ball, mesh.occlusion);
    // What the page computes is not asked for again once it is replaced.
    if (mesh.flow || mesh.modes) mesh.shapes.clear();
    mesh.shapes.set(positions, made);
    return made;
  }

  scene({mesh}) {
    const {wire, lines, flat} = this.state;
    return {
      mesh,
      shape: this.shape(mesh),
      values: this.values(mesh),
      lookup: this.lookup(),
      range: this.range(),
      wire,
      lines,
      flat,
    };
  }

  /**
   * Asks the module for what the colours need, at all stops since they share a range, and for the
   * values of a picked vertex; settles again if there is something new.
   */
  async ask() {
    const {state} = this;
    const chosen = this.chosen();
    const wanted = state.picked < 0 ? [chosen] : this.fields;
    const fields = wanted.filter((field) => field?.ask);
    const asked = [];
    for (const field of fields) {
      const now = () => asked.push(...this.visible().map((mesh) => field.ask(this, mesh)));
      if (field === chosen && !this.live?.on && !state.range) this.atAllStops(now);
      else now();
    }
    const found = await Promise.all(asked);
    if (!found.includes(true)) return;
    for (const field of fields) {
      field.kept?.clear();
      field.rangeKey = null;
    }
    this.settle();
  }

  settle() {
    this.asked = this.ask().catch((error) => { this.words.textContent = `This could not be computed: ${error.message}.`; });
    const {state} = this;
    if (this.fieldChoice) {
      this.fieldChoice.value = state.field;
      this.mapChoice.value = this.mapName();
      const range = this.range();
      this.rangeEnds.forEach((input, k) => {
        input.value = range[k];
        input.disabled = state.field < 0;
      });
    }
    for (const [key, box] of Object.entries(this.switches)) box.checked = state[key];
    this.sliders.forEach(({name, stops, input, words}, i) => {
      input.value = state.stops[i];
      const text = `${name} = ${stops[state.stops[i]]}`;
      words.textContent = text;
      input.setAttribute('aria-valuetext', text);
    });
    for (const picture of this.shown) {
      picture.explain(picture.panel.hidden ? null : this.colors(picture.mesh));
      picture.facts.replaceChildren(...this.facts(picture.mesh));
    }
    this.sum?.settle();
    this.words.textContent = this.pickedWords();
    this.draw();
  }

  /** What the colour bar of a panel shows, if there are values. */
  colors(mesh) {
    const values = this.values(mesh);
    if (!values) return null;
    const {even} = this.state;
    const {name, unit} = this.chosen();
    const range = this.range();
    const few = even ? this.distinct(...range, 6) : null;
    return {values, range, lookup: this.lookup(), name, unit, few, even};
  }

  /** What was measured of a panel at this combination of stops, number by number. */
  facts(mesh) {
    if (mesh.flow) {
      const angle = this.live.results[mesh.flow]?.angle;
      return Number.isFinite(angle) ? [fact('normal error', angle, '°')] : [];
    }
    return (mesh.facts ?? []).flatMap(({name, unit, values}) => {
      const value = values[this.stopOf(values)];
      if (value === null || value === undefined) return [];
      return [fact(name, value, unit)];
    });
  }

  pickedWords() {
    const v = this.state.picked;
    if (v < 0) return '';
    const parts = this.visible().filter((m) => v < m.vertices).map((mesh) => {
      const positions = this.positions(mesh);
      const at = [0, 1, 2].map((k) => readable(positions[3 * v + k], 4)).join(', ');
      const values = this.fields.flatMap((field) => {
        const x = this.valuesBy(field, mesh)?.[v];
        if (x === undefined || field.name.startsWith('error of ')) return [];
        const unit = field.unit === '°' || !field.unit ? field.unit : ` ${field.unit}`;
        const exact = mesh.fields.find((f) => f.name === field.name)?.exact?.[v];
        if (exact !== undefined) {
          return [`${field.name}: exact ${readable(exact)}, estimate ${readable(x)}, error ${readable(x - exact)}${unit}`];
        }
        return [`${field.name} ${Number.isFinite(x) ? readable(x) + unit : 'undefined'}`];
      });
      return `${mesh.title}: (${at})${values.length ? '; ' : ''}${values.join('; ')}`;
    });
    return `Vertex ${v}. ${parts.join('. ')}.`;
  }

  // What is remembered.

  remember() {
    document.dispatchEvent(new CustomEvent('fairing-state', {detail: this}));
  }

  toText() {
    const {state} = this;
    const switches = ['wire', 'lines', 'even', 'flat'].filter((key) => state[key]).join('~');
    const range = state.range ? state.range.join('~') : '';
    return [this.camera.toText(), state.stops.join('~'), state.field, state.map ?? '', range, switches, state.picked, this.live?.toText() ?? '', ...(this.sum ? [this.sum.toText()] : [])].join('!');
  }

  fromText(text) {
    const [camera, stops, field, map, range, switches, picked, live, sum] = text.split('!');
    const {sliders, panels} = this.description;
    this.camera.fromText(camera ?? '');
    const whole = (value, low, high, otherwise) => {
      const x = Number(value);
      return value !== '' && Number.isInteger(x) && x >= low && x <= high ? x : otherwise;
    };
    const {state} = this;
    const chosen = (stops ?? '').split('~');
    state.stops = sliders.map((s, i) => whole(chosen[i] ?? '', 0, s.stops.length - 1, state.stops[i]));
    // How many fields there are is known once the view is open.
    const isOpen = this.shown.length > 0;
    const named = field && !Number.isInteger(Number(field));
    if (!named) state.field = whole(field, -1, isOpen ? this.fields.length - 1 : 99, state.field);
    else if (!isOpen) state.field = field;
    else if (this.fields.some((f) => f.name === field)) state.field = this.fields.findIndex((f) => f.name === field);
    state.map = Object.hasOwn(this.maps, map) ? map : null;
    const ends = (range ?? '').split('~').map(Number);
    state.range = ends.length === 2 && ends[0] < ends[1] ? ends : null;
    const on = (switches ?? '').split('~');
    for (const key of ['wire', 'lines', 'even', 'flat']) state[key] = on.includes(key);
    state.picked = whole(picked, -1, Math.max(...panels.map((p) => p.vertices)) - 1, -1);
    this.wantedLive = live ?? '';
    this.wantedSum = sum ?? '';
    if (!isOpen) return;
    if (sum) this.sum?.recall(sum);
    this.live?.recall(this.wantedLive);
    this.settle();
  }
}

/** A number with its name and unit. */
function fact(name, value, unit) {
  return element('span', {class: 'fact'}, `${name} `, element('b', {}, `${readable(value, 2)}${unit === '°' || !unit ? unit : ` ${unit}`}`));
}

'use strict';

/** Numbers as the report writes them. */
function readable(x, digits = 3) {
  if (!Number.isFinite(x)) return '–';
  if (x === 0) return '0';
  const size = Math.abs(x);
  const text = size >= 1e-3 && size < 1e5 ? String(Number(x.toPrecision(digits))) : x.toExponential(digits - 1);
  return text.replace('e+', 'e').replaceAll('-', '\u2212');
}

function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (value === true) made.setAttribute(key, '');
    else if (value !== false && value !== null) made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

/**
 * One interactive view: panels side by side under one camera, with controls.
 *
 * What is chosen is kept in `state`; `settle` brings everything seen into line
 * with it.
 */
class View {
  constructor(figure, maps) {
    this.figure = figure;
    this.id = figure.id;
    this.maps = maps;
    this.description = JSON.parse(figure.querySelector('script.about').textContent);
    const {angles, zUp, sliders, fields} = this.description;
    this.camera = new Camera(angles[0], angles[1], zUp);
    this.state = {
      stops: sliders.map(() => 0),
      field: fields.length ? 0 : -1,
      map: null,
      range: null,
      wire: false,
      lines: false,
      even: false,
      flat: this.description.flat,
      picked: -1,
    };
    this.live = null;
    this.stage = figure.querySelector('.stage');
  }

  /** Unpacks the data and builds the controls; once. */
  open() {
    this.opened ??= this.build();
    return this.opened;
  }

  async build() {
    const block = await Block.unpack(await packedData(this.figure));
    const panels = decodeView(this.description, block);
    this.live = LiveFlows.of(panels, () => this.liveChanged());
    this.meshes = [...panels, ...(this.live?.panels ?? [])].map((panel) => ({
      ...panel,
      zeros: new Float32Array(panel.vertices),
      shapes: new Map(),
    }));
    this.stage.replaceChildren(...this.controls(), this.panels(), ...this.sliderRows(), this.readout());
    this.figure.classList.add('open');
    const fit = new ResizeObserver(() => this.resize());
    for (const {canvas} of this.shown) fit.observe(canvas);
    this.resize();
    this.settle();
    this.live?.recall(this.wantedLive);
  }

  // What is built.

  controls() {
    const row = element('div', {class: 'controls', role: 'group', 'aria-label': 'display'});
    const {fields} = this.description;
    const chooser = (label, options, change) => {
      const select = element('select', {'aria-label': label});
      options.forEach(([value, text]) => select.append(element('option', {value}, text)));
      select.addEventListener('input', () => change(select.value));
      row.append(element('label', {}, `${label} `, select));
      return select;
    };
    if (fields.length) {
      const names = fields.map((f, i) => [i, f.unit ? `${f.name} (${f.unit})` : f.name]);
      this.fieldChoice = chooser('colour by', [...names, [-1, 'nothing']], (value) => {
        this.change({field: Number(value), range: null, map: null});
      });
      this.mapChoice = chooser('colours', Object.keys(this.maps).map((m) => [m, m]), (map) => {
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
        row.append(element('label', {}, `${end} `, input));
        return input;
      });
    }
    this.switches = {};
    const names = {even: 'equalise', lines: 'isolines', wire: 'edges', flat: 'flat'};
    for (const [key, label] of Object.entries(names)) {
      if (!fields.length && (key === 'even' || key === 'lines')) continue;
      const box = element('input', {type: 'checkbox'});
      box.addEventListener('input', () => this.change({[key]: box.checked}));
      row.append(element('label', {}, box, ` ${label}`));
      this.switches[key] = box;
    }
    const home = element('button', {type: 'button'}, 'reset');
    home.addEventListener('click', () => {
      this.camera.reset();
      this.change({range: null, picked: -1});
    });
    row.append(home);
    return [row];
  }

  panels() {
    this.shown = this.meshes.map((mesh) => {
      const canvas = element('canvas', {
        tabindex: 0,
        role: 'img',
        'aria-label': `${mesh.title}. ${this.description.alt} Arrow keys turn, plus and minus zoom, Enter picks the vertex in the middle, n and p the next and the previous one.`,
      });
      const bar = element('div', {class: 'bar'});
      const title = element('h4', {}, mesh.title);
      const panel = element('div', {class: 'panel', hidden: Boolean(mesh.flow)}, title, canvas, bar);
      const shown = {mesh, canvas, bar, title, panel, target: canvas.getContext('2d')};
      this.listen(shown);
      return shown;
    });
    return element('div', {class: 'panels'}, ...this.shown.map(({panel}) => panel));
  }

  sliderRows() {
    this.sliders = this.description.sliders.map(({name, stops}, which) => {
      const input = element('input', {type: 'range', min: 0, max: stops.length - 1, step: 1, 'aria-label': name});
      const words = element('output', {});
      input.addEventListener('input', () => {
        this.live?.forget();
        this.change({stops: this.state.stops.map((stop, i) => (i === which ? Number(input.value) : stop))});
      });
      return {name, stops, input, words};
    });
    const rows = this.sliders.map(({input, words}) => element('div', {class: 'slider'}, words, input));
    return this.live ? [...rows, ...this.live.controls()] : rows;
  }

  readout() {
    this.words = element('output', {class: 'picked', 'aria-live': 'polite'});
    return element(
      'p', {class: 'hint'}, this.words,
      ' Drag to turn, Shift-drag to move, click a vertex for its values; the wheel zooms once the picture has been clicked.',
    );
  }

  // What happens.

  listen(shown) {
    const {canvas} = shown;
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
        if (spread) this.camera.zoom(spread / apart);
        spread = apart;
      } else if (e.shiftKey || e.buttons & 6) {
        const size = canvas.clientHeight;
        this.camera.move((0.65 * dx) / size, (-0.65 * dy) / size);
      } else {
        this.camera.turn(0.45 * dx, 0.45 * dy);
      }
      this.turnTo();
    });
    const lift = (e) => {
      if (fingers.delete(e.pointerId) && e.type === 'pointerup' && travelled < 4) {
        const box = canvas.getBoundingClientRect();
        this.pick(shown, (e.clientX - box.left) / box.width, (e.clientY - box.top) / box.height);
      }
      this.remember();
    };
    canvas.addEventListener('pointerup', lift);
    canvas.addEventListener('pointercancel', lift);
    canvas.addEventListener('wheel', (e) => {
      // The page must scroll past a picture that nobody has touched.
      if (document.activeElement !== canvas && !e.ctrlKey) return;
      e.preventDefault();
      this.camera.zoom(Math.exp(e.deltaY * 0.001));
      this.turnTo();
      this.remember();
    }, {passive: false});
    canvas.addEventListener('keydown', (e) => {
      const arrows = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]};
      const arrow = arrows[e.key];
      if (arrow && e.shiftKey) this.camera.move(0.02 * arrow[0], -0.02 * arrow[1]);
      else if (arrow) this.camera.turn(6 * arrow[0], 6 * arrow[1]);
      else if (e.key === '+' || e.key === '=') this.camera.zoom(0.9);
      else if (e.key === '-') this.camera.zoom(1 / 0.9);
      else if (e.key === '0' || e.key === 'Home') this.camera.reset();
      else if (e.key === 'Enter') this.pick(shown, 0.5, 0.5);
      else if (e.key === 'n' || e.key === 'p') this.step(shown.mesh, e.key === 'n' ? 1 : -1);
      else return;
      e.preventDefault();
      this.redraw();
      this.remember();
    });
  }

  /** The live flows have been computed, or put away: they take the place of the panel that the sliders move. */
  liveChanged() {
    for (const {mesh, title, panel} of this.shown) {
      if (mesh.flow) {
        title.textContent = this.live.titleOf(mesh.flow);
        panel.hidden = !this.live.on;
      } else {
        panel.hidden = this.live.on && mesh.stops.length > 1;
      }
    }
    this.resize();
    this.settle();
    this.remember();
  }

  change(what) {
    Object.assign(this.state, what);
    this.settle();
    this.remember();
  }

  /** Picks the next vertex, or the previous one. */
  step(mesh, by) {
    const picked = (Math.max(this.state.picked, by > 0 ? -1 : 0) + by + mesh.vertices) % mesh.vertices;
    this.change({picked});
  }

  /** Finds the vertex at a place given in parts of the width and height. */
  pick(shown, x, y) {
    const {canvas, mesh} = shown;
    const [px, py] = [Math.floor(x * canvas.width), Math.floor(y * canvas.height)];
    const face = Renderer.faceAt(this.scene(shown), canvas.width, canvas.height, px, py);
    let picked = -1;
    if (face >= 0) {
      let best = Infinity;
      for (const v of mesh.faces.subarray(3 * face, 3 * face + 3)) {
        const [vx, vy] = this.place(shown, v);
        const far = Math.hypot(vx - px, vy - py);
        if (far < best) [best, picked] = [far, v];
      }
    }
    this.change({picked});
    return picked;
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

  field(mesh) {
    const chosen = this.description.fields[this.state.field];
    return chosen ? mesh.fields.find((f) => f.name === chosen.name) : undefined;
  }

  values(mesh) {
    const field = this.field(mesh);
    return field ? field.stops[this.stopOf(field.stops)] : null;
  }

  /**
   * The range of the colours: that which was chosen, or the 2nd to the 98th
   * percentile of all panels and stops, about zero for a signed field.
   */
  range() {
    if (this.state.range) return this.state.range;
    const chosen = this.description.fields[this.state.field];
    if (!chosen) return [0, 1];
    chosen.range ??= this.percentiles(chosen);
    return chosen.range;
  }

  percentiles(chosen) {
    const all = [];
    for (const mesh of this.meshes) {
      for (const values of mesh.fields.find((f) => f.name === chosen.name)?.stops ?? []) {
        for (const x of values) if (Number.isFinite(x)) all.push(x);
      }
    }
    if (!all.length) return [0, 1];
    const sorted = Float32Array.from(all).sort();
    const at = (part) => sorted[Math.round(part * (sorted.length - 1))];
    let [low, high] = [at(0.02), at(0.98)];
    if (chosen.signed) {
      high = Math.max(Math.abs(low), Math.abs(high));
      low = -high;
    }
    if (!(low < high)) [low, high] = [low - 0.5 * (Math.abs(low) || 1), high + 0.5 * (Math.abs(high) || 1)];
    return [low, high].map((x) => Number(x.toPrecision(3)));
  }

  mapName() {
    const chosen = this.description.fields[this.state.field];
    return this.state.map ?? (chosen?.signed ? 'coolwarm' : 'viridis');
  }

  /** Colours along the range, 1024 of them, with the histogram equalised if asked. */
  lookup() {
    const map = this.maps[this.mapName()];
    const [low, high] = this.range();
    const size = 1024;
    const key = [this.mapName(), low, high, this.state.even, this.state.even && this.combination(), this.state.field].join();
    if (this.lookupKey === key) return this.lookupColors;
    const colors = new Uint8Array(3 * size);
    const shares = this.state.even ? this.shares(low, high, size) : null;
    for (let i = 0; i < size; i++) {
      const t = shares ? shares[i] : i / (size - 1);
      const k = 3 * Math.round(t * (map.length / 3 - 1));
      colors.set(map.subarray(k, k + 3), 3 * i);
    }
    [this.lookupKey, this.lookupColors] = [key, colors];
    return colors;
  }

  /** The different values in range that are shown, if there are at most `most`; null if there are more. */
  distinct(low, high, most = 16) {
    const found = new Set();
    for (const mesh of this.meshes) {
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
    for (const mesh of this.meshes) {
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

  /** Equalised colours of a few values: each has the middle of its ranks, and the bar shows no others. */
  sharesOf(few, low, high, size) {
    const counts = few.map(() => 0);
    for (const mesh of this.meshes) {
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
    return mesh.flow ? this.live.drawn(mesh.flow) : mesh.stops[this.stopOf(mesh.stops)];
  }

  /** Points and normals of a panel, scaled to the ball of the camera. */
  shape(mesh) {
    const positions = this.positions(mesh);
    if (mesh.shapes.has(positions)) return mesh.shapes.get(positions);
    const {center, radius} = this.description.ball;
    const n = mesh.vertices;
    const points = new Float32Array(4 * n);
    const normals = new Float32Array(4 * n);
    for (let v = 0; v < n; v++) {
      for (let k = 0; k < 3; k++) points[4 * v + k] = (positions[3 * v + k] - center[k]) / radius;
      points[4 * v + 3] = mesh.occlusion[v] / 255;
    }
    const {faces} = mesh;
    for (let f = 0; f < faces.length; f += 3) {
      const [a, b, c] = [4 * faces[f], 4 * faces[f + 1], 4 * faces[f + 2]];
      const [ux, uy, uz] = [points[b] - points[a], points[b + 1] - points[a + 1], points[b + 2] - points[a + 2]];
      const [vx, vy, vz] = [points[c] - points[a], points[c + 1] - points[a + 1], points[c + 2] - points[a + 2]];
      const [nx, ny, nz] = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
      for (const v of [a, b, c]) {
        normals[v] += nx;
        normals[v + 1] += ny;
        normals[v + 2] += nz;
      }
    }
    for (let v = 0; v < 4 * n; v += 4) {
      const length = Math.hypot(normals[v], normals[v + 1], normals[v + 2]);
      if (length > 0) for (let k = 0; k < 3; k++) normals[v + k] /= length;
    }
    const made = {points, normals};
    // A live result is not asked for again once it is replaced.
    if (mesh.flow) mesh.shapes.clear();
    mesh.shapes.set(positions, made);
    return made;
  }

  scene({mesh}) {
    const {wire, lines, flat} = this.state;
    return {
      mesh,
      shape: this.shape(mesh),
      values: this.values(mesh),
      camera: this.camera,
      lookup: this.lookup(),
      range: this.range(),
      pixel: this.pixel,
      wire,
      lines,
      flat,
    };
  }

  place({mesh, canvas}, v) {
    const point = this.shape(mesh).points.subarray(4 * v, 4 * v + 3);
    return this.camera.place(point, canvas.width, canvas.height);
  }

  resize() {
    this.pixel = Math.min(window.devicePixelRatio || 1, 2);
    for (const {canvas, panel} of this.shown) {
      if (panel.hidden) continue;
      const box = canvas.getBoundingClientRect();
      const [width, height] = [box.width, box.height].map((x) => Math.round(x * this.pixel));
      if (canvas.width !== width || canvas.height !== height) {
        canvas.width = width;
        canvas.height = height;
      }
    }
    this.draw();
  }

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

  draw() {
    for (const shown of this.shown) {
      if (shown.panel.hidden) continue;
      Renderer.draw(shown.target, this.scene(shown), this.moving ? 0.5 : 1);
      const {picked} = this.state;
      if (picked >= 0 && picked < shown.mesh.vertices) {
        const [x, y] = this.place(shown, picked);
        for (const [color, width] of [['#fff', 4], ['#111', 1.8]]) {
          shown.target.beginPath();
          shown.target.arc(x, y, 6 * this.pixel, 0, 2 * Math.PI);
          shown.target.strokeStyle = color;
          shown.target.lineWidth = width * this.pixel;
          shown.target.stroke();
        }
      }
    }
  }

  settle() {
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
    for (const shown of this.shown) shown.bar.replaceChildren(...drawBar(this, shown.mesh));
    this.words.textContent = this.pickedWords();
    this.draw();
  }

  pickedWords() {
    const v = this.state.picked;
    if (v < 0) return '';
    const visible = this.shown.filter(({panel}) => !panel.hidden).map(({mesh}) => mesh);
    const parts = visible.filter((m) => v < m.vertices).map((mesh) => {
      const positions = this.positions(mesh);
      const at = [0, 1, 2].map((k) => readable(positions[3 * v + k], 4)).join(', ');
      const values = mesh.fields.map((f) => {
        const x = f.stops[this.stopOf(f.stops)][v];
        return `${f.name} ${Number.isFinite(x) ? readable(x) : 'undefined'}${f.unit ? ` ${f.unit}` : ''}`;
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
    return [this.camera.toText(), state.stops.join('~'), state.field, state.map ?? '', range, switches, state.picked, this.live?.toText() ?? ''].join('!');
  }

  fromText(text) {
    const [camera, stops, field, map, range, switches, picked, live] = text.split('!');
    const {sliders, fields, panels} = this.description;
    this.camera.fromText(camera ?? '');
    const whole = (value, low, high, otherwise) => {
      const x = Number(value);
      return value !== '' && Number.isInteger(x) && x >= low && x <= high ? x : otherwise;
    };
    const {state} = this;
    const chosen = (stops ?? '').split('~');
    state.stops = sliders.map((s, i) => whole(chosen[i] ?? '', 0, s.stops.length - 1, state.stops[i]));
    state.field = whole(field, -1, fields.length - 1, state.field);
    state.map = Object.hasOwn(this.maps, map) ? map : null;
    const ends = (range ?? '').split('~').map(Number);
    state.range = ends.length === 2 && ends[0] < ends[1] ? ends : null;
    const on = (switches ?? '').split('~');
    for (const key of ['wire', 'lines', 'even', 'flat']) state[key] = on.includes(key);
    state.picked = whole(picked, -1, Math.max(...panels.map((p) => p.vertices)) - 1, -1);
    this.wantedLive = live ?? '';
    if (this.shown) this.live?.recall(this.wantedLive);
  }
}

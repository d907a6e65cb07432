import {element, readable} from '../../figure/viewer/dom.mjs';
import {linePlot, sliderRow} from './plots.mjs';

/**
 * A panel whose positions are a sum of modes, as many as the reader likes, the last of them in
 * part.
 */
export class ModeSum {
  /** For the first panel with modes; null if there is none. */
  static of(meshes, changed) {
    const mesh = meshes.find((m) => m.modes);
    return mesh ? new ModeSum(mesh, changed) : null;
  }

  constructor(mesh, changed) {
    this.mesh = mesh;
    this.changed = changed;
    const {values, coefficients, vectors} = mesh.modes;
    Object.assign(this, {values, coefficients, vectors, count: values.length});
    this.sums = new Map();
  }

  controls() {
    this.slider = sliderRow('k', {min: 1, max: this.count, step: 0.05, value: Math.min(8, this.count)}, (k) => `k = ${readable(k, 4)}`, () => this.changed());
    this.plot = element('div', {class: 'beside'});
    return [this.slider.row, this.plot];
  }

  get k() {
    return this.slider?.value() ?? 1;
  }

  /** The mode that is being added. */
  last() {
    return Math.min(this.count, Math.ceil(this.k)) - 1;
  }

  positions() {
    const {k} = this;
    if (this.shown?.k === k) return this.shown.sum;
    const n = this.mesh.vertices;
    const whole = Math.floor(k);
    const sum = Float64Array.from(this.upTo(whole));
    if (whole < this.count) this.add(sum, whole, k - whole, n);
    this.shown = {k, sum};
    return sum;
  }

  /** Sums of whole modes are kept at every tenth, so that a drag adds few of them. */
  upTo(whole) {
    const n = this.mesh.vertices;
    const tens = 10 * Math.floor(whole / 10);
    if (!this.sums.has(tens)) {
      const sum = tens ? Float64Array.from(this.upTo(tens - 1)) : new Float64Array(3 * n);
      if (tens) this.add(sum, tens - 1, 1, n);
      this.sums.set(tens, sum);
    }
    const sum = Float64Array.from(this.sums.get(tens));
    for (let i = tens; i < whole; i++) this.add(sum, i, 1, n);
    return sum;
  }

  add(sum, i, part, n) {
    const vector = this.vectors[i];
    const [x, y, z] = this.coefficients[i].map((c) => part * c);
    for (let v = 0; v < n; v++) {
      sum[3 * v] += x * vector[v];
      sum[3 * v + 1] += y * vector[v];
      sum[3 * v + 2] += z * vector[v];
    }
  }

  /** How much each mode has of the shape, and where k is. */
  settle() {
    const size = (i) => Math.hypot(...this.coefficients[i]);
    const points = Array.from({length: this.count - 1}, (_, i) => [i + 2, Math.max(1e-9, size(i + 1))]);
    const sizes = points.map(([, y]) => y);
    const k = this.last() + 1;
    const plot = linePlot({
      label: 'size of each mode in the positions over its number',
      size: [420, 130],
      x: {from: 1, to: this.count, label: 'mode, smooth to rough'},
      y: {from: Math.min(...sizes), to: Math.max(...sizes), log: true, label: 'size in the positions'},
      series: [
        {name: 'left out', kind: 'soft', dots: true, points: points.filter(([i]) => i > k)},
        {name: 'summed', kind: 'blue', dots: true, points: points.filter(([i]) => i <= k)},
      ],
      marks: [{at: this.k}],
    });
    this.plot.replaceChildren(plot);
  }

  /** The field that colours by the mode that is being added. */
  field() {
    return {
      name: 'the mode being added', unit: '', signed: true, fixed: [-1, 1],
      values: (mesh) => {
        if (mesh !== this.mesh) return null;
        const vector = this.vectors[this.last()];
        const most = vector.reduce((m, x) => Math.max(m, Math.abs(x)), 0) || 1;
        return Float32Array.from(vector, (x) => x / most);
      },
    };
  }

  toText() {
    return this.slider ? String(this.k) : '';
  }

  recall(text) {
    if (!text || !Number.isFinite(Number(text))) return;
    this.slider.input.value = text;
    this.slider.say();
  }
}

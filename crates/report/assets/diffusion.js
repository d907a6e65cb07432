'use strict';

/**
 * Explicit and implicit steps with uniform weights on a closed mesh of which all modes are known: λ can be dragged
 * through the limit 4/3 and through 2, and each mode is multiplied by its factor.
 */
Playground.kinds.set('diffusion', class extends Playground {
  build() {
    this.camera = new Camera(30, 20, true);
    this.lambda = this.slider('λ', {min: 0, max: 2.2, step: 0.01, value: 1.45}, (x) => `λ = ${readable(x)}`);
    this.count = this.slider('steps', {min: 0, max: 60, step: 1, value: 12}, (x) => `${x} steps`);
    this.before = this.stage('input, by its roughest mode', 'A bumpy ball with noise.');
    this.after = ['explicit', 'implicit'].map((flow) => Object.assign(this.stage(flow, `The ball after ${flow} steps.`), {flow}));
    this.plots = element('div', {class: 'panels'});
    this.result = element('p', {class: 'factors', 'aria-live': 'polite'});
    this.analyse();
    return [
      element('div', {class: 'panels'}, ...[this.before, ...this.after].map(({panel}) => panel)),
      this.lambda.row, this.count.row, this.result, this.plots,
    ];
  }

  /** The mesh and its modes: those of D^(−½) A D^(−½) are those of L = D⁻¹A − I times D^½, which is symmetric. */
  analyse() {
    const {positions, faces} = Geometry.octasphere(9);
    const n = positions.length / 3;
    const noise = Geometry.gaussians(3 * n, 5);
    for (let v = 0; v < n; v++) {
      const [x, y, z] = positions.subarray(3 * v, 3 * v + 3);
      const r = 1 + 0.22 * Math.sin(3 * x + 1) * Math.cos(4 * y) + 0.12 * Math.sin(5 * z);
      for (let k = 0; k < 3; k++) positions[3 * v + k] = r * positions[3 * v + k] + 0.02 * noise[3 * v + k];
    }
    const {starts, ends} = Geometry.neighbours(n, faces);
    const root = Float64Array.from({length: n}, (_, v) => Math.sqrt(starts[v + 1] - starts[v]));
    const matrix = new Float64Array(n * n);
    for (let v = 0; v < n; v++) {
      matrix[v * n + v] = -1;
      for (let i = starts[v]; i < starts[v + 1]; i++) matrix[v * n + ends[i]] = 1 / (root[v] * root[ends[i]]);
    }
    // Ascending: the roughest mode is the first.
    const {values, vectors} = symmetricEigen(matrix, n);
    const parts = new Float64Array(3 * n);
    for (let v = 0; v < n; v++) {
      for (let k = 0; k < n; k++) {
        for (let c = 0; c < 3; c++) parts[3 * k + c] += vectors[v * n + k] * root[v] * positions[3 * v + c];
      }
    }
    Object.assign(this, {n, positions, faces, root, values, vectors, parts});
  }

  /** The positions after steps that multiply each mode by this factor. */
  flown(factor, count) {
    const {n, root, values, vectors, parts} = this;
    const scaled = parts.map((x, i) => x * factor(values[Math.floor(i / 3)]) ** count);
    const out = new Float64Array(3 * n);
    for (let v = 0; v < n; v++) {
      let [x, y, z] = [0, 0, 0];
      for (let k = 0; k < n; k++) {
        const w = vectors[v * n + k];
        x += w * scaled[3 * k];
        y += w * scaled[3 * k + 1];
        z += w * scaled[3 * k + 2];
      }
      out.set([x / root[v], y / root[v], z / root[v]], 3 * v);
    }
    return out;
  }

  settle() {
    const [lambda, count] = [this.lambda.value(), this.count.value()];
    const factors = {explicit: (mu) => 1 + lambda * mu, implicit: (mu) => 1 / (1 - lambda * mu)};
    const ball = {center: [0, 0, 0], radius: 1.3};
    const rough = Float64Array.from({length: this.n}, (_, v) => this.vectors[v * this.n] / this.root[v]);
    const most = rough.reduce((m, x) => Math.max(m, Math.abs(x)), 0);
    this.before.show(this.positions, this.faces, ball, {
      flat: true,
      colors: {values: rough.map((x) => x / most), range: [-1, 1], map: 'coolwarm', name: 'roughest mode', unit: ''},
    });
    this.results = {};
    for (const stage of this.after) {
      const {flow} = stage;
      const result = this.flown(factors[flow], count);
      this.results[flow] = result;
      const {positions, note} = Geometry.fitted(this.positions, result, 0.75);
      stage.title.textContent = `${flow}, ${count} × ${readable(lambda)}${note}`;
      stage.show(positions, this.faces, ball, {flat: true});
    }
    this.plots.replaceChildren(this.factorPlot(lambda, factors), this.spectrum(factors, count));
    this.result.textContent = this.verdict(lambda, count, factors);
  }

  verdict(lambda, count, factors) {
    const mu = this.values[0];
    const [one, other] = [factors.explicit(mu), factors.implicit(mu)];
    const limit = -2 / mu;
    // The limit itself is 4/3, and sliders stop beside it.
    const side = lambda > limit + 1e-9
      ? `λ is beyond the limit 2/|μ| = 4/3: the explicit factor of the roughest mode is below −1, so it grows in every step.`
      : `λ is below the limit 2/|μ| = 4/3: no mode grows.`;
    return `The roughest mode has μ = ${readable(mu)}. An explicit step multiplies it by 1 + λμ = ${readable(one)}, an implicit one by 1/(1 − λμ) = ${readable(other)}; ` +
      `${count} steps by ${readable(one ** count)} and ${readable(other ** count)}. ${side}` +
      (lambda >= 2 ? ' At λ = 2 no mesh is safe: the eigenvalues sum to minus the number of vertices, so that one of them is below −1.' : '');
  }

  factorPlot(lambda, factors) {
    const along = Array.from({length: 101}, (_, i) => i / 50);
    const series = Object.entries(factors).map(([name, factor]) => (
      {name, kind: name === 'explicit' ? 'red' : 'blue', points: along.map((m) => [m, factor(-m)])}));
    const rough = -this.values[0];
    const plot = linePlot({
      label: 'factor of one step over the size of the eigenvalue: a falling line for explicit steps, a curve that stays positive for implicit ones',
      x: {from: 0, to: 2, label: '|μ|, smooth to rough'},
      y: {from: -2, to: 1.2, label: 'factor of one step'},
      band: [-1, 1],
      series,
      marks: [{at: rough, words: 'roughest'}],
      here: Object.values(factors).map((factor) => [rough, Math.max(-2, factor(-rough))]),
    });
    return element('div', {class: 'panel'}, element('p', {class: 'title'}, '1 − λ|μ| and 1/(1 + λ|μ|)'), plot);
  }

  /** The size of each mode in the positions, before and after. */
  spectrum(factors, count) {
    const {n, values, parts} = this;
    const size = (k) => Math.hypot(parts[3 * k], parts[3 * k + 1], parts[3 * k + 2]);
    const dots = (factor) => Array.from({length: n}, (_, k) => [-values[k], size(k) * Math.abs(factor(values[k])) ** count]);
    const series = [
      {name: 'input', kind: 'soft', dots: true, points: dots(() => 1)},
      {name: 'explicit', kind: 'red', dots: true, points: dots(factors.explicit)},
      {name: 'implicit', kind: 'blue', dots: true, points: dots(factors.implicit)},
    ];
    // From the smoothest mode to the roughest, so that labels are at the rough end.
    series.forEach(({points}) => points.reverse());
    const plot = linePlot({
      label: 'size of each mode in the positions before and after, on a logarithmic axis',
      x: {from: 0, to: 1.5, label: '|μ|, smooth to rough'},
      y: {from: 1e-4, to: 1e3, log: true, label: 'size in the positions'},
      series,
    });
    return element('div', {class: 'panel'}, element('p', {class: 'title'}, 'the spectrum of the result'), plot);
  }

  about(v) {
    const moved = (name) => Math.hypot(...[0, 1, 2].map((c) => this.results[name][3 * v + c] - this.positions[3 * v + c]));
    return `Moved by ${readable(moved('explicit'))} (explicit) and ${readable(moved('implicit'))} (implicit).`;
  }
});

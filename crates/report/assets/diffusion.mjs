import {Camera} from '../../figure/viewer/camera.mjs';
import {Computing} from './computing.mjs';
import {element, readable} from '../../figure/viewer/dom.mjs';
import {factorPlot, factorsOf, factorWords} from './factors.mjs';
import {fitted} from './fitted.mjs';
import {Playground} from './playground.mjs';
import {linePlot} from './plots.mjs';
import {octasphere} from './surfaces.mjs';

/**
 * Explicit and implicit steps with uniform weights on a closed mesh of which all modes are known: λ
 * can be dragged through the limit 4/3 and through 2, and each mode is multiplied by its factor.
 */
export class DiffusionPlayground extends Playground {
  ball = {center: [0, 0, 0], radius: 1.3};

  build() {
    this.camera = new Camera(30, 20, true);
    this.lambda = this.slider('λ', {min: 0, max: 2.2, step: 0.01, value: 1.45}, (x) => `λ = ${readable(x)}`);
    this.count = this.slider('steps', {min: 0, max: 60, step: 1, value: 12}, (x) => `${x} steps`);
    this.before = this.stage('input, by its roughest mode', 'A bumpy ball with noise.');
    this.after = ['explicit', 'implicit'].map((flow) => Object.assign(this.stage(flow, `The ball after ${flow} steps.`), {flow}));
    this.plots = element('div', {class: 'panels'});
    this.result = element('p', {class: 'factors', 'aria-live': 'polite'});
    this.make();
    return [
      element('div', {class: 'panels'}, ...[this.before, ...this.after].map(({panel}) => panel)),
      this.lambda.row, this.count.row, this.result, this.plots,
    ];
  }

  /** The ball; its noise is of waves too short for the mesh. */
  make() {
    const {positions, faces} = octasphere(9);
    const n = positions.length / 3;
    for (let v = 0; v < n; v++) {
      const [x, y, z] = positions.subarray(3 * v, 3 * v + 3);
      const r = 1 + 0.22 * Math.sin(3 * x + 1) * Math.cos(4 * y) + 0.12 * Math.sin(5 * z);
      for (let k = 0; k < 3; k++) positions[3 * v + k] = r * positions[3 * v + k] + 0.028 * Math.sin(10000 * (3 * v + k + 1));
    }
    Object.assign(this, {n, positions, faces});
  }

  preview() {
    for (const stage of [this.before, ...this.after]) stage.show(this.positions, this.faces, this.ball, {flat: true});
  }

  /** Hands the ball to the module, which finds its modes. */
  async prepare() {
    const mesh = await Computing.add(this.positions, this.faces);
    const {arrays: {values, sizes}} = await Computing.call({verb: 'spectrum', mesh, values: {k: this.n, operator: 'uniform'}});
    await Computing.call({verb: 'mode', mesh, mode: this.n - 1});
    const {arrays: {values: rough}} = await Computing.call({verb: 'field', mesh, name: 'mode'});
    Object.assign(this, {mesh, values, sizes, rough, roughest: -values[this.n - 1]});
  }

  async compute() {
    this.prepared ??= this.prepare();
    await this.prepared;
    const [lambda, count] = [this.lambda.value(), this.count.value()];
    const given = {explicit: {unstable: 'allow'}, implicit: {}};
    const results = {};
    for (const {flow: method} of this.after) {
      const values = {lambda, iterations: count, ...given[method]};
      results[method] = await Computing.made({verb: 'smooth', method, mesh: this.mesh, values});
    }
    this.now = {lambda, count, results};
  }

  show() {
    const {lambda, count, results} = this.now;
    this.before.show(this.positions, this.faces, this.ball, {flat: true, colors: this.colors()});
    for (const stage of this.after) {
      const {positions, note} = fitted(this.positions, results[stage.flow], 0.75);
      stage.title.textContent = this.titleOf(stage.flow, note);
      stage.show(positions, this.faces, this.ball, {flat: true});
    }
    this.plot(lambda, count);
    this.result.textContent = this.verdict(lambda, count);
  }

  /** The roughest mode. */
  colors() {
    const {rough} = this;
    const most = rough.reduce((m, x) => Math.max(m, Math.abs(x)), 0);
    return {values: rough.map((x) => x / most), range: [-1, 1], map: 'coolwarm', name: 'roughest mode', unit: ''};
  }

  titleOf(flow, note) {
    return `${flow}, ${this.now.count} × ${readable(this.now.lambda)}${note}`;
  }

  plot(lambda, count) {
    const factor = element('div', {class: 'panel'}, element('p', {class: 'title'}, '1 − λ|μ| and 1/(1 + λ|μ|)'), factorPlot(lambda, this.roughest));
    this.plots.replaceChildren(factor, this.spectrum(factorsOf(lambda), count));
  }

  verdict(lambda, count) {
    // The limit itself is 4/3, and sliders stop beside it.
    const side = lambda > -2 / this.roughest + 1e-9
      ? `λ is beyond the limit 2/|μ| = 4/3: the explicit factor of the roughest mode is below −1, so it grows in every step.`
      : `λ is below the limit 2/|μ| = 4/3: no mode grows.`;
    return `${factorWords(lambda, count, this.roughest)} ${side}` +
      (lambda >= 2 ? ' At λ = 2 no mesh is safe: the eigenvalues sum to minus the number of vertices, so that one of them is below −1.' : '');
  }

  /** The size of each mode in the positions, before and after. */
  spectrum(factors, count) {
    const {values, sizes} = this;
    // From the smoothest mode to the roughest, so that labels are at the rough end.
    const dots = (factor) => Array.from(values, (x, k) => [x, sizes[k] * Math.abs(factor(-x)) ** count]);
    const series = [
      {name: 'input', kind: 'soft', dots: true, points: dots(() => 1)},
      {name: 'explicit', kind: 'explicit', dots: true, points: dots(factors.explicit)},
      {name: 'implicit', kind: 'implicit', dots: true, points: dots(factors.implicit)},
    ];
    const plot = linePlot({
      size: [420, 165],
      label: 'size of each mode in the positions before and after, on a logarithmic axis',
      x: {from: 0, to: 1.5, label: '|μ|, smooth to rough'},
      y: {from: 1e-4, to: 1e3, log: true, label: 'size in the positions'},
      series,
    });
    return element('div', {class: 'panel'}, element('p', {class: 'title'}, 'the spectrum of the result'), plot);
  }

  about(v) {
    const moved = (name) => Math.hypot(...[0, 1, 2].map((c) => this.now.results[name][3 * v + c] - this.positions[3 * v + c]));
    return `Moved by ${readable(moved('explicit'))} (explicit) and ${readable(moved('implicit'))} (implicit).`;
  }
}

/** The same in one slider, before anything has a name. */
export class OpeningPlayground extends DiffusionPlayground {
  build() {
    this.camera = new Camera(30, 20, true);
    this.lambda = this.slider('λ', {min: 0, max: 1.6, step: 0.01, value: 0.5}, (x) => `λ = ${readable(x)}`);
    this.count = {value: () => 12};
    this.before = this.stage('before', 'A bumpy ball with noise.');
    this.after = [Object.assign(this.stage('after 12 steps', 'The ball after 12 steps.'), {flow: 'explicit'})];
    this.result = element('p', {class: 'factors', 'aria-live': 'polite'});
    this.make();
    return [element('div', {class: 'panels'}, this.before.panel, this.after[0].panel), this.lambda.row, this.result];
  }

  async prepare() {
    const mesh = await Computing.add(this.positions, this.faces);
    const {value} = await Computing.call({verb: 'info', mesh, roughest: true});
    Object.assign(this, {mesh, roughest: -value.roughest_eigenvalue});
  }

  colors() {
    return null;
  }

  titleOf(flow, note) {
    return `after 12 steps${note}`;
  }

  plot() {}

  verdict(lambda) {
    const factor = Math.abs(1 + lambda * this.roughest) ** 12;
    const size = factor < 0.01 ? 'less than a hundredth of its height' : `${readable(factor)} times its height`;
    return `After twelve steps the roughest wave has ${size}.`;
  }

  about(v) {
    const moved = Math.hypot(...[0, 1, 2].map((c) => this.now.results.explicit[3 * v + c] - this.positions[3 * v + c]));
    return `Moved by ${readable(moved)}.`;
  }
}

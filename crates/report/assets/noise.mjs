import {Camera} from '../../figure/viewer/camera.mjs';
import {Computing} from './computing.mjs';
import {element, readable} from '../../figure/viewer/dom.mjs';
import {Playground} from './playground.mjs';
import {linePlot} from './plots.mjs';
import {octasphere, torus} from './surfaces.mjs';

/**
 * Noise on surfaces whose curvature is known, and what it does to H (cotangents) and K (angle
 * defects).
 */
export class NoisePlayground extends Playground {
  static surfaces = {
    sphere: {
      make: (size) => octasphere(size),
      exact: ({positions}) => {
        const one = new Float64Array(positions.length / 3).fill(1);
        return {mean: one, gaussian: one};
      },
      radius: 1.15,
      euler: 2,
    },
    torus: {
      make: (size) => torus(1, 0.4, 4 * Math.round(0.95 * size), 2 * Math.round(0.8 * size)),
      exact: ({angles}) => ({
        mean: angles.map((v) => (1 + 0.8 * Math.cos(v)) / (0.8 * (1 + 0.4 * Math.cos(v)))),
        gaussian: angles.map((v) => Math.cos(v) / (0.4 * (1 + 0.4 * Math.cos(v)))),
      }),
      radius: 1.45,
      euler: 0,
    },
  };

  build() {
    this.camera = new Camera(25, 40, true);
    this.sigma = this.slider('noise', {min: 0, max: 0.5, step: 0.005, value: 0.02}, (x) => `σ = ${readable(x)} h`);
    this.size = this.slider('resolution', {min: 6, max: 24, step: 1, value: 12}, () => this.sizeWords());
    this.surface = this.choice('surface', [['torus', 'torus'], ['sphere', 'sphere']]);
    this.colored = this.choice('colour by', [['error', 'relative error'], ['estimate', 'estimate']]);
    this.panels = [this.stage('H, mean curvature', 'A noisy surface, coloured by mean curvature.'), this.stage('K, Gaussian curvature', 'The same surface, coloured by Gaussian curvature.')];
    this.result = element('p', {class: 'factors', 'aria-live': 'polite'});
    this.plots = element('div', {class: 'panel'});
    return [
      element('div', {class: 'controls', role: 'group', 'aria-label': 'display'}, this.surface.label, this.colored.label, this.seeds()),
      element('div', {class: 'panels'}, ...this.panels.map(({panel}) => panel), this.plots),
      this.sigma.row, this.size.row, this.result,
    ];
  }

  sizeWords() {
    return this.mesh ? `${this.mesh.positions.length / 3} vertices` : 'resolution';
  }

  /** The surface without noise. */
  make() {
    const key = [this.surface.value(), this.size.value()].join();
    if (key === this.made) return false;
    this.made = key;
    this.kind = this.constructor.surfaces[this.surface.value()];
    this.mesh = this.kind.make(this.size.value());
    this.exact = this.kind.exact(this.mesh);
    this.size.say();
    return true;
  }

  preview() {
    this.make();
    this.made = '';
    for (const stage of this.panels) stage.show(this.mesh.positions, this.mesh.faces, {center: [0, 0, 0], radius: this.kind.radius});
  }

  async compute() {
    if (this.make()) {
      await Computing.drop(this.number);
      this.number = await Computing.add(this.mesh.positions, this.mesh.faces);
    }
    const sigma = this.sigma.value();
    this.now = {sigma, ...await this.estimate(sigma)};
  }

  /** The curve of errors, which is kept until the surface or the seed changes. */
  async refine() {
    const key = [this.made, this.seed].join();
    if (key === this.key) return;
    const curve = [];
    for (let i = 0; i <= 10 && !this.isStale; i++) {
      const sigma = 0.005 * 100 ** (i / 10);
      curve.push([sigma, ...this.errors(await this.estimate(sigma))]);
    }
    if (this.isStale) return;
    [this.key, this.curve] = [key, curve];
    this.present();
  }

  /** The noisy surface with its curvature, and the sum of its angle defects. */
  estimate(sigma) {
    const request = {verb: 'noise', method: 'axes', mesh: this.number, values: {sigma, seed: this.seed}};
    return Computing.made(request, async (mesh, positions) => {
      const {value} = await Computing.call({verb: 'info', mesh});
      return {positions, total: value.total_curvature, ...await Computing.curvature(mesh)};
    });
  }

  /** Root mean square errors of H and K over the root mean square of the exact values. */
  errors(estimate) {
    return ['mean', 'gaussian'].map((name) => {
      let [off, size] = [0, 0];
      this.exact[name].forEach((x, v) => {
        off += (estimate[name][v] - x) ** 2;
        size += x ** 2;
      });
      return Math.sqrt(off / size);
    });
  }

  typical(name) {
    return Math.sqrt(this.exact[name].reduce((sum, x) => sum + x * x, 0) / this.exact[name].length);
  }

  show() {
    const {sigma} = this.now;
    const [mean, gaussian] = this.errors(this.now);
    const ball = {center: [0, 0, 0], radius: this.kind.radius};
    const relative = this.colored.value() === 'error';
    ['mean', 'gaussian'].forEach((name, k) => {
      const letter = 'HK'[k];
      const typical = this.typical(name);
      const values = relative ? this.now[name].map((x, v) => (x - this.exact[name][v]) / typical) : this.now[name];
      const limit = relative ? 1 : 2.5 * typical;
      const colors = {values, range: [-limit, limit], map: 'coolwarm', name: relative ? `error of ${letter} over its RMS` : `${letter}, estimated`, unit: ''};
      this.panels[k].show(this.now.positions, this.mesh.faces, ball, {colors});
    });
    this.result.textContent =
      `H is off by ${readable(100 * mean, 2)} %, K by ${readable(100 * gaussian, 2)} %: ${readable(gaussian / mean, 2)} times as much. ` +
      `The angle defects still add up to ${this.total()}, as they must: 2πχ = ${2 * this.kind.euler ? `${2 * this.kind.euler} π` : '0'}.`;
    this.plots.replaceChildren(element('p', {class: 'title'}, 'errors over the noise'), this.plot(sigma, mean, gaussian));
    if (this.picked >= this.mesh.positions.length / 3) this.picked = -1;
  }

  /** The sum of all angle defects in parts of π; what is left of zero is rounding. */
  total() {
    const parts = Number((this.now.total / Math.PI).toFixed(9));
    return parts ? `${readable(parts, 9)} π` : '0';
  }

  plot(sigma, mean, gaussian) {
    const series = ['H', 'K'].map((name, k) => ({name, kind: k ? 'red' : 'blue', points: (this.curve ?? []).map((row) => [row[0], row[1 + k]])}));
    const shown = Math.min(0.5, Math.max(0.005, sigma));
    return linePlot({
      label: 'relative errors of H and K over the noise, on logarithmic axes',
      size: [225, 200],
      x: {from: 0.005, to: 0.5, log: true, label: 'noise σ/h'},
      y: {from: 1e-2, to: 100, log: true, label: 'relative error'},
      series,
      marks: [{at: shown}],
      here: [[shown, mean], [shown, gaussian]],
    });
  }

  about(v) {
    return ['mean', 'gaussian'].map((name, k) => {
      const [estimate, exact] = [this.now[name][v], this.exact[name][v]];
      return `${'HK'[k]}: exact ${readable(exact)}, estimate ${readable(estimate)}, error ${readable(estimate - exact)}`;
    }).join('. ') + '.';
  }
}

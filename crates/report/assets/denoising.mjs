import {Camera} from '../../figure/viewer/camera.mjs';
import {Computing} from './computing.mjs';
import {angles} from './derived.mjs';
import {element, readable} from '../../figure/viewer/dom.mjs';
import {Playground} from './playground.mjs';
import {linePlot} from './plots.mjs';
import {turned} from './surfaces.mjs';

/**
 * A turned part with creases under noise, after diffusion and after a filter of normals, with what
 * each costs.
 */
export class DenoisingPlayground extends Playground {
  /**
   * Radius and height along the outline of the part, from the middle of its bottom to that of its
   * top.
   */
  static outline = [[0, -0.7], [1, -0.7], [1, 0], [0.62, 0], [0.62, 0.45], [0.4, 0.67], [0, 0.67]];

  build() {
    this.camera = new Camera(30, 32, true);
    this.sigma = this.slider('noise', {min: 0, max: 0.6, step: 0.01, value: 0.2}, (x) => `σ = ${readable(x)} h`);
    this.steps = this.slider('diffusion', {min: 0, max: 40, step: 1, value: 8}, (x) => `${x} explicit steps, λ = 0.5`);
    this.rounds = this.slider('filter', {min: 0, max: 40, step: 1, value: 20}, (x) => `${x} rounds of the filter`);
    for (const title of ['noisy', 'diffusion', 'filter of normals']) this.stage(title, `The part: ${title}.`).facts.hidden = false;
    this.result = element('p', {class: 'factors', 'aria-live': 'polite'});
    this.plots = element('div', {class: 'beside'});
    const {positions, faces} = turned(this.constructor.outline, 0.1);
    Object.assign(this, {truth: positions, faces, ball: {center: [0, 0, 0], radius: 1.2}});
    return [
      element('div', {class: 'controls', role: 'group', 'aria-label': 'display'}, this.seeds()),
      element('div', {class: 'panels'}, ...this.shown.map(({panel}) => panel)),
      this.sigma.row, this.steps.row, this.rounds.row, this.result, this.plots,
    ];
  }

  preview() {
    for (const stage of this.shown) stage.show(this.truth, this.faces, this.ball, {flat: true});
  }

  async prepare() {
    this.number = await Computing.add(this.truth, this.faces);
    this.h = (await Computing.call({verb: 'info', mesh: this.number})).value.mean_edge;
  }

  /** The part under this noise, after diffusion and after the filter, each with its scores. */
  restored(sigma) {
    const scored = async (mesh, positions) => {
      const {normal_mean: angle, volume_drift: volume, feature_f_score: score} = await Computing.matching(mesh, this.number);
      return {positions, angle, volume: 100 * volume, creases: 100 * score};
    };
    const noise = {verb: 'noise', method: 'axes', mesh: this.number, values: {sigma, seed: this.seed}};
    return Computing.made(noise, async (mesh, positions) => [
      await scored(mesh, positions),
      await Computing.made({verb: 'smooth', method: 'explicit', mesh, values: {lambda: 0.5, iterations: this.steps.value()}}, scored),
      await Computing.made({verb: 'denoise', method: 'bilateral-normal', mesh, values: {iterations: this.rounds.value()}}, scored),
    ]);
  }

  async compute() {
    this.prepared ??= this.prepare();
    await this.prepared;
    const sigma = this.sigma.value();
    this.now = {sigma, found: await this.restored(sigma)};
  }

  /**
   * The normal error over the noise, which is kept until the steps, the rounds or the seed change.
   */
  async refine() {
    const key = [this.steps.value(), this.rounds.value(), this.seed].join();
    if (key === this.key) return;
    const curve = [];
    for (const sigma of [0.02, 0.06, 0.12, 0.2, 0.3, 0.42, 0.6]) {
      if (this.isStale) return;
      curve.push([sigma, ...(await this.restored(sigma)).map(({angle}) => angle)]);
    }
    [this.key, this.curve] = [key, curve];
    this.present();
  }

  show() {
    this.shown.forEach((stage, k) => {
      const {positions, angle, volume, creases} = this.now.found[k];
      const fact = (name, value) => element('span', {class: 'fact'}, `${name} `, element('b', {}, value));
      stage.facts.replaceChildren(
        fact('normal error', `${readable(angle, 2)}°`),
        fact('volume', `${Math.abs(volume) < 5e-13 ? '0' : readable(volume, 2)} %`),
        fact('creases, F-score', `${readable(creases, 2)} %`));
      const values = angles(positions, this.truth, this.faces);
      stage.show(positions, this.faces, this.ball, {flat: true, colors: {values, range: [0, 40], map: 'viridis', name: 'normal error', unit: '°'}});
    });
    this.result.textContent = this.verdict();
    this.plots.replaceChildren(this.plot(this.now.sigma));
  }

  verdict() {
    const [noisy, flow, filter] = this.now.found;
    const of = ({angle, volume, creases}) => `a normal error of ${readable(angle, 2)}°, creases with an F-score of ${readable(creases, 2)} % and a volume changed by ${Math.abs(volume) < 5e-13 ? '0' : readable(volume, 2)} %`;
    const least = Math.min(noisy.angle, flow.angle, filter.angle);
    const who = least === noisy.angle ? 'Neither helps here: the noisy part is closest to the truth'
      : `${least === filter.angle ? 'The filter' : 'Diffusion'} has the smallest normal error`;
    return `${who}. Diffusion has ${of(flow)}; the filter has ${of(filter)}.`;
  }

  plot(sigma) {
    const names = [['noisy', 'soft'], ['diffusion', 'explicit'], ['filter', 'filter']];
    return linePlot({
      size: [420, 150],
      label: 'normal error over the noise: of the noisy part, after diffusion and after the filter',
      x: {from: 0, to: 0.6, label: 'noise σ/h'},
      y: {from: 0, to: 80, label: 'normal error in degrees'},
      series: names.map(([name, kind], k) => ({name, kind, points: (this.curve ?? []).map((row) => [row[0], row[1 + k]])})),
      marks: [{at: sigma}],
      here: this.now.found.map(({angle}) => [sigma, Math.min(80, angle)]),
    });
  }

  about(v) {
    const off = this.now.found.map(({positions}) => Math.hypot(...[0, 1, 2].map((c) => positions[3 * v + c] - this.truth[3 * v + c])) / this.h);
    const [noisy, flow, filter] = off.map((x) => readable(x, 2));
    return `Distance from its true position: ${noisy} h (noisy), ${flow} h (diffusion) and ${filter} h (filter).`;
  }
}

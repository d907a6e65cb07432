import {Computing} from './computing.mjs';
import {element, readable} from '../../figure/viewer/dom.mjs';
import {factorPlot, factorWords} from './factors.mjs';
import {fitted} from './fitted.mjs';
import {sliderRow} from './plots.mjs';

/**
 * Explicit and implicit smoothing of a view's input, computed by the module, side
 * by side at the same λ and number of steps, so at equal diffusion time. The
 * input itself stays where it is.
 */
export class LiveFlows {
  /** For the first panel that is smoothed here; null if none is. */
  static of(panels, truth, changed) {
    const source = panels.find((panel) => panel.live);
    return source ? new LiveFlows(source, truth, changed) : null;
  }

  constructor(source, truth, changed) {
    [this.input] = source.stops;
    this.truth = truth;
    this.faces = source.faces;
    this.changed = changed;
    this.on = false;
    this.task = 0;
    this.results = {};
    const {vertices, faces} = source;
    this.panels = ['explicit', 'implicit'].map((flow) => (
      {flow, title: flow, vertices, faces, stops: [], fields: []}));
  }

  /** λ from 0.01 to 1000 and up to 100 steps, beginning just below the limit of closed meshes. */
  controls() {
    const run = () => this.run();
    const lambda = sliderRow('λ', {min: -2, max: 3, step: 0.01, value: 0.12}, (x) => `λ = ${readable(10 ** x)}`, run);
    const count = sliderRow('steps', {min: 0, max: 100, step: 1, value: 10}, (x) => `${x} steps`, run);
    this.rows = [lambda, count];
    [this.lambda, this.count] = [lambda.input, count.input];
    this.status = element('output', {class: 'status', 'aria-live': 'polite'});
    this.modes = element('div', {class: 'modes'});
    this.button = element('button', {type: 'button'}, 'smooth the input here');
    this.button.addEventListener('click', () => (this.on ? this.forget() : this.run()));
    for (const {row} of this.rows) row.classList.add('live');
    this.sliders = element('div', {class: 'sliders', hidden: true}, lambda.row, count.row);
    return [
      element('p', {class: 'hint'}, this.button, ' Explicit and implicit steps with uniform weights, computed in this page as you move. ', this.status),
      this.sliders,
      this.modes,
    ];
  }

  chosen() {
    return [10 ** Number(this.lambda.value), Number(this.count.value)];
  }

  /** Puts the results away. */
  forget() {
    this.sliders.hidden = true;
    if (!this.on) return;
    this.on = false;
    this.button.textContent = 'smooth the input here';
    this.status.textContent = '';
    this.modes.replaceChildren();
    this.changed();
  }

  /** The sliders as they were at first, and no results. */
  reset() {
    for (const input of [this.lambda, this.count]) input.value = input.defaultValue;
    this.forget();
  }

  /** Hands the input and the truth to the module. */
  async prepare() {
    this.mesh = await Computing.add(this.input, this.faces);
    if (this.truth) this.reference = await Computing.add(this.truth, this.faces);
    const {value} = await Computing.call({verb: 'info', mesh: this.mesh, roughest: true});
    this.roughest = -value.roughest_eigenvalue;
  }

  /** The result of a flow with its normal error, or null if it grows beyond all numbers. */
  async flown(method, values) {
    try {
      return await Computing.made({verb: 'smooth', method, mesh: this.mesh, values}, async (mesh, positions) => ({
        positions,
        angle: this.truth ? (await Computing.matching(mesh, this.reference)).normal_mean : null,
      }));
    } catch (error) {
      if (method === 'explicit' && !error.isCancelled) return null;
      throw error;
    }
  }

  /** Smooths with the values of the sliders; of changes meanwhile, the last one counts. */
  run() {
    this.task += 1;
    this.sliders.hidden = false;
    for (const {say} of this.rows) say();
    this.running ??= this.follow();
    return this.running;
  }

  async follow() {
    try {
      for (let task = 0; task !== this.task && !this.sliders.hidden;) {
        task = this.task;
        await this.smooth();
      }
    } catch (error) {
      this.status.textContent = `This could not be computed: ${error.message}.`;
    } finally {
      this.running = null;
    }
  }

  async smooth() {
    const [lambda, count] = this.chosen();
    this.prepared ??= this.prepare();
    await this.prepared;
    const start = performance.now();
    const values = {lambda, iterations: count};
    const explicit = await this.flown('explicit', {...values, unstable: 'allow'});
    const implicit = await this.flown('implicit', values);
    // The results may have been put away meanwhile.
    if (this.sliders.hidden) return;
    const took = performance.now() - start;
    const shown = (result) => ({...fitted(this.input, result?.positions), angle: result?.angle ?? null});
    this.results = {explicit: shown(explicit), implicit: shown(implicit)};
    this.on = true;
    this.shown = [lambda, count];
    this.button.textContent = 'back to the measured steps';
    const moved = (result) => (result ? readable(this.moved(result.positions)) : 'no number');
    this.status.textContent =
      `Moved by ${moved(explicit)} (explicit) and ${moved(implicit)} (implicit), RMS in mesh units; ${took.toFixed(0)} ms.`;
    this.modes.replaceChildren(...this.factors(lambda, count));
    this.changed();
  }

  moved(positions) {
    let sum = 0;
    for (let i = 0; i < positions.length; i++) sum += (positions[i] - this.input[i]) ** 2;
    return Math.sqrt((3 * sum) / positions.length);
  }

  drawn(flow) {
    return this.results[flow]?.positions ?? this.input;
  }

  titleOf(flow) {
    const [lambda, count] = this.shown;
    return `${flow}, ${count} × ${readable(lambda)}${this.results[flow]?.note ?? ''}`;
  }

  /** The factor of the roughest mode in words, and curves over all modes. */
  factors(lambda, count) {
    const limit = 2 / -this.roughest;
    const verdict = lambda > limit
      ? `λ is beyond the limit 2/|μ| = ${readable(limit)} of this mesh: the explicit factor is below −1 and the mode grows.`
      : `λ is below the limit 2/|μ| = ${readable(limit)} of this mesh: no mode grows.`;
    const words = `${factorWords(lambda, count, this.roughest)} ${verdict}`;
    return [element('p', {class: 'factors'}, words), factorPlot(lambda, this.roughest)];
  }

  toText() {
    return this.on ? `${this.lambda.value}~${this.count.value}` : '';
  }

  /** Smooths with the values in an address. */
  recall(text) {
    const [lambda, count] = (text ?? '').split('~').map(Number);
    if (!text || !Number.isFinite(lambda) || !Number.isInteger(count)) return;
    this.lambda.value = lambda;
    this.count.value = count;
    this.run();
  }
}

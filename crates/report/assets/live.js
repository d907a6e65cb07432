'use strict';

/**
 * Explicit and implicit smoothing of a view's input, computed in the page, side
 * by side at the same λ and number of steps, so at equal diffusion time. The
 * input itself stays where it is.
 */
class LiveFlows {
  /** For the first panel that brings its input along; null if none does. */
  static of(panels, changed) {
    const source = panels.find((panel) => panel.live);
    return source ? new LiveFlows(source, changed) : null;
  }

  constructor(source, changed) {
    this.smoother = new Smoother(source.live, source.faces);
    this.input = source.live;
    this.changed = changed;
    this.on = false;
    this.task = 0;
    this.results = {};
    const {vertices, faces, occlusion} = source;
    this.panels = ['explicit', 'implicit'].map((flow) => (
      {flow, title: flow, vertices, faces, occlusion, stops: [], fields: []}));
  }

  /** λ from 0.01 to 1000 and up to 100 steps, beginning just below the limit of closed meshes. */
  controls() {
    const range = (label, attributes) => element('input', {type: 'range', 'aria-label': label, ...attributes});
    this.lambda = range('λ', {min: -2, max: 3, step: 0.01, value: 0.12});
    this.count = range('steps', {min: 0, max: 100, step: 1, value: 10});
    this.lambdaText = element('output', {});
    this.countText = element('output', {});
    this.status = element('output', {class: 'status', 'aria-live': 'polite'});
    this.modes = element('div', {class: 'modes'});
    for (const input of [this.lambda, this.count]) input.addEventListener('input', () => this.run());
    const button = element('button', {type: 'button'}, 'smooth the input here');
    button.addEventListener('click', () => this.run());
    this.words();
    return [
      element('p', {class: 'hint'}, button, ' Explicit and implicit steps with uniform weights, computed in this page as you move. ', this.status),
      element('div', {class: 'slider live'}, this.lambdaText, this.lambda),
      element('div', {class: 'slider live'}, this.countText, this.count),
      this.modes,
    ];
  }

  chosen() {
    return [10 ** Number(this.lambda.value), Number(this.count.value)];
  }

  words() {
    const [lambda, count] = this.chosen();
    this.lambdaText.textContent = `λ = ${readable(lambda)}`;
    this.countText.textContent = `${count} steps`;
    this.lambda.setAttribute('aria-valuetext', readable(lambda));
    this.count.setAttribute('aria-valuetext', `${count} steps`);
  }

  /** Puts the results away. */
  forget() {
    this.task += 1;
    if (!this.on) return;
    this.on = false;
    this.status.textContent = '';
    this.modes.replaceChildren();
    this.changed();
  }

  async run() {
    const task = ++this.task;
    const [lambda, count] = this.chosen();
    this.words();
    const start = performance.now();
    const explicit = this.smoother.explicit(lambda, count);
    const implicit = await this.smoother.smooth(lambda, count, () => task !== this.task, (done) => {
      this.status.textContent = `step ${done} of ${count} …`;
    });
    if (!implicit) return;
    this.results = {explicit: this.fitted(explicit), implicit: this.fitted(implicit)};
    this.on = true;
    const took = performance.now() - start;
    const moved = (x) => (x ? readable(this.moved(x)) : 'no number');
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

  /** What has grown beyond three times the size of the input is drawn smaller, at its middle. */
  fitted(positions) {
    const size = (x) => {
      let sum = 0;
      const middle = [0, 1, 2].map((c) => {
        let s = 0;
        for (let i = c; i < x.length; i += 3) s += x[i];
        return (3 * s) / x.length;
      });
      for (let i = 0; i < x.length; i++) sum += (x[i] - middle[i % 3]) ** 2;
      return {middle, spread: Math.sqrt(sum / x.length)};
    };
    if (!positions) return {positions: this.input, note: ' has no number left'};
    const [before, after] = [size(this.input), size(positions)];
    const growth = after.spread / before.spread;
    if (!(growth > 3)) return {positions, note: ''};
    const drawn = positions.map((x, i) => before.middle[i % 3] + (x - after.middle[i % 3]) / growth);
    return {positions: drawn, note: ` (drawn 1 : ${readable(growth, 2)})`};
  }

  drawn(flow) {
    return this.results[flow]?.positions ?? this.input;
  }

  titleOf(flow) {
    const [lambda, count] = this.chosen();
    return `${flow}, ${count} × ${readable(lambda)}${this.results[flow]?.note ?? ''}`;
  }

  /** What one step does to the roughest mode, in words and as curves over all modes. */
  factors(lambda, count) {
    const mu = this.smoother.roughest();
    const limit = 2 / -mu;
    const [one, other] = [1 + lambda * mu, 1 / (1 - lambda * mu)];
    const verdict = lambda > limit
      ? `λ is beyond the limit 2/|μ| = ${readable(limit)} of this mesh: the explicit factor is below −1 and the mode grows.`
      : `λ is below the limit 2/|μ| = ${readable(limit)} of this mesh: no mode grows.`;
    const text = element('p', {class: 'factors'},
      `The roughest mode has μ = ${readable(mu)}. An explicit step multiplies it by 1 + λμ = ${readable(one)}, ` +
      `an implicit one by 1/(1 − λμ) = ${readable(other)}; ${count} steps by ${readable(one ** count)} and ${readable(other ** count)}. ${verdict}`);
    return [text, factorPlot(lambda, -mu)];
  }

  toText() {
    return this.on ? `${this.lambda.value}~${this.count.value}` : '';
  }

  /** Smooths as the address says. */
  recall(text) {
    const [lambda, count] = (text ?? '').split('~').map(Number);
    if (!text || !Number.isFinite(lambda) || !Number.isInteger(count)) return;
    this.lambda.value = lambda;
    this.count.value = count;
    this.run();
  }
}

/** The factors of one step over −μ, from constant functions to the roughest mode of any mesh, 2. */
function factorPlot(lambda, roughest) {
  const space = 'http://www.w3.org/2000/svg';
  const svg = document.createElementNS(space, 'svg');
  const [width, height] = [420, 180];
  svg.setAttribute('viewBox', `-40 -8 ${width + 130} ${height + 36}`);
  svg.setAttribute('role', 'img');
  svg.setAttribute('aria-label', 'factor of one step over the eigenvalue: a falling line for explicit steps, a curve that stays positive for implicit ones');
  svg.setAttribute('class', 'plot');
  const add = (name, attributes, text = '') => {
    const made = document.createElementNS(space, name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    made.textContent = text;
    svg.append(made);
  };
  const x = (m) => (width * m) / 2;
  const y = (f) => (height * (1.5 - Math.max(-1.5, Math.min(1.5, f)))) / 3;
  add('rect', {class: 'stable', x: 0, y: y(1), width, height: y(-1) - y(1)});
  for (const f of [-1, 0, 1]) {
    add('path', {class: 'grid', d: `M0 ${y(f)}H${width}`});
    add('text', {x: -6, y: y(f) + 4, 'text-anchor': 'end'}, readable(f));
  }
  for (const m of [0, 0.5, 1, 1.5, 2]) add('text', {x: x(m), y: height + 16, 'text-anchor': 'middle'}, readable(m));
  add('text', {x: width / 2, y: height + 28, 'text-anchor': 'middle'}, '−μ, smooth to rough');
  add('path', {class: 'mark', d: `M${x(roughest)} 0V${height}`});
  const curves = {explicit: (m) => 1 - lambda * m, implicit: (m) => 1 / (1 + lambda * m)};
  for (const [name, factor] of Object.entries(curves)) {
    const points = Array.from({length: 101}, (_, i) => `${x(i / 50).toFixed(1)} ${y(factor(i / 50)).toFixed(1)}`);
    add('path', {class: `curve ${name}`, d: `M${points.join('L')}`});
    add('text', {class: name, x: width + 4, y: y(factor(2)) + 4}, name);
  }
  return svg;
}

import {Camera} from '../../figure/viewer/camera.mjs';
import {element, picture, readable} from '../../figure/viewer/dom.mjs';
import {ring} from '../../figure/viewer/pictures.mjs';
import {Playground} from './playground.mjs';
import {linePlot} from './plots.mjs';
import {octasphere} from './surfaces.mjs';

/**
 * The ellipsoid of question 2: normal curvature at (a, 0, 0), right and as the original report has
 * it.
 */
export class EllipsoidPlayground extends Playground {
  build() {
    this.camera = new Camera(58, 22, true);
    const axis = (name, value) => this.slider(name, {min: 0.4, max: 2.5, step: 0.05, value}, (x) => `${name} = ${readable(x)}`);
    this.axes = [axis('a', 2), axis('b', 1), axis('c', 0.7)];
    this.angle = this.slider('direction', {min: 0, max: 180, step: 1, value: 0}, (x) => `direction ${readable(x)}° from y to z`);
    this.solid = this.stage('the ellipsoid', 'An ellipsoid with the circle that fits it best at the end of its first axis.');
    this.plots = element('div', {class: 'panels'});
    this.result = element('p', {class: 'factors', 'aria-live': 'polite'});
    this.ball = octasphere(24);
    return [
      element('div', {class: 'panels'}, this.solid.panel, this.plots), this.result,
      ...[...this.axes, this.angle].map(({row}) => row),
    ];
  }

  /**
   * The curvature at (a, 0, 0) in a direction, inward normal: ours, and from the coefficients L = M
   * = 0, N = −c, G = c².
   */
  curvatures(theta) {
    const [a, b, c] = this.axes.map((axis) => axis.value());
    const [cos, sin] = [Math.cos(theta), Math.sin(theta)];
    return {exact: a * ((cos / b) ** 2 + (sin / c) ** 2), source: -(cos ** 2) / c};
  }

  show() {
    this.now = {};
    const [a, b, c] = this.axes.map((axis) => axis.value());
    const theta = (this.angle.value() * Math.PI) / 180;
    const {exact, source} = this.curvatures(theta);
    const positions = this.ball.positions.map((x, i) => x * [a, b, c][i % 3]);
    const radius = Math.max(a, b, c);
    const [cos, sin] = [Math.cos(theta), Math.sin(theta)];
    // The section of the plane through the normal and the direction is an ellipse with these half
    // axes.
    const across = 1 / Math.sqrt((cos / b) ** 2 + (sin / c) ** 2);
    const at = (x, s) => [x / radius, (s * cos) / radius, (s * sin) / radius];
    const around = (f) => Array.from({length: 97}, (_, i) => f((2 * Math.PI * i) / 96));
    const section = (t) => [a * Math.cos(t), across * Math.sin(t)];
    const circle = (kappa) => (t) => [a - 1 / kappa + Math.cos(t) / kappa, Math.sin(t) / kappa];
    const theirs = Math.abs(source) > 0.02 ? circle(Math.abs(source)) : null;
    this.solid.show(positions, this.ball.faces, {center: [0, 0, 0], radius}, {
      over: (stage) => {
        const path = (f) => around(f).map(([x, s]) => at(x, s));
        stage.line(path(section), 'rgb(90 90 90 / 0.8)', 1.5);
        stage.line(path(circle(exact)), '#2f7de1', 3);
        if (theirs) stage.line(path(theirs), '#d9403a', 2, [6, 4]);
        const length = 0.45 * radius;
        stage.line([at(a, 0), at(a, length)], '#2f7de1', 4);
        ring(stage.target, this.camera.place(at(a, 0), stage.canvas.width, stage.canvas.height), this.pixel);
      },
    });
    this.plots.replaceChildren(this.flat(section, circle(exact), theirs, around), this.curves(theta));
    const off = Math.abs(Math.abs(source) / exact - 1);
    this.result.textContent =
      `The curvature in this direction is a(cos²θ/b² + sin²θ/c²) = ${readable(exact)}: the circle that fits has radius ${readable(1 / exact)}. ` +
      (Math.abs(source) < 1e-3
        ? 'The original report’s coefficients give 0: no circle at all.'
        : `The original report’s coefficients give ${readable(source)}, radius ${readable(1 / Math.abs(source))}: ` +
          (off < 5e-3 ? 'the same size.' : `${readable(100 * off, 2)} % off in size.`));
  }

  /** The section plane itself, both circles at scale. */
  flat(section, ours, theirs, around) {
    const all = around(section);
    const [width, height] = [0, 1].map((k) => Math.max(...all.map((p) => Math.abs(p[k]))));
    // One and a half times as wide as high, as the picture beside it.
    const size = 1.15 * Math.max(width / 1.5, height);
    const {svg, add} = picture(`${-1.5 * size} ${-size} ${3 * size} ${2 * size}`, 'the section along the normal, with the circle that fits and that of the original report', 'plot square');
    const path = (f, kind) => add('path', {class: `curve ${kind}`, 'vector-effect': 'non-scaling-stroke', d: `M${around(f).map(([x, s]) => `${x.toFixed(4)} ${(-s).toFixed(4)}`).join('L')}`});
    path(section, 'soft');
    path(ours, 'blue');
    if (theirs) path(theirs, 'red dashed');
    return element('div', {class: 'panel'}, element('p', {class: 'title'}, 'the section along the normal'), svg);
  }

  curves(theta) {
    const steps = Array.from({length: 73}, (_, i) => (Math.PI * i) / 72);
    const [exact, source] = ['exact', 'source'].map((name) => steps.map((t) => [(180 * t) / Math.PI, this.curvatures(t)[name]]));
    const here = (180 * theta) / Math.PI;
    const now = this.curvatures(theta);
    const values = [...exact, ...source].map(([, k]) => k);
    const [low, high] = [Math.min(...values), Math.max(...values)];
    const margin = 0.08 * (high - low);
    const plot = linePlot({
      label: 'normal curvature over the direction: two curves that differ',
      size: [225, 200],
      x: {from: 0, to: 180, label: 'direction in degrees, y at 0, z at 90'},
      y: {from: low - margin, to: high + margin, label: 'κₙ'},
      series: [{name: 'right', kind: 'blue', points: exact}, {name: 'original', kind: 'red dashed', points: source}],
      marks: [{at: here}],
      here: [[here, now.exact], [here, now.source]],
    });
    return element('div', {class: 'panel'}, element('p', {class: 'title'}, 'over all directions'), plot);
  }

  about(v) {
    const [x, y, z] = [0, 1, 2].map((k) => this.ball.positions[3 * v + k] * this.axes[k].value());
    const [a, b, c] = this.axes.map((axis) => axis.value());
    const s = (x / a ** 2) ** 2 + (y / b ** 2) ** 2 + (z / c ** 2) ** 2;
    const gaussian = 1 / ((a * b * c) ** 2 * s ** 2);
    const mean = (a ** 2 + b ** 2 + c ** 2 - x ** 2 - y ** 2 - z ** 2) / (2 * (a * b * c) ** 2 * s ** 1.5);
    return `Here H = ${readable(mean)} and K = ${readable(gaussian)}.`;
  }
}

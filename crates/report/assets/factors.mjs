import {readable} from '../../figure/viewer/dom.mjs';
import {linePlot} from './plots.mjs';

/** The factor of one step for the mode of an eigenvalue μ ≤ 0, by flow. */
export function factorsOf(lambda) {
  return {explicit: (mu) => 1 + lambda * mu, implicit: (mu) => 1 / (1 - lambda * mu)};
}

/** The factor of the roughest mode after some steps, in words. */
export function factorWords(lambda, count, mu) {
  const [one, other] = Object.values(factorsOf(lambda)).map((factor) => factor(mu));
  return `The roughest mode has μ = ${readable(mu)}. An explicit step multiplies it by 1 + λμ = ${readable(one)}, an implicit one by 1/(1 − λμ) = ${readable(other)}; ` +
    `${count} steps by ${readable(one ** count)} and ${readable(other ** count)}.`;
}

/**
 * The factors of one step over |μ|, from constant functions to the roughest mode of any mesh, 2.
 */
export function factorPlot(lambda, mu) {
  const along = Array.from({length: 101}, (_, i) => i / 50);
  const factors = Object.entries(factorsOf(lambda));
  return linePlot({
    size: [420, 165],
    label: 'factor of one step over the size of the eigenvalue: a falling line for explicit steps, a curve that stays positive for implicit ones',
    x: {from: 0, to: 2, label: '|μ|, smooth to rough'},
    y: {from: -2, to: 1.2, label: 'factor of one step'},
    band: [-1, 1],
    series: factors.map(([name, factor]) => ({name, kind: name, points: along.map((m) => [m, factor(-m)])})),
    marks: [{at: -mu, words: 'roughest'}],
    here: factors.map(([, factor]) => [-mu, Math.max(-2, factor(mu))]),
  });
}

import {readable} from '../../figure/viewer/dom.mjs';

/** The middle of positions and the root mean square distance from it. */
function spread(positions) {
  const middle = [0, 0, 0];
  positions.forEach((x, i) => { middle[i % 3] += (3 * x) / positions.length; });
  let sum = 0;
  positions.forEach((x, i) => { sum += (x - middle[i % 3]) ** 2; });
  return {middle, size: Math.sqrt((3 * sum) / positions.length)};
}

/**
 * Positions as they are drawn: those that have grown beyond three times the size of the input, or
 * shrunk below this part of it, at its middle in its size; the words say so.
 */
export function fitted(input, positions, least = 0) {
  if (!positions || !positions.every(Number.isFinite)) return {positions: input, note: ' has overflowed'};
  const [before, after] = [spread(input), spread(positions)];
  const growth = after.size / before.size;
  if (growth <= 3 && growth >= least) return {positions, note: ''};
  const drawn = positions.map((x, i) => before.middle[i % 3] + (x - after.middle[i % 3]) / growth);
  return {positions: drawn, note: growth > 1 ? ` (drawn 1 : ${readable(growth, 2)})` : ` (drawn ×${readable(1 / growth, 2)})`};
}

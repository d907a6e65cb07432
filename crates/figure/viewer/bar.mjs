import {picture, readable, roundValues} from './dom.mjs';

/**
 * A colour bar with the histogram of what it shows standing on it; values beyond the ends are
 * counted in words. `across` is the width of its place: in a narrow one the bar is shorter, and its
 * words keep their size.
 */
export function colorBar({values, range, lookup, name, unit, across = 408}) {
  const [low, high] = range;
  const bins = 90;
  const counts = new Array(bins).fill(0);
  let [below, above, undefinedCount] = [0, 0, 0];
  for (const x of values) {
    if (!Number.isFinite(x)) undefinedCount += 1;
    else if (x < low) below += 1;
    else if (x > high) above += 1;
    else counts[Math.min(bins - 1, Math.floor(((x - low) / (high - low)) * bins))] += 1;
  }
  const tallest = Math.max(1, ...counts);
  const width = Math.max(160, Math.min(360, across - 48));
  const words = unit ? ` (${unit})` : '';
  const label = `colour bar: ${name}${words} from ${readable(low)} to ${readable(high)}`;
  const beyond = [
    below && `${below} below`,
    above && `${above} above`,
    undefinedCount && `${undefinedCount} undefined`,
  ].filter(Boolean).join(', ');
  const title = `${name}${words}`;
  // About six and a half pixels a letter.
  const fits = 6.5 * (title.length + beyond.length + 3) < width + 48;
  const lines = beyond && !fits ? [title, beyond] : [[title, beyond].filter(Boolean).join(' · ')];
  const {svg, add} = picture(`-24 0 ${width + 48} ${62 + 14 * lines.length}`, label, 'colors');
  counts.forEach((count, i) => {
    const h = (24 * count) / tallest;
    add('rect', {class: 'count', x: (width * i) / bins, y: 25 - h, width: width / bins - 0.4, height: h});
  });
  const strip = (t) => {
    const k = 3 * Math.min(1023, Math.round(t * 1023));
    return `rgb(${lookup[k]} ${lookup[k + 1]} ${lookup[k + 2]})`;
  };
  const steps = 180;
  for (let i = 0; i < steps; i++) {
    add('rect', {x: (width * i) / steps, y: 26, width: width / steps + (i + 1 < steps ? 0.5 : 0), height: 12, fill: strip((i + 0.5) / steps), 'shape-rendering': 'crispEdges'});
  }
  if (below) add('path', {d: 'M0 26L-9 32L0 38Z', fill: strip(0)});
  if (above) add('path', {d: `M${width} 26l9 6l-9 6Z`, fill: strip(1)});
  for (const x of roundValues(low, high, width < 300 ? 3 : 5)) {
    const at = (width * (x - low)) / (high - low);
    add('path', {class: 'tick', d: `M${at} 38v4`});
    add('text', {x: at, y: 54, 'text-anchor': 'middle'}, readable(x));
  }
  lines.forEach((line, i) => add('text', {class: 'name', x: width / 2, y: 71 + 14 * i, 'text-anchor': 'middle'}, line));
  return svg;
}

'use strict';

/** Round values, about `wanted` of them. */
function roundValues(low, high, wanted) {
  const raw = (high - low) / wanted;
  const decade = 10 ** Math.floor(Math.log10(raw));
  const step = decade * ([1, 2, 5, 10].find((m) => m * decade >= 0.75 * raw) ?? 10);
  const values = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i++) {
    values.push(Number((i * step).toPrecision(12)));
  }
  return values;
}

/**
 * The colour bar of a panel, with the histogram of what it shows standing on
 * it; values beyond the ends are counted in words.
 */
function drawBar(view, mesh) {
  const values = view.values(mesh);
  if (!values) return [];
  const field = view.field(mesh);
  const [low, high] = view.range();
  const colors = view.lookup();
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
  const space = 'http://www.w3.org/2000/svg';
  const svg = document.createElementNS(space, 'svg');
  const width = 360;
  const add = (name, attributes, text = '') => {
    const made = document.createElementNS(space, name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    made.textContent = text;
    svg.append(made);
  };
  svg.setAttribute('viewBox', `-24 0 ${width + 48} 76`);
  svg.setAttribute('role', 'img');
  const unit = field.unit ? ` (${field.unit})` : '';
  svg.setAttribute('aria-label', `colour bar: ${field.name}${unit} from ${readable(low)} to ${readable(high)}`);
  counts.forEach((count, i) => {
    const h = (24 * count) / tallest;
    add('rect', {class: 'count', x: (width * i) / bins, y: 25 - h, width: width / bins - 0.4, height: h});
  });
  const strip = (t) => {
    const k = 3 * Math.min(1023, Math.round(t * 1023));
    return `rgb(${colors[k]} ${colors[k + 1]} ${colors[k + 2]})`;
  };
  const steps = 180;
  for (let i = 0; i < steps; i++) {
    add('rect', {x: (width * i) / steps, y: 26, width: width / steps + (i + 1 < steps ? 0.5 : 0), height: 12, fill: strip((i + 0.5) / steps), 'shape-rendering': 'crispEdges'});
  }
  if (below) add('path', {d: 'M0 26L-9 32L0 38Z', fill: strip(0)});
  if (above) add('path', {d: `M${width} 26l9 6l-9 6Z`, fill: strip(1)});
  const few = view.state.even ? view.distinct(low, high, 6) : null;
  for (const x of few?.length ? few : roundValues(low, high, 5)) {
    const at = (width * (x - low)) / (high - low);
    add('path', {class: 'tick', d: `M${at} 38v4`});
    add('text', {x: at, y: 54, 'text-anchor': 'middle'}, readable(x));
  }
  const beyond = [
    below && `${below} below`,
    above && `${above} above`,
    undefinedCount && `${undefinedCount} undefined`,
  ].filter(Boolean);
  const words = `${field.name}${unit}${view.state.even ? ', equalised' : ''}${beyond.length ? ` · ${beyond.join(', ')}` : ''}`;
  add('text', {class: 'name', x: width / 2, y: 71, 'text-anchor': 'middle'}, words);
  return [svg];
}

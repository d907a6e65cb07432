import {element, picture, readable, roundValues, superscript} from '../../figure/viewer/dom.mjs';

/** A slider with its words before it; `read` turns its position into words. */
export function sliderRow(label, attributes, read, changed) {
  const input = element('input', {type: 'range', 'aria-label': label, ...attributes});
  const words = element('output', {});
  const say = () => {
    words.textContent = read(Number(input.value));
    input.setAttribute('aria-valuetext', words.textContent);
  };
  input.addEventListener('input', () => {
    say();
    changed();
  });
  say();
  const row = element('div', {class: 'slider'}, words, input);
  return {row, input, say, value: () => Number(input.value)};
}

/** A power of ten. */
function powerOfTen(x) {
  return `10${superscript(Math.round(Math.log10(x)))}`;
}

/**
 * Lines over one axis, each labelled at its end. `x` and `y`: `from`, `to`, `label`, `log`. A
 * series has `name`, `points`, `kind` (a class of the style sheet) and perhaps `dots` instead of a
 * line. `marks` are vertical lines with words, `band` is a range of y with a ground of its own,
 * `here` a point that is ringed.
 */
export function linePlot({label, x, y, series, marks = [], band = null, here = [], size = [420, 200]}) {
  // On a telephone words would be too small in a wide picture.
  const [width, height] = innerWidth < 600 ? [215, 170] : size;
  const longest = Math.max(...series.map(({name}) => name.length));
  const {svg, add} = picture(`-52 -16 ${width + 72 + 7 * longest} ${height + 56}`, label);
  const scale = ({from, to, log}, length) => {
    const f = log ? Math.log10 : (t) => t;
    const [a, b] = [f(from), f(to)];
    return (t) => (length * (f(Math.max(log ? 1e-300 : -Infinity, t)) - a)) / (b - a);
  };
  const [along, above] = [scale(x, width), scale(y, height)];
  const clamp = (t) => Math.max(-0.02 * height, Math.min(1.02 * height, t));
  const [px, py] = [along, (t) => height - clamp(above(t))];
  const ticks = ({from, to, log}, wanted) => {
    if (!log) return roundValues(from, to, wanted);
    const [a, b] = [from, to].map((t) => Math.log10(t));
    const step = Math.max(1, Math.ceil((b - a) / wanted));
    const all = [];
    for (let e = Math.ceil(a - 1e-9); e <= b + 1e-9; e += step) all.push(10 ** e);
    return all;
  };
  const written = ({log}, t) => (log && (t < 1e-2 || t > 1e3) ? powerOfTen(t) : readable(t));
  const inside = (t, {from, to}) => t >= from - 1e-9 * Math.abs(from) && t <= to + 1e-9 * Math.abs(to);
  if (band) add('rect', {class: 'stable', x: 0, y: py(band[1]), width, height: py(band[0]) - py(band[1])});
  for (const t of ticks(y, 4)) {
    add('path', {class: 'grid', d: `M0 ${py(t)}H${width}`});
    add('text', {x: -6, y: py(t) + 4, 'text-anchor': 'end'}, written(y, t));
  }
  for (const t of ticks(x, width < 300 ? 3 : 5)) add('text', {x: px(t), y: height + 16, 'text-anchor': 'middle'}, written(x, t));
  add('text', {class: 'name', x: width / 2, y: height + 34, 'text-anchor': 'middle'}, x.label);
  add('text', {class: 'name', x: -46, y: -6}, y.label);
  for (const {at, words} of marks) {
    add('path', {class: 'mark', d: `M${px(at)} 0V${height}`});
    if (words) add('text', {x: px(at) + 3, y: 10}, words);
  }
  const ends = [];
  for (const {name, points, kind, dots} of series) {
    const kept = points.filter(([s, t]) => Number.isFinite(s) && Number.isFinite(t) && !(y.log && t <= 0));
    if (dots) {
      for (const [s, t] of kept.filter(([, t]) => inside(t, y))) add('circle', {class: `dot ${kind}`, cx: px(s), cy: py(t), r: 2});
    } else if (kept.length) {
      add('path', {class: `curve ${kind}`, d: `M${kept.map(([s, t]) => `${px(s).toFixed(1)} ${py(t).toFixed(1)}`).join('L')}`});
    }
    if (kept.length) ends.push({name, kind, at: py(kept.at(-1)[1])});
  }
  // Labels keep their order and do not cover one another.
  ends.sort((a, b) => a.at - b.at);
  for (let i = 1; i < ends.length; i++) ends[i].at = Math.max(ends[i].at, ends[i - 1].at + 14);
  for (let i = ends.length - 1, most = height + 6; i >= 0; i--) {
    ends[i].at = Math.min(ends[i].at, most);
    most = ends[i].at - 14;
  }
  for (const {name, kind, at} of ends) add('text', {class: kind, x: width + 5, y: at + 4}, name);
  for (const [s, t] of here) add('circle', {class: 'here', cx: px(s), cy: py(t), r: 4.5});
  return svg;
}

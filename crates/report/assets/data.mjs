import {unzipped} from '../../figure/viewer/bytes.mjs';

/** The view that a figure of the page carries, with its arrays in place. */
export async function viewIn(figure) {
  const {arrays, panels, truth, ...view} = JSON.parse(figure.querySelector('script.data').textContent);
  const buffers = await Promise.all(arrays.map(unzipped));
  const known = new Map();
  const once = (key, make) => {
    if (!known.has(key)) known.set(key, make());
    return known.get(key);
  };
  const floats = (index) => (index === null ? null : once(index, () => new Float32Array(buffers[index])));
  const integers = (index) => once(`${index} faces`, () => new Uint32Array(buffers[index]));
  /** Positions after the first ones are displacements from those. */
  const moved = (first, index) => once(`${first} ${index}`, () => floats(index).map((x, i) => x + floats(first)[i]));
  const stops = ([first, ...others]) => [floats(first), ...others.map((index) => moved(first, index))];
  const decoded = panels.map((panel) => ({
    ...panel,
    faces: integers(panel.faces),
    stops: stops(panel.positions),
    fields: panel.fields.map((field) => ({...field, stops: field.values.map(floats), exact: floats(field.exact)})),
    modes: panel.modes && {...panel.modes, vectors: panel.modes.vectors.map(floats)},
  }));
  return {...view, panels: decoded, truth: floats(truth)};
}

/** The entry of a combination of stops, in a list with one for each or one for all. */
export function stopOf(list, at) {
  return list[Math.min(at, list.length - 1)];
}

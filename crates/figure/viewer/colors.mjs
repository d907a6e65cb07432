import {bytesOf} from './bytes.mjs';

/** The number of colours of the renderer and of colour bars. */
const COLORS = 1024;
/** The most values from which a range is estimated. */
const SAMPLED = 200_000;

/** The colour maps of the page by name, as RGB bytes. */
export function colorMaps() {
  const maps = Object.entries(JSON.parse(document.getElementById('colour-maps').textContent));
  return Object.fromEntries(maps.map(([name, text]) => [name, bytesOf(text)]));
}

const lookups = new WeakMap();

/** The colours of a map. */
export function lookupOf(map) {
  if (!lookups.has(map)) {
    const colors = new Uint8Array(3 * COLORS);
    for (let i = 0; i < COLORS; i++) {
      const k = 3 * Math.round((i / (COLORS - 1)) * (map.length / 3 - 1));
      colors.set(map.subarray(k, k + 3), 3 * i);
    }
    lookups.set(map, colors);
  }
  return lookups.get(map);
}

/**
 * The least and greatest of most values: the 2nd and 98th percentile, about zero if they are
 * `signed`, which they are where there are both signs unless it is given. Of many values every
 * second or third one counts.
 */
export function rangeOf(lists, signed = null) {
  const step = Math.ceil(lists.reduce((sum, {length}) => sum + length, 0) / SAMPLED);
  const size = lists.reduce((sum, {length}) => sum + Math.ceil(length / step), 0);
  const sorted = new Float64Array(size);
  let count = 0;
  for (const values of lists) {
    for (let i = 0; i < values.length; i += step) {
      if (Number.isFinite(values[i])) sorted[count++] = values[i];
    }
  }
  if (!count) return [0, 1];
  sorted.subarray(0, count).sort();
  const at = (part) => sorted[Math.round(part * (count - 1))];
  let [low, high] = [at(0.02), at(0.98)];
  if (signed ?? (low < 0 && high > 0)) {
    high = Math.max(Math.abs(low), Math.abs(high));
    low = -high;
  }
  if (!(low < high)) {
    [low, high] = [low - 0.5 * (Math.abs(low) || 1), high + 0.5 * (Math.abs(high) || 1)];
  }
  return [low, high].map((x) => Number(x.toPrecision(3)));
}

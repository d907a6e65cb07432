import {readable} from '../../../figure/viewer/dom.mjs';

/** Fields that a curvature sets, and that fit no other positions. */
export const CURVATURE = ['mean', 'gaussian', 'kappa1', 'kappa2', 'mean_error', 'gaussian_error', 'scale',
  'defined', 'boundary', 'direction1', 'direction2'];

/** Names and units of fields. */
const LABELS = {
  mean: ['mean curvature', '1/file unit'],
  gaussian: ['Gaussian curvature', '1/file unit²'],
  kappa1: ['principal curvature κ₁', '1/file unit'],
  kappa2: ['principal curvature κ₂', '1/file unit'],
  mean_error: ['standard error of H', '1/file unit'],
  gaussian_error: ['standard error of K', '1/file unit²'],
  scale: ['radius with the largest weight in H', 'file units'],
  distance: ['geodesic distance', 'file units'],
  source: ['vertex before the repair', ''],
};

/** The name and the unit of a field that was computed. */
export function labelled(name) {
  return LABELS[name] ?? [name, ''];
}

/** A score with its unit. */
export function measured(value, unit) {
  if (unit === 'relative') return `${readable(100 * value)} %`;
  return `${readable(value)} ${{count: '', diagonal: 'diagonals'}[unit] ?? unit}`.trim();
}

/** Formats that change positions or connectivity. */
const ROUNDED = {
  STL: 'STL rounds positions to 32 bits and repeats shared vertices.',
  GLB: 'GLB rounds positions and fields to 32 bits.',
};

/** The contents that a format leaves out or rounds, in a sentence; empty if it keeps all. */
export function leftOut(format, names, labelled) {
  const fields = names.length ? `${format} leaves out: ${names.map((name) => labelled(name)[0]).join(', ')}.` : '';
  return [ROUNDED[format], fields].filter(Boolean).join(' ');
}

/** Fields of the file whose places computed ones have taken, in a sentence. */
export function replacing(names) {
  return names.length ? `Replaced fields of the file: ${names.join(', ')}.` : '';
}

const KINDS = {
  creased: 'The surface has sharp edges.',
  smooth: 'The surface has few sharp edges or none.',
  clean: 'No noise was found, and no vertex was moved.',
  uneven: 'The faces are too uneven for their normals to determine positions, and no vertex was moved.',
};

/** A sentence of the counts of elements, by the names of steps. */
function counted(verb, counts) {
  const each = Object.entries(counts).map(([name, count]) => `${name.replaceAll('-', ' ')}: ${count}`);
  return each.length && `${verb} ${each.join(', ')}.`;
}

/** Sentences about the entries of reports; empty if there is nothing to report. */
const SENTENCES = {
  iterations: (count) => `${count} ${count === 1 ? 'step' : 'steps'}.`,
  stopped: (is) => is && 'The flow ended before its last step.',
  stable_limit: (limit) => limit && `The largest stable step is ${readable(limit)}.`,
  unstable: (is) => is && 'The steps are beyond the stable limit.',
  too_thin: (face) => face !== null && `Face ${face} is too thin for cotangents, so the robust Laplacian was used.`,
  degenerate_faces: (count) => count && `${count} faces became degenerate.`,
  sigma: (sigma) => `The standard deviation of the noise is ${readable(sigma)} file units.`,
  displacement: (length) => `The vertices moved by ${readable(length)} file units (root mean square).`,
  split: (split) => split && 'The number of modes splits a group of equal eigenvalues.',
  noise: (noise) => noise && `Estimated standard deviation of the noise: ${readable(noise.sigma)} file units.`,
  kind: (kind) => KINDS[kind],
  spikes: (count) => count && `${count} ${count === 1 ? 'spike was' : 'spikes were'} moved back to the surface.`,
  uneven_vertices: (count) => count && `${count} vertices among uneven faces were not moved.`,
  displacement_limit: (length) => `No vertex moved by more than ${readable(length)} file units.`,
  unchanged: (is) => is && 'There was nothing to repair.',
  flat: (reason) => reason && `The patches of holes stay flat: ${reason}.`,
  changes: (changes) => counted('Repaired', changes),
  left: (left) => counted('Left', left),
};

/** The report of a task, in sentences. */
export function reported(report) {
  const sentences = Object.entries(report ?? {}).map(([name, value]) => SENTENCES[name]?.(value));
  return sentences.filter(Boolean).join(' ');
}

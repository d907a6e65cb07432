import {Computing} from './computing.mjs';
import {normals} from '../../figure/viewer/geometry.mjs';

/**
 * Fields that follow from positions: how far vertices moved, how far they are off the truth, and
 * mean curvature, which the module computes. `from` of a view is the panel from which displacement
 * counts, `truth` the true positions.
 */

/** Of each vertex, something of three coordinates of two meshes. */
const pairs = (a, b, f) => Float32Array.from({length: a.length / 3}, (_, v) => f(a, b, 3 * v));
const distance = (a, b, i) => Math.hypot(a[i] - b[i], a[i + 1] - b[i + 1], a[i + 2] - b[i + 2]);

/** Along the normals of the truth, positive outside. */
function off(positions, truth, faces) {
  const along = normals(truth, faces);
  return pairs(positions, truth, (a, b, i) => (
    (a[i] - b[i]) * along[i] + (a[i + 1] - b[i + 1]) * along[i + 1] + (a[i + 2] - b[i + 2]) * along[i + 2]));
}

/** Between the normals at vertices, in degrees. */
export function angles(positions, truth, faces) {
  const [n, m] = [positions, truth].map((p) => normals(p, faces));
  return pairs(n, m, (a, b, i) => {
    const cosine = a[i] * b[i] + a[i + 1] * b[i + 1] + a[i + 2] * b[i + 2];
    return (180 * Math.acos(Math.max(-1, Math.min(1, cosine)))) / Math.PI;
  });
}

/** Mean curvature by positions, as far as it is known. */
const curvatures = new WeakMap();
const asked = new WeakMap();

async function meanCurvature(positions, faces) {
  const mesh = await Computing.add(positions, faces);
  const {mean} = await Computing.curvature(mesh);
  await Computing.drop(mesh);
  return Float32Array.from(mean);
}

/**
 * What a view can be coloured by beyond the fields that it brings along. A field with `ask` is
 * computed by it first, which returns whether there is something new.
 */
export function fieldsOf({from, truth, panels, fields: own}, meshes) {
  const all = [];
  const add = (name, unit, signed, values) => all.push({name, unit, signed, derived: values});
  const reference = (view) => view.positions(meshes[from]);
  if (from !== undefined) {
    add('displacement', 'mesh units', false, (view, mesh) => pairs(view.positions(mesh), reference(view), distance));
  }
  if (truth !== undefined) {
    add('distance off the truth', 'mesh units', true, (view, mesh) => off(view.positions(mesh), view.truth, mesh.faces));
    add('normal error', '°', false, (view, mesh) => angles(view.positions(mesh), view.truth, mesh.faces));
  }
  for (const field of own) {
    if (!panels.some((p) => p.fields.some((f) => f.name === field.name && f.exact))) continue;
    add(`error of ${field.name}`, field.unit, true, (view, mesh) => {
      const given = mesh.fields.find((f) => f.name === field.name);
      return given?.exact ? view.valuesOf(given).map((x, v) => x - given.exact[v]) : null;
    });
  }
  if (!own.some((f) => f.name.startsWith('mean curvature'))) {
    add('mean curvature', '1/mesh units', true, (view, mesh) => curvatures.get(view.positions(mesh)) ?? null);
    all.at(-1).ask = async (view, mesh) => {
      const positions = view.positions(mesh);
      if (curvatures.has(positions)) return false;
      if (!asked.has(positions)) asked.set(positions, meanCurvature(positions, mesh.faces));
      curvatures.set(positions, await asked.get(positions));
      return true;
    };
  }
  return all;
}

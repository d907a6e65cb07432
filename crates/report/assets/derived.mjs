import {Computing} from './computing.mjs';
import {stopOf} from './data.mjs';
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
 * The fields of a view by name: the mode that is added, the fields in the data, and those that
 * follow from them and from positions. A field has a function `values` of a panel and a combination
 * of stops, which returns null if the panel lacks the field. If it has `ask`, this computes the
 * values first, and returns true if there are new ones.
 */
export function fieldsOf(view) {
  const {from, truth, panels} = view.description;
  const own = panels.flatMap(({fields}) => fields);
  const ownOf = (mesh, name) => mesh.fields.find((field) => field.name === name);
  const all = view.sum ? [view.sum.field()] : [];
  for (const {name, unit, signed} of own) {
    all.push({name, unit, signed, values: (mesh, at) => {
      const field = ownOf(mesh, name);
      return field ? stopOf(field.stops, at) : null;
    }});
  }
  if (from !== null) {
    const reference = (at) => view.positions(panels[from], at);
    all.push({name: 'displacement', unit: 'mesh units', signed: false, values: (mesh, at) => (
      pairs(view.positions(mesh, at), reference(at), distance))});
  }
  if (truth) {
    all.push({name: 'distance off the truth', unit: 'mesh units', signed: true, values: (mesh, at) => (
      off(view.positions(mesh, at), truth, mesh.faces))});
    all.push({name: 'normal error', unit: '°', signed: false, values: (mesh, at) => (
      angles(view.positions(mesh, at), truth, mesh.faces))});
  }
  for (const {name, unit} of own.filter(({exact}) => exact)) {
    all.push({name: `error of ${name}`, unit, signed: true, isError: true, values: (mesh, at) => {
      const field = ownOf(mesh, name);
      return field?.exact ? stopOf(field.stops, at).map((x, v) => x - field.exact[v]) : null;
    }});
  }
  if (!own.some(({name}) => name.startsWith('mean curvature'))) all.push(curvatureField(view));
  const named = new Map();
  for (const field of all) if (!named.has(field.name)) named.set(field.name, field);
  return named;
}

function curvatureField(view) {
  return {
    name: 'mean curvature', unit: '1/mesh units', signed: true,
    values: (mesh, at) => curvatures.get(view.positions(mesh, at)) ?? null,
    ask: async (mesh, at) => {
      const positions = view.positions(mesh, at);
      if (curvatures.has(positions)) return false;
      if (!asked.has(positions)) asked.set(positions, meanCurvature(positions, mesh.faces));
      curvatures.set(positions, await asked.get(positions));
      return true;
    },
  };
}

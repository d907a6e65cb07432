'use strict';

/**
 * Fields that the page computes from positions: how far vertices moved, how far they are off the truth, and mean
 * curvature. `from` of a view is the panel from which displacement counts, `truth` the true positions.
 */
const Derived = (() => {
  /** Of each vertex, something of three coordinates of two meshes. */
  const pairs = (a, b, f) => Float32Array.from({length: a.length / 3}, (_, v) => f(a, b, 3 * v));
  const distance = (a, b, i) => Math.hypot(a[i] - b[i], a[i + 1] - b[i + 1], a[i + 2] - b[i + 2]);

  /** Along the normals of the truth, positive outside. */
  function off(positions, truth, faces) {
    const normals = Geometry.normals(truth, faces);
    return pairs(positions, truth, (a, b, i) => (
      (a[i] - b[i]) * normals[i] + (a[i + 1] - b[i + 1]) * normals[i + 1] + (a[i + 2] - b[i + 2]) * normals[i + 2]));
  }

  /** Between the normals at vertices, in degrees. */
  function angles(positions, truth, faces) {
    const [n, m] = [positions, truth].map((p) => Geometry.normals(p, faces));
    return pairs(n, m, (a, b, i) => {
      const cosine = a[i] * b[i] + a[i + 1] * b[i + 1] + a[i + 2] * b[i + 2];
      return (180 * Math.acos(Math.max(-1, Math.min(1, cosine)))) / Math.PI;
    });
  }

  /** The mean angle between corresponding face normals, in degrees; faces without area do not count. */
  function normalError(positions, truth, faces) {
    let [sum, count] = [0, 0];
    for (let f = 0; f < faces.length; f += 3) {
      const [m, n] = [positions, truth].map((p) => Geometry.faceNormal(p, faces, f));
      const sizes = Math.hypot(...m) * Math.hypot(...n);
      if (!(sizes > 0)) continue;
      const cosine = (m[0] * n[0] + m[1] * n[1] + m[2] * n[2]) / sizes;
      sum += (180 * Math.acos(Math.max(-1, Math.min(1, cosine)))) / Math.PI;
      count += 1;
    }
    return sum / count;
  }

  /** What a view can be coloured by beyond the fields that it brings along. */
  function fields({from, truth, panels, fields: own}, meshes) {
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
      add('mean curvature', '1/mesh units', true, (view, mesh) => Float32Array.from(Geometry.curvature(view.positions(mesh), mesh.faces).mean));
    }
    return all;
  }

  return {fields, angles, normalError};
})();

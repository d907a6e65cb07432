'use strict';

/** Meshes as they are drawn: normals, and places in the ball of the camera. */
const Geometry = (() => {
  /** The normal of the face whose corners begin at `f`, twice its area long. */
  function faceNormal(p, faces, f) {
    const [a, b, c] = [3 * faces[f], 3 * faces[f + 1], 3 * faces[f + 2]];
    const [ux, uy, uz] = [p[b] - p[a], p[b + 1] - p[a + 1], p[b + 2] - p[a + 2]];
    const [vx, vy, vz] = [p[c] - p[a], p[c + 1] - p[a + 1], p[c + 2] - p[a + 2]];
    return [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
  }

  /** Area vectors of the faces around each vertex, summed: normals, weighted by area. */
  function areaVectors(positions, faces) {
    const sums = new Float64Array(positions.length);
    for (let f = 0; f < faces.length; f += 3) {
      const [nx, ny, nz] = faceNormal(positions, faces, f);
      for (let k = 0; k < 3; k++) {
        const v = 3 * faces[f + k];
        sums[v] += nx;
        sums[v + 1] += ny;
        sums[v + 2] += nz;
      }
    }
    return sums;
  }

  /** The same of length one; zero where there is none. */
  function normals(positions, faces) {
    const n = areaVectors(positions, faces);
    for (let v = 0; v < n.length; v += 3) {
      const length = Math.hypot(n[v], n[v + 1], n[v + 2]);
      if (length > 0) for (let k = 0; k < 3; k++) n[v + k] /= length;
    }
    return n;
  }

  /** Points and normals as the renderer takes them, scaled to the ball of the camera; `occlusion` in 255ths, or null. */
  function shape(positions, faces, {center, radius}, occlusion) {
    const n = positions.length / 3;
    const points = new Float32Array(4 * n);
    const directions = new Float32Array(4 * n);
    const all = normals(positions, faces);
    for (let v = 0; v < n; v++) {
      for (let k = 0; k < 3; k++) {
        points[4 * v + k] = (positions[3 * v + k] - center[k]) / radius;
        directions[4 * v + k] = all[3 * v + k];
      }
      points[4 * v + 3] = occlusion ? occlusion[v] / 255 : 1;
    }
    return {points, normals: directions};
  }

  /** The middle of positions and the root mean square distance from it. */
  function spread(positions) {
    const middle = [0, 0, 0];
    positions.forEach((x, i) => { middle[i % 3] += (3 * x) / positions.length; });
    let sum = 0;
    positions.forEach((x, i) => { sum += (x - middle[i % 3]) ** 2; });
    return {middle, size: Math.sqrt((3 * sum) / positions.length)};
  }

  /**
   * What has grown beyond three times the size of the input, or shrunk below this part of it, is drawn at its middle in
   * the size of the input; the words say so.
   */
  function fitted(input, positions, least = 0) {
    if (!positions || !positions.every(Number.isFinite)) return {positions: input, note: ' has no number left'};
    const [before, after] = [spread(input), spread(positions)];
    const growth = after.size / before.size;
    if (growth <= 3 && growth >= least) return {positions, note: ''};
    const drawn = positions.map((x, i) => before.middle[i % 3] + (x - after.middle[i % 3]) / growth);
    return {positions: drawn, note: growth > 1 ? ` (drawn 1 : ${readable(growth, 2)})` : ` (drawn ×${readable(1 / growth, 2)})`};
  }

  return {normals, shape, fitted};
})();

'use strict';

/**
 * What the page computes of triangle meshes: positions are x, y, z one after another in double precision, faces three
 * vertices each, seen counterclockwise from outside.
 */
const Geometry = (() => {
  /**
   * An octahedron with `k` segments on each edge, blown up to the unit sphere: 4k² + 2 vertices. All valences are even,
   * so that the vertices have three colours without an edge between equal ones, and the uniform Laplacian the
   * eigenvalue −3/2, the least that a closed mesh can have.
   */
  function octasphere(k) {
    const known = new Map();
    const positions = [];
    const vertex = (corner) => {
      const key = corner.join();
      if (!known.has(key)) {
        known.set(key, known.size);
        const p = corner.map((t) => Math.sin((Math.PI / 2) * (t / k)));
        const length = Math.hypot(...p);
        positions.push(...p.map((t) => t / length));
      }
      return known.get(key);
    };
    const faces = [];
    for (const sx of [1, -1]) for (const sy of [1, -1]) for (const sz of [1, -1]) {
      const at = (a, b) => vertex([sx * a || 0, sy * b || 0, sz * (k - a - b) || 0]);
      const add = (u, v, w) => faces.push(...(sx * sy * sz > 0 ? [u, v, w] : [u, w, v]));
      for (let a = 0; a < k; a++) {
        for (let b = 0; a + b < k; b++) {
          add(at(a, b), at(a + 1, b), at(a, b + 1));
          if (a + b + 1 < k) add(at(a + 1, b), at(a + 1, b + 1), at(a, b + 1));
        }
      }
    }
    return {positions: Float64Array.from(positions), faces: Uint32Array.from(faces)};
  }

  /** A torus about the z axis, `m` times `n` vertices; `angles` has the angle around the tube at each. */
  function torus(major, minor, m, n) {
    const positions = new Float64Array(3 * m * n);
    const angles = new Float64Array(m * n);
    const faces = [];
    for (let i = 0; i < m; i++) {
      for (let j = 0; j < n; j++) {
        // Every other row is shifted, so that faces are nearly equilateral.
        const [u, v] = [(2 * Math.PI * (i + 0.5 * (j % 2))) / m, (2 * Math.PI * j) / n];
        const r = major + minor * Math.cos(v);
        positions.set([r * Math.cos(u), r * Math.sin(u), minor * Math.sin(v)], 3 * (i * n + j));
        angles[i * n + j] = v;
        const at = (k, l) => ((i + k) % m) * n + ((j + l) % n);
        if (j % 2) faces.push(at(0, 0), at(1, 0), at(1, 1), at(0, 0), at(1, 1), at(0, 1));
        else faces.push(at(0, 0), at(1, 0), at(0, 1), at(1, 0), at(1, 1), at(0, 1));
      }
    }
    return {positions, angles, faces: Uint32Array.from(faces)};
  }

  /**
   * A body of revolution about the z axis: `outline` lists radius and height from the axis to the axis, upwards. Vertices
   * are about `spacing` apart, and on every crease.
   */
  function turned(outline, spacing) {
    const rings = [];
    const positions = [];
    const faces = [];
    const add = (r, z) => {
      const count = r > 0 ? Math.max(6, Math.round((2 * Math.PI * r) / spacing)) : 1;
      const first = positions.length / 3;
      for (let i = 0; i < count; i++) {
        // Every other ring is shifted, so that faces are nearly equilateral.
        const u = (2 * Math.PI * (i + 0.5 * (rings.length % 2))) / count;
        positions.push(r * Math.cos(u), r * Math.sin(u), z);
      }
      rings.push({first, count, shift: 0.5 * (rings.length % 2)});
    };
    outline.forEach(([r, z], i) => {
      if (!i) return add(r, z);
      const [r0, z0] = outline[i - 1];
      const steps = Math.max(1, Math.round(Math.hypot(r - r0, z - z0) / (0.87 * spacing)));
      for (let k = 1; k <= steps; k++) add(r0 + ((r - r0) * k) / steps, z0 + ((z - z0) * k) / steps);
    });
    for (let k = 1; k < rings.length; k++) {
      const [below, above] = [rings[k - 1], rings[k]];
      const at = ({first, count}, i) => first + (i % count);
      const turn = ({count, shift}, i) => (i + shift) / count;
      let [i, j] = [0, 0];
      // The ring whose next vertex comes first goes on.
      while (i < below.count || j < above.count) {
        const lower = j >= above.count || (i < below.count && turn(below, i + 1) <= turn(above, j + 1));
        if (lower && below.count > 1) faces.push(at(below, i), at(below, i + 1), at(above, j));
        if (!lower && above.count > 1) faces.push(at(above, j), at(below, i), at(above, j + 1));
        if (lower) i += 1;
        else j += 1;
      }
    }
    return {positions: Float64Array.from(positions), faces: Uint32Array.from(faces)};
  }

  /** The neighbours of all vertices: those of `v` are `ends` from `starts[v]` to `starts[v + 1]`. */
  function neighbours(count, faces) {
    const lists = Array.from({length: count}, () => []);
    for (let f = 0; f < faces.length; f += 3) {
      for (let k = 0; k < 3; k++) {
        const [a, b] = [faces[f + k], faces[f + ((k + 1) % 3)]];
        lists[a].push(b);
        lists[b].push(a);
      }
    }
    const starts = new Uint32Array(count + 1);
    const ends = [];
    lists.forEach((list, v) => {
      for (const w of [...new Set(list)].sort((a, b) => a - b)) ends.push(w);
      starts[v + 1] = ends.length;
    });
    return {starts, ends: Uint32Array.from(ends)};
  }

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

  /**
   * Mean curvature of the cotangent Laplacian, along the normal and positive on spheres, and Gaussian curvature of the
   * angle defect, both over mixed areas; the sum of all angle defects. Boundary vertices have no value.
   */
  function curvature(positions, faces) {
    const n = positions.length / 3;
    const [area, defect] = [new Float64Array(n), new Float64Array(n).fill(2 * Math.PI)];
    const vector = new Float64Array(3 * n);
    const p = positions;
    for (let f = 0; f < faces.length; f += 3) {
      const corner = [faces[f], faces[f + 1], faces[f + 2]];
      const edge = corner.map((_, k) => [0, 1, 2].map((c) => p[3 * corner[(k + 2) % 3] + c] - p[3 * corner[(k + 1) % 3] + c]));
      const square = edge.map((e) => e[0] * e[0] + e[1] * e[1] + e[2] * e[2]);
      const [u, v] = [edge[2], edge[1]];
      const double = Math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]);
      if (!(double > 0)) continue;
      const cosine = [0, 1, 2].map((k) => 0.5 * (square[(k + 1) % 3] + square[(k + 2) % 3] - square[k]));
      const cot = cosine.map((t) => t / double);
      const obtuse = cosine.findIndex((t) => t < 0);
      for (let k = 0; k < 3; k++) {
        const [i, j] = [corner[(k + 1) % 3], corner[(k + 2) % 3]];
        defect[corner[k]] -= Math.atan2(double, cosine[k]);
        for (let c = 0; c < 3; c++) {
          const pull = 0.5 * cot[k] * edge[k][c];
          vector[3 * i + c] += pull;
          vector[3 * j + c] -= pull;
        }
        if (obtuse < 0) {
          area[i] += (cot[k] * square[k]) / 8;
          area[j] += (cot[k] * square[k]) / 8;
        } else area[corner[k]] += (k === obtuse ? 0.25 : 0.125) * double;
      }
    }
    const normal = normals(positions, faces);
    const [mean, gaussian] = [new Float64Array(n), new Float64Array(n)];
    let total = 0;
    for (let v = 0; v < n; v++) {
      const along = vector[3 * v] * normal[3 * v] + vector[3 * v + 1] * normal[3 * v + 1] + vector[3 * v + 2] * normal[3 * v + 2];
      mean[v] = area[v] > 0 ? -along / (2 * area[v]) : NaN;
      gaussian[v] = area[v] > 0 ? defect[v] / area[v] : NaN;
      total += defect[v];
    }
    for (const v of boundary(n, faces)) mean[v] = gaussian[v] = NaN;
    return {mean, gaussian, total};
  }

  /** The vertices of edges with one face. */
  function boundary(count, faces) {
    const seen = new Set();
    for (let f = 0; f < faces.length; f += 3) {
      for (let k = 0; k < 3; k++) {
        const [a, b] = [faces[f + k], faces[f + ((k + 1) % 3)]];
        if (!seen.delete(b * count + a)) seen.add(a * count + b);
      }
    }
    const found = new Set();
    for (const key of seen) found.add(Math.floor(key / count)).add(key % count);
    return found;
  }

  /** The mean length of the edges. */
  function meanEdge(positions, faces) {
    let [sum, count] = [0, 0];
    for (let f = 0; f < faces.length; f += 3) {
      for (let k = 0; k < 3; k++) {
        const [a, b] = [3 * faces[f + k], 3 * faces[f + ((k + 1) % 3)]];
        sum += Math.hypot(positions[b] - positions[a], positions[b + 1] - positions[a + 1], positions[b + 2] - positions[a + 2]);
        count += 1;
      }
    }
    return sum / count;
  }

  /** Numbers with the normal distribution, the same for the same seed. */
  function gaussians(count, seed) {
    let state = seed >>> 0;
    const uniform = () => {
      state = (state + 0x6d2b79f5) >>> 0;
      let t = Math.imul(state ^ (state >>> 15), state | 1);
      t ^= t + Math.imul(t ^ (t >>> 7), t | 61);
      return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
    };
    return Float64Array.from({length: count}, () => (
      Math.sqrt(-2 * Math.log(1 - uniform())) * Math.cos(2 * Math.PI * uniform())));
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

  return {octasphere, torus, turned, neighbours, normals, faceNormal, shape, curvature, boundary, meanEdge, gaussians, spread, fitted};
})();

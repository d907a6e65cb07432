'use strict';

/**
 * Denoising by normals, and what it is measured by: the local bilateral filter of Zheng et al. (2011) with the vertex
 * update of Sun et al. (2007), E_a, volume and kept creases, all in double precision.
 */
const Filter = (() => {
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

  /** What the faces of a mesh share, whatever the positions: rings (faces that share a vertex), hinges and corners. */
  function topology(count, faces) {
    const corners = Array.from({length: count}, () => []);
    faces.forEach((v, c) => corners[v].push(c));
    const rings = Array.from({length: faces.length / 3}, (_, f) => {
      const near = new Set([0, 1, 2].flatMap((k) => corners[faces[3 * f + k]].map((c) => Math.floor(c / 3))));
      near.delete(f);
      return Uint32Array.from(near).sort();
    });
    const hinges = [];
    const seen = new Map();
    for (let c = 0; c < faces.length; c++) {
      const f = Math.floor(c / 3);
      const [a, b] = [faces[c], faces[3 * f + ((c + 1) % 3)]];
      if (seen.has(b * count + a)) hinges.push([seen.get(b * count + a), f]);
      else seen.set(a * count + b, f);
    }
    return {corners, rings, hinges};
  }

  /** Areas, unit normals (zero where there is none) and centroids of faces. */
  function shapes(positions, faces) {
    const n = faces.length / 3;
    const [areas, normals, centroids] = [new Float64Array(n), new Float64Array(3 * n), new Float64Array(3 * n)];
    const p = positions;
    for (let f = 0; f < n; f++) {
      const a = 3 * faces[3 * f], b = 3 * faces[3 * f + 1], c = 3 * faces[3 * f + 2];
      const ux = p[b] - p[a], uy = p[b + 1] - p[a + 1], uz = p[b + 2] - p[a + 2];
      const vx = p[c] - p[a], vy = p[c + 1] - p[a + 1], vz = p[c + 2] - p[a + 2];
      const nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
      const length = Math.sqrt(nx * nx + ny * ny + nz * nz);
      areas[f] = 0.5 * length;
      if (length > 0) {
        normals[3 * f] = nx / length;
        normals[3 * f + 1] = ny / length;
        normals[3 * f + 2] = nz / length;
      }
      for (let k = 0; k < 3; k++) centroids[3 * f + k] = (p[a + k] + p[b + k] + p[c + k]) / 3;
    }
    return {areas, normals, centroids};
  }

  const apart = (x, i, j) => Math.hypot(x[i] - x[j], x[i + 1] - x[j + 1], x[i + 2] - x[j + 2]);

  /**
   * Rounds of nᵢ ← Σ Aⱼ exp(−‖cᵢ − cⱼ‖²/2σ_c²) exp(−‖nᵢ − nⱼ‖²/2σ_s²) nⱼ over the ring, with σ_c the mean distance of
   * neighbouring centroids; then the vertices follow.
   */
  function bilateral(positions, faces, {corners, rings, hinges}, rounds, range = 0.45, steps = 10) {
    const {areas, normals: noisy, centroids} = shapes(positions, faces);
    const unit = hinges.reduce((sum, [f, g]) => sum + apart(centroids, 3 * f, 3 * g), 0) / hinges.length;
    // What does not change from round to round, ring by ring.
    const near = rings.map((ring, f) => Float64Array.from(ring, (g) => areas[g] * Math.exp(-0.5 * (apart(centroids, 3 * f, 3 * g) / unit) ** 2)));
    const half = -0.5 / (range * range);
    let normals = noisy;
    for (let round = 0; round < rounds; round++) {
      const next = new Float64Array(normals.length);
      for (let f = 0; f < rings.length; f++) {
        const [ring, weights] = [rings[f], near[f]];
        const own = areas[f];
        const nx = normals[3 * f], ny = normals[3 * f + 1], nz = normals[3 * f + 2];
        let x = own * nx, y = own * ny, z = own * nz;
        for (let i = 0; i < ring.length; i++) {
          const g = 3 * ring[i];
          const mx = normals[g], my = normals[g + 1], mz = normals[g + 2];
          const square = (nx - mx) * (nx - mx) + (ny - my) * (ny - my) + (nz - mz) * (nz - mz);
          const w = weights[i] * Math.exp(half * square);
          x += w * mx;
          y += w * my;
          z += w * mz;
        }
        const length = Math.sqrt(x * x + y * y + z * z);
        if (!(length > 0)) continue;
        next[3 * f] = x / length;
        next[3 * f + 1] = y / length;
        next[3 * f + 2] = z / length;
      }
      normals = next;
    }
    let moved = positions;
    for (let step = 0; step < steps; step++) moved = follow(moved, faces, corners, normals);
    return moved;
  }

  /** Whether a face whose corner `c` goes from `x` to `y` turns from agreeing with its normal to opposing it. */
  function turns(positions, faces, normals, c, x, y) {
    const f = Math.floor(c / 3);
    const [p, q] = [3 * faces[3 * f + ((c + 1) % 3)], 3 * faces[3 * f + ((c + 2) % 3)]];
    const side = (t) => {
      const ax = positions[p] - t[0], ay = positions[p + 1] - t[1], az = positions[p + 2] - t[2];
      const bx = positions[q] - t[0], by = positions[q + 1] - t[1], bz = positions[q + 2] - t[2];
      return (ay * bz - az * by) * normals[3 * f] + (az * bx - ax * bz) * normals[3 * f + 1] + (ax * by - ay * bx) * normals[3 * f + 2];
    };
    return side(x) > 0 && side(y) <= 0;
  }

  /**
   * One step of all vertices at once towards the planes through the centroids of their faces. A vertex that alone would
   * turn a face against its normal goes back half of the way, up to three times, and then stays.
   */
  function follow(positions, faces, corners, normals) {
    const {centroids} = shapes(positions, faces);
    const out = Float64Array.from(positions);
    const [x, y] = [new Float64Array(3), new Float64Array(3)];
    for (let v = 0; v < corners.length; v++) {
      const own = corners[v];
      for (let k = 0; k < 3; k++) x[k] = positions[3 * v + k];
      let sx = 0, sy = 0, sz = 0, count = 0;
      for (const c of own) {
        const f = 3 * Math.floor(c / 3);
        const nx = normals[f], ny = normals[f + 1], nz = normals[f + 2];
        if (nx === 0 && ny === 0 && nz === 0) continue;
        const far = nx * (centroids[f] - x[0]) + ny * (centroids[f + 1] - x[1]) + nz * (centroids[f + 2] - x[2]);
        sx += far * nx;
        sy += far * ny;
        sz += far * nz;
        count += 1;
      }
      if (!count) continue;
      y[0] = x[0] + sx / count;
      y[1] = x[1] + sy / count;
      y[2] = x[2] + sz / count;
      const flips = () => own.some((c) => turns(positions, faces, normals, c, x, y));
      let back = 0;
      while (back < 3 && flips()) {
        for (let k = 0; k < 3; k++) y[k] = 0.5 * (y[k] + x[k]);
        back += 1;
      }
      if (back < 3 || !flips()) out.set(y, 3 * v);
    }
    return out;
  }

  /** In degrees between two unit vectors in lists. */
  function angle(m, i, n, j) {
    const [a, b] = [[m[i], m[i + 1], m[i + 2]], [n[j], n[j + 1], n[j + 2]]];
    return (180 / Math.PI) * Math.atan2(Math.hypot(...cross(a, b)), dot(a, b));
  }

  /** The enclosed volume of a closed mesh. */
  function volume(positions, faces) {
    const at = (v) => [positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]];
    let sum = 0;
    for (let f = 0; f < faces.length; f += 3) sum += dot(at(faces[f]), cross(at(faces[f + 1]), at(faces[f + 2])));
    return sum / 6;
  }

  /** E_a in degrees, the change of volume and the share of creases kept, both in per cent. A crease turns by 30° or more. */
  function scores(positions, truth, faces, {hinges}) {
    const [m, n] = [positions, truth].map((x) => shapes(x, faces).normals);
    const has = (x, f) => x[3 * f] || x[3 * f + 1] || x[3 * f + 2];
    let [sum, count] = [0, 0];
    for (let f = 0; f < faces.length / 3; f++) {
      if (!has(m, f) || !has(n, f)) continue;
      sum += angle(m, 3 * f, n, 3 * f);
      count += 1;
    }
    const sharp = (x, [f, g]) => has(x, f) && has(x, g) && angle(x, 3 * f, x, 3 * g) >= 30;
    const expected = hinges.filter((hinge) => sharp(n, hinge));
    const kept = expected.filter((hinge) => sharp(m, hinge)).length;
    return {
      angle: sum / count,
      volume: 100 * (volume(positions, faces) / volume(truth, faces) - 1),
      creases: (100 * kept) / expected.length,
    };
  }

  return {topology, bilateral, scores};
})();

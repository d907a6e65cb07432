/**
 * Meshes by formula for playgrounds: positions are x, y, z one after another in double precision,
 * faces three vertices each, seen counterclockwise from outside.
 */

/**
 * An octahedron with `k` segments on each edge, blown up to the unit sphere: 4k² + 2 vertices. All
 * valences are even, so that the vertices have three colours without an edge between equal ones,
 * and the uniform Laplacian the eigenvalue −3/2, the least that a closed mesh can have.
 */
export function octasphere(k) {
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

/**
 * A torus about the z axis, `m` times `n` vertices; `angles` has the angle around the tube at each.
 */
export function torus(major, minor, m, n) {
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
 * A body of revolution about the z axis: `outline` lists radius and height from the axis to the
 * axis, upwards. Vertices are about `spacing` apart, and on every crease.
 */
export function turned(outline, spacing) {
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

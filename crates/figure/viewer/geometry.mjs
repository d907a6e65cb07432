/** The normal of the face whose corners begin at `f`, twice its area long. */
function faceNormal(p, faces, f) {
  const [a, b, c] = [3 * faces[f], 3 * faces[f + 1], 3 * faces[f + 2]];
  const [ux, uy, uz] = [p[b] - p[a], p[b + 1] - p[a + 1], p[b + 2] - p[a + 2]];
  const [vx, vy, vz] = [p[c] - p[a], p[c + 1] - p[a + 1], p[c + 2] - p[a + 2]];
  return [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
}

/**
 * Normals of vertices: sums of those of their faces, weighted by area; zero where there is none.
 */
export function normals(positions, faces) {
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
  for (let v = 0; v < sums.length; v += 3) {
    const length = Math.hypot(sums[v], sums[v + 1], sums[v + 2]);
    if (length > 0) for (let k = 0; k < 3; k++) sums[v + k] /= length;
  }
  return sums;
}

/** Points and normals as the renderer takes them, scaled to the ball of the camera. */
export function shape(positions, directions, {center, radius}) {
  const n = positions.length / 3;
  const points = new Float32Array(4 * n);
  const normals = new Float32Array(4 * n);
  for (let v = 0; v < n; v++) {
    for (let k = 0; k < 3; k++) {
      points[4 * v + k] = (positions[3 * v + k] - center[k]) / radius;
      normals[4 * v + k] = directions[3 * v + k];
    }
  }
  return {points, normals};
}

/** The box that holds all positions of some lists. */
export function boxOf(lists) {
  const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  for (const positions of lists) {
    for (let i = 0; i < positions.length; i += 3) {
      for (let k = 0; k < 3; k++) {
        const x = positions[i + k];
        if (x < low[k]) low[k] = x;
        if (x > high[k]) high[k] = x;
      }
    }
  }
  return {low, high};
}

/** The ball about the middle of the box that holds all positions of some lists. */
export function ballOf(lists) {
  const {low, high} = boxOf(lists);
  const center = low.map((x, k) => 0.5 * (x + high[k]));
  const [x, y, z] = center;
  let square = 0;
  for (const positions of lists) {
    for (let i = 0; i < positions.length; i += 3) {
      const [dx, dy, dz] = [positions[i] - x, positions[i + 1] - y, positions[i + 2] - z];
      square = Math.max(square, dx * dx + dy * dy + dz * dz);
    }
  }
  return {center, radius: Math.sqrt(square) || 1};
}

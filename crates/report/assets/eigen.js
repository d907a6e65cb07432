'use strict';

/**
 * All eigenvalues, ascending, and orthonormal eigenvectors (`vectors[i * n + k]` is entry `i` of the `k`-th) of a
 * dense symmetric matrix: Householder's reduction to tridiagonal form, then the QL algorithm with implicit shifts, as in
 * EISPACK (tred2 and tql2).
 */
function symmetricEigen(matrix, n) {
  const z = Float64Array.from(matrix);
  const [d, e] = [new Float64Array(n), new Float64Array(n)];
  tridiagonal(z, n, d, e);
  diagonal(z, n, d, e);
  const order = Array.from({length: n}, (_, k) => k).sort((a, b) => d[a] - d[b]);
  const vectors = new Float64Array(n * n);
  for (let i = 0; i < n; i++) for (let k = 0; k < n; k++) vectors[i * n + k] = z[order[k] * n + i];
  return {values: Float64Array.from(order, (k) => d[k]), vectors};
}

/** `z` becomes the transposed product of the reflections, `d` and `e` the diagonal and what is below it. */
function tridiagonal(z, n, d, e) {
  // Reflections that are stored by rows, from the last row up.
  for (let i = n - 1; i > 0; i--) {
    let [h, scale] = [0, 0];
    for (let k = 0; k < i; k++) scale += Math.abs(z[i * n + k]);
    if (i === 1 || scale === 0) {
      e[i] = z[i * n + i - 1];
      d[i] = 0;
      continue;
    }
    for (let k = 0; k < i; k++) {
      z[i * n + k] /= scale;
      h += z[i * n + k] ** 2;
    }
    const f = z[i * n + i - 1];
    const g = f >= 0 ? -Math.sqrt(h) : Math.sqrt(h);
    e[i] = scale * g;
    h -= f * g;
    z[i * n + i - 1] = f - g;
    let sum = 0;
    for (let j = 0; j < i; j++) {
      z[j * n + i] = z[i * n + j] / h;
      let s = 0;
      for (let k = 0; k <= j; k++) s += z[j * n + k] * z[i * n + k];
      for (let k = j + 1; k < i; k++) s += z[k * n + j] * z[i * n + k];
      e[j] = s / h;
      sum += e[j] * z[i * n + j];
    }
    const half = sum / (2 * h);
    for (let j = 0; j < i; j++) {
      const fj = z[i * n + j];
      e[j] -= half * fj;
      const gj = e[j];
      for (let k = 0; k <= j; k++) z[j * n + k] -= fj * e[k] + gj * z[i * n + k];
    }
    d[i] = h;
  }
  d[0] = 0;
  e[0] = 0;
  for (let i = 0; i < n; i++) {
    if (d[i] !== 0) {
      for (let j = 0; j < i; j++) {
        let s = 0;
        for (let k = 0; k < i; k++) s += z[i * n + k] * z[k * n + j];
        for (let k = 0; k < i; k++) z[k * n + j] -= s * z[k * n + i];
      }
    }
    d[i] = z[i * n + i];
    z[i * n + i] = 1;
    for (let j = 0; j < i; j++) z[j * n + i] = z[i * n + j] = 0;
  }
  // Rows are rotated faster than columns.
  for (let i = 0; i < n; i++) {
    for (let j = 0; j < i; j++) [z[i * n + j], z[j * n + i]] = [z[j * n + i], z[i * n + j]];
  }
}

function diagonal(z, n, d, e) {
  for (let i = 1; i < n; i++) e[i - 1] = e[i];
  e[n - 1] = 0;
  for (let l = 0; l < n; l++) {
    for (let round = 0; ; round++) {
      let m = l;
      for (; m < n - 1; m++) {
        if (Math.abs(e[m]) <= Number.EPSILON * (Math.abs(d[m]) + Math.abs(d[m + 1]))) break;
      }
      if (m === l) break;
      if (round > 60) throw new Error('the eigenvalues do not converge');
      let g = (d[l + 1] - d[l]) / (2 * e[l]);
      let r = Math.hypot(g, 1);
      g = d[m] - d[l] + e[l] / (g + (g >= 0 ? r : -r));
      let [s, c, p] = [1, 1, 0];
      let i = m - 1;
      for (; i >= l; i--) {
        const [f, b] = [s * e[i], c * e[i]];
        r = Math.hypot(f, g);
        e[i + 1] = r;
        if (r === 0) {
          d[i + 1] -= p;
          e[m] = 0;
          break;
        }
        s = f / r;
        c = g / r;
        g = d[i + 1] - p;
        r = (d[i] - g) * s + 2 * c * b;
        p = s * r;
        d[i + 1] = g + p;
        g = c * r - b;
        rotate(z, n, i, s, c);
      }
      if (r === 0 && i >= l) continue;
      d[l] -= p;
      e[l] = g;
      e[m] = 0;
    }
  }
}

/** Rows `i` and `i + 1`. */
function rotate(z, n, i, s, c) {
  const [a, b] = [i * n, (i + 1) * n];
  for (let k = 0; k < n; k++) {
    const f = z[b + k];
    z[b + k] = s * z[a + k] + c * f;
    z[a + k] = c * z[a + k] - s * f;
  }
}

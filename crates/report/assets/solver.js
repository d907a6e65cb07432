'use strict';

/**
 * Explicit and implicit uniform smoothing, computed in the page in double
 * precision. An explicit step is x + λLx. Each implicit step solves (I − λL) x′ = x with L = D⁻¹A − I, which, multiplied by the
 * valences D, is symmetric and positive definite:
 *
 *     (D + λ(D − A)) x′ = D x
 *
 * by conjugate gradients with the diagonal as preconditioner. Isolated
 * vertices stay where they are.
 */
class Smoother {
  constructor(positions, faces) {
    this.n = positions.length / 3;
    this.input = positions;
    Object.assign(this, Geometry.neighbours(this.n, faces));
  }

  /** L x for one coordinate, or for any values at the vertices. */
  laplacian(x, stride, c, out) {
    for (let v = 0; v < this.n; v++) {
      let sum = 0;
      for (let i = this.starts[v]; i < this.starts[v + 1]; i++) sum += x[stride * this.ends[i] + c];
      const valence = this.starts[v + 1] - this.starts[v];
      out[stride * v + c] = valence ? sum / valence - x[stride * v + c] : 0;
    }
  }

  /** `count` explicit steps x + λLx, in mesh units; they diverge where λ is too long. */
  explicit(lambda, count) {
    let x = Float64Array.from(this.input);
    const change = new Float64Array(x.length);
    for (let k = 0; k < count; k++) {
      for (let c = 0; c < 3; c++) this.laplacian(x, 3, c, change);
      for (let i = 0; i < x.length; i++) x[i] += lambda * change[i];
      if (!Number.isFinite(x[0]) || Math.abs(x[0]) > 1e150) return null;
    }
    return x;
  }

  /**
   * The smallest eigenvalue μ of L, that of the roughest mode, from below in
   * size: power iterations with L − I/4, whose largest eigenvalue in size is
   * that of the smallest μ. The Rayleigh quotient weighs by valences.
   */
  roughest(rounds = 200) {
    this.mu ??= (() => {
      let x = Float64Array.from({length: this.n}, (_, v) => Math.sin(12.9898 * (v + 1)));
      const y = new Float64Array(this.n);
      let mu = -1;
      for (let k = 0; k < rounds; k++) {
        this.laplacian(x, 1, 0, y);
        let [above, below] = [0, 0];
        for (let v = 0; v < this.n; v++) {
          const d = this.starts[v + 1] - this.starts[v];
          above += d * x[v] * y[v];
          below += d * x[v] * x[v];
        }
        mu = above / below;
        const size = 1 / Math.sqrt(below);
        for (let v = 0; v < this.n; v++) x[v] = size * (y[v] - 0.25 * x[v]);
      }
      return mu;
    })();
    return this.mu;
  }

  /** One implicit step, for the three coordinates one after another. */
  step(positions, lambda) {
    const out = new Float64Array(positions.length);
    for (let c = 0; c < 3; c++) this.solve(positions, lambda, c, out);
    return out;
  }

  solve(positions, lambda, c, out) {
    const {n, starts, ends} = this;
    const x = new Float64Array(n);
    const r = new Float64Array(n);
    const p = new Float64Array(n);
    const q = new Float64Array(n);
    const inverse = new Float64Array(n);
    const apply = (from, to) => {
      for (let v = 0; v < n; v++) {
        let sum = 0;
        for (let i = starts[v]; i < starts[v + 1]; i++) sum += from[ends[i]];
        const valence = starts[v + 1] - starts[v];
        to[v] = valence ? valence * (1 + lambda) * from[v] - lambda * sum : from[v];
      }
    };
    for (let v = 0; v < n; v++) {
      x[v] = positions[3 * v + c];
      const valence = starts[v + 1] - starts[v];
      inverse[v] = valence ? 1 / (valence * (1 + lambda)) : 1;
    }
    apply(x, q);
    let norm = 0;
    let rho = 0;
    for (let v = 0; v < n; v++) {
      const valence = starts[v + 1] - starts[v] || 1;
      const b = valence * x[v];
      r[v] = b - q[v];
      p[v] = inverse[v] * r[v];
      norm += b * b;
      rho += r[v] * p[v];
    }
    // Residuals beyond this are rounding errors of the right-hand side.
    const enough = 1e-26 * norm;
    for (let round = 0; round < 10000; round++) {
      let residual = 0;
      for (let v = 0; v < n; v++) residual += r[v] * r[v];
      if (residual <= enough || rho === 0) break;
      apply(p, q);
      let curvature = 0;
      for (let v = 0; v < n; v++) curvature += p[v] * q[v];
      const alpha = rho / curvature;
      let next = 0;
      for (let v = 0; v < n; v++) {
        x[v] += alpha * p[v];
        r[v] -= alpha * q[v];
        next += inverse[v] * r[v] * r[v];
      }
      const beta = next / rho;
      rho = next;
      for (let v = 0; v < n; v++) p[v] = inverse[v] * r[v] + beta * p[v];
    }
    for (let v = 0; v < n; v++) out[3 * v + c] = x[v];
  }

  /**
   * `count` steps; lets the page breathe between them and gives up with `null`
   * once `cancelled()` says so.
   */
  async smooth(lambda, count, cancelled = () => false, report = () => {}) {
    let positions = this.input;
    let since = performance.now();
    for (let i = 0; i < count; i++) {
      positions = this.step(positions, lambda);
      if (performance.now() - since > 40) {
        report(i + 1);
        await new Promise((go) => setTimeout(go, 0));
        if (cancelled()) return null;
        since = performance.now();
      }
    }
    return positions;
  }
}

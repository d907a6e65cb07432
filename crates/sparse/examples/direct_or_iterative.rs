//! Measures Cholesky against conjugate gradients, between which `Workload` chooses, on M + tS of a
//! regular triangle grid (the graph of an equilateral mesh with S = ½ (D − A) 2/√3 and M = I √3/2,
//! so that h = 1), positions as right-hand sides.
//!
//! `cargo run --release -p fairing-sparse --example direct_or_iterative`

use std::time::Instant;

use fairing_sparse::{
    CgOptions, FieldOperator, Mass, Ordering, SparseMatrix, SymbolicCholesky, combine,
    conjugate_gradients, product_by_rows,
};

/// Each edge of an equilateral mesh has the cotangent weight 1/√3; cells have the area √3/2.
fn triangle_grid(side: usize) -> SparseMatrix {
    let at = |i: usize, j: usize| (i % side) + side * (j % side);
    let mut t = sprs::TriMatI::<f64, u32>::new((side * side, side * side));
    let weight = 1.0 / 3f64.sqrt();
    for j in 0..side {
        for i in 0..side {
            let a = at(i, j);
            for b in [(i + 1, j), (i, j + 1), (i + 1, j + 1)]
                .into_iter()
                .filter(|b| b.0 < side && b.1 < side)
                .map(|b| at(b.0, b.1))
            {
                t.add_triplet(a, a, weight);
                t.add_triplet(b, b, weight);
                t.add_triplet(a, b, -weight);
                t.add_triplet(b, a, -weight);
            }
        }
    }
    t.to_csr()
}

fn seconds<T>(work: impl Fn() -> T) -> (f64, T) {
    let mut best: Option<(f64, T)> = None;
    let begin = Instant::now();
    while best.is_none() || begin.elapsed().as_secs_f64() < 0.3 {
        let start = Instant::now();
        let result = work();
        let time = start.elapsed().as_secs_f64();
        if best.as_ref().is_none_or(|(b, _)| time < *b) {
            best = Some((time, result));
        }
    }
    // The loop runs at least once.
    best.unwrap_or_else(|| (0.0, work()))
}

fn main() -> anyhow::Result<()> {
    println!("rows t/h2 entries(L) analyse factor solve3 | iterations cg3 | per row and iteration");
    for side in [32, 64, 128, 256, 400, 800] {
        let s = triangle_grid(side);
        let n = s.rows();
        let mass = vec![0.5 * 3f64.sqrt(); n];
        let b: Vec<[f64; 3]> = (0..n)
            .map(|i| {
                let bump = libm::sin(i as f64 * 12.9898) * 0.3;
                [(i % side) as f64 + bump, (i / side) as f64 - bump, bump]
            })
            .collect();
        for t in [1.0, 10.0, 100.0, 1000.0] {
            let a = combine(1.0, Mass::Lumped(&mass), t, &s);
            let (analyse, symbolic) = seconds(|| SymbolicCholesky::new(&a, Ordering::default()));
            let symbolic = symbolic?;
            let (factor, cholesky) = seconds(|| symbolic.factorize(&a));
            let cholesky = cholesky?;
            let (solve, _) = seconds(|| cholesky.solve_points(&b));
            let options = CgOptions { tolerance: 1e-10, ..Default::default() };
            let rows: Vec<_> = a.outer_iterator().collect();
            let diagonal = a.diag().to_dense().to_vec();
            let operator = FieldOperator::new(&diagonal, |p, q| {
                product_by_rows(p, q, |i| {
                    let row = rows[i].iter();
                    row.fold([0.0; 3], |sum, (j, a)| std::array::from_fn(|k| sum[k] + a * p[j][k]))
                })
            });
            let (cg, solution) =
                seconds(|| conjugate_gradients(&operator, &b, vec![[0.0; 3]; n], &options));
            let iterations = solution.iterations;
            println!(
                "{n:7} {t:5} {:9} {:7.2} {:7.2} {:6.2} ms | {iterations:5} {:8.2} ms | {:.1} ns",
                symbolic.factor_entries(),
                1e3 * analyse,
                1e3 * factor,
                1e3 * solve,
                1e3 * cg,
                1e9 * cg / n as f64 / iterations as f64,
            );
        }
    }
    Ok(())
}

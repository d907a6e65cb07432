//! The product of the stiffness with three columns, as a share of the memory bandwidth.

use anyhow::Result;
use fairing_mesh::io;
use fairing_operators::cotan_stiffness;
use fairing_sparse::multiply_points_into;
use rayon::prelude::*;

use crate::task::{Job, Work, fingerprint, work};

/// Numbers of an array of the triad: 64 MB, far more than caches hold.
const NUMBERS: usize = 1 << 23;
/// Numbers of a parallel task.
const PIECE: usize = 1 << 16;
/// Repetitions, of which the fastest counts, as in STREAM.
const REPETITIONS: usize = 10;

/// Y = S X with three columns, and the triad a = b + s c in the same run.
///
/// Rates are in GB/s: three arrays of the triad; values, columns and row starts of S and each
/// position once in and once out.
pub(crate) fn bandwidth(job: &Job) -> Result<Work> {
    let mesh = io::read(&job.input)?.mesh;
    let stiffness = cotan_stiffness(&mesh)?;
    let mut y = vec![[0.0; 3]; mesh.vertex_count()];
    let [mut a, b, c] = [1.0, 2.0, 3.0].map(|value| vec![value; NUMBERS]);
    // The least of all repetitions, of the triad and of the product.
    let mut seconds = [f64::INFINITY; 2];
    work(move |watch| {
        for _ in 0..REPETITIONS {
            let took = watch.phase("triad", || timed(|| triad(&mut a, &b, &c)));
            seconds[0] = seconds[0].min(took);
            let product = || multiply_points_into(&stiffness, mesh.positions(), &mut y);
            let took = watch.phase("product", || timed(product));
            seconds[1] = seconds[1].min(took);
        }
        let number = size_of::<f64>();
        let rows = y.len() * (size_of::<u32>() + 6 * number);
        let entries = stiffness.nnz() * (size_of::<u32>() + number);
        let gigabytes = [3 * number * NUMBERS, rows + entries].map(|bytes| bytes as f64 / 1e9);
        let [triad, product] = [0, 1].map(|k| gigabytes[k] / seconds[k]);
        let sum = y.iter().flatten().sum::<f64>() + a[0];
        Ok(move || {
            Ok(fingerprint! { triad: triad, product: product, share: product / triad, sum: sum })
        })
    })
}

/// a ← b + s c.
fn triad(a: &mut [f64], b: &[f64], c: &[f64]) {
    a.par_chunks_mut(PIECE).zip(b.par_chunks(PIECE)).zip(c.par_chunks(PIECE)).for_each(
        |((a, b), c)| {
            for ((a, b), c) in a.iter_mut().zip(b).zip(c) {
                *a = b + 3.0 * c;
            }
        },
    );
}

fn timed(work: impl FnOnce()) -> f64 {
    let start = std::time::Instant::now();
    work();
    start.elapsed().as_secs_f64()
}

//! The product of the stiffness with three columns, as a share of the memory bandwidth.

use anyhow::Result;
use fairing_mesh::io;
use fairing_operators::{SparseMatrix, cotan_stiffness};
use fairing_sparse::multiply_points_into;
use rayon::prelude::*;

use super::stopwatch::Stopwatch;
use super::task::{Fingerprint, Job, Task, Work, fingerprint};

/// Numbers of an array of the triad: 64 MB, far more than caches hold.
const NUMBERS: usize = 1 << 23;
/// Numbers of a parallel task.
const PIECE: usize = 1 << 16;
/// Repetitions, of which the fastest counts, as in STREAM.
const REPETITIONS: usize = 10;

/// Y = S X with three columns, and the triad a = b + s c in the same run.
pub(super) struct Bandwidth;

impl Task for Bandwidth {
    fn name(&self) -> &'static str {
        "bandwidth"
    }

    fn about(&self) -> &'static str {
        "S times three columns, and the triad a = b + s c of STREAM"
    }

    fn prepare(&self, job: &Job) -> Result<Box<dyn Work>> {
        let mesh = io::read(&job.input)?.mesh;
        let stiffness = cotan_stiffness(&mesh)?;
        let x = mesh.positions().to_vec();
        let y = vec![[0.0; 3]; x.len()];
        let arrays = [1.0, 2.0, 3.0].map(|value| vec![value; NUMBERS]);
        Ok(Box::new(Moving { stiffness, x, y, arrays, seconds: [f64::INFINITY; 2] }))
    }
}

struct Moving {
    stiffness: SparseMatrix,
    x: Vec<[f64; 3]>,
    y: Vec<[f64; 3]>,
    arrays: [Vec<f64>; 3],
    /// Least seconds of the triad and of the product.
    seconds: [f64; 2],
}

impl Work for Moving {
    fn run(&mut self, watch: &mut Stopwatch) -> Result<()> {
        for _ in 0..REPETITIONS {
            let [a, b, c] = &mut self.arrays;
            let took = watch.phase("triad", || timed(|| triad(a, b, c)));
            self.seconds[0] = self.seconds[0].min(took);
            let (matrix, x, y) = (&self.stiffness, &self.x, &mut self.y);
            let took = watch.phase("product", || timed(|| multiply_points_into(matrix, x, y)));
            self.seconds[1] = self.seconds[1].min(took);
        }
        Ok(())
    }

    /// Rates in GB/s: three arrays of the triad; values, columns and row starts of S and each
    /// position once in and once out.
    fn fingerprint(&mut self) -> Result<Fingerprint> {
        let number = size_of::<f64>();
        let rows = self.x.len() * (size_of::<u32>() + 6 * number);
        let entries = self.stiffness.nnz() * (size_of::<u32>() + number);
        let gigabytes = [3 * number * NUMBERS, rows + entries].map(|bytes| bytes as f64 / 1e9);
        let [triad, product] = [0, 1].map(|k| gigabytes[k] / self.seconds[k]);
        Ok(fingerprint! {
            triad: triad,
            product: product,
            share: product / triad,
            sum: self.y.iter().flatten().sum::<f64>() + self.arrays[0][0],
        })
    }
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

//! Test meshes, and transformations that keep their shape.

use fairing_mesh::TriMesh;

/// A mesh with its positions mapped.
pub(crate) fn mapped(mesh: &TriMesh, f: impl Fn([f64; 3]) -> [f64; 3]) -> TriMesh {
    mesh.with_positions(mesh.positions().iter().map(|p| f(*p)).collect()).unwrap()
}

pub(crate) fn scaled(mesh: &TriMesh, s: f64) -> TriMesh {
    mapped(mesh, |p| p.map(|x| s * x))
}

/// Turned about two axes.
pub(crate) fn turned(mesh: &TriMesh) -> TriMesh {
    let ((s, c), (t, d)) = (0.7f64.sin_cos(), 2.1f64.sin_cos());
    mapped(mesh, |[x, y, z]| {
        let [x, y] = [c * x - s * y, s * x + c * y];
        [x, d * y - t * z, t * y + d * z]
    })
}

/// Both as components of one mesh.
pub(crate) fn union(a: &TriMesh, b: &TriMesh) -> TriMesh {
    let n = a.vertex_count() as u32;
    let points = a.positions().iter().chain(b.positions()).copied().collect();
    let faces = a.faces().iter().copied().chain(b.faces().iter().map(|f| f.map(|v| v + n)));
    TriMesh::new(points, faces.collect()).unwrap()
}

/// Vertex v becomes vertex `order(v)` = (a v + b) mod n; faces are rotated and in another order
/// too.
pub(crate) fn relabelled(mesh: &TriMesh) -> (TriMesh, Vec<usize>) {
    let n = mesh.vertex_count();
    let step = (n / 3..).find(|s| gcd(*s, n) == 1).unwrap();
    let place: Vec<usize> = (0..n).map(|v| (step * v + 5) % n).collect();
    let mut points = vec![[0.0; 3]; n];
    for (v, p) in mesh.positions().iter().enumerate() {
        points[place[v]] = *p;
    }
    let face = |&[a, b, c]: &[u32; 3]| [b, c, a].map(|v| place[v as usize] as u32);
    let faces = mesh.faces().iter().rev().map(face).collect();
    (TriMesh::new(points, faces).unwrap(), place)
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// A cylinder of length 2 with half spheres of radius 1. With `fans` each pole is as many vertices
/// as a ring has, all in one place, and half of the faces there have no area; else it is one
/// vertex.
pub(crate) fn capsule(around: usize, half: usize, fans: bool) -> TriMesh {
    let quarter = std::f64::consts::FRAC_PI_2;
    let mut rings = vec![];
    for (end, turn) in [(-1.0, -quarter), (1.0, 0.0)] {
        for j in 0..=half {
            let t = turn + quarter * j as f64 / half as f64;
            rings.push((t.cos(), t.sin() + end));
        }
    }
    let (last, mut points, mut starts) = (rings.len() - 1, vec![], vec![]);
    for (j, (r, z)) in rings.into_iter().enumerate() {
        starts.push(points.len());
        let pole = j == 0 || j == last;
        for i in 0..if pole && !fans { 1 } else { around } {
            let (s, c) = (std::f64::consts::TAU * i as f64 / around as f64).sin_cos();
            let r = if pole { 0.0 } else { r };
            points.push([r * c, r * s, z]);
        }
    }
    let at = |j: usize, i: usize| -> u32 {
        let single = (j == 0 || j == last) && !fans;
        (starts[j] + if single { 0 } else { i % around }) as u32
    };
    let mut faces = vec![];
    for j in 0..last {
        for i in 0..around {
            let [a, b, c, d] = [at(j, i), at(j, i + 1), at(j + 1, i + 1), at(j + 1, i)];
            faces.extend(
                [[a, b, c], [a, c, d]].iter().filter(|[p, q, r]| p != q && q != r && r != p),
            );
        }
    }
    TriMesh::new(points, faces).unwrap()
}

/// A grid of nx × ny quads of the given size, one diagonal each, sheared by `shear` quads a row.
pub(crate) fn sheet(nx: usize, ny: usize, size: [f64; 2], shear: f64) -> TriMesh {
    let mut points = vec![];
    let mut faces = vec![];
    for j in 0..=ny {
        for i in 0..=nx {
            points.push([size[0] * (i as f64 + shear * j as f64), size[1] * j as f64, 0.0]);
            if i < nx && j < ny {
                let a = (j * (nx + 1) + i) as u32;
                let up = a + nx as u32 + 1;
                faces.extend([[a, a + 1, up + 1], [a, up + 1, up]]);
            }
        }
    }
    TriMesh::new(points, faces).unwrap()
}

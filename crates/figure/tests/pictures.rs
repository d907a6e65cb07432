//! Content of pictures, measured in their pixels.

#![expect(clippy::disallowed_methods, reason = "tests do not need the same bits")]

use fairing_figure::{
    Background, Camera, Colors, FigureError, Image, Occlusion, RenderOptions, Shading, Up,
    Viewpoint, Wireframe, render,
};
use fairing_mesh::TriMesh;

/// A unit sphere in `2 n` strips of `n` bands about the y axis.
fn sphere(n: u32, center: [f64; 3]) -> TriMesh {
    let mut positions = Vec::new();
    for i in 0..=n {
        let theta = std::f64::consts::PI * f64::from(i) / f64::from(n);
        for j in 0..2 * n {
            let phi = std::f64::consts::PI * f64::from(j) / f64::from(n);
            let p = [theta.sin() * phi.sin(), theta.cos(), theta.sin() * phi.cos()];
            positions.push([p[0] + center[0], p[1] + center[1], p[2] + center[2]]);
        }
    }
    let mut faces = Vec::new();
    for i in 0..n {
        for j in 0..2 * n {
            let k = (j + 1) % (2 * n);
            let [a, b] = [i * 2 * n + j, i * 2 * n + k];
            let [c, d] = [a + 2 * n, b + 2 * n];
            faces.extend([[a, c, d], [a, d, b]]);
        }
    }
    TriMesh::new(positions, faces).unwrap()
}

type Square = ([[f64; 3]; 4], [[u32; 3]; 2]);

/// A square in the plane z = `z`, seen from its outer side by the front view.
fn square(z: f64, half: f64) -> Square {
    let p = [[-half, -half, z], [half, -half, z], [half, half, z], [-half, half, z]];
    (p, [[0, 1, 2], [0, 2, 3]])
}

fn join(parts: &[Square]) -> TriMesh {
    let (mut positions, mut faces) = (vec![], vec![]);
    for (p, f) in parts {
        let offset = positions.len() as u32;
        positions.extend_from_slice(p);
        faces.extend(f.iter().map(|f| f.map(|v| v + offset)));
    }
    TriMesh::new(positions, faces).unwrap()
}

fn front(mesh: &TriMesh) -> Camera {
    Camera::fit(&[mesh], Viewpoint::Front, Up::Y, 1.0).unwrap()
}

fn options(side: u32) -> RenderOptions {
    RenderOptions { width: side, height: side, ..RenderOptions::default() }
}

fn draw(mesh: &TriMesh, colors: Colors<'_>, options: &RenderOptions) -> Image {
    render(mesh, colors, None, &front(mesh), options).unwrap()
}

/// The tight fit makes the disc 94 % of the side, so its area is known; the
/// outline of the polyhedron lies a little inside of the sphere's.
#[test]
fn a_sphere_covers_the_area_of_its_disc() {
    let image = draw(&sphere(64, [0.0; 3]), Colors::CLAY, &options(300));
    let covered: f64 = image.pixels().iter().map(|p| f64::from(p[3]) / 255.0).sum();
    let disc = std::f64::consts::PI * (0.94f64 * 150.0).powi(2);
    assert!((covered / disc - 1.0).abs() < 2e-3, "{covered} against {disc}");
}

/// Alpha is symmetric though the light is not. A sphere's mesh is symmetric
/// only up to the direction of its diagonals, hence the tolerance of a few
/// samples of nine.
#[test]
fn the_outline_is_symmetric() {
    let image = draw(&sphere(48, [0.0; 3]), Colors::CLAY, &options(201));
    for y in 0..201 {
        for x in 0..201 {
            let a = i32::from(image.pixel(x, y)[3]);
            let (left, down) = (image.pixel(200 - x, y)[3], image.pixel(x, 200 - y)[3]);
            assert!((a - i32::from(left)).abs() <= 57, "{x} {y}");
            assert!((a - i32::from(down)).abs() <= 57, "{x} {y}");
        }
    }
}

#[test]
fn the_nearer_surface_hides_the_farther() {
    let red = [255, 0, 0];
    let green = [0, 160, 0];
    for order in [[0.0, 0.3], [0.3, 0.0]] {
        let mesh = join(&[square(order[0], 1.0), square(order[1], 0.5)]);
        let colors: Vec<_> = [[red; 4], [green; 4]].concat();
        let image = draw(&mesh, Colors::PerVertex(&colors), &options(100));
        let [r, g, ..] = image.pixel(50, 50);
        let nearer_is_green = order[1] > order[0];
        assert_eq!(g > r, nearer_is_green, "{order:?}: {r} {g}");
        // The border of the larger square shows in either case.
        let [r, g, ..] = image.pixel(10, 50);
        assert!(r > g, "{order:?}: {r} {g}");
    }
}

/// Equal colours at all vertices or faces are the uniform colour, and light
/// is white: grey stays grey.
#[test]
fn a_constant_field_has_one_colour() {
    let mesh = sphere(24, [0.0; 3]);
    let clay = [180, 180, 180];
    let constant = vec![clay; mesh.vertex_count()];
    let image = draw(&mesh, Colors::PerVertex(&constant), &options(80));
    assert_eq!(image, draw(&mesh, Colors::Uniform(clay), &options(80)));
    let by_face = vec![clay; mesh.face_count()];
    assert_eq!(image, draw(&mesh, Colors::PerFace(&by_face), &options(80)));
    assert!(image.pixels().iter().all(|p| p[0] == p[1] && p[1] == p[2]));
}

#[test]
fn both_sides_show_and_the_inner_one_is_tinted() {
    let (p, f) = square(0.0, 1.0);
    let outer = TriMesh::new(p.to_vec(), f.to_vec()).unwrap();
    let inner = TriMesh::new(p.to_vec(), f.iter().map(|&[a, b, c]| [a, c, b]).collect()).unwrap();
    let plain = RenderOptions { back_tint: None, ..options(40) };
    assert_eq!(draw(&outer, Colors::CLAY, &plain), draw(&inner, Colors::CLAY, &plain));
    let ratio = |mesh: &TriMesh| {
        let [r, _, b, a] = draw(mesh, Colors::CLAY, &options(40)).pixel(20, 20);
        assert_eq!(a, 255);
        f64::from(b) / f64::from(r)
    };
    assert!(ratio(&inner) > ratio(&outer) + 0.03, "the tint is bluish");
}

/// The bottom of a valley sees little of the sky, its rim nearly all of it.
#[test]
fn crevices_are_darker() {
    let n = 20u32;
    let mut positions = vec![];
    for j in 0..=n {
        for i in 0..=n {
            let x = 2.0 * f64::from(i) / f64::from(n) - 1.0;
            let y = 2.0 * f64::from(j) / f64::from(n) - 1.0;
            // A valley along y.
            positions.push([x, y, 3.0 * x.abs()]);
        }
    }
    let mut faces = vec![];
    for j in 0..n {
        for i in 0..n {
            let a = j * (n + 1) + i;
            faces.extend([[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]);
        }
    }
    let mesh = TriMesh::new(positions, faces).unwrap();
    let occlusion = Occlusion::bake(&mesh);
    let at = |i: u32| occlusion.front()[((n / 2) * (n + 1) + i) as usize];
    assert!(at(n / 2) < 0.35, "bottom of the valley {}", at(n / 2));
    assert!(at(0) > 0.75, "rim {}", at(0));
    // From below the same line is a ridge.
    assert!(occlusion.back()[((n / 2) * (n + 1) + n / 2) as usize] > 0.95);
    let camera = front(&mesh);
    let lit = |o| render(&mesh, Colors::CLAY, o, &camera, &options(100)).unwrap();
    let (with, without) = (lit(Some(&occlusion)), lit(None));
    assert!(u16::from(with.pixel(50, 50)[0]) + 30 < u16::from(without.pixel(50, 50)[0]));
}

/// Far from the origin, 32-bit coordinates would leave steps of half a unit.
#[test]
fn map_coordinates_give_the_same_picture() {
    let (near, far) = (sphere(24, [0.0; 3]), sphere(24, [500_000.0, 4_649_776.0, 100.0]));
    let [a, b] = [&near, &far].map(|m| draw(m, Colors::CLAY, &options(90)));
    let differing = a
        .pixels()
        .iter()
        .zip(b.pixels())
        .filter(|(p, q)| p.iter().zip(q.iter()).any(|(a, b)| a.abs_diff(*b) > 2));
    // A sample on an edge may fall to the other side.
    assert!(differing.count() < 20);
}

#[test]
fn lines_show_on_a_coarse_mesh_and_fade_on_a_dense_one() {
    let wire = RenderOptions { wireframe: Some(Wireframe::default()), ..options(120) };
    let change = |n: u32| {
        let mesh = sphere(n, [0.0; 3]);
        let (a, b) = (draw(&mesh, Colors::CLAY, &options(120)), draw(&mesh, Colors::CLAY, &wire));
        let differing = a.pixels().iter().zip(b.pixels()).filter(|(p, q)| p != q).count();
        differing as f64 / (120.0 * 120.0)
    };
    assert!(change(6) > 0.08, "{}", change(6));
    assert_eq!(change(120), 0.0);
}

/// A square behind the camera does not show; a floor that reaches past the
/// camera is cut off, not thrown away or turned inside out.
#[test]
fn what_is_behind_the_camera_does_not_show() {
    let small = sphere(16, [0.0; 3]);
    let camera = front(&small);
    let eye = camera.eye()[2];
    let behind = join(&[square(eye + 1.0, 100.0)]);
    let image = render(&behind, Colors::CLAY, None, &camera, &options(60)).unwrap();
    assert!(image.pixels().iter().all(|p| p[3] == 0));
    // A floor that runs from far in front to far behind, below the eye.
    let floor = TriMesh::new(
        vec![[-9.0, -1.0, -20.0], [-9.0, -1.0, 20.0], [9.0, -1.0, 20.0], [9.0, -1.0, -20.0]],
        vec![[0, 1, 2], [0, 2, 3]],
    )
    .unwrap();
    let image = render(&floor, Colors::CLAY, None, &camera, &options(60)).unwrap();
    assert_eq!(image.pixel(30, 59)[3], 255);
    assert_eq!(image.pixel(30, 25)[3], 0);
}

#[test]
fn background_and_alpha() {
    let mesh = sphere(24, [0.0; 3]);
    let white = RenderOptions { background: Background::WHITE, ..options(50) };
    let image = draw(&mesh, Colors::CLAY, &white);
    assert_eq!(image.pixel(0, 0), [255; 4]);
    assert!(image.pixels().iter().all(|p| p[3] == 255));
    assert_eq!(draw(&mesh, Colors::CLAY, &options(50)).pixel(0, 0), [0; 4]);
}

#[test]
fn threads_do_not_change_the_picture() {
    let mesh = sphere(40, [0.0; 3]);
    let shaded = RenderOptions {
        shading: Shading::Creased { degrees: 30.0 },
        wireframe: Some(Wireframe::default()),
        ..options(150)
    };
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let occlusion = Occlusion::bake(&mesh);
            let image =
                render(&mesh, Colors::CLAY, Some(&occlusion), &front(&mesh), &shaded).unwrap();
            (occlusion, image)
        })
    };
    let one = run(1);
    for threads in [2, 3, 8] {
        assert_eq!(run(threads), one);
    }
}

#[test]
fn what_cannot_be_drawn_is_refused() {
    let mesh = sphere(4, [0.0; 3]);
    let camera = front(&mesh);
    let error =
        |m: &TriMesh, c: Colors<'_>, o: &RenderOptions| render(m, c, None, &camera, o).unwrap_err();
    assert_eq!(
        error(&mesh, Colors::CLAY, &options(0)),
        FigureError::Size { width: 0, height: 0, samples: 3 }
    );
    assert_eq!(
        error(&mesh, Colors::PerVertex(&[[0; 3]; 2]), &options(10)),
        FigureError::Count { what: "colours", expected: mesh.vertex_count(), found: 2 }
    );
    let points = TriMesh::new(vec![[0.0; 3]; 2], vec![]).unwrap();
    assert_eq!(error(&points, Colors::CLAY, &options(10)), FigureError::NoFaces { vertices: 2 });
    // A mesh that has grown without overflowing is drawn.
    let grown = mesh.positions().iter().map(|p| p.map(|x| 4e29 * x)).collect();
    let grown = mesh.with_positions(grown).unwrap();
    render(&grown, Colors::CLAY, None, &camera, &options(10)).unwrap();
    assert_eq!(Occlusion::bake(&points).front(), [1.0; 2]);
}

#[test]
fn png_holds_the_pixels() {
    let image = draw(&sphere(8, [0.0; 3]), Colors::CLAY, &options(33));
    let bytes = image.to_png().unwrap();
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    assert_eq!((info.width, info.height), (33, 33));
    assert_eq!(pixels, image.pixels().as_flattened());
}

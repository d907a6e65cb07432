//! Every numbered formula of `docs/ellipsoid.md`, compared with automatic differentiation of the
//! parametrisation; the closed forms of the other surfaces likewise.

use std::f64::consts::{FRAC_PI_2, PI};
use std::ops::{Add, Mul};

use fairing_operators::surface::{
    ClosedForms, Cylinder, Ellipsoid, Helicoid, ImplicitSurface, ParametricSurface, Sphere,
    SurfaceJet, Torus, WavyGraph,
};
use glam::DVec3;

/// A function of u and v with its derivatives to second order at a point.
#[derive(Clone, Copy)]
struct Dual {
    x: f64,
    u: f64,
    v: f64,
    uu: f64,
    uv: f64,
    vv: f64,
}

impl Dual {
    fn constant(x: f64) -> Self {
        Self { x, u: 0.0, v: 0.0, uu: 0.0, uv: 0.0, vv: 0.0 }
    }

    fn parameters(u: f64, v: f64) -> (Self, Self) {
        (Self { u: 1.0, ..Self::constant(u) }, Self { v: 1.0, ..Self::constant(v) })
    }

    /// f ∘ self, from f and its first two derivatives at self.
    fn chain(self, f: f64, df: f64, ddf: f64) -> Self {
        Self {
            x: f,
            u: df * self.u,
            v: df * self.v,
            uu: df * self.uu + ddf * self.u * self.u,
            uv: df * self.uv + ddf * self.u * self.v,
            vv: df * self.vv + ddf * self.v * self.v,
        }
    }

    fn sin(self) -> Self {
        self.chain(self.x.sin(), self.x.cos(), -self.x.sin())
    }

    fn cos(self) -> Self {
        self.chain(self.x.cos(), -self.x.sin(), -self.x.cos())
    }
}

impl Add for Dual {
    type Output = Self;

    fn add(self, o: Self) -> Self {
        Self {
            x: self.x + o.x,
            u: self.u + o.u,
            v: self.v + o.v,
            uu: self.uu + o.uu,
            uv: self.uv + o.uv,
            vv: self.vv + o.vv,
        }
    }
}

impl Mul for Dual {
    type Output = Self;

    fn mul(self, o: Self) -> Self {
        Self {
            x: self.x * o.x,
            u: self.u * o.x + self.x * o.u,
            v: self.v * o.x + self.x * o.v,
            uu: self.uu * o.x + 2.0 * self.u * o.u + self.x * o.uu,
            uv: self.uv * o.x + self.u * o.v + self.v * o.u + self.x * o.uv,
            vv: self.vv * o.x + 2.0 * self.v * o.v + self.x * o.vv,
        }
    }
}

impl Mul<Dual> for f64 {
    type Output = Dual;

    fn mul(self, o: Dual) -> Dual {
        Dual::constant(self) * o
    }
}

fn jet(p: [Dual; 3]) -> SurfaceJet {
    SurfaceJet {
        point: p.map(|d| d.x),
        du: p.map(|d| d.u),
        dv: p.map(|d| d.v),
        duu: p.map(|d| d.uu),
        duv: p.map(|d| d.uv),
        dvv: p.map(|d| d.vv),
    }
}

/// The parametrisation, independent of the library.
fn differentiate(e: &Ellipsoid, u: f64, v: f64) -> SurfaceJet {
    let (u, v) = Dual::parameters(u, v);
    jet([e.a * (u.cos() * v.sin()), e.b * (u.sin() * v.sin()), e.c * v.cos()])
}

const ELLIPSOIDS: [Ellipsoid; 4] = [
    Ellipsoid { a: 1.0, b: 1.5, c: 2.0 },
    Ellipsoid { a: 3.0, b: 0.7, c: 1.1 },
    Ellipsoid { a: 2.0, b: 2.0, c: 0.5 },
    Ellipsoid { a: 1.3, b: 1.3, c: 1.3 },
];

/// Points over the whole chart except the poles.
fn chart() -> Vec<(f64, f64)> {
    let us = (0..12).map(|i| 0.11 + f64::from(i) * PI / 6.0);
    us.flat_map(|u| (1..12).map(move |j| (u, f64::from(j) * PI / 12.0))).collect()
}

fn everywhere(check: impl Fn(&Ellipsoid, f64, f64, &SurfaceJet)) {
    for e in &ELLIPSOIDS {
        for (u, v) in chart() {
            check(e, u, v, &differentiate(e, u, v));
        }
    }
}

/// Closed forms and automatic derivatives differ by rounding only: a dozen operations on numbers of
/// order ten.
#[track_caller]
fn close(a: f64, b: f64) {
    assert!((a - b).abs() <= 1e-13 * (1.0 + a.abs().max(b.abs())), "{a} {b}");
}

#[track_caller]
fn close3(a: impl Into<[f64; 3]>, b: impl Into<[f64; 3]>) {
    let (a, b) = (a.into(), b.into());
    for k in 0..3 {
        close(a[k], b[k]);
    }
}

/// The inward unit normal; the centre decides the sign.
fn inward(jet: &SurfaceJet) -> DVec3 {
    let n = across(jet).normalize();
    if n.dot(jet.point.into()) < 0.0 { n } else { -n }
}

/// ∂p/∂u × ∂p/∂v
fn across(jet: &SurfaceJet) -> DVec3 {
    DVec3::from(jet.du).cross(jet.dv.into())
}

#[track_caller]
fn same_jet(a: &SurfaceJet, b: &SurfaceJet) {
    close3(a.point, b.point);
    close3(a.du, b.du);
    close3(a.dv, b.dv);
    close3(a.duu, b.duu);
    close3(a.duv, b.duv);
    close3(a.dvv, b.dvv);
}

#[test]
fn formulas_1_and_7_derivatives() {
    everywhere(|e, u, v, d| {
        same_jet(&e.jet(u, v), d);
        let ((su, cu), (sv, cv)) = (u.sin_cos(), v.sin_cos());
        close3(d.du, [-e.a * su * sv, e.b * cu * sv, 0.0]);
        close3(d.dv, [e.a * cu * cv, e.b * su * cv, -e.c * sv]);
        close3(d.dvv, -DVec3::from(d.point));
    });
}

#[test]
fn formula_2_first_form() {
    everywhere(|e, u, v, d| {
        let [du, dv] = [d.du, d.dv].map(DVec3::from);
        close3(e.first_form(u, v), [du.dot(du), du.dot(dv), dv.dot(dv)]);
        close3(e.forms(u, v).unwrap().first, e.first_form(u, v));
    });
}

#[test]
fn formulas_3_and_6_the_cross_product_points_inward() {
    everywhere(|e, u, v, d| {
        let ((su, cu), (sv, cv)) = (u.sin_cos(), v.sin_cos());
        let bracket = DVec3::new(e.b * e.c * cu * sv, e.a * e.c * su * sv, e.a * e.b * cv);
        close3(across(d), -sv * bracket);
        assert!(across(d).dot(d.point.into()) < 0.0);
        close3(inward(d), bracket * (-1.0 / e.discriminant(u, v).sqrt()));
        close3(e.forms(u, v).unwrap().normal, -inward(d));
    });
}

#[test]
fn formulas_4_and_5_discriminant() {
    everywhere(|e, u, v, d| {
        let [x, y, z] = d.point;
        let sum = (x / e.a.powi(2)).powi(2) + (y / e.b.powi(2)).powi(2) + (z / e.c.powi(2)).powi(2);
        close(e.discriminant(u, v), (e.a * e.b * e.c).powi(2) * sum);
        let [ee, f, g] = e.first_form(u, v);
        close(ee * g - f * f, v.sin().powi(2) * e.discriminant(u, v));
        close(ee * g - f * f, across(d).length_squared());
    });
}

#[test]
fn formula_8_second_form() {
    everywhere(|e, u, v, d| {
        let m = inward(d);
        close3(e.second_form(u, v), [d.duu, d.duv, d.dvv].map(|x| m.dot(x.into())));
        close3(e.forms(u, v).unwrap().second, e.second_form(u, v));
    });
}

#[test]
fn formula_9_normal_curvature_in_any_direction() {
    everywhere(|e, u, v, d| {
        let forms = e.forms(u, v).unwrap();
        for i in 0..8 {
            let (dv, du) = (f64::from(i) * 0.4).sin_cos();
            // The curve (u + t du, v + t dv): κₙ = c″·m / ‖c′‖².
            let first = du * DVec3::from(d.du) + dv * DVec3::from(d.dv);
            let [uu, uv, vv] = [d.duu, d.duv, d.dvv].map(DVec3::from);
            let second = du * du * uu + 2.0 * du * dv * uv + dv * dv * vv;
            let expected = second.dot(inward(d)) / first.length_squared();
            close(forms.normal_curvature([du, dv]).unwrap(), expected);
            let [ee, f, g] = e.first_form(u, v);
            let abc = e.a * e.b * e.c;
            let form = (v.sin() * du).powi(2) + dv * dv;
            let length = ee * du * du + 2.0 * f * du * dv + g * dv * dv;
            close(abc * form / (e.discriminant(u, v).sqrt() * length), expected);
        }
        assert_eq!(forms.normal_curvature([0.0, 0.0]), None);
    });
}

/// Comparison with the level set, which needs no chart.
#[test]
fn formulas_10_and_11_gaussian_and_mean() {
    everywhere(|e, u, v, d| {
        let forms = e.forms(u, v).unwrap();
        close(e.gaussian_curvature(u, v), forms.gaussian_curvature());
        close(e.mean_curvature(u, v), forms.mean_curvature());
        let point = e.curvature(d.point).unwrap();
        close(point.gaussian(), e.gaussian_curvature(u, v));
        close(point.mean(), e.mean_curvature(u, v));
        close3(point.normal, forms.normal);
    });
}

#[test]
fn formulas_12_to_14_at_the_end_of_the_first_axis() {
    for e in &ELLIPSOIDS {
        let (a, b, c) = (e.a, e.b, e.c);
        let forms = e.forms(0.0, FRAC_PI_2).unwrap();
        close3(e.jet(0.0, FRAC_PI_2).point, [a, 0.0, 0.0]);
        close3(forms.du, [0.0, b, 0.0]);
        close3(forms.dv, [0.0, 0.0, -c]);
        close3(forms.normal, [1.0, 0.0, 0.0]);
        close3(forms.first, [b * b, 0.0, c * c]);
        close3(forms.second, [a, 0.0, a]);
        close(forms.mean_curvature(), 0.5 * (a / (b * b) + a / (c * c)));
        close(forms.gaussian_curvature(), (a / (b * c)).powi(2));
        for i in 0..=12 {
            let theta = f64::from(i) * PI / 12.0;
            let direction = [theta.cos() / b, -theta.sin() / c];
            let kappa = forms.normal_curvature(direction).unwrap();
            close(kappa, e.normal_curvature_at_a(theta));
            close(kappa, a * ((theta.cos() / b).powi(2) + (theta.sin() / c).powi(2)));
        }
    }
}

/// The original report's κₙ = −1/c is neither along y nor along z, up to sign,
/// unless the ellipsoid is a sphere.
#[test]
fn the_claim_of_the_report_holds_on_spheres_only() {
    for e in &ELLIPSOIDS {
        let along_y = e.normal_curvature_at_a(0.0);
        let along_z = e.normal_curvature_at_a(FRAC_PI_2);
        let sphere = e.a == e.b && e.b == e.c;
        assert_eq!((along_y - 1.0 / e.c).abs() < 1e-12, sphere);
        assert_eq!((along_z - 1.0 / e.c).abs() < 1e-12, sphere);
    }
}

/// At the pole the chart is singular, its second form tends to (0, 0, c), and
/// H and K take their limits.
#[test]
fn formulas_15_and_16_at_the_poles() {
    for e in &ELLIPSOIDS {
        let (a, b, c) = (e.a, e.b, e.c);
        for v in [0.0, PI] {
            assert!(matches!(
                e.forms(0.3, v),
                Err(fairing_operators::OperatorError::SingularChart { .. })
            ));
            let pole = e.curvature([0.0, 0.0, c * v.cos()]).unwrap();
            close(e.gaussian_curvature(0.3, v), pole.gaussian());
            close(e.mean_curvature(0.3, v), pole.mean());
            close(pole.gaussian(), (c / (a * b)).powi(2));
        }
        // The distance from the limit is of first order in v².
        let v = 1e-6;
        for (u, _) in chart() {
            let [l, m, n] = e.second_form(u, v);
            assert!(l.abs() < 1e-10 && m == 0.0 && (n - c).abs() < 1e-10);
            assert!((e.discriminant(u, v) - (a * b).powi(2)).abs() < 1e-10);
            let kappa = e.forms(u, v).unwrap().normal_curvature([0.0, 1.0]).unwrap();
            let limit = c / ((a * u.cos()).powi(2) + (b * u.sin()).powi(2));
            assert!((kappa - limit).abs() < 1e-10, "{kappa} {limit}");
        }
    }
}

/// Principal values are the extremes of κₙ, directions are conjugate and
/// orthogonal, and the level set agrees.
#[test]
fn principal_directions() {
    everywhere(|e, u, v, d| {
        let forms = e.forms(u, v).unwrap();
        let p = forms.principal();
        assert!(p.values[0] >= p.values[1]);
        close(0.5 * (p.values[0] + p.values[1]), e.mean_curvature(u, v));
        close(p.values[0] * p.values[1], e.gaussian_curvature(u, v));
        let directions = p.directions.map(DVec3::from);
        for k in 0..2 {
            close(directions[k].length(), 1.0);
            // At an umbilic the value is the same in every direction.
            close(forms.normal_curvature(p.parameters[k]).unwrap(), p.values[k]);
        }
        close3(directions[0].cross(directions[1]), forms.normal);
        let point = e.curvature(d.point).unwrap();
        close(point.values[0], p.values[0]);
        if p.values[0] - p.values[1] > 1e-2 {
            // Rounding of the form over the gap of the values.
            let sine = DVec3::from(point.directions[0]).cross(directions[0]).length();
            assert!(sine < 1e-11, "{sine}");
        }
    });
}

fn same_surface<S: ClosedForms>(surface: &S, p: impl Fn(Dual, Dual) -> [Dual; 3]) {
    for (u, v) in chart() {
        let (du, dv) = Dual::parameters(u, v);
        same_jet(&surface.jet(u, v), &jet(p(du, dv)));
        let forms = surface.forms(u, v).unwrap();
        close3(forms.first, surface.first_form(u, v));
        close3(forms.second, surface.second_form(u, v));
        close(forms.mean_curvature(), surface.mean_curvature(u, v));
        close(forms.gaussian_curvature(), surface.gaussian_curvature(u, v));
    }
}

#[test]
fn closed_forms_of_the_other_surfaces() {
    let sphere = Sphere { radius: 1.7 };
    same_surface(&sphere, |u, v| {
        [1.7 * (u.cos() * v.sin()), 1.7 * (u.sin() * v.sin()), 1.7 * v.cos()]
    });
    let torus = Torus { major: 3.0, minor: 1.0 };
    same_surface(&torus, |u, v| {
        let rho = Dual::constant(3.0) + v.cos();
        [rho * u.cos(), rho * u.sin(), v.sin()]
    });
    same_surface(&Helicoid { rise: 0.6 }, |u, v| [v * u.cos(), v * u.sin(), 0.6 * u]);
    same_surface(&Cylinder { radius: 0.8 }, |u, v| [0.8 * u.cos(), 0.8 * u.sin(), v]);
}

#[test]
fn level_sets_agree_with_charts() {
    fn agree<S: ParametricSurface + ImplicitSurface>(surface: &S) {
        for (u, v) in chart() {
            let point = surface.curvature(surface.jet(u, v).point).unwrap();
            let forms = surface.forms(u, v).unwrap();
            close(point.gaussian(), forms.gaussian_curvature());
            close(point.mean(), forms.mean_curvature());
            close3(point.normal, forms.normal);
        }
    }
    agree(&Sphere { radius: 1.7 });
    agree(&Torus { major: 3.0, minor: 1.0 });
    agree(&Cylinder { radius: 0.8 });
    agree(&WavyGraph { amplitude: 0.4, wave_number: 1.3 });
    assert_eq!(Sphere { radius: 1.0 }.curvature([0.0; 3]), None);
}

#[test]
fn the_wavy_graph_is_differentiated_right() {
    let graph = WavyGraph { amplitude: 0.4, wave_number: 1.3 };
    for (u, v) in chart() {
        let (du, dv) = Dual::parameters(u, v);
        let z = 0.4 * ((1.3 * du).sin() * (1.3 * dv).cos());
        same_jet(&graph.jet(u, v), &jet([du, dv, z]));

        let gradient = DVec3::from(graph.gradient(graph.jet(u, v).point));
        close(gradient.dot(graph.jet(u, v).du.into()), 0.0);
    }
}

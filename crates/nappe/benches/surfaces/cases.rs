//! The surfaces of the benchmark: the inputs in `bench/inputs`, and a closed form of every kind.

use nappe::basis::{BSplineBasis, Blending};
use nappe::curve::CurveRef;
use nappe::exact::{NurbsCurve, NurbsSurface};
use nappe::surface::{
    Construction, Contour, Coons, CoonsOptions, DiagonalKey, DiagonalKeyOptions, Dir, Fillet,
    FilletOptions, Quadric, QuadricOptions, QuadricShape, Radius, Revolution, RevolutionOptions,
    SurfaceRef, Torus, TorusOptions, bilinear, biquadratic, ruled,
};
use nappe::{DVec3, Frame};
use serde_json::Value;
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

fn input(name: &str) -> Value {
    let path = format!(
        "{}/../../bench/inputs/{name}.json",
        env!("CARGO_MANIFEST_DIR")
    );
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn numbers(v: &Value) -> Vec<f64> {
    v.as_array()
        .unwrap()
        .iter()
        .map(|x| x.as_f64().unwrap())
        .collect()
}

fn points(v: &Value) -> Vec<DVec3> {
    v.as_array()
        .unwrap()
        .iter()
        .map(|p| DVec3::from_slice(&numbers(p)))
        .collect()
}

fn degree(v: &Value) -> usize {
    v.as_u64().unwrap() as usize
}

fn curve(v: &Value) -> CurveRef {
    let weights = v.get("weights").map(numbers);
    let c = NurbsCurve::new(
        degree(&v["degree"]),
        numbers(&v["knots"]),
        &points(&v["points"]),
        weights.as_deref(),
    );
    Arc::new(c.unwrap())
}

fn surface(name: &str) -> SurfaceRef {
    let v = input(name);
    let net: Vec<DVec3> = v["points"]
        .as_array()
        .unwrap()
        .iter()
        .flat_map(points)
        .collect();
    let weights: Option<Vec<f64>> = v
        .get("weights")
        .map(|w| w.as_array().unwrap().iter().flat_map(numbers).collect());
    let degrees = [degree(&v["degree_u"]), degree(&v["degree_v"])];
    let knots = [numbers(&v["knots_u"]), numbers(&v["knots_v"])];
    Arc::new(NurbsSurface::new(degrees, knots, &net, weights.as_deref()).unwrap())
}

/// Every case with the name of its kind.
pub(crate) fn all() -> Vec<(&'static str, SurfaceRef)> {
    let coons = input("coons");
    let [south, north, west, east] = ["c0_v0", "c1_v1", "d0_u0", "d1_u1"].map(|k| curve(&coons[k]));
    let boundary = |blend| -> SurfaceRef {
        let options = CoonsOptions {
            blend,
            ..CoonsOptions::default()
        };
        Arc::new(
            Coons::new(
                south.clone(),
                north.clone(),
                west.clone(),
                east.clone(),
                &options,
            )
            .unwrap(),
        )
    };
    let profile = curve(&input("profile"));
    let turn = |construction| -> SurfaceRef {
        let options = RevolutionOptions {
            construction,
            ..RevolutionOptions::default()
        };
        Arc::new(Revolution::new(profile.clone(), Frame::WORLD, options).unwrap())
    };
    let (o, x, y, z) = (DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z);
    let plane = |corners| -> SurfaceRef { Arc::new(bilinear(corners).unwrap()) };
    let (floor, wall) = (plane([[o, y], [x, x + y]]), plane([[o, z], [x, x + z]]));
    let quadric = |shape: QuadricShape, axes: &[f64]| -> SurfaceRef {
        Arc::new(Quadric::new(shape, axes, QuadricOptions::default()).unwrap())
    };
    let nine = [0.0, 1.0, 2.0]
        .map(|x| [0.0, 1.0, 2.0].map(|y| DVec3::new(x, y, (3.0 * x * x + y) % 2.5 * 0.2)));
    let contour = Contour::new(south.clone(), north.clone(), west.clone(), east.clone()).unwrap();
    let bezier: Vec<DVec3> = (0..16)
        .map(|i| DVec3::new((i / 4) as f64, (i % 4) as f64, ((i * 7) % 5) as f64 * 0.3))
        .collect();
    vec![
        ("bilinear", plane([[o, y], [x + z, y + z]])),
        (
            "bezier 3x3",
            Arc::new(NurbsSurface::bezier(4, &bezier, None).unwrap()),
        ),
        (
            "biquadratic",
            Arc::new(biquadratic(&nine, 0.7, 0.8).unwrap()),
        ),
        ("nurbs bicubic 20x20", surface("bicubic")),
        ("nurbs rational torus", surface("torus")),
        (
            "ruled",
            Arc::new(ruled(south.clone(), north.clone(), Dir::U).unwrap()),
        ),
        ("coons linear", boundary(Blending::linear())),
        ("coons cubic", boundary(Blending::cubic())),
        (
            "coons trigonometric",
            boundary(Blending::trigonometric(FRAC_PI_2).unwrap()),
        ),
        ("revolution angle", turn(Construction::Angle)),
        ("revolution rational", turn(Construction::Rational)),
        ("sphere", quadric(QuadricShape::Sphere, &[1.0])),
        (
            "hyperboloid-1",
            quadric(QuadricShape::Hyperboloid1, &[1.0, 1.2, 0.8]),
        ),
        ("cone", quadric(QuadricShape::Cone, &[1.0, 1.0, 1.0])),
        (
            "torus",
            Arc::new(Torus::new(3.0, 1.0, TorusOptions::default()).unwrap()),
        ),
        (
            "fillet",
            Arc::new(
                Fillet::new(
                    &floor,
                    &wall,
                    Radius::Constant(0.2),
                    FilletOptions::default(),
                )
                .unwrap(),
            ),
        ),
        (
            "diagonal-key",
            Arc::new(DiagonalKey::new(contour, &DiagonalKeyOptions::default()).unwrap()),
        ),
        ("nurbs degree 5", {
            let net: Vec<DVec3> = (0..100)
                .map(|i| {
                    DVec3::new(
                        (i / 10) as f64,
                        (i % 10) as f64,
                        ((i * 7) % 11) as f64 * 0.1,
                    )
                })
                .collect();
            let knots = BSplineBasis::clamped_uniform(5, 10);
            Arc::new(NurbsSurface::new([5, 5], [knots.clone(), knots], &net, None).unwrap())
        }),
    ]
}

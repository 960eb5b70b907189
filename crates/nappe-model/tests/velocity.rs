//! Velocities of a model's objects: against differences of models that are built anew, and what is refused.

#![allow(clippy::unwrap_used)]

use nappe::laws::Random;
use nappe::surface::Dir;
use nappe::{Break, Breaks, DVec3};
use nappe_model::{Model, Overrides, Velocities, Velocity, load, parse, velocities};
use std::path::{Path, PathBuf};

/// Relative step of the differences, and the share of the objects' size by which they may differ from the velocity times
/// the parameter's size: with Richardson's rule the error of differences is h⁴ and 1e-16/h.
const STEP: f64 = 1e-3;
const AGREE: f64 = 1e-8;

/// Builds a model; `None` if it cannot be.
type Build<'a> = &'a dyn Fn(&Overrides) -> Option<Model>;

/// The model with another value of a parameter.
fn at(build: Build, name: &str, value: f64) -> Option<Model> {
    let mut o = Overrides::default();
    o.set(name, &format!("{value:?}"));
    build(&o)
}

/// The parameter with the same share of the way between two breaks, of two curves that have equally many.
fn carried(t: f64, [from, to]: [&[Break]; 2]) -> f64 {
    assert_eq!(from.len(), to.len());
    let k = (1..from.len() - 1).find(|&k| t < from[k].at);
    let k = k.unwrap_or(from.len() - 1);
    let share = (t - from[k - 1].at) / (from[k].at - from[k - 1].at);
    to[k - 1].at + share * (to[k].at - to[k - 1].at)
}

/// Compares all velocities with differences; gives the numbers of moving, still and unknown objects.
fn compare(build: Build, what: &str, parameter: &str) -> Option<[usize; 3]> {
    let none = Overrides::default();
    let model = build(&none)?;
    let found = velocities(&model, &none, parameter)
        .unwrap_or_else(|e| panic!("{what}, {parameter}: {}", e.list[0].message));
    let scale = if found.value == 0.0 {
        1.0
    } else {
        found.value.abs()
    };
    let h = STEP * scale;
    let steps = [h, -h, 0.5 * h, -0.5 * h].into_iter();
    let models: Option<Vec<Model>> = steps
        .map(|d| at(build, parameter, found.value + d))
        .collect();
    let models = models?;
    let difference = |p: [DVec3; 4]| {
        let [coarse, fine] = [(p[0] - p[1]) / (2.0 * h), (p[2] - p[3]) / h];
        (fine * 4.0 - coarse) / 3.0
    };
    let mut random = Random(7);
    let mut counts = [0; 3];
    let check = |got: DVec3, points: [DVec3; 4], size: f64, name: &str| {
        let want = difference(points);
        let error = (got - want).length() * scale;
        // Points are rounded in proportion to their distance from the origin.
        let rounding = 16.0 * f64::EPSILON * points[0].length() / STEP;
        assert!(
            error <= AGREE * size.max(got.length() * scale) + rounding,
            "{what}: {name} by {parameter}: {got} is not {want} (size {size})"
        );
    };
    for (i, curve) in model.curves.iter().enumerate() {
        let domain = curve.curve.domain();
        let size = curve.curve.bounds(domain).diagonal();
        let size = if size.is_finite() { size } else { 1.0 };
        let velocity = match &found.curves[i] {
            Velocity::Unknown(_) => {
                counts[2] += 1;
                continue;
            }
            Velocity::Still => None,
            Velocity::Moves(v) | Velocity::Follows(v) => Some(v),
        };
        let follows = matches!(found.curves[i], Velocity::Follows(_));
        counts[usize::from(velocity.is_none())] += 1;
        for _ in 0..20 {
            let t = random.within(domain);
            let got = velocity.map_or(DVec3::ZERO, |v| v.point(t));
            let points = [0, 1, 2, 3].map(|k| {
                let other = &models[k].curves[i].curve;
                let breaks = [curve.curve.breaks(), other.breaks()];
                other.point(if follows { carried(t, breaks) } else { t })
            });
            check(got, points, size, &curve.name);
        }
    }
    for (i, surface) in model.surfaces.iter().enumerate() {
        let domain = surface.surface.domain();
        let size = surface.surface.bounds(domain).diagonal();
        let velocity = match &found.surfaces[i] {
            Velocity::Unknown(_) => {
                counts[2] += 1;
                continue;
            }
            Velocity::Still => None,
            Velocity::Moves(v) | Velocity::Follows(v) => {
                assert_eq!(v.domain(), domain, "{what}: {}", surface.name);
                Some(v)
            }
        };
        let follows = matches!(found.surfaces[i], Velocity::Follows(_));
        counts[usize::from(velocity.is_none())] += 1;
        for _ in 0..20 {
            let uv = domain.map(|d| random.within(d));
            let got = velocity.map_or(DVec3::ZERO, |v| v.point(uv));
            let points = [0, 1, 2, 3].map(|k| {
                let other = &models[k].surfaces[i].surface;
                let at = [Dir::U, Dir::V].map(|dir| {
                    let t = uv[usize::from(dir == Dir::V)];
                    let breaks = [surface.surface.breaks(dir), other.breaks(dir)];
                    if follows { carried(t, breaks) } else { t }
                });
                other.point(at)
            });
            check(got, points, size, &surface.name);
            // The velocity encloses itself and its derivatives.
            if let Some(v) = velocity {
                let around = [0, 1].map(|d| {
                    let breaks = v.breaks([Dir::U, Dir::V][d]);
                    let piece = breaks.piece(breaks.find(uv[d], nappe::Limit::Above));
                    nappe::Interval::new(uv[d], (uv[d] + 0.01).min(piece.hi))
                });
                let mut boxes = vec![nappe::Box3::ENTIRE; 6];
                v.enclose_piece(around, [nappe::Limit::Above; 2], 2, &mut boxes);
                let inside = [0, 1].map(|d| around[d].mid());
                let jet = v.jet(inside, [nappe::Limit::Above; 2], 2);
                for (b, p) in boxes.iter().zip(&jet.d) {
                    let slack = 1e-12 * (1.0 + p.length() + size / scale);
                    assert!(
                        b.inflate(slack).contains(*p),
                        "{what}: {}: {b:?} {p}",
                        surface.name
                    );
                }
            }
        }
    }
    Some(counts)
}

#[test]
fn velocities_of_all_examples_agree_with_differences() {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let paths = std::fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap().path());
    let paths: Vec<PathBuf> = paths
        .filter(|p| p.extension().is_some_and(|e| e == "toml"))
        .collect();
    let moving: usize = std::thread::scope(|scope| {
        let threads: Vec<_> = paths
            .iter()
            .map(|path| scope.spawn(move || example(path)))
            .collect();
        threads.into_iter().map(|t| t.join().unwrap()).sum()
    });
    assert!(moving > 100, "{moving}");
}

/// Compares the velocities of an example for each of its parameters; gives how many objects move.
fn example(path: &Path) -> usize {
    let build = |o: &Overrides| load(path, o).ok();
    let model = build(&Overrides::default()).unwrap();
    let name = path.file_name().unwrap().to_string_lossy();
    let mut moving = 0;
    for p in &model.params {
        // A parameter that is an expression may not be free: contours open when it changes alone.
        let Some(counts) = compare(&build, &name, &p.name) else {
            assert!(p.expression.is_some(), "{name}, {}", p.name);
            continue;
        };
        moving += counts[0];
    }
    moving
}

/// A model with one parameter p of a value.
fn model(p: f64, rest: &str) -> impl Fn(&Overrides) -> Option<Model> + use<> {
    let text = format!("nappe = 1\n[params]\np = {p:?}\n{rest}");
    move |o| {
        let built = parse(&text, "test", o);
        let all = |e: nappe_model::Diagnostics| e.list.iter().map(|d| d.message.clone()).collect();
        let built = built.map_err(|e| -> Vec<String> { all(e) });
        Some(built.unwrap_or_else(|e| panic!("{}: {text}", e.join("; "))))
    }
}

#[test]
fn velocities_of_every_kind_agree_with_differences() {
    let base = r#"
[curves.arc]
kind = "arc"
center = [0, 0, 3]
radius = 2
from = "10deg"
to = "70deg"
[surfaces.sheet]
kind = "bezier"
points = [[[0, 0, 0], [0, 5, 2], [0, 10, 0]], [[4, 0, 3], [5, 5, 1], [4, 10, 3]], [[10, 0, 0], [11, 5, 2], [10, 10, 0]]]
"#;
    let curves = [
        r#"kind = "line"
from = ["p", 0, "p^2"]
to = [3, "1/p", 0]"#,
        r#"kind = "polyline"
points = [[0, 0, 0], ["p", 1, 0], [3, "p", 1]]
parametrization = "uniform""#,
        r#"kind = "polyline"
points = [[0, 0, 0], ["p", "2*p", 0], ["3*p", "p", "p"]]"#,
        r#"kind = "bezier"
points = [[1e5, 0, 0], ["1e5 + p", 1, 0], ["1e5 + 3", "p", 1]]
weights = [1, "p", "2 + p"]"#,
        r#"kind = "nurbs"
degree = 2
points = [[0, 0, 0], ["p", 1, 0], [3, "p", 1], [5, 0, "p"]]
weights = [1, 2, "sqrt(p)", 1]"#,
        r#"kind = "hermite"
from = ["p", 0, 0]
to = [3, "p", 0]
from_tangent = [0, 0, "p"]
to_tangent = ["p", 0, 1]"#,
        r#"kind = "arc"
center = ["p", 1, 0]
radius = "2*p"
from = "10*p deg"
to = "1 + p rad"
normal = [0.1, "p", 3]"#,
        r#"kind = "circle"
center = [100, "p", 0]
radius = "p"
normal = ["p", 1, "2 - p"]
x_direction = [1, "p/2", 0]"#,
        r#"kind = "ellipse"
semi_axes = ["p", "3 - p"]
from = "p rad""#,
        r#"kind = "conic"
points = [[0, 0, 0], ["p", 3, 0], [4, 0, "p"]]
weight = "p/2""#,
        r#"kind = "interpolate"
points = [[0, 0, 0], ["p", 1, 0], [3, "p", 1], [5, 0, "p"], [6, 1, 0]]
parametrization = "uniform"
start_tangent = ["p", 0, 1]"#,
        r#"kind = "interpolate"
closed = true
points = [[0, 0, 0], ["4*p", 0, 0], ["4*p", "4*p", "p"], [0, "4*p", 0], [0, 0, 0]]"#,
        // The corners move along the parameter.
        r#"kind = "polyline"
points = [[0, 0, 0], ["p", 1, 0], [3, "p", 1], [3, 5, "p^2"]]"#,
        r#"kind = "polyline"
points = [[1e5, 0, 0], ["1e5 + p", 1, 0], ["1e5 + 3", "p", 1]]
parametrization = "centripetal""#,
        r#"kind = "reverse"
curve = { kind = "polyline", points = [[0, 0, 0], ["p", 1, 0], [3, "p", 1], [3, 5, 0]] }"#,
        r#"kind = "join"
curves = [{ kind = "line", from = [0, "p", 0], to = [1, "p", 0] }, { kind = "polyline", points = [[1, "p", 0], ["5*p", 3, 0], [9, 9, 9]] }]"#,
        r#"kind = "transform"
curve = { kind = "polyline", points = [[0, 0, 0], ["p", 1, 0], [3, "p", 1], [3, 5, 0]] }
rotate = { axis = "x", angle = "p rad" }"#,
        // The knots move with the points.
        r#"kind = "interpolate"
points = [[0, 0, 0], ["p", 1, 0], [3, "p", 1], [5, 0, "p"], [6, 1, 0]]"#,
        r#"kind = "interpolate"
points = [[0, 0, 0], ["p", 1, 0], [3, "p", 1], [5, 0, "p"], [6, 1, 0]]
parametrization = "centripetal"
start_tangent = ["p", 0, 1]
end_tangent = [0, "p^2", 0]"#,
        r#"kind = "interpolate"
points = [[0, 0, 0], ["p", 1, 0], [3, "p", 1]]
end_tangent = [0, 20, 0]"#,
        r#"kind = "interpolate"
closed = true
points = [[0, 0, 0], [4, 0, 0], [4, "4*p", "p"], ["-p", 4, 0], [0, 3, 0]]"#,
        r#"kind = "interpolate"
closed = true
points = [["p", 0, 0], [4, 0, 0], [4, "4*p", "p"], ["p", 0, 0]]
parametrization = "centripetal""#,
        r#"kind = "expression"
x = "p*t^2"
y = "sin(p*t) + if(t < 0.5, p, p + t - 0.5)"
z = "atan2(t, p)""#,
        r#"kind = "isocurve"
surface = "sheet"
u = "p/3""#,
        r#"kind = "trim"
curve = "arc"
from = "0.1*p"
to = "1 - p/9""#,
        r#"kind = "reverse"
curve = { kind = "line", from = [0, "p", 0], to = [1, 0, 0] }"#,
        r#"kind = "join"
curves = [{ kind = "line", from = [0, "p", 0], to = [1, "p", 0] }, { kind = "line", from = [1, "p", 0], to = ["5*p", 3, 0] }]"#,
        r#"kind = "transform"
curve = "arc"
mirror = { origin = ["p", 0, 0], normal = [1, "p", 0] }
scale = ["p", 1, "2*p"]
rotate = { axis = { origin = [1, "p", 0], direction = ["p", 1, 1] }, angle = "30*p deg" }
translate = [0, "p^2", 0]"#,
    ];
    for text in curves {
        let build = model(1.3, &format!("{base}[curves.c]\n{text}\n"));
        let counts = compare(&build, text, "p");
        assert_eq!(counts, Some([1, 2, 0]), "{text}");
    }
    let surfaces = [
        r#"kind = "bilinear"
corners = [[[0, 0, "p"], [0, 5, 0]], [["5*p", 0, 0], [5, 5, "p"]]]"#,
        r#"kind = "ruled"
south = { kind = "line", from = [0, 0, 0], to = ["p", 0, 1] }
north = "arc""#,
        r#"kind = "ruled"
west = { kind = "circle", radius = "p" }
east = { kind = "circle", radius = 2, center = [0, 0, "p"] }"#,
        r#"kind = "hermite"
corners = [[[0, 0, "p"], [0, 5, 0]], [["5*p", 0, 0], [5, 5, "p"]]]
tangents_u = [[[1, 0, "p"], [0, 5, 0]], [["5*p", 0, 0], [5, 5, "p"]]]
tangents_v = [[[0, 0, "p"], [0, 5, 0]], [["5*p", 0, 0], [5, 5, "p"]]]
twists = [[["p", 0, "p"], [0, 5, 0]], [["5*p", 0, 0], [5, 5, "p"]]]"#,
        r#"kind = "bezier"
points = [[[0, 0, 0], [0, 5, "p"]], [["5*p", 0, 0], [5, 5, 0]]]
weights = [["p", 1], [1, "2*p"]]"#,
        r#"kind = "nurbs"
degree = [1, 2]
points = [[[0, 0, 0], [0, 3, "p"], [0, 5, 0], [0, 9, 0]], [["5*p", 0, 0], [5, 5, 0], [7, 8, 1], [6, 9, 0]]]"#,
        r#"kind = "biquadratic"
points = [[[0, 0, 0], [0, 5, 2], [0, 10, 0]], [[4, 0, 3], [5, 5, 1], [4, 10, 3]], [[10, 0, 0], [11, 5, "p"], [10, 10, 0]]]
weight_u = "p"
weight_v = "1/p""#,
        r#"kind = "rational"
basis_u = ["1 - t", "t"]
basis_v = ["(1 - t)^2", "2*t*(1 - t)", "t^2"]
points = [[[0, 0, 0], [0, 5, "p"], [1, 9, 0]], [["5*p", 0, 0], [5, 5, 0], [5, 9, 1]]]
weights = [[1, "p", 1], [1, 1, 1]]"#,
        r#"kind = "revolution"
profile = { kind = "line", from = ["3 + p", 0, 0], to = [5, "p/4", 4] }
axis = { origin = ["p", 0, 0], direction = ["p/9", 0, 1] }
start = "20*p deg"
angle = "100*p deg""#,
        r#"kind = "revolution"
profile = { kind = "arc", center = [0, 0, 0], radius = "p", from = "-90deg", to = "90deg", normal = "y" , x_direction = "x" }"#,
        r#"kind = "revolution"
profile = { kind = "line", from = ["3 + p", 0, 0], to = [5, 0, 4] }
construction = "rational"
start = "20*p deg""#,
        r#"kind = "revolution"
profile = { kind = "line", from = ["3 + p", 0, 0], to = [5, 0, 4] }
construction = "coons"
angle = "60*p deg""#,
        r#"kind = "revolution"
profile = { kind = "polyline", points = [[0, 0, "2*p"], ["p", 0, "2*p"], ["p", 0, 0], [0, 0, 0]] }
angle = "100*p deg""#,
        r#"kind = "revolution"
profile = { kind = "interpolate", points = [[1, 0, 0], ["p", 0, 1], [1, 0, "2*p"], [2, 0, 4]] }"#,
        r#"kind = "ruled"
south = { kind = "polyline", points = [[0, 0, 0], ["p", 0, 0], ["p", 2, 0], [0, 2, 0]] }
north = { kind = "polyline", points = [[0, 0, 5], ["p", 0, 5], ["p", 2, 5], [0, 2, 5]] }"#,
        r#"kind = "ruled"
west = { kind = "arc", center = [0, 0, 0], radius = "p", from = "0deg", to = "90deg" }
east = { kind = "polyline", points = [[5, 0, 0], ["5 + p", 1, 0], [5, 5, "p"]] }"#,
        r#"kind = "ruled"
south = { kind = "polyline", points = [[5, 0, 0], ["5 + p", 1, 0], [5, 5, "p"]] }
north = { kind = "line", from = [0, 0, 5], to = [0, 7, 5] }"#,
        r#"kind = "ruled"
south = { kind = "interpolate", points = [[0, 0, 0], ["p", 0, 1], ["p", 2, 0], [0, 2, 0]] }
north = { kind = "interpolate", points = [[0, 0, 5], [1, "p", 5], [0, 2, 7]] }"#,
        r#"kind = "coons"
south = { kind = "interpolate", points = [[0, 0, 0], ["p", 1, 0], ["5*p", 0, 0]] }
north = { kind = "line", from = [0, 5, 0], to = [5, 5, 1] }
west = { kind = "line", from = [0, 0, 0], to = [0, 5, 0] }
east = { kind = "line", from = ["5*p", 0, 0], to = [5, 5, 1] }"#,
        r#"kind = "torus"
major = "5*p"
minor = "p^2"
center = [0, "p", 1e4]
axis = ["p", 1, 5]
range = { u = ["0deg", "200deg"] }"#,
        r#"kind = "transform"
surface = "sheet"
rotate = { axis = "x", angle = "p rad" }
translate = ["p", 0, 0]"#,
        r#"kind = "coons"
south = { kind = "line", from = [0, 0, 0], to = ["5*p", 0, 0] }
north = { kind = "bezier", points = [[0, 5, 0], [2, 5, "p"], [5, 5, 1]] }
west = { kind = "line", from = [0, 0, 0], to = [0, 5, 0] }
east = { kind = "line", from = ["5*p", 0, 0], to = [5, 5, 1] }"#,
        r#"kind = "coons"
blend = "cubic"
cross = "adini"
south = { kind = "line", from = [0, 0, 0], to = ["5*p", 0, 0] }
north = { kind = "bezier", points = [[0, 5, 0], [2, 5, "p"], [5, 5, 1]] }
west = { kind = "line", from = [0, 0, 0], to = [0, 5, 0] }
east = { kind = "line", from = ["5*p", 0, 0], to = [5, 5, 1] }"#,
        r#"kind = "coons"
blend = "quintic"
second = { south = { kind = "bezier", points = [[0, 0, 0], [0, "p", 40], [0, 0, 0]] } }
south = { kind = "line", from = [0, 0, 0], to = ["5*p", 0, 0] }
north = { kind = "line", from = [0, 5, 0], to = [5, 5, 0] }
west = { kind = "line", from = [0, 0, 0], to = [0, 5, 0] }
east = { kind = "line", from = ["5*p", 0, 0], to = [5, 5, 0] }"#,
        // The derivatives across south come from a sheet that moves, and from corners whose tangents turn.
        r#"kind = "coons"
blend = "cubic"
cross = { south = { from = "moving.north" } }
south = "moving.north"
north = { kind = "bezier", points = [[0, 20, 0], [5, 20, "3*p"], [10, 20, 0]] }
west = { kind = "bezier", points = [[0, 10, 0], ["0 - p", 14, "0 - 0.8*p - 0.2*p^2"], [0, 20, 0]] }
east = { kind = "bezier", points = [[10, 10, "p"], ["11.8 - 1.3*p", 14, "1.9*p - 0.1*p^2 - 1.6"], [10, 20, 0]] }"#,
        r#"kind = "coons"
blend = "cubic"
cross = { north = { from = "turned.north" }, east = "adini" }
north = "moving.north"
south = { kind = "bezier", points = [[0, 20, 0], [5, 20, "3*p"], [10, 20, 0]] }
west = { kind = "bezier", points = [[0, 20, 0], ["0 - p", 14, "0 - 0.8*p - 0.2*p^2"], [0, 10, 0]] }
east = { kind = "bezier", points = [[10, 20, 0], ["11.8 - 1.3*p", 14, "1.9*p - 0.1*p^2 - 1.6"], [10, 10, "p"]] }"#,
        // Generators in planes that stay, with free functions; in planes that turn; exchanged.
        r#"kind = "diagonal-key"
south = { kind = "bezier", points = [[60, 0, 0], [60, 12, "26*p"], [60, 40, 4]] }
north = { kind = "bezier", points = [[0, 4, 6], [0, 10, "2*p"], [0, "34*p", 22]] }
west = { kind = "bezier", points = [[60, 0, 0], [40, "4*p", 12], [0, 4, 6]] }
east = { kind = "bezier", points = [[60, 40, 4], [40, 46, "2*p"], [0, "34*p", 22]] }
p = "p^2 * v*(1 - v)"
q = "3*v*(1 - v)""#,
        r#"kind = "diagonal-key"
south = { kind = "bezier", points = [[60, 0, 0], ["60 + 26*p", 12, 26], ["60 + 4*p", 40, 4]] }
north = { kind = "bezier", points = [["6*p", 4, 6], ["2*p", 10, 2], ["22*p", 34, 22]] }
west = { kind = "bezier", points = [[60, 0, 0], [40, 4, 12], ["6*p", 4, 6]] }
east = { kind = "bezier", points = [["60 + 4*p", 40, 4], ["40 - 10*p", 46, 2], ["22*p", 34, 22]] }"#,
        r#"kind = "diagonal-key"
generators = "west-east"
west = { kind = "bezier", points = [[60, 0, 0], [60, 12, "26*p"], [60, 40, 4]] }
east = { kind = "bezier", points = [[0, 4, 6], [0, 10, "2*p"], [0, "34*p", 22]] }
south = { kind = "bezier", points = [[60, 0, 0], [40, "4*p", 12], [0, 4, 6]] }
north = { kind = "bezier", points = [[60, 40, 4], [40, 46, "2*p"], [0, "34*p", 22]] }"#,
        // Stitched along both guides; and a parallelogram whose guides stay translates.
        r#"kind = "diagonal-key"
south = { kind = "hermite", from = [0, 0, 0], to = [10, 0, 0], from_tangent = [10, 0, "8*p"], to_tangent = [10, 0, -5] }
north = { kind = "hermite", from = [0, 12, 0], to = [11, 13, "p"], from_tangent = [12, "p", 4], to_tangent = [9, 3, -7] }
west = { kind = "bezier", points = [[0, 0, 0], [0, 6, "3*p"], [0, 12, 0]] }
east = { kind = "bezier", points = [[10, 0, 0], ["10 + p", 7, 2], [11, 13, "p"]] }
tangent_west = { kind = "bezier", points = [[10, 0, "8*p"], [11, 1, "p"], [12, "p", 4]] }
tangent_east = { kind = "bezier", points = [[10, 0, -5], [10, "p", -6], [9, 3, -7]] }"#,
        r#"kind = "diagonal-key"
south = { kind = "bezier", points = [[0, 0, 0], [5, 0, "p"], [10, 0, 0]] }
north = { kind = "bezier", points = [[0, 10, 0], [5, 10, "2*p"], [10, 10, 0]] }
west = { kind = "bezier", points = [[0, 0, 0], ["p", 5, 0], [0, 10, 0]] }
east = { kind = "bezier", points = [[10, 0, 0], ["10 + p", 5, 0], [10, 10, 0]] }"#,
        r#"kind = "coons"
blend = "cubic"
twists = [[[0, 0, "p"], [0, 0, 0]], [[0, 0, 0], ["p^2", 0, 0]]]
south = { kind = "line", from = [0, 0, 0], to = [5, 0, 0] }
north = { kind = "line", from = [0, 5, 0], to = [5, 5, 0] }
west = { kind = "line", from = [0, 0, 0], to = [0, 5, 0] }
east = { kind = "line", from = [5, 0, 0], to = [5, 5, 0] }"#,
    ];
    let moving = r#"
[surfaces.moving]
kind = "bezier"
points = [[[0, 0, 0], [0, 5, "p"], [0, 10, 0]], [[5, 0, 1], [5, 5, 1], ["5*p", 10, "p^2"]], [[10, 0, 0], ["9 + p", 5, 2], [10, 10, "p"]]]
[surfaces.turned]
kind = "transform"
surface = "moving"
translate = [0, 0, 0]
"#;
    for text in surfaces {
        let build = model(1.3, &format!("{base}{moving}[surfaces.s]\n{text}\n"));
        let counts = compare(&build, text, "p");
        assert_eq!(counts, Some([3, 2, 0]), "{text}");
    }
    for (shape, axes, range) in [
        ("sphere", r#"["p"]"#, ""),
        (
            "ellipsoid",
            r#"["p", "2*p", 3]"#,
            r#"range = { v = ["-30deg", "60deg"] }"#,
        ),
        ("hyperboloid-1", r#"["p", 2, "p"]"#, ""),
        ("hyperboloid-2", r#"["p", 2, "p"]"#, ""),
        (
            "elliptic-paraboloid",
            r#"["p", 2, "p"]"#,
            r#"range = { v = ["p", 9] }"#,
        ),
        ("elliptic-paraboloid", r#"["p", 2, "p"]"#, ""),
        (
            "hyperbolic-paraboloid",
            r#"["p", 2, "p"]"#,
            r#"range = { u = ["-p", 2], v = [-1, "p"] }"#,
        ),
        ("cone", r#"["p", 2, "p"]"#, r#"range = { v = [1, "2*p"] }"#),
        ("cone", r#"["p", 2, "p"]"#, ""),
        ("cylinder", r#"["p"]"#, ""),
        ("cylinder", r#"["p", 2]"#, r#"range = { v = ["p", 7] }"#),
        ("parabolic-cylinder", r#"["p", 2]"#, ""),
        ("hyperbolic-cylinder", r#"[2, "p"]"#, ""),
    ] {
        let text = format!(
            "{base}[surfaces.s]\nkind = \"quadric\"\nshape = \"{shape}\"\nsemi_axes = {axes}\n{range}\ncenter = [\"p\", 0, 50]\nframe = {{ x = [1, \"p/3\", 0], z = [\"p/5\", 0, 1] }}\n"
        );
        let counts = compare(&model(1.3, &text), &text, "p");
        assert_eq!(counts, Some([1, 2, 0]), "{text}");
    }
}

fn of(text: &str, p: f64) -> Result<Velocities, String> {
    let build = model(p, text);
    let none = Overrides::default();
    velocities(&build(&none).unwrap(), &none, "p").map_err(|e| e.list[0].message.clone())
}

#[test]
fn what_is_not_known_is_refused_by_name() {
    for (text, says) in [
        (
            "[curves.c]\nkind = \"trim\"\ncurve = { kind = \"polyline\", points = [[0, 0, 0], [\"p\", 1, 0], [3, 0, 0]] }\nfrom = 0.25",
            "curve `c`, `curve`: its corners move along its parameter",
        ),
        (
            "[curves.c]\nkind = \"interpolate\"\ndegree = 2\npoints = [[0, 0, 0], [\"p\", 1, 0], [3, 0, 0], [4, 1, 0]]",
            "curve `c`: its knots change with the distances of its points: write degree = 3",
        ),
        (
            "[curves.c]\nkind = \"interpolate\"\nclosed = true\npoints = [[1.3, 0, 0], [2, 1, 0], [3, 0, 0], [\"p\", 0, 0]]",
            "curve `c`: its first point leaves its last one",
        ),
        (
            "[curves.c]\nkind = \"join\"\ncurves = [{ kind = \"line\", from = [0, 0, 0], to = [1.3, 0, 0] }, { kind = \"line\", from = [\"p\", 0, 0], to = [3, 1, 0] }]",
            "curve `c`: its curves 1 and 2 part as they move",
        ),
        (
            "[curves.c]\nkind = \"nurbs\"\ndegree = 1\npoints = [[0, 0, 0], [1, 1, 0], [3, 0, 0]]\nknots = [0, 0, \"p/4\", 1, 1]",
            "curve `c`: its knots change",
        ),
        (
            "[curves.c]\nkind = \"arc\"\nthrough = [[0, 0, 0], [\"p\", 1, 0], [3, 0, 0]]",
            "curve `c`: how the kind \"arc\" changes with its data is not known",
        ),
        (
            "[curves.c]\nkind = \"expression\"\nx = \"t\"\ny = \"0\"\nz = \"0\"\ndomain = [0, \"p\"]",
            "curve `c`: its domain changes",
        ),
        (
            "[curves.c]\nkind = \"circle\"\nradius = 1\nnormal = [\"p - 1.3\", 0, 1]",
            "curve `c`: its x direction jumps",
        ),
    ] {
        match &of(text, 1.3).unwrap().curves[0] {
            Velocity::Unknown(why) => assert!(why.starts_with(says), "{why}"),
            other => panic!("{text}: {other:?}"),
        }
    }
    // Contours beside which the surface is of another kind.
    let key = |south: &str, east: &str| {
        format!(
            "[surfaces.s]\nkind = \"diagonal-key\"\nsouth = {{ kind = \"bezier\", points = {south} }}\nnorth = {{ kind = \"bezier\", points = [[0, 10, 0], [0, 12, 3], [10, 10, 0]] }}\nwest = {{ kind = \"bezier\", points = [[0, 0, 0], [0, 5, 4], [0, 10, 0]] }}\neast = {{ kind = \"bezier\", points = {east} }}\n"
        )
    };
    let translated = "[[10, 0, 0], [10, 5, 4], [10, 10, 0]]";
    for (text, says) in [
        (
            key(
                "[[0, 0, 0], [5, 0, 2], [10, 0, 0]]",
                "[[10, 0, 0], [10, \"5 + p - 1.3\", 4], [10, 10, 0]]",
            ),
            "surface `s`: its guides do not stay translates",
        ),
        (
            key(
                "[[0, 0, 0], [5, 0, 2], [\"8.7 + p\", 0, 0]]",
                &translated.replace("[[10,", "[[\"8.7 + p\","),
            ),
            "surface `s`: its guides do not stay translates",
        ),
    ] {
        match &of(&text, 1.3).unwrap().surfaces[0] {
            Velocity::Unknown(why) => assert!(why.starts_with(says), "{why}"),
            other => panic!("{text}: {other:?}"),
        }
    }
    let bent = |x: &str| {
        format!(
            "[surfaces.s]\nkind = \"diagonal-key\"\nsouth = {{ kind = \"bezier\", points = [[60, 0, 0], [{x}, 12, 26], [60, 40, 4]] }}\nnorth = {{ kind = \"bezier\", points = [[0, 4, 6], [0, 10, 2], [0, 34, 22]] }}\nwest = {{ kind = \"bezier\", points = [[60, 0, 0], [40, 4, 12], [0, 4, 6]] }}\neast = {{ kind = \"bezier\", points = [[60, 40, 4], [40, 46, 2], [0, 34, 22]] }}\n"
        )
    };
    let found = of(&bent("\"58.7 + p\""), 1.3).unwrap();
    assert!(
        matches!(&found.surfaces[0], Velocity::Unknown(why) if why.contains("leaves the plane")),
        "{:?}",
        found.surfaces[0]
    );
    // Corners that move in different ways.
    let ruled = r#"
[surfaces.s]
kind = "ruled"
south = { kind = "polyline", points = [[0, 0, 0], ["p", 1, 0], [3, 0, 0]] }
north = { kind = "polyline", points = [[0, 0, 5], [1, 1, 5], [3, 0, 5]] }
"#;
    let found = of(ruled, 1.3).unwrap();
    assert!(
        matches!(&found.surfaces[0], Velocity::Unknown(why) if why.contains("its corners move")),
        "{:?}",
        found.surfaces[0]
    );
    let chain = r#"
[curves.c]
kind = "arc"
through = [[1, 0, 0], ["p", 0, 1], [2, 0, 2]]
[surfaces.r]
kind = "revolution"
profile = "c"
[surfaces.t]
kind = "transform"
surface = "r"
"#;
    let found = of(chain, 1.4).unwrap();
    for s in &found.surfaces {
        // The reason is that of the curve at the bottom.
        assert!(
            matches!(s, Velocity::Unknown(why) if why.starts_with("curve `c`")),
            "{s:?}"
        );
    }
}

#[test]
fn kinks_are_errors() {
    for (text, says) in [
        (
            "[curves.c]\nkind = \"line\"\nfrom = [0, 0, 0]\nto = [1, \"max(p, 3)\", 0]",
            "it",
        ),
        (
            "[curves.c]\nkind = \"line\"\nfrom = [0, 0, 0]\nto = [1, \"floor(p)\", 0]",
            "it jumps",
        ),
        (
            "[curves.c]\nkind = \"expression\"\nx = \"t\"\ny = \"t*max(p, 3)\"\nz = \"0\"",
            "depends on the parameter",
        ),
        (
            "[curves.c]\nkind = \"line\"\nfrom = [0, 0, 0]\nto = [1, \"sqrt(p - 3)\", 0]",
            "no finite derivative",
        ),
        (
            "[curves.c]\nkind = \"expression\"\nx = \"t\"\ny = \"abs(t - p/9)\"\nz = \"0\"",
            "depends on the parameter",
        ),
        (
            "[curves.c]\nkind = \"nurbs\"\ndegree = \"p\"\npoints = [[0, 0, 0], [1, 1, 0], [3, 0, 0], [4, 0, 0]]",
            "a whole number has no derivative",
        ),
    ] {
        let message = of(text, 3.0).unwrap_err();
        assert!(message.contains(says), "{message}");
    }
    // Beside the kink there is a derivative.
    let beside = of(
        "[curves.c]\nkind = \"line\"\nfrom = [0, 0, 0]\nto = [1, \"max(p, 3)\", 0]",
        3.5,
    );
    assert!(matches!(beside.unwrap().curves[0], Velocity::Moves(_)));
    // What does not depend on the parameter may be on a switch.
    let constants = "n = 4\nk = \"floor(n/2)\"\n[curves.c]\nkind = \"line\"\nfrom = [0, 0, \"k + if(n/2 < 2, 1, 3)\"]\nto = [1, \"p*floor(n/2)\", 0]";
    let Velocity::Moves(v) = &of(constants, 3.0).unwrap().curves[0] else {
        panic!("it moves")
    };
    assert_eq!(v.point(1.0), DVec3::new(0.0, 2.0, 0.0));
    let none = Overrides::default();
    let model = model(1.0, "")(&none).unwrap();
    let e = velocities(&model, &none, "q").unwrap_err();
    assert_eq!(e.list[0].message, "there is no parameter `q`");
}

//! Models that move with a parameter.

use nappe::measure::Moving;
use nappe_model::{Overrides, Velocity, parse, velocities};

/// The surfaces of a model and how they move with its parameter p.
pub(crate) fn moving(p: f64, rest: &str) -> Vec<Moving> {
    let text = format!("nappe = 1\n[params]\np = {p:?}\n{rest}");
    let none = Overrides::default();
    let model = parse(&text, "test", &none).unwrap_or_else(|e| panic!("{}", e.list[0].message));
    let found = velocities(&model, &none, "p").unwrap_or_else(|e| panic!("{}", e.list[0].message));
    let all = model.surfaces.iter().zip(found.surfaces);
    all.map(|(s, v)| Moving {
        surface: s.surface.clone(),
        velocity: match v {
            Velocity::Moves(v) | Velocity::Follows(v) => Some(v),
            Velocity::Still => None,
            Velocity::Unknown(why) => panic!("{why}"),
        },
    })
    .collect()
}

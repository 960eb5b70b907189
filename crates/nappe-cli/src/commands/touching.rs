//! The certificate of fillets in `nappe info`: that the ball touches both supports.

use crate::text::{Table, bound, number};
use nappe::surface::Fillet;
use nappe_model::NamedSurface;
use serde_json::{Value, json};

/// The parameters at which the centre is compared with its contacts.
const PLACES: usize = 129;

/// What is said of a fillet's ball.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touching {
    /// The least and the greatest radius at the places looked at.
    radius: [f64; 2],
    /// How far the centre's distances from the supports are from the radius, at most, at the places looked at; `None`
    /// where the ball has a formula.
    error: Option<f64>,
}

impl Touching {
    pub(super) fn of(fillet: &Fillet) -> Touching {
        let radii = (0..PLACES).map(|k| fillet.ball(k as f64 / (PLACES - 1) as f64).1);
        Touching {
            radius: radii.fold([f64::INFINITY, 0.0], |[lo, hi], r| [lo.min(r), hi.max(r)]),
            error: fillet.contact_errors(PLACES),
        }
    }

    fn contacts(self) -> String {
        match self.error {
            None => "by a formula".to_owned(),
            Some(error) => format!(
                "proven for the whole path; in numbers within {} at {PLACES} places",
                bound(error, 2)
            ),
        }
    }

    pub(super) fn json(self) -> Value {
        json!({
            "radius": self.radius,
            "places": PLACES,
            "contact_error": self.error,
        })
    }
}

/// The fillets of a model; `None` if there are none.
pub(super) fn table<'a>(
    surfaces: impl Iterator<Item = (&'a NamedSurface, Option<Touching>)>,
    unit: &str,
) -> Option<Table> {
    let radius = format!("ball's radius in {unit}");
    let mut table = Table::headed([
        "fillet",
        &radius,
        "distance of the centre from both supports = radius",
    ]);
    let mut any = false;
    for (s, ball) in surfaces {
        let Some(ball) = ball else { continue };
        any = true;
        let [least, greatest] = ball.radius.map(|r| number(r, 6));
        let radius = if least == greatest {
            least
        } else {
            format!("{least} … {greatest}")
        };
        table.row([s.name.clone(), radius, ball.contacts()]);
    }
    any.then_some(table)
}

//! How curvature, the room beside a surface and integrals of curvature change with a parameter.

use super::info::SurfaceFacts;
use super::report::{certainty_json, measured_json};
use crate::text::number;
use nappe::measure::{
    BendingRate, CurvatureRate, ExtremeRate, Moving, RollingBall, bending_rate, curvature_rate,
};
use nappe::mesh::Certainty;
use serde_json::{Value, json};

/// Derivatives of what a surface's figures say about bending. All are estimated.
pub(super) struct Bends {
    curvature: CurvatureRate,
    /// Of the largest ball on the side of the normal, and behind.
    room: [Option<ExtremeRate>; 2],
    /// If the integrals are among the figures.
    pub(super) integrals: Option<BendingRate>,
}

impl Bends {
    pub(super) fn of(part: &Moving, facts: &SurfaceFacts) -> Bends {
        let curvature = facts.curvature.as_ref();
        let curvature = curvature.map_or_else(CurvatureRate::default, |c| curvature_rate(part, c));
        let room = match &facts.balls {
            Some([front, back]) => [
                room(front, curvature.k1, 1.0),
                room(back, curvature.k2, -1.0),
            ],
            None => [None; 2],
        };
        let finite = facts.bending.filter(|(_, v)| v.value.is_finite());
        Bends {
            curvature,
            room,
            integrals: finite.map(|_| bending_rate(part)),
        }
    }

    pub(super) fn headings(unit: &str, integrals: bool) -> Vec<String> {
        let mut all = vec![
            format!("Gaussian curvature in 1/{unit}²"),
            format!("mean curvature in 1/{unit}"),
            format!("room for a tool in {unit}"),
            "behind".to_owned(),
        ];
        if integrals {
            all.push("total curvature in sr".to_owned());
            all.push(format!("variation of curvature in 1/{unit}²"));
        }
        all
    }

    pub(super) fn cells(&self) -> Vec<String> {
        let range = |[a, b]: [Option<ExtremeRate>; 2]| format!("{} … {}", text(a), text(b));
        let mut all = vec![range(self.curvature.gaussian), range(self.curvature.mean)];
        all.extend(self.room.map(text));
        if let Some(i) = self.integrals {
            // What is less than its error is nothing.
            let digits = |m: nappe::measure::Measured| {
                let nothing = m.value.abs() <= m.certainty.error();
                number(if nothing { 0.0 } else { m.value }, 5)
            };
            all.extend([i.total, i.variation].map(digits));
        }
        all
    }

    pub(super) fn add_to(&self, surface: &mut Value) {
        let both = |e: [Option<ExtremeRate>; 2]| e.map(|e| e.map(rate_json));
        surface["gaussian_curvature"] = json!(both(self.curvature.gaussian));
        surface["mean_curvature"] = json!(both(self.curvature.mean));
        surface["rolling_balls"] = json!({
            "normal_side": self.room[0].map(rate_json),
            "behind": self.room[1].map(rate_json),
        });
        if let Some(i) = self.integrals {
            surface["total_curvature"] = measured_json(i.total);
            surface["curvature_variation"] = measured_json(i.variation);
        }
    }
}

/// Of a ball's radius `sign / k`.
fn room(ball: &RollingBall, k: Option<ExtremeRate>, sign: f64) -> Option<ExtremeRate> {
    let is_some = ball.radius > 0.0 && ball.radius.is_finite();
    let k = k.filter(|_| is_some)?;
    let slope = ball.radius * ball.radius;
    let [a, b] = k.range.map(|x| -sign * slope * x);
    Some(ExtremeRate {
        range: [a.min(b), a.max(b)],
        certainty: Certainty::Estimated(slope * k.certainty.error()),
    })
}

fn text(e: Option<ExtremeRate>) -> String {
    let Some(e) = e else {
        return "–".to_owned();
    };
    let digits = |x: f64| {
        let nothing = x.abs() <= e.certainty.error();
        number(if nothing { 0.0 } else { x }, 5)
    };
    match e.range {
        [a, b] if a == b => digits(a),
        [a, b] => format!("({} to {})", digits(a), digits(b)),
    }
}

fn rate_json(e: ExtremeRate) -> Value {
    json!({ "range": e.range, "certainty": certainty_json(e.certainty) })
}

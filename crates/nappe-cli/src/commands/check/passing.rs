//! The part of the report on surfaces that pass through themselves or each other.

use crate::text::{Table, bound, number};
use nappe::measure::{Meeting, Overlap, OverlapOptions, Overlaps, overlaps};
use nappe::surface::SurfaceRef;
use nappe_model::NamedSurface;
use serde_json::{Value, json};

/// What is known of surfaces that pass through themselves or each other.
pub(super) struct Passing {
    names: Vec<String>,
    unit: &'static str,
    tolerance: f64,
    all: Overlaps,
}

impl Passing {
    pub(super) fn of(named: &[&NamedSurface], tolerance: f64, unit: &'static str) -> Self {
        let surfaces: Vec<SurfaceRef> = named.iter().map(|s| s.surface.clone()).collect();
        Self {
            names: named.iter().map(|s| s.name.clone()).collect(),
            unit,
            tolerance,
            all: overlaps(&surfaces, &OverlapOptions::with_contact(tolerance)),
        }
    }

    /// The number of surfaces that pass through themselves.
    pub(super) fn failures(&self) -> usize {
        self.all.found.iter().filter(|o| fails(o)).count()
    }

    /// The number of pairs for which neither a crossing was found nor its absence proven.
    pub(super) fn undecided(&self) -> usize {
        let open = |o: &&Overlap| {
            matches!(
                o.meeting,
                Meeting::Undecided { .. } | Meeting::Touches { only: false }
            )
        };
        self.all.found.iter().filter(open).count()
    }

    /// The places that were found, with whether they are failures.
    pub(super) fn found(&self) -> impl Iterator<Item = (&Overlap, bool)> {
        self.all.found.iter().map(|o| (o, fails(o)))
    }

    pub(super) fn text(&self) -> String {
        let pairs = self.names.len() * (self.names.len() + 1) / 2;
        let but = format!(
            "but within at most {} {} of shared sides and corners",
            number(self.tolerance, 4),
            self.unit
        );
        let head = "Surfaces that pass through themselves or each other";
        if self.all.found.is_empty() {
            return format!("{head}: none, proven ({but})");
        }
        format!(
            "{head}\n\n{}\n\nThe other {} of {pairs} pairs, each surface with itself included, are proven to have no common \
             points {but}.",
            self.table(),
            self.all.apart
        )
    }

    fn table(&self) -> Table {
        let mut table = Table::headed(["", "surfaces", "", "where", "parameters"]);
        for o in &self.all.found {
            let [a, b] = self.pair(o);
            let point = o.point.to_array().map(|x| number(x, 5)).join(", ");
            let mut uv: Vec<String> =
                o.uv.iter()
                    .map(|p| format!("({})", p.map(|x| number(x, 4)).join(", ")))
                    .collect();
            if o.uv[0] == o.uv[1] && o.surfaces[0] == o.surfaces[1] {
                uv.pop();
            }
            table.row([
                (if fails(o) { "✗" } else { "•" }).to_owned(),
                format!("{a} – {b}"),
                self.words(o),
                format!("({point})"),
                uv.join(" – "),
            ]);
        }
        table
    }

    fn pair<'s>(&'s self, o: &Overlap) -> [&'s str; 2] {
        let [i, j] = o.surfaces;
        [
            &self.names[i],
            if i == j { "itself" } else { &self.names[j] },
        ]
    }

    fn words(&self, o: &Overlap) -> String {
        match o.meeting {
            Meeting::Crosses { proven, angle } => format!(
                "cross at {}°, {}",
                number(angle.to_degrees(), 3),
                if proven { "proven" } else { "found" }
            ),
            Meeting::Overlaps => "have an area in common, found".to_owned(),
            Meeting::Touches { only: true } => "touch; that they cross is excluded".to_owned(),
            Meeting::Touches { only: false } => "touch; that they cross is not excluded".to_owned(),
            // One place of one surface: not two that come near each other.
            Meeting::Undecided { .. } if o.surfaces[0] == o.surfaces[1] && o.uv[0] == o.uv[1] => {
                "not decided beside this place".to_owned()
            }
            Meeting::Undecided { distance } => {
                format!(
                    "not decided; these places are {} {} apart",
                    bound(distance, 3),
                    self.unit
                )
            }
        }
    }

    pub(super) fn json(&self) -> Value {
        let found: Vec<Value> = self
            .all
            .found
            .iter()
            .map(|o| {
                let (what, proven, angle, distance) = match o.meeting {
                    Meeting::Crosses { proven, angle } => ("cross", proven, Some(angle), None),
                    Meeting::Overlaps => ("overlap", false, None, None),
                    Meeting::Touches { only } => ("touch", only, None, None),
                    Meeting::Undecided { distance } => ("undecided", false, None, Some(distance)),
                };
                json!({
                    "surfaces": o.surfaces.map(|i| &self.names[i]),
                    "is": what,
                    "proven": proven,
                    "angle": angle,
                    "distance": distance,
                    "uv": o.uv,
                    "point": o.point.to_array(),
                    "fails": fails(o),
                })
            })
            .collect();
        json!({ "contact": self.tolerance, "proven_apart": self.all.apart, "found": found })
    }
}

/// A surface that passes through itself is a fault; two that pass through each other may be meant to.
fn fails(o: &Overlap) -> bool {
    let [i, j] = o.surfaces;
    i == j && matches!(o.meeting, Meeting::Crosses { .. } | Meeting::Overlaps)
}

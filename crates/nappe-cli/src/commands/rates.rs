//! How the figures of `nappe info` change with a parameter.

use super::bends::Bends;
use super::info::{Facts, INTEGRALS, error, measured, members};
use super::report::measured_json;
use crate::text::{Table, number};
use nappe::measure::{
    AreaRate, FaceRate, Measured, Moving, Opening, SolidRate, area_rate, face_rate, solid_rate,
};
use nappe::surface::Side;
use nappe_model::{Model, NamedSurface, Velocities, Velocity};
use rayon::prelude::*;
use serde_json::{Value, json};

/// How a surface changes.
enum Change {
    Still,
    Moves(Box<Moves>),
    Unknown(String),
}

/// How the figures of a surface change.
struct Moves {
    area: Measured,
    bends: Bends,
}

/// Derivatives by one parameter.
pub(super) struct Rates {
    parameter: String,
    value: f64,
    surfaces: Vec<Change>,
    /// Of all surfaces together; `None` if the motion of one is not known, or if one is torn.
    area: Option<AreaRate>,
    /// Of the least and greatest x, y and z; `None` as the area, or without a bound.
    faces: Option<[[FaceRate; 2]; 3]>,
    /// Of each shell, after the names of its surfaces; or why not: the motion of one is not known, or a joint opens.
    shells: Vec<(String, Result<SolidRate, String>)>,
}

impl Rates {
    pub(super) fn of(model: &Model, velocities: &Velocities, facts: &Facts) -> Rates {
        let all = model.surfaces.iter().zip(&velocities.surfaces);
        let put_out: Vec<(&NamedSurface, &Velocity<_>)> =
            all.filter(|(s, _)| !s.construction_only).collect();
        let parts: Vec<Moving> = put_out
            .iter()
            .map(|(s, v)| Moving {
                surface: s.surface.clone(),
                velocity: match v {
                    Velocity::Moves(v) | Velocity::Follows(v) => Some(v.clone()),
                    Velocity::Still | Velocity::Unknown(_) => None,
                },
            })
            .collect();
        let named: Vec<&NamedSurface> = put_out.iter().map(|p| p.0).collect();
        let known = |k: usize| !matches!(put_out[k].1, Velocity::Unknown(_));
        let all_known = (0..parts.len()).all(known) && !parts.is_empty();
        let areas: Vec<_> = facts.areas().collect();
        let bends: Vec<_> = facts.bends().collect();
        let own: Vec<Option<Moves>> = (0..parts.len())
            .into_par_iter()
            .map(|k| {
                let moves = parts[k].velocity.is_some();
                moves.then(|| Moves {
                    area: area_rate(&parts[k..=k], areas[k], &INTEGRALS).area,
                    bends: Bends::of(&parts[k], bends[k]),
                })
            })
            .collect();
        let surfaces = put_out.iter().zip(own).map(|((_, v), own)| match (v, own) {
            (Velocity::Unknown(why), _) => Change::Unknown(why.clone()),
            (_, Some(moves)) => Change::Moves(Box::new(moves)),
            (_, None) => Change::Still,
        });
        let whole = facts.area.filter(|_| all_known);
        let area = whole.map(|whole| area_rate(&parts, &whole, &INTEGRALS));
        let faces = all_known.then(|| {
            let faces: Option<Vec<FaceRate>> = (0..6)
                .into_par_iter()
                .map(|k| face_rate(&parts, k / 2, k % 2 == 1))
                .collect();
            let faces = faces?;
            Some([0, 1, 2].map(|a| [faces[2 * a], faces[2 * a + 1]]))
        });
        let shells = facts.shells.iter().map(|solid| {
            let unknown = solid
                .shell
                .surfaces
                .iter()
                .find_map(|f| match put_out[f.0].1 {
                    Velocity::Unknown(why) => Some(why.clone()),
                    _ => None,
                });
            let rate = match unknown {
                Some(why) => Err(why),
                None => solid_rate(&parts, solid, Some(facts.joined), &INTEGRALS)
                    .map_err(|o| opens(&o, &named)),
            };
            (members(&solid.shell, &named), rate)
        });
        Rates {
            parameter: velocities.parameter.clone(),
            value: velocities.value,
            area,
            faces: faces.flatten(),
            shells: shells.collect(),
            surfaces: surfaces.collect(),
        }
    }

    pub(super) fn text(&self, model: &Model) -> String {
        let unit = model.units.symbol();
        let named: Vec<&NamedSurface> = model.output().collect();
        let mut table = Table::of_facts();
        let by = format!("{} (which is {})", self.parameter, number(self.value, 7));
        table.row(["derivatives by", &by]);
        let unknown = self.surfaces.iter().find_map(|c| match c {
            Change::Unknown(why) => Some(format!("not told: {why}")),
            _ => None,
        });
        let untold = || unknown.clone().unwrap_or_else(|| "not bounded".to_owned());
        let faces = self.faces.map_or_else(&untold, |faces| {
            let of = |(axis, [least, greatest]): (&str, [FaceRate; 2])| {
                format!("{axis} from {} to {}", face(&least), face(&greatest))
            };
            let each = ["x", "y", "z"].into_iter().zip(faces).map(of);
            format!("{} {unit}", each.collect::<Vec<_>>().join(", "))
        });
        table.row(["box", &faces]);
        let area = match (&self.area, &unknown) {
            (Some(a), _) => format!("{} {unit}²", measured(a.area)),
            (None, None) => "not told: a surface is torn".to_owned(),
            (None, Some(why)) => why.clone(),
        };
        table.row(["area", &area]);
        if let Some(c) = self.area.and_then(|a| a.centroid) {
            table.row(["centroid of the area", &vector(&c, unit)]);
        }
        for (name, solid) in &self.shells {
            if self.shells.len() > 1 {
                table.row(["shell", name]);
            }
            let s = match solid {
                Ok(s) => s,
                Err(why) => {
                    table.row(["volume", &format!("not told: {why}")]);
                    continue;
                }
            };
            table.row(["volume", &format!("{} {unit}³", measured(s.volume))]);
            if let Some(c) = &s.centroid {
                table.row(["centroid of the volume", &vector(c, unit)]);
            }
            match &s.principal {
                Some(p) => {
                    let all = p.map(measured).join(", ");
                    table.row(["principal moments", &format!("{all} {unit}⁵")]);
                }
                None => table.row([
                    "principal moments",
                    "not told: nothing tells an axis from another (the tensor is in the JSON)",
                ]),
            }
        }
        let area = format!("area in {unit}²");
        let mut headings = vec!["surface".to_owned(), area];
        headings.extend(Bends::headings(unit, self.has_integrals()));
        let columns = headings.len();
        let mut each = Table::headed(headings);
        for (s, change) in named.iter().zip(&self.surfaces) {
            let mut row = vec![s.name.clone()];
            match change {
                Change::Still => row.push("does not move".to_owned()),
                Change::Moves(m) => {
                    row.push(measured(m.area));
                    row.extend(m.bends.cells());
                }
                Change::Unknown(why) => row.push(format!("not known: {why}")),
            }
            row.resize(columns, String::new());
            each.row(row);
        }
        if named.is_empty() {
            return format!("{table}\n");
        }
        format!("{table}\n\n{each}\n")
    }

    fn has_integrals(&self) -> bool {
        let moving = |c: &Change| matches!(c, Change::Moves(m) if m.bends.integrals.is_some());
        self.surfaces.iter().any(moving)
    }

    pub(super) fn json(&self, model: &Model) -> Value {
        let surfaces = model.output().zip(&self.surfaces).map(|(s, change)| {
            let (motion, why, moves) = match change {
                Change::Still => ("still", None, None),
                Change::Moves(m) => ("moves", None, Some(m)),
                Change::Unknown(why) => ("unknown", Some(why), None),
            };
            let area = moves.map(|m| measured_json(m.area));
            let mut all = json!({ "name": s.name, "motion": motion, "why": why, "area": area });
            if let Some(m) = moves {
                m.bends.add_to(&mut all);
            }
            all
        });
        let ends = |end: usize| self.faces.map(|f| f.map(|axis| face_json(&axis[end])));
        json!({
            "parameter": self.parameter,
            "value": self.value,
            "box": self.faces.map(|_| json!({ "min": ends(0), "max": ends(1) })),
            "area": self.area.map(|a| measured_json(a.area)),
            "centroid": self.area.and_then(|a| a.centroid).map(|c| c.map(measured_json)),
            "shells": self.shells.iter().map(|(_, s)| match s {
                Ok(s) => shell_json(s),
                Err(why) => json!({ "volume": null, "why": why }),
            }).collect::<Vec<_>>(),
            "surfaces": surfaces.collect::<Vec<_>>(),
        })
    }
}

/// Where a shell opens.
fn opens(at: &Opening, named: &[&NamedSurface]) -> String {
    let name = |(k, side): (usize, Side)| format!("{}.{side}", named[k].name);
    let speed = number(at.speed, 3);
    match at.second {
        Some(second) => format!(
            "{} and {} part at a speed of {speed}, so that nothing is closed beside this value",
            name(at.first),
            name(second)
        ),
        None => format!(
            "{} is one point that opens at a speed of {speed}, so that nothing is closed beside this value",
            name(at.first)
        ),
    }
}

/// The derivative of a face, or those to either side.
fn face(f: &FaceRate) -> String {
    if f.between {
        let [a, b] = [f.range.lo, f.range.hi].map(|x| number(x, 4));
        return format!("({a} … {b}, which differ to either side or are not told apart)");
    }
    measured(middle(f))
}

fn middle(f: &FaceRate) -> Measured {
    let value = f.range.mid();
    let error = (f.range.hi - value).max(value - f.range.lo).next_up();
    Measured {
        value,
        certainty: nappe::mesh::Certainty::Bounded(error),
    }
}

fn face_json(f: &FaceRate) -> Value {
    json!({ "range": [f.range.lo, f.range.hi], "one_sided": f.between })
}

fn vector(v: &[Measured; 3], unit: &str) -> String {
    let largest = v
        .iter()
        .map(|m| m.certainty)
        .reduce(nappe::mesh::Certainty::and);
    let at = v.map(|m| {
        let noise = m.value.abs() <= m.certainty.error();
        number(if noise { 0.0 } else { m.value }, 10)
    });
    format!(
        "({}){} {unit}",
        at.join(", "),
        largest.map_or(String::new(), error)
    )
}

fn shell_json(s: &SolidRate) -> Value {
    json!({
        "volume": measured_json(s.volume),
        "centroid": s.centroid.map(|c| c.map(measured_json)),
        "inertia": s.inertia.map(|t| t.map(|row| row.map(measured_json))),
        "principal": s.principal.map(|p| p.map(measured_json)),
    })
}

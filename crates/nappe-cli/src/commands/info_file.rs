//! `nappe info` of files of other systems.

use super::convert::left_out;
use super::info::{box_json, error, measured};
use super::report::{ReportFormat, measured_json};
use crate::failure::Failure;
use crate::input;
use crate::screen::Screen;
use crate::text::{Table, count, number};
use nappe::body::{self, Body};
use nappe::measure::Measured;
use nappe::mesh::Certainty;
use nappe::surface::{Elementary, Surface};
use nappe::{Box3, DVec3, Interval};
use nappe_exchange::{
    Document, DocumentMesh, Format, Item, ItemForm, MeshFacts, Progress, Read, TriangleMesh,
    face_place, item_name, item_place, mesh_document, mesh_facts,
};
use serde_json::{Value, json};
use std::path::Path;

/// Items and problems that a report for people lists.
const MOST_SHOWN: usize = 40;
/// Where a file does not say how far its parts agree, bodies are checked with this share of the box.
const AGREEMENT: f64 = 1e-6;

/// The report on a file.
pub(super) fn report(path: &Path, form: ReportFormat, screen: &Screen) -> Result<String, Failure> {
    let read = input::read(path, screen)?;
    let format = Format::from_path(path).map_or_else(|_| String::new(), |f| f.to_string());
    Ok(match read {
        Read::Mesh(m) => {
            let facts = mesh_facts(&m);
            match form {
                ReportFormat::Text => mesh_text(&m, &facts, &format),
                ReportFormat::Json => format!("{:#}\n", mesh_json(&m, &facts, &format)),
            }
        }
        Read::Document(d) => {
            let facts = Facts::of(&d, screen);
            match form {
                ReportFormat::Text => facts.text(&d, &format),
                ReportFormat::Json => format!("{:#}\n", facts.json(&d, &format)),
            }
        }
    })
}

/// What surfaces are, in the order in which they are told.
const KINDS: [&str; 7] = [
    "plane", "cylinder", "cone", "sphere", "torus", "NURBS", "other",
];

/// The kind of a surface by what it is, not by how a file writes it: an index into [`KINDS`].
fn kind(surface: &dyn Surface) -> usize {
    match surface.elementary() {
        Some(Elementary::Plane { .. }) => 0,
        Some(Elementary::Cylinder { .. }) => 1,
        Some(Elementary::Cone { .. }) => 2,
        Some(Elementary::Sphere { .. }) => 3,
        Some(Elementary::Torus { .. }) => 4,
        None if surface.to_rational().is_some() => 5,
        None => 6,
    }
}

/// What is said of a body.
struct BodyFacts {
    /// The number of its item.
    item: usize,
    closed: bool,
    faces: usize,
    edges: usize,
    /// `None` if a face has none.
    area: Option<Measured>,
    /// `None` if it is not closed, or a face has no region.
    volume: Option<Measured>,
}

struct Facts {
    bodies: Vec<BodyFacts>,
    curves: usize,
    points: usize,
    kinds: [usize; KINDS.len()],
    extent: Option<(Box3, Certainty)>,
    problems: Vec<String>,
}

impl Facts {
    fn of(document: &Document, screen: &Screen) -> Facts {
        let progress = screen.progress("Measuring");
        let tell = |share: f64| progress.tell(share / 2.0);
        let made = mesh_document(document, None, Progress::to(&tell));
        let mut facts = Facts {
            bodies: Vec::new(),
            curves: 0,
            points: made.points,
            kinds: [0; KINDS.len()],
            extent: extent(document, &made),
            problems: Vec::new(),
        };
        let size = facts.extent.map_or(0.0, |(hull, _)| hull.diagonal());
        let agreement = document.uncertainty.unwrap_or(AGREEMENT * size);
        for (number, item) in document.items.iter().enumerate() {
            match &item.form {
                ItemForm::Body { body, .. } => facts.body(number, item, body, agreement),
                ItemForm::Curve(_) => facts.curves += 1,
                ItemForm::Points(_) => {}
            }
            progress.tell(0.5 + 0.5 * (number + 1) as f64 / document.items.len() as f64);
        }
        progress.finish();
        let missing = made.missing.iter();
        facts
            .problems
            .extend(missing.map(|m| format!("{} cannot be meshed: {}", m.place, m.why)));
        let turned = made.turned_round.iter();
        facts
            .problems
            .extend(turned.map(|place| format!("{place}: its loops run the wrong way round")));
        facts
    }

    fn body(&mut self, number: usize, item: &Item, body: &Body, agreement: f64) {
        if let Err(e) = body.validate(agreement) {
            self.problems
                .push(format!("{}: {e}", item_place(number, item)));
        }
        for f in &body.faces {
            self.kinds[kind(f.surface.as_ref())] += 1;
        }
        let (mut area, mut volume) = (None, None);
        // What is not sound is told where it is meshed.
        if let Ok(figures) = body::figures(body) {
            for (face, e) in figures.areas.iter().enumerate() {
                if let Err(e) = e {
                    let place = face_place(number, item, face);
                    self.problems.push(format!("{place} has no area: {e}"));
                }
            }
            let areas: Option<Vec<Measured>> = figures
                .areas
                .iter()
                .map(|a| a.as_ref().ok().copied())
                .collect();
            area = areas.map(|a| a.into_iter().sum());
            let closed = body
                .shells
                .iter()
                .zip(&figures.volumes)
                .filter(|s| s.0.closed);
            let volumes: Option<Vec<Measured>> = closed.map(|s| *s.1).collect();
            volume = volumes
                .filter(|v| !v.is_empty())
                .map(|v| v.into_iter().sum());
        }
        self.bodies.push(BodyFacts {
            item: number,
            closed: body.shells.iter().any(|s| s.closed),
            faces: body.faces.len(),
            edges: body.edges.len(),
            area,
            volume,
        });
    }

    fn solids(&self) -> usize {
        self.bodies.iter().filter(|b| b.closed).count()
    }

    fn faces(&self) -> usize {
        self.bodies.iter().map(|b| b.faces).sum()
    }

    fn edges(&self) -> usize {
        self.bodies.iter().map(|b| b.edges).sum()
    }

    fn area(&self) -> Option<Measured> {
        let all: Option<Vec<Measured>> = self.bodies.iter().map(|b| b.area).collect();
        Some(all?.into_iter().sum())
    }

    /// The sum of what the solids enclose.
    fn volume(&self) -> Option<Measured> {
        let solids = self.bodies.iter().filter(|b| b.closed);
        let all: Option<Vec<Measured>> = solids.map(|b| b.volume).collect();
        all.filter(|v| !v.is_empty()).map(|v| v.into_iter().sum())
    }

    fn text(&self, document: &Document, format: &str) -> String {
        let unit = document.units.symbol();
        let mut head = Table::of_facts();
        if let Some(name) = &document.name {
            head.row(["name", name]);
        }
        head.row(["format", format]);
        head.row(["units", unit]);
        let uncertainty = document.uncertainty.map_or_else(
            || "not said".to_owned(),
            |e| format!("{} {unit}", number(e, 4)),
        );
        head.row(["uncertainty", &uncertainty]);
        let sheets = self.bodies.len() - self.solids();
        let counted = [
            (self.solids(), "solid"),
            (sheets, "sheet"),
            (self.curves, "curve"),
            (self.points, "point"),
        ];
        head.row(["items", &list(counted.map(|(n, what)| plural(n, what)))]);
        if !self.bodies.is_empty() {
            let kinds = KINDS.iter().zip(self.kinds).filter(|k| k.1 > 0);
            let kinds: Vec<String> = kinds
                .map(|(what, n)| format!("{} {what}", count(n)))
                .collect();
            let faces = format!("{}: {}", count(self.faces()), kinds.join(", "));
            head.row(["faces", &faces]);
            head.row(["edges", &count(self.edges())]);
        }
        if let Some((hull, certainty)) = self.extent {
            head.row(["box", &box_text(hull, &error(certainty), unit)]);
        }
        if !self.bodies.is_empty() {
            let area = self.area().map_or_else(
                || "not told: a face has none".to_owned(),
                |a| format!("{} {unit}²", measured(a)),
            );
            head.row(["area", &area]);
        }
        let solids = self.solids();
        if solids > 0 {
            let each = if solids == 1 {
                ""
            } else {
                ", the sum of all solids"
            };
            let volume = self.volume().map_or_else(
                || "not told: a face of a solid has no region".to_owned(),
                |v| format!("{} {unit}³{each}", measured(v)),
            );
            head.row(["volume", &volume]);
        }
        let mut text = format!("{head}\n");
        if self.bodies.len() > 1 {
            text.push_str(&format!("\n{}\n", self.table(document, unit)));
            let more = self.bodies.len().saturating_sub(MOST_SHOWN);
            if more > 0 {
                text.push_str(&format!(
                    "and {} more; --format json lists all\n",
                    count(more)
                ));
            }
        }
        let left = document.left_out.iter().map(left_out);
        let lines: Vec<String> = left.chain(self.problems.iter().cloned()).collect();
        if !lines.is_empty() {
            text.push('\n');
        }
        for line in lines.iter().take(MOST_SHOWN) {
            text.push_str(&format!("{line}\n"));
        }
        let more = lines.len().saturating_sub(MOST_SHOWN);
        if more > 0 {
            text.push_str(&format!(
                "and {} more; --format json lists all\n",
                count(more)
            ));
        }
        text
    }

    /// The bodies one by one.
    fn table(&self, document: &Document, unit: &str) -> Table {
        let (area, volume) = (format!("area in {unit}²"), format!("volume in {unit}³"));
        let mut table = Table::headed(["body", "is a", "faces", "edges", &area, &volume]);
        for b in self.bodies.iter().take(MOST_SHOWN) {
            table.row([
                item_name(b.item, &document.items[b.item]),
                b.what().to_owned(),
                count(b.faces),
                count(b.edges),
                b.area.map_or_else(|| "not told".to_owned(), measured),
                b.volume.map_or_else(String::new, measured),
            ]);
        }
        table
    }

    fn json(&self, document: &Document, format: &str) -> Value {
        let body = |b: &BodyFacts| {
            json!({
                "item": b.item + 1,
                "name": document.items[b.item].name,
                "is": b.what(),
                "faces": b.faces,
                "edges": b.edges,
                "area": b.area.map(measured_json),
                "volume": b.volume.map(measured_json),
            })
        };
        let left_out = document.left_out.iter();
        let left_out = left_out
            .map(|l| json!({ "what": l.what, "why": l.why, "count": l.count, "first": l.first, "is_geometry": l.is_geometry }));
        let kinds = KINDS.iter().zip(self.kinds);
        json!({
            "name": document.name,
            "format": format,
            "units": document.units.symbol(),
            "uncertainty": document.uncertainty,
            "solids": self.solids(),
            "sheets": self.bodies.len() - self.solids(),
            "curves": self.curves,
            "points": self.points,
            "faces": self.faces(),
            "faces_by_kind": kinds.map(|(k, n)| (k.to_string(), Value::from(n))).collect::<serde_json::Map<_, _>>(),
            "edges": self.edges(),
            "box": self.extent.map(|(hull, certainty)| box_json(hull, certainty)),
            "area": self.area().map(measured_json),
            "volume": self.volume().map(measured_json),
            "bodies": self.bodies.iter().map(body).collect::<Vec<_>>(),
            "left_out": left_out.collect::<Vec<_>>(),
            "problems": self.problems,
        })
    }
}

impl BodyFacts {
    fn what(&self) -> &'static str {
        if self.closed { "solid" } else { "sheet" }
    }
}

/// The box of the triangles, lines and points. Surfaces may leave that of the triangles by their distance.
fn extent(document: &Document, made: &DocumentMesh) -> Option<(Box3, Certainty)> {
    let points = document.items.iter().filter_map(|i| match &i.form {
        ItemForm::Points(points) => Some(points.iter().copied()),
        _ => None,
    });
    let ends = made.scene.extent().into_iter().flatten();
    let hull = Box3::around(ends.chain(points.flatten()))?;
    let curves = if made.scene.curves.is_empty() {
        Certainty::Exact
    } else {
        Certainty::Estimated(made.tolerance)
    };
    let certainty = made.scene.deviation().and(curves);
    let certainty = match certainty {
        // What has no triangles may be anywhere.
        c if !made.missing.is_empty() => Certainty::Estimated(c.error()),
        c => c,
    };
    Some((hull, certainty))
}

fn box_text(hull: Box3, error: &str, unit: &str) -> String {
    let size = hull.to_array().map(|i| number(i.hi - i.lo, 7)).join(" × ");
    let range = |i: Interval| format!("{} … {}", number(i.lo, 7), number(i.hi, 7));
    format!(
        "{size} {unit}{error}: {}",
        hull.to_array().map(range).join(", ")
    )
}

fn plural(n: usize, what: &str) -> Option<String> {
    match n {
        0 => None,
        1 => Some(format!("1 {what}")),
        n => Some(format!("{} {what}s", count(n))),
    }
}

fn list(parts: impl IntoIterator<Item = Option<String>>) -> String {
    let parts: Vec<String> = parts.into_iter().flatten().collect();
    if parts.is_empty() {
        "none".to_owned()
    } else {
        parts.join(", ")
    }
}

/// The box of a mesh, which is what it is.
fn hull(facts: &MeshFacts) -> Option<Box3> {
    Box3::around(facts.extent.into_iter().flatten().collect::<Vec<DVec3>>())
}

fn mesh_text(mesh: &TriangleMesh, facts: &MeshFacts, format: &str) -> String {
    let unit = mesh.units.map_or("units", |u| u.symbol());
    let mut head = Table::of_facts();
    if let Some(title) = &mesh.title {
        head.row(["name", title]);
    }
    head.row(["format", format]);
    head.row(["units", mesh.units.map_or("not said", |u| u.symbol())]);
    head.row(["parts", &count(mesh.groups.len())]);
    if !mesh.curves.is_empty() {
        head.row(["curves", &count(mesh.curves.len())]);
    }
    head.row(["triangles", &count(facts.triangles)]);
    head.row(["points", &count(facts.points)]);
    for (n, what) in [
        (facts.degenerate, "triangles without area"),
        (facts.open_edges, "open edges"),
        (facts.crowded_edges, "edges of more than two triangles"),
        (facts.turned_edges, "edges where normals disagree"),
    ] {
        if n > 0 {
            head.row([what, &count(n)]);
        }
    }
    if let Some(hull) = hull(facts) {
        head.row(["box", &box_text(hull, "", unit)]);
    }
    head.row(["area", &format!("{} {unit}²", number(facts.area, 10))]);
    let volume = facts.volume.map_or_else(
        || "encloses nothing".to_owned(),
        |v| {
            format!(
                "{} {unit}³ enclosed, if nothing passes through itself",
                number(v, 10)
            )
        },
    );
    head.row(["volume", &volume]);
    let mut text = format!("{head}\n");
    if !(mesh.missing.is_empty() && mesh.notes.is_empty()) {
        text.push('\n');
    }
    for missing in &mesh.missing {
        text.push_str(&format!("missing geometry: {missing}\n"));
    }
    for note in &mesh.notes {
        text.push_str(&format!("{note}\n"));
    }
    text
}

fn mesh_json(mesh: &TriangleMesh, facts: &MeshFacts, format: &str) -> Value {
    json!({
        "name": mesh.title,
        "format": format,
        "units": mesh.units.map(|u| u.symbol()),
        "parts": mesh.groups.iter().map(|g| json!({ "name": g.name, "triangles": g.triangles.len() })).collect::<Vec<_>>(),
        "curves": mesh.curves.len(),
        "triangles": facts.triangles,
        "points": facts.points,
        "triangles_without_area": facts.degenerate,
        "open_edges": facts.open_edges,
        "edges_of_more_than_two_triangles": facts.crowded_edges,
        "edges_where_normals_disagree": facts.turned_edges,
        "box": hull(facts).map(|hull| box_json(hull, Certainty::Exact)),
        "area": facts.area,
        "volume": facts.volume,
        "missing": mesh.missing,
        "notes": mesh.notes,
    })
}

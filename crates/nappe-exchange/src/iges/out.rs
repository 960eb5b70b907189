//! Lines of 80 columns.

use crate::Colour;
use crate::text::number;
use glam::DVec3;
use nappe::Units;

/// Columns of data in a line of parameters.
const PARAMETERS: usize = 64;
/// Columns of data in a line of the other sections.
const DATA: usize = 72;

/// Entities with their parameters, in the order of their numbers.
#[derive(Default)]
pub(super) struct Out {
    entities: Vec<Entity>,
    colours: Vec<(Colour, usize)>,
}

struct Entity {
    kind: u32,
    form: u32,
    status: String,
    params: Params,
    /// The number of its colour's entity, or 0.
    colour: usize,
    /// The number of its name's entity, or 0.
    name: usize,
}

/// Parameters, each as text.
#[derive(Default)]
pub(super) struct Params(Vec<String>);

impl Params {
    pub(super) fn int(&mut self, x: usize) {
        self.0.push(x.to_string());
    }

    /// The shortest decimal that reads back as the same number; reals have a point.
    pub(super) fn real(&mut self, x: f64) {
        let mut s = number(x);
        if !s.contains('.') {
            match s.find('e') {
                Some(e) => s.insert(e, '.'),
                None => s.push('.'),
            }
        }
        self.0.push(s.replace('e', "E"));
    }

    pub(super) fn point(&mut self, p: DVec3) {
        p.to_array().into_iter().for_each(|x| self.real(x));
    }

    fn text(&mut self, s: &str) {
        self.0.push(string(s));
    }
}

/// A string with its length in front. The format has ASCII only.
fn string(s: &str) -> String {
    let s: String = s
        .chars()
        .map(|c| if (' '..='~').contains(&c) { c } else { '?' })
        .collect();
    if s.is_empty() {
        return s;
    }
    format!("{}H{s}", s.len())
}

impl Out {
    /// Adds an entity and returns its number in the directory.
    pub(super) fn entity(
        &mut self,
        kind: u32,
        form: u32,
        status: &str,
        fill: impl FnOnce(&mut Params),
    ) -> usize {
        let mut params = Params::default();
        fill(&mut params);
        self.entities.push(Entity {
            kind,
            form,
            status: status.to_owned(),
            params,
            colour: 0,
            name: 0,
        });
        2 * self.entities.len() - 1
    }

    /// Gives an entity a name and a colour.
    pub(super) fn style(&mut self, number: usize, name: &str, colour: Option<Colour>) {
        let colour = colour.map_or(0, |c| self.colour(c));
        let name = if name.is_empty() {
            0
        } else {
            self.entity(406, 15, "00010200", |r| {
                r.int(1);
                r.text(name);
            })
        };
        let entity = &mut self.entities[(number - 1) / 2];
        (entity.colour, entity.name) = (colour, name);
    }

    fn colour(&mut self, colour: Colour) -> usize {
        if let Some(known) = self.colours.iter().find(|c| c.0 == colour) {
            return known.1;
        }
        let d = self.entity(314, 0, "00000200", |r| {
            colour
                .iter()
                .for_each(|x| r.real(f64::from(*x).clamp(0.0, 1.0) * 100.0));
        });
        self.colours.push((colour, d));
        d
    }

    /// The whole file. `resolution`: what is nearer is one point; `largest`: the largest coordinate.
    pub(super) fn finish(self, name: &str, units: Units, resolution: f64, largest: f64) -> Vec<u8> {
        let (flag, symbol) = match units {
            Units::Inch => (1, "IN"),
            Units::Millimetre => (2, "MM"),
            Units::Foot => (4, "FT"),
            Units::Metre => (6, "M"),
            Units::Centimetre => (10, "CM"),
        };
        let mut g = Params::default();
        g.text(",");
        g.text(";");
        for text in [name, "nappe.igs", "nappe", env!("CARGO_PKG_VERSION")] {
            g.text(text);
        }
        [32, 38, 6, 308, 15].into_iter().for_each(|x| g.int(x));
        g.text(name);
        g.real(1.0);
        g.int(flag);
        g.text(symbol);
        g.int(1);
        g.real(0.01);
        // The same document makes the same bytes, so the file bears no date of its own.
        g.text("19700101.000000");
        g.real(resolution);
        g.real(largest);
        g.text("");
        g.text("");
        // Version 5.3, no drafting standard.
        g.int(11);
        g.int(0);
        let mut out = String::new();
        let start = wrapped(&["Exact surfaces in IGES 5.3".to_owned()], DATA);
        let global = wrapped(&joined(g.0), DATA);
        let mut counts = [0; 4];
        for (lines, section, count) in [(&start, 'S', 0), (&global, 'G', 1)] {
            counts[count] = lines.len();
            for (i, line) in lines.iter().enumerate() {
                out += &format!("{line:<DATA$}{section}{:7}\n", i + 1);
            }
        }
        let mut data = String::new();
        for (i, e) in self.entities.into_iter().enumerate() {
            let d = 2 * i + 1;
            let mut params = vec![e.kind.to_string()];
            params.extend(e.params.0);
            if e.name > 0 {
                // No groups, one property.
                params.extend(["0".into(), "1".into(), e.name.to_string()]);
            }
            let lines = wrapped(&joined(params), PARAMETERS);
            let first = counts[3] + 1;
            for line in &lines {
                counts[3] += 1;
                data += &format!("{line:<PARAMETERS$}{d:8}P{:7}\n", counts[3]);
            }
            let colour = if e.colour > 0 {
                format!("-{}", e.colour)
            } else {
                "0".into()
            };
            let (kind, zero) = (e.kind, 0);
            out += &format!(
                "{kind:8}{first:8}{zero:8}{zero:8}{zero:8}{zero:8}{zero:8}{zero:8}{:>8}D{d:7}\n",
                e.status
            );
            out += &format!(
                "{kind:8}{zero:8}{colour:>8}{:8}{:8}{:8}{:8}{:8}{zero:8}D{:7}\n",
                lines.len(),
                e.form,
                "",
                "",
                "",
                d + 1
            );
            counts[2] += 2;
        }
        out += &data;
        out += &format!(
            "{:<DATA$}T{:7}\n",
            format!(
                "S{:7}G{:7}D{:7}P{:7}",
                counts[0], counts[1], counts[2], counts[3]
            ),
            1
        );
        out.into_bytes()
    }
}

/// Parameters with the delimiters behind them.
fn joined(params: Vec<String>) -> Vec<String> {
    let last = params.len() - 1;
    params
        .into_iter()
        .enumerate()
        .map(|(i, p)| p + if i == last { ";" } else { "," })
        .collect()
}

/// Lines of a width: numbers are never cut, strings that do not fit go on in the next line.
fn wrapped(params: &[String], width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for p in params {
        let mut p = p.as_str();
        let room = width - lines.last().map_or(0, String::len);
        if p.len() <= room {
            if let Some(l) = lines.last_mut() {
                l.push_str(p);
            }
            continue;
        }
        if p.len() <= width {
            lines.push(p.to_owned());
            continue;
        }
        // All of it is ASCII.
        let mut room = room;
        while !p.is_empty() {
            let (head, tail) = p.split_at(room.min(p.len()));
            if let Some(l) = lines.last_mut() {
                l.push_str(head);
            }
            p = tail;
            if !p.is_empty() {
                lines.push(String::new());
                room = width;
            }
        }
    }
    lines
}

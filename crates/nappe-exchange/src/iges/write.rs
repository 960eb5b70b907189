//! IGES files out.
//!
//! Surfaces go out as NURBS (128), curves as lines (110) or NURBS (126): exactly where that exists, else within a
//! tolerance. A closed body is a solid (186), other shells are shells of faces (514) that share their edges (510, 508, 504,
//! 502), or single trimmed surfaces (144) with the edges as boundaries (142), as asked for.

use super::out::Out;
use super::trimmed::projected_area;
use crate::atomic::write_atomically;
use crate::hollow::is_hollow;
use crate::report::{Progress, Shares};
use crate::{Document, ExchangeError, Item, ItemForm};
use glam::DVec3;
use nappe::body::{Body, Coedge, Face, Loop};
use nappe::exact::{to_nurbs_or_approximate, to_nurbs_or_approximate_curve};
use nappe::mesh::Certainty;
use nappe::{Box3, CurveRef, NurbsCurve, NurbsSurface, SurfaceRef};
use std::io::Write;
use std::path::Path;

/// How to write.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IgesOptions {
    /// How far what has no exact form may be from the surface it stands for.
    pub tolerance: f64,
    /// Whether open shells are written as single trimmed surfaces (144), which more programs read, and not as shells that
    /// share edges (514). Closed ones are solids (186) in any case.
    pub trimmed: bool,
}

/// What was written.
#[derive(Clone, Debug, PartialEq)]
pub struct IgesReport {
    /// How far curves and surfaces of the file are from the document's.
    pub certainty: Certainty,
    /// How many surfaces are approximated.
    pub approximated: usize,
    /// Solids, shells, trimmed surfaces.
    pub bodies: [usize; 3],
}

/// Entities that belong to another one, and such that it cannot be without.
pub(super) const PART: &str = "00010000";
/// Entities by themselves.
pub(super) const WHOLE: &str = "00000000";
/// Curves in the parameters of a surface, and definitions.
const DEFINITION: &str = "00010200";

/// Writes a document to a file, which is replaced only when the new one is whole. Numbers have as many digits as tell them
/// from their neighbours, so control points come back as they are.
///
/// # Errors
/// [`ExchangeError`]: nothing to write, a body that is not valid, numbers that are not finite, a file that cannot be
/// written.
pub fn write(
    path: &Path,
    document: &Document,
    options: &IgesOptions,
) -> Result<IgesReport, ExchangeError> {
    write_telling(path, document, options, Progress::default())
}

/// The same, telling how far it is.
pub(crate) fn write_telling(
    path: &Path,
    document: &Document,
    options: &IgesOptions,
    progress: Progress<'_>,
) -> Result<IgesReport, ExchangeError> {
    document.holds_something(path)?;
    let (text, report) = text(document, options, progress).map_err(|why| ExchangeError::Shape {
        path: path.to_owned(),
        why,
    })?;
    write_atomically(path, |out| out.write_all(&text))?;
    Ok(report)
}

/// The file.
pub(super) fn text(
    document: &Document,
    options: &IgesOptions,
    progress: Progress<'_>,
) -> Result<(Vec<u8>, IgesReport), String> {
    let surfaces = document.items.iter().map(|item| match &item.form {
        ItemForm::Body { body, .. } => body.faces.len(),
        _ => 0,
    });
    let mut w = Writer {
        out: Out::default(),
        steps: Shares::new(progress, surfaces.sum()),
        options: *options,
        report: IgesReport {
            certainty: Certainty::Exact,
            approximated: 0,
            bodies: [0; 3],
        },
    };
    for item in &document.items {
        w.item(item)
            .map_err(|why| format!("`{}`: {why}", item.name))?;
    }
    let mut largest = 0.0f64;
    let mut gap = document.uncertainty.unwrap_or(0.0);
    for item in &document.items {
        if let ItemForm::Body { body, .. } = &item.form {
            let far = body.vertices.iter().map(|v| v.point.abs().max_element());
            largest = far.fold(largest, f64::max);
            gap = body.edges.iter().fold(gap, |g, e| g.max(e.tolerance));
        }
    }
    let least = 1e-12 * largest.max(1.0);
    let text = w.out.finish(
        document.name.as_deref().unwrap_or("nappe"),
        document.units,
        gap.max(least),
        largest,
    );
    Ok((text, w.report))
}

struct Writer<'p> {
    out: Out,
    /// One for each surface.
    steps: Shares<'p>,
    options: IgesOptions,
    report: IgesReport,
}

impl Writer<'_> {
    fn item(&mut self, item: &Item) -> Result<(), String> {
        match &item.form {
            ItemForm::Curve(c) => {
                let d = self.curve(c, WHOLE)?;
                self.out.style(d, &item.name, item.colour);
            }
            ItemForm::Points(points) => {
                for p in points {
                    let d = self.out.entity(116, 0, WHOLE, |r| {
                        r.point(*p);
                        r.int(0);
                    });
                    self.out.style(d, &item.name, item.colour);
                }
            }
            ItemForm::Body { body, faces } => {
                body.validate(f64::INFINITY).map_err(|e| e.to_string())?;
                let style = |face: usize| {
                    let own = faces.get(face);
                    let name = own.map_or("", |f| f.name.as_str());
                    (name.to_owned(), own.and_then(|f| f.colour).or(item.colour))
                };
                if self.options.trimmed && !body.shells.iter().any(|s| s.closed) {
                    for face in 0..body.faces.len() {
                        let d = self.trimmed(body, face)?;
                        let (mut name, colour) = style(face);
                        if name.is_empty() {
                            name.clone_from(&item.name);
                        }
                        self.out.style(d, &name, colour);
                    }
                    self.report.bodies[2] += body.faces.len();
                    return Ok(());
                }
                self.shells(body, item, &style)?;
            }
        }
        Ok(())
    }

    fn curve(&mut self, curve: &CurveRef, status: &str) -> Result<usize, String> {
        let made = to_nurbs_or_approximate_curve(curve.as_ref(), self.options.tolerance)
            .map_err(|e| e.to_string())?;
        self.report.certainty = self.report.certainty.and(made.certainty);
        Ok(self.nurbs(&made.nurbs, status))
    }

    fn nurbs(&mut self, n: &NurbsCurve, status: &str) -> usize {
        let (points, weights) = (n.control_points(), n.weights());
        let (p, knots) = (n.degree(), n.knots());
        let plain = knots == [0.0, 0.0, 1.0, 1.0] && !n.is_rational();
        if plain {
            return self.out.entity(110, 0, status, |r| {
                points.iter().for_each(|p| r.point(*p));
            });
        }
        let closed = points.first() == points.last();
        self.out.entity(126, 0, status, |r| {
            r.int(points.len() - 1);
            r.int(p);
            [false, closed, !n.is_rational(), false]
                .into_iter()
                .for_each(|f| r.int(usize::from(f)));
            knots.iter().chain(&weights).for_each(|x| r.real(*x));
            points.iter().for_each(|p| r.point(*p));
            r.real(knots[p]);
            r.real(knots[points.len()]);
            r.point(DVec3::ZERO);
        })
    }

    /// `turned`: with its normal on the other side, its parameters exchanged.
    fn surface(
        &mut self,
        s: &SurfaceRef,
        turned: bool,
        status: &str,
    ) -> Result<(usize, NurbsSurface), String> {
        let made = to_nurbs_or_approximate(s.as_ref(), self.options.tolerance)
            .map_err(|e| e.to_string())?;
        self.report.certainty = self.report.certainty.and(made.certainty);
        self.report.approximated += usize::from(made.certainty != Certainty::Exact);
        self.steps.step();
        let n = if turned {
            made.nurbs.swapped()
        } else {
            made.nurbs
        };
        let [rows, columns] = n.size();
        let bases = [n.basis_u(), n.basis_v()];
        let (points, weights) = (n.control_points(), n.weights());
        let d = self.out.entity(128, 0, status, |r| {
            r.int(rows - 1);
            r.int(columns - 1);
            bases.iter().for_each(|b| r.int(b.degree()));
            [false, false, !n.is_rational(), false, false]
                .into_iter()
                .for_each(|f| r.int(usize::from(f)));
            for b in bases {
                b.knots().iter().for_each(|k| r.real(*k));
            }
            // The file has u fastest.
            let order = || (0..columns).flat_map(|j| (0..rows).map(move |i| i * columns + j));
            order().for_each(|k| r.real(weights[k]));
            order().for_each(|k| r.point(points[k]));
            for (b, count) in bases.into_iter().zip([rows, columns]) {
                r.real(b.knots()[b.degree()]);
                r.real(b.knots()[count]);
            }
        });
        Ok((d, n))
    }

    /// Loops of a face as its surface's own normal sees them.
    fn loops(body: &Body, face: usize) -> impl Iterator<Item = Vec<Coedge>> {
        let f = &body.faces[face];
        f.loops.iter().filter_map(move |l| {
            let Loop::Edges(coedges) = l else { return None };
            let mut c = coedges.clone();
            if !f.forward {
                c.reverse();
                c.iter_mut().for_each(|c| c.forward = !c.forward);
            }
            Some(c)
        })
    }

    /// 144. The file has no mark for a face whose normal is not that of its surface: the surface is turned.
    fn trimmed(&mut self, body: &Body, face: usize) -> Result<usize, String> {
        // As the body has it.
        let mut seen = body.faces[face].clone();
        let mut all = body.shells.iter().flat_map(|s| &s.faces);
        if all.find(|s| s.0 == face).is_some_and(|s| !s.1) {
            seen.turn();
        }
        let (surface, _) = self.surface(&seen.surface, !seen.forward, PART)?;
        let mut borders = Vec::new();
        for coedges in outer_first(body, &seen) {
            let mut parts = Vec::new();
            for c in coedges {
                let curve = &body.edges[c.edge].curve;
                let made = to_nurbs_or_approximate_curve(curve.as_ref(), self.options.tolerance)
                    .map_err(|e| e.to_string())?;
                self.report.certainty = self.report.certainty.and(made.certainty);
                let n = if c.forward {
                    made.nurbs
                } else {
                    made.nurbs.reversed().map_err(|e| e.to_string())?
                };
                parts.push(self.nurbs(&n, PART));
            }
            let curve = match parts[..] {
                [one] => one,
                _ => self.out.entity(102, 0, PART, |r| {
                    r.int(parts.len());
                    parts.iter().for_each(|p| r.int(*p));
                }),
            };
            borders.push(self.out.entity(142, 0, PART, |r| {
                // Made in no particular way; no curve in parameters; the one in space is meant.
                [1, surface, 0, curve, 2].into_iter().for_each(|x| r.int(x));
            }));
        }
        if borders.is_empty() {
            return Err(format!("its face {face} has no edges; write it as a shell"));
        }
        Ok(self.out.entity(144, 0, WHOLE, |r| {
            [surface, 1, borders.len() - 1]
                .into_iter()
                .chain(borders.iter().copied())
                .for_each(|x| r.int(x));
        }))
    }

    /// 186 around 514, or 514 by itself.
    fn shells(
        &mut self,
        body: &Body,
        item: &Item,
        style: &dyn Fn(usize) -> (String, Option<crate::Colour>),
    ) -> Result<(), String> {
        let vertices = self.out.entity(502, 1, DEFINITION, |r| {
            r.int(body.vertices.len());
            body.vertices.iter().for_each(|v| r.point(v.point));
        });
        let mut curves = Vec::new();
        for e in &body.edges {
            curves.push(self.curve(&e.curve, PART)?);
        }
        let edges = self.out.entity(504, 1, DEFINITION, |r| {
            r.int(curves.len());
            for (e, curve) in body.edges.iter().zip(&curves) {
                let [a, b] = e.vertices.map(|v| v + 1);
                [*curve, vertices, a, vertices, b]
                    .into_iter()
                    .for_each(|x| r.int(x));
            }
        });
        let mut faces = Vec::new();
        for face in 0..body.faces.len() {
            let (surface, _) = self.surface(&body.faces[face].surface, false, PART)?;
            let mut borders = Vec::new();
            for coedges in Self::loops(body, face) {
                borders.push(self.out.entity(508, 1, DEFINITION, |r| {
                    r.int(coedges.len());
                    for c in &coedges {
                        [0, edges, c.edge + 1, usize::from(c.forward), 0]
                            .into_iter()
                            .for_each(|x| r.int(x));
                    }
                }));
            }
            let d = self.out.entity(510, 1, PART, |r| {
                // The first border is not said to be the outer one.
                [surface, borders.len(), 0]
                    .into_iter()
                    .chain(borders.iter().copied())
                    .for_each(|x| r.int(x));
            });
            let (name, colour) = style(face);
            self.out.style(d, &name, colour);
            faces.push(d);
        }
        let hollow = is_hollow(body);
        let mut around = Vec::new();
        for shell in &body.shells {
            let status = if shell.closed { PART } else { WHOLE };
            let form = if shell.closed { 1 } else { 2 };
            let d = self.out.entity(514, form, status, |r| {
                r.int(shell.faces.len());
                for (face, agrees) in &shell.faces {
                    r.int(faces[*face]);
                    r.int(usize::from(*agrees == body.faces[*face].forward));
                }
            });
            if hollow {
                around.push(d);
                continue;
            }
            let d = if shell.closed {
                self.report.bodies[0] += 1;
                self.out.entity(186, 0, WHOLE, |r| {
                    [d, 1, 0].into_iter().for_each(|x| r.int(x));
                })
            } else {
                self.report.bodies[1] += 1;
                d
            };
            self.out.style(d, &item.name, item.colour);
        }
        if hollow {
            // The shell around the solid, then those around its holes; each has the normals of the solid.
            self.report.bodies[0] += 1;
            let d = self.out.entity(186, 0, WHOLE, |r| {
                [around[0], 1, around.len() - 1]
                    .into_iter()
                    .chain(around[1..].iter().flat_map(|d| [*d, 1]))
                    .for_each(|x| r.int(x));
            });
            self.out.style(d, &item.name, item.colour);
        }
        Ok(())
    }
}

/// The loops of a face as its own normal sees them, that around all others first: the largest in the parameters, and in
/// space where the surface closes.
fn outer_first<'a>(body: &Body, f: &'a Face) -> Vec<&'a [Coedge]> {
    let mut loops: Vec<&[Coedge]> = f
        .loops
        .iter()
        .filter_map(|l| match l {
            Loop::Edges(coedges) => Some(&coedges[..]),
            Loop::Vertex(_) => None,
        })
        .collect();
    if loops.len() < 2 {
        return loops;
    }
    let curves = |l: &[Coedge]| -> Vec<(&CurveRef, bool)> {
        let one = |c: &Coedge| (&body.edges[c.edge].curve, c.forward);
        l.iter().map(one).collect()
    };
    let areas: Option<Vec<f64>> = loops
        .iter()
        .map(|l| projected_area(&f.surface, &curves(l)).map(f64::abs))
        .collect();
    let sizes = areas.unwrap_or_else(|| {
        let size = |l: &&[Coedge]| {
            let boxes = curves(l).into_iter().map(|(c, _)| c.bounds(c.domain()));
            boxes.reduce(Box3::hull).map_or(0.0, |b| b.diagonal())
        };
        loops.iter().map(size).collect()
    });
    let largest = (0..loops.len()).max_by(|&a, &b| sizes[a].total_cmp(&sizes[b]));
    loops.swap(0, largest.unwrap_or(0));
    loops
}

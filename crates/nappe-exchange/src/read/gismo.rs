//! Geometry of the G+Smo library (`.xml`): curves and surfaces with B-spline bases, also rational ones.
//!
//! Coefficients have the first parameter running fastest. Other kinds (volumes, hierarchical splines, meshes) and those of
//! other than two or three coordinates are left out. There are no units.
//! Source: the documentation of G+Smo, *Tutorial 01: geometry*, and its `filedata`.

use super::sheet::{sheet, wire};
use super::words::Words;
use super::{Fault, net, number, shown};
use crate::document::{Document, Item, Lost, note};
use glam::DVec3;
use nappe::{NurbsCurve, NurbsSurface};
use roxmltree::{Node, ParsingOptions};
use std::sync::Arc;

/// More elements are no geometry that this format is meant for.
const MOST_NODES: u32 = 2_000_000;

pub(super) fn read(bytes: &[u8]) -> Result<Document, Fault> {
    let text = String::from_utf8_lossy(bytes);
    let xml = declared(&text);
    let before = text[..text.len() - xml.len()].matches('\n').count();
    let options = ParsingOptions {
        nodes_limit: MOST_NODES,
        ..ParsingOptions::default()
    };
    let tree = roxmltree::Document::parse_with_options(xml, options).map_err(|e| {
        let line = before + e.pos().row as usize;
        Fault::line(line, format!("not well-formed XML: {e}"))
    })?;
    let root = tree.root_element();
    if !root.has_tag_name("xml") {
        let name = shown(root.tag_name().name());
        return Err(Fault::whole(format!(
            "no G+Smo file: its root element is `{name}` and should be `xml`"
        )));
    }
    let mut document = Document::default();
    for node in root.children().filter(Node::is_element) {
        let line = |n: Node<'_, '_>| before + tree.text_pos_at(n.range().start).row as usize;
        let kind = node.attribute("type").unwrap_or_default();
        let dimension = match (node.tag_name().name(), kind) {
            ("Geometry", "BSpline" | "Nurbs") => 1,
            ("Geometry", "TensorBSpline2" | "TensorNurbs2") => 2,
            (name, kind) => {
                let (lost, why) = match name {
                    "MultiPatch" => (
                        Lost::Other,
                        "its patches are read one by one, without what it says of their sides",
                    ),
                    "Geometry" => (Lost::Geometry, "geometry of this type is not read"),
                    _ => (Lost::Other, "it is no geometry"),
                };
                let what = shown(format!("{name} {kind}").trim());
                note(
                    &mut document.left_out,
                    lost,
                    what,
                    why.into(),
                    format!("line {}", line(node)),
                );
                continue;
            }
        };
        match geometry(node, dimension, &line)? {
            Ok(item) => document.items.push(item),
            Err(why) => note(
                &mut document.left_out,
                Lost::Geometry,
                shown(&format!("Geometry {kind}")),
                why,
                format!("line {}", line(node)),
            ),
        }
    }
    Ok(document)
}

/// The text from its XML declaration on: files have white space and comments before it, which XML does not allow.
fn declared(text: &str) -> &str {
    let mut rest = text.trim_start_matches('\u{feff}').trim_start();
    while let Some(comment) = rest.strip_prefix("<!--") {
        let Some(end) = comment.find("-->") else {
            break;
        };
        rest = comment[end + 3..].trim_start();
    }
    rest
}

/// A curve or surface; the inner error is why it is left out.
fn geometry(
    node: Node<'_, '_>,
    dimension: usize,
    line: &impl Fn(Node<'_, '_>) -> usize,
) -> Result<Result<Item, String>, Fault> {
    let at = line(node);
    let mut bases = Vec::new();
    for k in node.descendants().filter(|n| n.has_tag_name("KnotVector")) {
        let degree = k.attribute("degree").and_then(|d| d.parse().ok());
        let degree: usize =
            degree.ok_or_else(|| Fault::line(line(k), "a knot vector without a degree"))?;
        if k.attribute("mode").is_some() {
            return Ok(Err("knots that are not written out are not read".into()));
        }
        let index = k.parent().and_then(|b| b.attribute("index"));
        let index: Option<usize> = index.and_then(|i| i.parse().ok());
        bases.push((index.unwrap_or(bases.len()), degree, numbers(k, line)?));
    }
    bases.sort_by_key(|b| b.0);
    let in_order = bases.iter().enumerate().all(|(i, b)| b.0 == i);
    if bases.len() != dimension || !in_order {
        return Err(Fault::line(
            at,
            format!(
                "it has {} knot vectors; {dimension} with the indices from 0 are needed",
                bases.len()
            ),
        ));
    }
    let one = |name: &str| node.descendants().find(|n| n.has_tag_name(name));
    let coefs = one("coefs").ok_or_else(|| Fault::line(at, "it has no coefficients"))?;
    let text_of = |n: Node<'_, '_>| {
        let format = n.attribute("format").unwrap_or("ascii");
        format.eq_ignore_ascii_case("ascii")
    };
    let weights = one("weights");
    if !text_of(coefs) || !weights.is_none_or(text_of) {
        return Ok(Err(
            "numbers that are not written as text are not read".into()
        ));
    }
    let width = coefs.attribute("geoDim").unwrap_or_default();
    let width: usize = match width.parse() {
        Ok(n @ (2 | 3)) => n,
        _ => {
            let width = shown(width);
            return Ok(Err(format!(
                "of `{width}` coordinates; those of 2 and 3 are read"
            )));
        }
    };
    let flat = numbers(coefs, line)?;
    if flat.len() % width != 0 {
        return Err(Fault::line(
            line(coefs),
            format!(
                "{} coefficients, which are no points of {width} coordinates",
                flat.len()
            ),
        ));
    }
    let point = |c: &[f64]| DVec3::new(c[0], c[1], c.get(2).copied().unwrap_or(0.0));
    let points: Vec<DVec3> = flat.chunks_exact(width).map(point).collect();
    let weights = weights.map(|w| numbers(w, line)).transpose()?;
    if let Some(w) = weights.as_ref().filter(|w| w.len() != points.len()) {
        return Err(Fault::line(
            at,
            format!("{} weights for {} points", w.len(), points.len()),
        ));
    }
    let name = node.attribute("label").unwrap_or_default();
    let name = crate::text::line(name.trim());
    let mut bases = bases.into_iter().map(|(_, degree, knots)| (degree, knots));
    let item = match (bases.next(), bases.next()) {
        (Some((degree, knots)), None) => {
            NurbsCurve::new(degree, knots, &points, weights.as_deref())
                .map_err(|e| e.to_string())
                .and_then(|c| wire(name, Arc::new(c)))
        }
        (Some((m, u)), Some((n, v))) => {
            // Unequal numbers of knots and points are told by the surface, which needs some order of the points.
            let count =
                |knots: &[f64], degree: usize| knots.len().saturating_sub(degree.saturating_add(1));
            let size = [count(&u, m), count(&v, n)];
            if size[0].checked_mul(size[1]) != Some(points.len()) {
                return Err(Fault::line(
                    at,
                    format!(
                        "its knots ask for {} × {} points, and there are {}",
                        size[0],
                        size[1],
                        points.len()
                    ),
                ));
            }
            let weights = weights.map(|w| net(&w, size));
            NurbsSurface::new([m, n], [u, v], &net(&points, size), weights.as_deref())
                .map_err(|e| e.to_string())
                .and_then(|s| sheet(name, s))
        }
        _ => Err("it has no knots".into()),
    };
    item.map(Ok).map_err(|e| Fault::line(at, e))
}

/// The numbers in an element.
fn numbers(node: Node<'_, '_>, line: &impl Fn(Node<'_, '_>) -> usize) -> Result<Vec<f64>, Fault> {
    let mut all = Vec::new();
    for text in node.children().filter(Node::is_text) {
        let mut words = Words::new(text.text().unwrap_or_default(), line(text));
        while let Some(word) = words.next() {
            let x = number(word);
            all.push(x.ok_or_else(|| {
                words.fault(format!("`{}` should be a finite number", shown(word)))
            })?);
        }
    }
    Ok(all)
}

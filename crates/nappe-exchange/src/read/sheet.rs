//! Single surfaces and curves as items of a document.

use crate::document::{Item, ItemForm};
use glam::DVec3;
use nappe::body::sew;
use nappe::surface::check_not_collapsed;
use nappe::{CurveRef, LARGEST_LENGTH, NurbsSurface, SurfaceRef};
use std::sync::Arc;

/// A body of one face, all of a surface. Error: the surface has no area, or is too large to be computed with.
pub(super) fn sheet(name: String, surface: NurbsSurface) -> Result<Item, String> {
    fits(&surface.control_points())?;
    check_not_collapsed(&surface).map_err(|e| e.to_string())?;
    let surface: SurfaceRef = Arc::new(surface);
    Ok(Item {
        name,
        colour: None,
        form: ItemForm::Body {
            body: sew(&[surface], 0.0).body,
            faces: Vec::new(),
        },
    })
}

/// A curve. Error: it is too large to be computed with.
pub(super) fn wire(name: String, curve: CurveRef) -> Result<Item, String> {
    match curve.to_nurbs() {
        Some(n) => fits(&n.control_points())?,
        None => fits(&curve.ends())?,
    }
    Ok(Item {
        name,
        colour: None,
        form: ItemForm::Curve(curve),
    })
}

/// Points. Error: one is too far away to be computed with.
pub(super) fn dots(name: String, points: Vec<DVec3>) -> Result<Item, String> {
    fits(&points)?;
    Ok(Item {
        name,
        colour: None,
        form: ItemForm::Points(points),
    })
}

fn fits(points: &[DVec3]) -> Result<(), String> {
    let far = |p: &&DVec3| !p.is_finite() || p.abs().max_element() > LARGEST_LENGTH;
    match points.iter().find(far) {
        None => Ok(()),
        Some(p) => Err(format!(
            "the point {p} is farther out than {LARGEST_LENGTH:e}"
        )),
    }
}

//! Solids with cavities.

use nappe::body::{Body, Loop, Shell, figures};
use nappe::measure::Measured;

/// Whether a shell takes all its faces the other way round.
pub(crate) fn is_turned(shell: &Shell) -> bool {
    shell.faces.iter().all(|f| !f.1)
}

/// Whether all shells but the first are turned inside out: the hollows of a solid. Where their faces do not all say so, what
/// they enclose does. Cost: the volume of each shell where faces do not say so.
pub(crate) fn is_hollow(body: &Body) -> bool {
    let shells = &body.shells;
    if shells.len() < 2 || !shells.iter().all(|s| s.closed) {
        return false;
    }
    if !is_turned(&shells[0]) && shells[1..].iter().all(is_turned) {
        return true;
    }
    if !shells[1..].iter().all(|s| is_within(body, s, &shells[0])) {
        return false;
    }
    let Ok(figures) = figures(body) else {
        return false;
    };
    let sign = |v: &Option<Measured>| {
        let v = v.as_ref()?;
        (v.value.abs() > v.certainty.error()).then_some(v.value > 0.0)
    };
    let mut signs = figures.volumes.iter().map(sign);
    signs.next() == Some(Some(true)) && signs.all(|s| s == Some(false))
}

/// Whether a shell may lie in another: their edges' boxes do not say that it does not.
fn is_within(body: &Body, inner: &Shell, outer: &Shell) -> bool {
    let extent = |shell: &Shell| {
        let loops = shell.faces.iter().flat_map(|f| &body.faces[f.0].loops);
        let coedges = loops.flat_map(|l| match l {
            Loop::Edges(coedges) => coedges.as_slice(),
            Loop::Vertex(_) => &[],
        });
        let curves = coedges.map(|c| &body.edges[c.edge].curve);
        curves
            .map(|c| c.bounds(c.domain()))
            .reduce(|a, b| a.hull(b))
    };
    // Faces without edges reach anywhere, and faces reach beyond their edges.
    match (extent(inner), extent(outer)) {
        (Some(inner), Some(outer)) => inner.mid().distance(outer.mid()) <= outer.diagonal(),
        _ => true,
    }
}

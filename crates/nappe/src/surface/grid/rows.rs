//! Row by row: the core collapsed to the vectors that the functions of v take, and the way of a row to its places.

use super::blocks::{Blocks, Layout};
use super::columns::{COLUMNS, Columns, Piece, in_packs};
use super::output::Output;
use super::places::{Places, To};
use super::row::{Block, Part};
use crate::breaks::Limit;
use crate::simd::{Registers, far_from_limits};
use crate::surface::{Core, Separable};
use glam::DVec4;
use nappe_stream::LINE;

/// Evaluates a grid with derivatives up to `ORDER`, a register of points at a time.
#[inline(always)]
pub(super) fn evaluate<R: Registers, O: Output<R, JET>, const ORDER: usize, const JET: usize>(
    r: R,
    surface: &Separable,
    uv: [&[f64]; 2],
    out: &mut Places,
    output: &O,
) {
    match (surface.core(), surface.is_rational()) {
        (Core::Net(net), false) => {
            rows::<R, O, 3, ORDER, JET>(r, surface, Some(net), uv, out, output);
        }
        (Core::Net(net), true) => {
            rows::<R, O, 4, ORDER, JET>(r, surface, Some(net), uv, out, output);
        }
        (Core::Terms(_), false) => rows::<R, O, 3, ORDER, JET>(r, surface, None, uv, out, output),
        (Core::Terms(_), true) => rows::<R, O, 4, ORDER, JET>(r, surface, None, uv, out, output),
    }
}

/// The same in `D` homogeneous coordinates, for a net or a sparse core.
#[inline(always)]
fn rows<R: Registers, O: Output<R, JET>, const D: usize, const ORDER: usize, const JET: usize>(
    r: R,
    surface: &Separable,
    net: Option<&[DVec4]>,
    [u, v]: [&[f64]; 2],
    out: &mut Places,
    output: &O,
) {
    let (side, count) = (surface.functions_u(), surface.functions_v().count());
    let mut all = vec![[0.0; 4]; (ORDER + 1) * count];
    let (mut a, mut sparse) = (Vec::new(), Vec::new());
    // A row that is put together.
    let mut stage = Vec::new();
    let mut before = Block::new(r);
    let layout = Layout {
        order: ORDER,
        dimensions: D,
        is_net: net.is_some(),
    };
    for (tile, columns) in v.chunks(COLUMNS).enumerate() {
        let first = tile * COLUMNS;
        let width = O::EACH * columns.len();
        let columns = Columns::new(surface, columns, ORDER);
        // Rows that begin at the same place in a line of the cache have the same blocks.
        let mut blocks: [Option<Blocks>; LINE] = [const { None }; LINE];
        // Long sums of products load so much for each point that they wait for stores under way; their rows are put
        // together first. Short sums load little (in a sparse core each coordinate has functions of its own), and
        // divisions and normals take long enough to store beside them.
        let is_long = |p: &Piece| match net {
            Some(_) => p.active.len() > 4,
            None => p.sparse.used.len() > 2,
        };
        let is_staged = D == 3 && JET == 1 && columns.pieces.iter().any(is_long);
        if is_staged && matches!(out, Places::Near(_)) {
            stage.resize(width, 0.0);
        }
        in_packs(
            side.as_ref(),
            u,
            ORDER,
            #[inline(always)]
            |rows, pack| {
                for (lane, row) in rows.enumerate() {
                    let active = side.active(u[row], Limit::Above);
                    let at = O::EACH * (row * v.len() + first);
                    a.clear();
                    a.extend(pack.iter().map(|f| f.0[lane]));
                    if let Some(net) = net {
                        collapse_net(&a, &net[active.start * count..], count, &mut all);
                    }
                    let head = match out {
                        Places::Near(_) => 0,
                        Places::Far(out) => out.head(at, O::EACH).min(columns.count),
                    };
                    let blocks = blocks[head]
                        .get_or_insert_with(|| Blocks::new(&columns, &layout, R::LANES, head));
                    let (mut to, begun) = match out {
                        Places::Near(_) if is_staged => (To::Near(&mut stage[..]), None),
                        Places::Near(out) => (To::Near(&mut out[at..][..width]), None),
                        Places::Far(out) => {
                            let shape = [width, O::EACH * head, O::EACH * R::LANES];
                            let (to, begun) = out.begin(r, at, shape);
                            (to, Some(begun))
                        }
                    };
                    for run in &blocks.runs {
                        let piece = &columns.pieces[run.piece];
                        let slots = if net.is_some() {
                            piece.active.len()
                        } else {
                            piece.sparse.collapse(&a, &active, ORDER + 1, &mut sparse);
                            piece.sparse.used.len()
                        };
                        let k = std::array::from_fn(|p| match net {
                            _ if p > ORDER => &[][..],
                            Some(_) => &all[p * count + piece.active.start..][..slots],
                            None => &sparse[p * slots..][..slots],
                        });
                        let moderate =
                            |k: &&[[f64; 4]]| k.as_flattened().iter().all(|&x| far_from_limits(x));
                        let part = Part {
                            r,
                            row,
                            run,
                            columns: &blocks.columns[run.blocks.clone()],
                            first,
                            functions: blocks.values(run),
                            k,
                            is_quick: D == 4
                                && ORDER < 2
                                && piece.moderate
                                && k.iter().all(moderate),
                        };
                        match net {
                            Some(_) => part.evaluate::<O, true, D, ORDER, JET>(
                                &mut to,
                                &mut before,
                                output,
                            ),
                            None => part.evaluate::<O, false, D, ORDER, JET>(
                                &mut to,
                                &mut before,
                                output,
                            ),
                        }
                    }
                    match (&mut *out, begun) {
                        (Places::Far(out), Some(begun)) => out.end(begun),
                        (Places::Near(out), _) if is_staged => {
                            out[at..][..width].copy_from_slice(&stage);
                        }
                        _ => {}
                    }
                }
            },
        );
    }
    if let Places::Far(out) = out {
        out.flush();
    }
}

/// `K_j⁽ᵖ⁾ = Σ_i a_i⁽ᵖ⁾ C_ij` of a net that starts with the first active row and has rows of `count` points.
#[inline(always)]
fn collapse_net(a: &[f64], net: &[DVec4], count: usize, k: &mut [[f64; 4]]) {
    let n = a.len() / (k.len() / count);
    for (k, a) in k.chunks_exact_mut(count).zip(a.chunks_exact(n)) {
        k.fill([0.0; 4]);
        for (&a, row) in a.iter().zip(net.chunks_exact(count)) {
            for (k, c) in k.iter_mut().zip(row) {
                *k = [
                    k[0] + a * c.x,
                    k[1] + a * c.y,
                    k[2] + a * c.z,
                    k[3] + a * c.w,
                ];
            }
        }
    }
}

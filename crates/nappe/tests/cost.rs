//! What bulk evaluation costs, in evaluations of the sides: a count, so that no clock decides.

#![allow(clippy::unwrap_used, missing_docs)]

use nappe::basis::{Functions, FunctionsRef};
use nappe::surface::{Core, Separable, Surface};
use nappe::{Break, DVec3, DVec4, Interval, Limit};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// `1, t` in some pieces, counting how often values and enclosures are asked for.
#[derive(Debug)]
struct Counting {
    values: AtomicUsize,
    enclosures: AtomicUsize,
    breaks: Vec<Break>,
}

impl Counting {
    fn new(pieces: usize) -> Arc<Self> {
        let at = |k: usize| Break::new(k as f64 / pieces as f64, 1);
        Arc::new(Self {
            values: AtomicUsize::new(0),
            enclosures: AtomicUsize::new(0),
            breaks: (0..=pieces).map(at).collect(),
        })
    }
}

impl Functions for Counting {
    fn count(&self) -> usize {
        2
    }
    fn breaks(&self) -> &[Break] {
        &self.breaks
    }
    fn jet_into(&self, t: f64, _limit: Limit, order: usize, out: &mut [f64]) {
        self.values.fetch_add(1, Ordering::Relaxed);
        out[..2 * (order + 1)].fill(0.0);
        (out[0], out[1]) = (1.0, t);
        if order > 0 {
            out[3] = 1.0;
        }
    }
    fn enclose_piece(&self, _t: Interval, _limit: Limit, _order: usize, out: &mut [Interval]) {
        self.enclosures.fetch_add(1, Ordering::Relaxed);
        out.fill(Interval::ENTIRE);
    }
}

fn surface([u, v]: &[Arc<Counting>; 2]) -> Separable {
    let (u, v): (FunctionsRef, FunctionsRef) = (u.clone(), v.clone());
    let net = vec![DVec4::X, DVec4::Y, DVec4::Z, DVec4::ZERO];
    Separable::polynomial(u, v, Core::Net(net), DVec3::ZERO)
}

#[test]
fn an_enclosure_over_n_by_m_pieces_asks_each_side_twice_for_each_of_n_and_m() {
    let sides = [Counting::new(13), Counting::new(9)];
    let s = surface(&sides);
    let bounds = s.bounds(s.domain());
    assert!(!bounds.is_finite(), "these sides enclose nothing");
    // Over the piece and in its middle.
    let counts = [0, 1].map(|k: usize| sides[k].enclosures.load(Ordering::Relaxed));
    assert_eq!(counts, [2 * 13, 2 * 9]);
}

#[test]
fn a_grid_of_n_by_m_points_asks_each_side_n_and_m_times() {
    let sides = [Counting::new(1), Counting::new(1)];
    let s = surface(&sides);
    let (n, m) = (50, 31);
    let t = |n: usize| (0..n).map(|i| i as f64 / n as f64).collect::<Vec<_>>();
    let counts = || [0, 1].map(|k: usize| sides[k].values.swap(0, Ordering::Relaxed));
    let mut out = vec![DVec3::ZERO; n * m];
    s.grid(&t(n), &t(m), &mut out);
    assert_eq!(counts(), [n, m]);
    let mut out = vec![DVec3::ZERO; 6 * n * m];
    s.grid_jets(&t(n), &t(m), 2, &mut out);
    assert_eq!(counts(), [n, m]);
    let mut out = vec![[DVec3::ZERO; 2]; n * m];
    s.grid_normals(&t(n), &t(m), &mut out);
    assert_eq!(counts(), [n, m]);
    assert_eq!(out[0][0], DVec3::X);
    let uv = vec![[0.5, 0.25]; 100];
    let mut out = vec![DVec3::ZERO; 100];
    // The first list prepares the sides.
    s.points(&uv, &mut out);
    counts();
    s.points(&uv, &mut out);
    assert_eq!(counts(), [100, 100]);
    assert_eq!(out[99], DVec3::new(1.0, 0.25, 0.5));
}

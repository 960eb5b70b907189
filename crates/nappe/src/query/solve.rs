//! All zeros of N functions of N unknowns in a box, each proven to be alone.
//!
//! For a box X with the middle m, a matrix Y near the inverse of the derivatives at m, and an enclosure J of the
//! derivatives over X, Krawczyk's operator is `K = m - Y F(m) + (1 - Y J)(X - m)`. All zeros in X are in K; if K lies inside
//! X there is exactly one. Source: Neumaier, *Interval methods for systems of equations* (1990), §5.1.
//!
//! A box is asked with some space around it, so that zeros on the border between boxes are proven too.

use super::chains::touch;
use crate::interval::Interval;
use std::array::from_fn;
use std::collections::VecDeque;

/// The space around a box, relative to its width.
const AROUND: f64 = 0.125;
/// Where a box is cut.
const CUT: f64 = 0.487_163_9;
/// A box that shrinks by less is halved.
const SHRINK: f64 = 0.75;
/// Steps that make the box of a zero narrower: each squares its width.
const STEPS: usize = 20;

/// Values and derivatives, one row for each function.
pub(super) struct Enclosed<const N: usize> {
    pub(super) value: [Interval; N],
    pub(super) slopes: [[Interval; N]; N],
}

/// N functions of N unknowns.
pub(super) trait System<const N: usize> {
    /// Enclosures over a box, which may reach a little beyond the domain. `None` where there is no value.
    fn enclose(&self, x: &[Interval; N]) -> Option<Enclosed<N>>;
}

/// A zero.
#[derive(Clone, Copy, Debug)]
pub(super) struct Zero<const N: usize> {
    /// It is in here.
    pub(super) at: [Interval; N],
    /// No other zero is in here.
    pub(super) alone: [Interval; N],
}

/// All that was found.
#[derive(Debug)]
pub(super) struct Zeros<const N: usize> {
    pub(super) zeros: Vec<Zero<N>>,
    /// Boxes in which it is not known how many zeros there are.
    pub(super) open: Vec<[Interval; N]>,
    pub(super) looked: usize,
}

/// The zeros in a box. Boxes narrower than `smallest` of the start are left open, as are all when `budget` have been looked at.
pub(super) fn solve<const N: usize>(
    system: &dyn System<N>,
    start: [Interval; N],
    smallest: f64,
    budget: usize,
) -> Zeros<N> {
    let mut out = Zeros {
        zeros: Vec::new(),
        open: Vec::new(),
        looked: 0,
    };
    let mut queue = VecDeque::from([start]);
    while let Some(mut x) = queue.pop_front() {
        out.looked += 1;
        loop {
            if out.zeros.iter().any(|z| encloses(&z.alone, &x)) {
                break;
            }
            match look(system, &x) {
                Look::None => break,
                Look::One(alone, inside) => {
                    let at = narrowed(system, inside);
                    out.add(Zero { at, alone });
                    break;
                }
                Look::Within(y) => {
                    let shrinks = (0..N).any(|k| y[k].width() < SHRINK * x[k].width());
                    x = y;
                    if shrinks {
                        continue;
                    }
                }
            }
            let relative = |k: usize| x[k].width() / start[k].width();
            let d = (0..N)
                .max_by(|&a, &b| relative(a).total_cmp(&relative(b)))
                .unwrap_or(0);
            let at = x[d].lo + CUT * (x[d].hi - x[d].lo);
            let narrow = relative(d) <= smallest || at <= x[d].lo || at >= x[d].hi;
            if narrow || out.looked + queue.len() >= budget {
                out.open.push(x);
                break;
            }
            for range in [
                Interval {
                    lo: x[d].lo,
                    hi: at,
                },
                Interval {
                    lo: at,
                    hi: x[d].hi,
                },
            ] {
                let mut half = x;
                half[d] = range;
                queue.push_back(half);
            }
            break;
        }
    }
    // Boxes that were open before the zero in them was found.
    let zeros = &out.zeros;
    out.open
        .retain(|x| !zeros.iter().any(|z| encloses(&z.alone, x)));
    out
}

impl<const N: usize> Zeros<N> {
    /// Adds a zero that may be known already: found from two boxes, it lies where each is alone.
    fn add(&mut self, zero: Zero<N>) {
        let same = |z: &Zero<N>| {
            touch(z.at, zero.at) && (encloses(&z.alone, &zero.at) || encloses(&zero.alone, &z.at))
        };
        match self.zeros.iter_mut().find(|z| same(z)) {
            Some(known) => {
                known.at = from_fn(|k| known.at[k].meet(zero.at[k]));
            }
            None => self.zeros.push(zero),
        }
    }
}

enum Look<const N: usize> {
    None,
    /// Exactly one zero in the first box, and it is in the second.
    One([Interval; N], [Interval; N]),
    /// All zeros of the box are in this part of it.
    Within([Interval; N]),
}

fn look<const N: usize>(system: &dyn System<N>, x: &[Interval; N]) -> Look<N> {
    let Some(over) = system.enclose(x) else {
        return Look::None;
    };
    if over.value.iter().any(|f| !f.contains(0.0)) {
        return Look::None;
    }
    // Wide derivatives will not do in a wider box either.
    let Some(first) = krawczyk(system, x, &over.slopes) else {
        return Look::Within(*x);
    };
    let Some(within) = intersection(&first, x) else {
        return Look::None;
    };
    let wide: [Interval; N] = x.map(|t| t.inflate(AROUND * t.width()));
    if let Some(over) = system.enclose(&wide)
        && let Some(k) = krawczyk(system, &wide, &over.slopes)
        && (0..N).all(|i| wide[i].lo < k[i].lo && k[i].hi < wide[i].hi)
    {
        return Look::One(wide, k);
    }
    Look::Within(within)
}

/// Makes the box of the only zero in it narrower.
fn narrowed<const N: usize>(system: &dyn System<N>, mut x: [Interval; N]) -> [Interval; N] {
    for _ in 0..STEPS {
        let next = system
            .enclose(&x)
            .and_then(|over| krawczyk(system, &x, &over.slopes))
            .and_then(|k| intersection(&k, &x));
        match next {
            Some(next) if (0..N).any(|k| next[k].width() < SHRINK * x[k].width()) => x = next,
            _ => break,
        }
    }
    x
}

/// Krawczyk's operator; `None` where the derivatives are too uncertain.
fn krawczyk<const N: usize>(
    system: &dyn System<N>,
    x: &[Interval; N],
    slopes: &[[Interval; N]; N],
) -> Option<[Interval; N]> {
    let middle = x.map(|t| Interval::point(t.mid()));
    let y = inverse(slopes.map(|row| row.map(Interval::mid)))?;
    let f = system.enclose(&middle)?.value;
    let mut k = middle;
    for i in 0..N {
        for j in 0..N {
            k[i] = k[i] - Interval::point(y[i][j]) * f[j];
            let product = (0..N).fold(Interval::ZERO, |s, l| {
                s + Interval::point(y[i][l]) * slopes[l][j]
            });
            let unit = if i == j {
                Interval::ONE
            } else {
                Interval::ZERO
            };
            k[i] = k[i] + (unit - product) * (x[j] - middle[j]);
        }
    }
    k.iter().all(|k| k.is_finite()).then_some(k)
}

/// The inverse by Gauss and Jordan with row pivots; `None` if it is not finite.
pub(super) fn inverse<const N: usize>(mut a: [[f64; N]; N]) -> Option<[[f64; N]; N]> {
    let mut b: [[f64; N]; N] = from_fn(|i| from_fn(|j| if i == j { 1.0 } else { 0.0 }));
    for c in 0..N {
        let p = (c..N).max_by(|&i, &j| a[i][c].abs().total_cmp(&a[j][c].abs()))?;
        a.swap(c, p);
        b.swap(c, p);
        let pivot = a[c][c];
        if pivot == 0.0 {
            return None;
        }
        for j in 0..N {
            a[c][j] /= pivot;
            b[c][j] /= pivot;
        }
        for i in (0..N).filter(|&i| i != c) {
            let factor = a[i][c];
            for j in 0..N {
                a[i][j] -= factor * a[c][j];
                b[i][j] -= factor * b[c][j];
            }
        }
    }
    b.as_flattened().iter().all(|x| x.is_finite()).then_some(b)
}

/// True if a box holds another one.
pub(super) fn encloses<const N: usize>(a: &[Interval; N], b: &[Interval; N]) -> bool {
    (0..N).all(|k| a[k].encloses(b[k]))
}

/// The common part of two boxes.
pub(super) fn intersection<const N: usize>(
    a: &[Interval; N],
    b: &[Interval; N],
) -> Option<[Interval; N]> {
    let mut out = *a;
    for k in 0..N {
        out[k] = a[k].intersection(b[k])?;
    }
    Some(out)
}

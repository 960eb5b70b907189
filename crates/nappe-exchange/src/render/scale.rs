//! The range of a field that colours cover, with round ticks.

use super::colour::ColourMap;
use crate::scene::Field;
use nappe::Mesh;

/// Values beyond these shares of the area do not stretch the colours, if they lie far off.
const PERCENTILES: [f64; 2] = [0.02, 0.98];
/// Colours are clipped only where that leaves less than this share of the whole range: a mild tail is shown in full.
const MILD: f64 = 0.6;
/// A range narrower than this, relative to the values, is rounding: the field is constant.
const CONSTANT: f64 = 1e-9;
/// Intervals between ticks, about.
const INTERVALS: f64 = 6.0;

/// From numbers to shares of a colour map.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Scale {
    pub(crate) map: ColourMap,
    pub(crate) lo: f64,
    pub(crate) hi: f64,
    /// Round numbers from `lo` to `hi`.
    pub(crate) ticks: Vec<f64>,
    step: f64,
    /// Whether values below `lo` or above `hi` exist.
    pub(crate) clipped: [bool; 2],
}

impl Scale {
    /// The scale for the finite values of a field, each with its weight; `range` replaces the automatic one.
    pub(crate) fn of(
        field: &Field,
        patches: &[usize],
        weights: &[Vec<f64>],
        map: ColourMap,
        range: Option<[f64; 2]>,
    ) -> Scale {
        let weighted = |&p: &usize| {
            field.values[p]
                .iter()
                .copied()
                .zip(weights[p].iter().copied())
        };
        let mut values: Vec<(f64, f64)> = patches
            .iter()
            .flat_map(weighted)
            .filter(|(v, _)| v.is_finite())
            .collect();
        values.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (least, most) = match (values.first(), values.last()) {
            (Some(&(a, _)), Some(&(b, _))) => (a, b),
            _ => (0.0, 0.0),
        };
        let whole: f64 = values.iter().map(|(_, weight)| weight).sum();
        // The first value that, with the smaller ones, has this share of the weight.
        let at = |share: f64| {
            let mut left = share * whole;
            let reached = values.iter().find(|(_, weight)| {
                left -= weight;
                left <= 0.0
            });
            reached.map_or(most, |(v, _)| *v)
        };
        let (mut lo, mut hi) = match range {
            Some([a, b]) => (a.min(b), a.max(b)),
            None if values.len() > 2 => {
                let (a, b) = (at(PERCENTILES[0]), at(PERCENTILES[1]));
                if b - a < MILD * (most - least) {
                    (a, b)
                } else {
                    (least, most)
                }
            }
            None => (least, most),
        };
        let size = lo.abs().max(hi.abs());
        if hi - lo <= CONSTANT * size || hi == lo {
            // A constant is put in the middle of a range of its own size.
            let half = if size > 0.0 { size / 2.0 } else { 1.0 };
            let middle = (lo + hi) / 2.0;
            (lo, hi) = (middle - half, middle + half);
        }
        let map = match map {
            ColourMap::Auto if least < 0.0 && most > 0.0 => ColourMap::Diverging,
            ColourMap::Auto => ColourMap::Sequential,
            map => map,
        };
        if map == ColourMap::Diverging {
            hi = lo.abs().max(hi.abs());
            lo = -hi;
        }
        let (ticks, step) = ticks(lo, hi);
        (lo, hi) = (ticks[0], ticks[ticks.len() - 1]);
        let slack = CONSTANT * (hi - lo);
        Scale {
            map,
            lo,
            hi,
            ticks,
            step,
            clipped: [
                least < lo - slack || field.unbounded[0],
                most > hi + slack || field.unbounded[1],
            ],
        }
    }

    /// The share of the range at a value: 0 at `lo`, 1 at `hi`.
    pub(crate) fn share(&self, value: f64) -> f64 {
        ((value - self.lo) / (self.hi - self.lo)).clamp(0.0, 1.0)
    }

    /// The text of a tick; at a clipped end it says that the colour stands for more.
    pub(crate) fn label(&self, tick: usize) -> String {
        let text = decimal(self.ticks[tick], self.step);
        match (tick, self.clipped) {
            (0, [true, _]) => format!("≤ {text}"),
            (k, [_, true]) if k + 1 == self.ticks.len() => format!("≥ {text}"),
            _ => text,
        }
    }
}

/// The weights of the vertices of each patch: the areas of their triangles, so that a dense part of a mesh counts no more
/// than a coarse one.
pub(crate) fn areas(mesh: &Mesh) -> Vec<Vec<f64>> {
    let of_patch = mesh.patches.iter().map(|patch| {
        let mut areas = vec![0.0; patch.vertices.len()];
        for t in &patch.triangles {
            let point = |v: u32| mesh.points[patch.vertices[v as usize].point as usize];
            let [a, b, c] = t.map(point);
            let area = (b - a).cross(c - a).length();
            t.iter().for_each(|&v| areas[v as usize] += area);
        }
        areas
    });
    of_patch.collect()
}

/// Multiples of 1, 2 or 5 times a power of ten, from the last at or below `lo` to the first at or above `hi`.
fn ticks(lo: f64, hi: f64) -> (Vec<f64>, f64) {
    let rough = (hi - lo) / INTERVALS;
    let power = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0]
        .map(|m| m * power)
        .into_iter()
        .find(|s| *s >= rough * (1.0 - 1e-9))
        .unwrap_or(power);
    // Rounding must not add a tick beyond an end that is a tick.
    let (first, last) = (
        (lo / step + 1e-9).floor() as i64,
        (hi / step - 1e-9).ceil() as i64,
    );
    (
        (first..=last.max(first + 1))
            .map(|k| k as f64 * step)
            .collect(),
        step,
    )
}

/// A tick with just the decimals its step needs.
fn decimal(value: f64, step: f64) -> String {
    let exponent = step.log10().floor() as i32;
    let size = value.abs().max(step);
    let text = if (1e-4..1e6).contains(&size) && exponent >= -5 {
        format!("{value:.*}", (-exponent).max(0) as usize)
    } else if value == 0.0 {
        "0".into()
    } else {
        let digits = (size.log10().floor() as i32 - exponent).max(0) as usize;
        format!("{value:.digits$e}")
    };
    let zero = text
        .trim_start_matches('-')
        .chars()
        .all(|c| c == '0' || c == '.');
    if zero {
        text.trim_start_matches('-').into()
    } else {
        text.replace('-', "−")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn weighted(values: &[f64], weights: &[f64], map: ColourMap, unbounded: [bool; 2]) -> Scale {
        let field = Field {
            name: String::new(),
            unit: String::new(),
            values: vec![values.to_vec()],
            unbounded,
        };
        Scale::of(&field, &[0], &[weights.to_vec()], map, None)
    }

    fn scale(values: Vec<f64>, map: ColourMap) -> Scale {
        weighted(&values, &vec![1.0; values.len()], map, [false; 2])
    }

    #[test]
    fn a_dense_corner_does_not_stretch_the_range_and_no_bound_is_said() {
        // Half of the vertices crowd around a tip, where 1/r grows; they have a thousandth of the area.
        let values: Vec<f64> = (1..=1000).map(|k| 1000.0 / f64::from(k)).collect();
        let weights: Vec<f64> = values
            .iter()
            .map(|v| if *v > 2.0 { 1e-6 } else { 1e-3 })
            .collect();
        let s = weighted(&values, &weights, ColourMap::Auto, [false; 2]);
        assert!(s.hi <= 3.0 && s.clipped == [false, true], "{s:?}");
        // All values are shown, but there are larger ones beside them.
        let s = weighted(&[0.0, 1.0, 2.0], &[1.0; 3], ColourMap::Auto, [false, true]);
        assert_eq!(s.clipped, [false, true]);
        assert!(s.label(s.ticks.len() - 1).starts_with("≥ "));
        assert!(!s.label(0).contains('≤'));
    }

    #[test]
    fn ticks_are_round_and_cover_the_range() {
        for (lo, hi) in [
            (0.0, 1.0),
            (-3.7, 12.9),
            (1e-7, 9e-7),
            (-2e8, -1e8),
            (0.999, 1.001),
            (0.0, 6.0),
        ] {
            let s = scale(vec![lo, (lo + hi) / 2.0, hi], ColourMap::Sequential);
            assert!(
                s.lo <= lo + 1e-9 * (hi - lo) && s.hi >= hi - 1e-9 * (hi - lo),
                "{s:?}"
            );
            assert!((4..=10).contains(&s.ticks.len()), "{s:?}");
            let mantissa = s.step
                / 10f64
                    .powf(s.step.log10().floor() + 1e-12)
                    .round()
                    .max(1e-300);
            let m = s.step / 10f64.powi((s.step.log10() + 1e-9).floor() as i32);
            assert!(
                [1.0, 2.0, 5.0].iter().any(|r| (m - r).abs() < 1e-9),
                "{m} {mantissa}"
            );
            for (k, t) in s.ticks.iter().enumerate() {
                assert!((t / s.step - (t / s.step).round()).abs() < 1e-6);
                // The label reads back as the tick.
                let read: f64 = s.label(k).replace('−', "-").parse().unwrap();
                assert!((read - t).abs() < 1e-6 * s.step, "{} {t}", s.label(k));
            }
            assert_eq!(s.clipped, [false, false]);
        }
    }

    #[test]
    fn far_values_are_clipped_and_labelled() {
        let mut values: Vec<f64> = (0..1000).map(|k| k as f64 / 1000.0).collect();
        values.push(1e6);
        let s = scale(values, ColourMap::Auto);
        assert!(s.hi < 1.5 && s.clipped == [false, true], "{s:?}");
        assert!(s.label(s.ticks.len() - 1).starts_with("≥ "));
        assert_eq!((s.share(5.0), s.map), (1.0, ColourMap::Sequential));
    }

    #[test]
    fn signs_make_it_symmetric_and_constants_have_a_range() {
        let s = scale(vec![-0.3, 0.0, 0.9], ColourMap::Auto);
        assert_eq!(
            (s.map, s.lo, s.share(0.0)),
            (ColourMap::Diverging, -s.hi, 0.5)
        );
        for c in [0.0, 1.0, -4e-6] {
            let s = scale(vec![c; 50], ColourMap::Auto);
            assert!(
                s.lo < c && c < s.hi && s.share(c) > 0.2 && s.share(c) < 0.8,
                "{s:?}"
            );
        }
        assert!(scale(vec![f64::NAN], ColourMap::Auto).lo < 0.0);
    }
}

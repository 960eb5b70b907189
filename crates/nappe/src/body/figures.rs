//! Area and volume of trimmed faces, from the exact surfaces and edges.
//!
//! By Green's theorem `∬ f dx dy = ∮ F dy` with `F = ∫ f dx` over the region of the parameters. F is found by quadrature along x, the
//! border by quadrature along each chord of each edge, at points that are projected to the surface: no triangle is
//! involved, and the result is as accurate as the surfaces are smooth.

use super::mesh::Task;
use super::region::{Region, Step};
use super::{Body, BodyMeshError, FaceError};
use crate::box3::Box3;
use crate::breaks::{Breaks, Limit};
use crate::measure::Measured;
use crate::mesh::{Certainty, MeshOptions};
use crate::parallel;
use crate::surface::Dir;
use glam::DVec3;

/// Area and volume of a body.
#[derive(Clone, Debug)]
pub struct BodyFigures {
    /// The area of each face, or why it has none.
    pub areas: Vec<Result<Measured, FaceError>>,
    /// For each shell what it encloses, negative if normals point inwards; `None` if it is not closed or a face of it has no region.
    pub volumes: Vec<Option<Measured>>,
}

/// Points of quadrature along a chord, and of the coarser rule that it is compared with.
const ALONG: [usize; 2] = [7, 5];
/// Points of quadrature along a part of x, and the parts of the domain.
const ACROSS: usize = 12;
const PARTS: f64 = 12.0;
/// Relative rounding of sums.
const ROUNDING: f64 = 1e-12;

/// The areas of faces, and what closed shells enclose. The errors are estimates: two rules of quadrature are compared, and
/// the distance of the edges from the surfaces counts over their length. Cost: some thousand evaluations for each chord
/// of a coarse mesh.
///
/// # Errors
/// The body is not sound. A face without a region has its own error.
pub fn figures(body: &Body) -> Result<BodyFigures, BodyMeshError> {
    let task = Task::new(body, &MeshOptions::default())?;
    let base = super::mesh::hull(body).mid();
    let face = |i: usize| -> Result<[Measured; 2], FaceError> {
        let region = task.region(i)?;
        Ok(Integral::new(&task, i, base).over(&region))
    };
    let threads = parallel::all_threads();
    let found = parallel::each(threads, body.faces.len(), face, |_| false);
    let volume = |shell: &super::Shell| {
        if !shell.closed {
            return None;
        }
        let one = |&(f, kept): &(usize, bool)| {
            let flux = found[f].as_ref().ok()?[1];
            let sign = if kept == body.faces[f].forward {
                1.0
            } else {
                -1.0
            };
            Some(Measured {
                value: sign * flux.value,
                ..flux
            })
        };
        let parts: Option<Vec<Measured>> = shell.faces.iter().map(one).collect();
        Some(parts?.into_iter().sum())
    };
    let volumes = body.shells.iter().map(volume).collect();
    let areas = found.into_iter().map(|f| f.map(|f| f[0])).collect();
    Ok(BodyFigures { areas, volumes })
}

/// The greatest box of edges and vertices of a body, and of its faces that are whole surfaces.
pub fn extent(body: &Body) -> Box3 {
    super::mesh::hull(body)
}

struct Integral<'a> {
    task: &'a Task<'a>,
    face: usize,
    base: DVec3,
    rules: [Vec<[f64; 2]>; 2],
    across: Vec<[f64; 2]>,
}

type Pair = [f64; 2];

impl<'a> Integral<'a> {
    fn new(task: &'a Task<'a>, face: usize, base: DVec3) -> Self {
        Self {
            task,
            face,
            base,
            rules: ALONG.map(gauss),
            across: gauss(ACROSS),
        }
    }

    /// Area and a third of the flux of `r - base`.
    fn over(&self, region: &Region) -> [Measured; 2] {
        let chart = &self.task.charts[self.face];
        let corners = || region.polygons.iter().flatten();
        let start = corners().map(|c| c.xy[0]).fold(f64::INFINITY, f64::min);
        let (mut sum, mut error) = ([0.0; 2], [0.0; 2]);
        let mut size = [0.0; 2];
        let mut add = |fine: Pair, coarse: Pair| {
            for k in 0..2 {
                sum[k] += fine[k];
                size[k] += fine[k].abs();
                error[k] += (fine[k] - coarse[k]).abs();
            }
        };
        let mut loose = 0.0;
        for polygon in &region.polygons {
            for (k, c) in polygon.iter().enumerate() {
                let next = polygon[(k + 1) % polygon.len()].xy;
                let chord = [0, 1].map(|r| {
                    let mut total = [0.0; 2];
                    for &[s, w] in &self.rules[r] {
                        let guess = [0, 1].map(|d| c.xy[d] + (next[d] - c.xy[d]) * s);
                        let (xy, slope, off) = match c.step {
                            Step::Straight => (guess, next[1] - c.xy[1], 0.0),
                            Step::Edge { edge, t } => {
                                let dt = t[1] - t[0];
                                let curve = &self.task.body.edges[edge].curve;
                                let jet = curve.jet(t[0] + dt * s, Limit::Above, 1);
                                let uv = chart.nearest(jet.d[0], region.plane.uv(guess));
                                let d = self.slope(uv, jet.d[0], jet.d[1] * dt);
                                let off = chart.point(uv).distance(jet.d[0]);
                                let way = off * jet.d[1].length() * dt.abs();
                                (region.plane.xy(uv), region.plane.xy(d)[1], way)
                            }
                        };
                        if r == 0 {
                            loose += w * off;
                        }
                        let f = self.along_x(region, start, xy);
                        for k in 0..2 {
                            total[k] += w * f[k] * slope;
                        }
                    }
                    total
                });
                add(chord[0], chord[1]);
            }
        }
        for fan in &region.fans {
            let (from, to) = (fan.ring[0].0, fan.ring[fan.ring.len() - 1].0);
            let height = (fan.y - from[1]).abs();
            let both = [0, 1].map(|r| {
                let mut total = [0.0; 2];
                for &[s, w] in &self.rules[r] {
                    let y = from[1] + (fan.y - from[1]) * s;
                    let f = self.along_x(region, from[0], [to[0], y]);
                    for k in 0..2 {
                        total[k] += w * f[k] * height;
                    }
                }
                total
            });
            add(both[0], both[1]);
        }
        // The part of the surface between an edge and its projection.
        let reach = 0.5 * super::mesh::hull(self.task.body).diagonal();
        error[0] += loose;
        error[1] += loose * reach / 3.0;
        [0, 1].map(|k| Measured {
            value: sum[k],
            certainty: Certainty::Estimated(error[k] + ROUNDING * size[k]),
        })
    }

    /// The parameters' derivative of the point nearest to one that moves by `d`.
    fn slope(&self, uv: [f64; 2], p: DVec3, d: DVec3) -> [f64; 2] {
        let j = self.task.charts[self.face].jet(uv, 2);
        let r = j[0] - p;
        let [a, b, c] = [
            j[1].dot(j[1]) + r.dot(j[3]),
            j[1].dot(j[2]) + r.dot(j[4]),
            j[2].dot(j[2]) + r.dot(j[5]),
        ];
        let g = [j[1].dot(d), j[2].dot(d)];
        let det = a * c - b * b;
        let s = [(c * g[0] - b * g[1]) / det, (a * g[1] - b * g[0]) / det];
        if s.iter().all(|s| s.is_finite()) {
            s
        } else {
            [0.0; 2]
        }
    }

    /// Both integrands integrated along x up to a place.
    fn along_x(&self, region: &Region, start: f64, [x, y]: [f64; 2]) -> Pair {
        let chart = &self.task.charts[self.face];
        let plane = region.plane;
        let dir = if plane.turned { Dir::V } else { Dir::U };
        let breaks = chart.surface.breaks(dir);
        let whole = breaks.domain();
        let mut cuts = vec![start, x];
        let (lo, hi) = (start.min(x), start.max(x));
        let lifts: Vec<f64> = match plane.period[0] {
            Some(p) => (-3..=3).map(|k| f64::from(k) * p).collect(),
            None => vec![0.0],
        };
        for b in breaks {
            cuts.extend(lifts.iter().map(|l| b.at + l).filter(|&c| lo < c && c < hi));
        }
        cuts.sort_by(f64::total_cmp);
        let mut total = [0.0; 2];
        for w in cuts.windows(2) {
            let width = w[1] - w[0];
            let parts = (width / whole.width() * PARTS).ceil().max(1.0);
            for k in 0..parts as usize {
                for &[s, weight] in &self.across {
                    let at = w[0] + width * (k as f64 + s) / parts;
                    let f = self.integrands(plane.uv([at, y]));
                    for k in 0..2 {
                        total[k] += weight * f[k] * width / parts;
                    }
                }
            }
        }
        if x < start { total.map(|t| -t) } else { total }
    }

    fn integrands(&self, uv: [f64; 2]) -> Pair {
        let j = self.task.charts[self.face].jet(uv, 1);
        let n = j[1].cross(j[2]);
        [n.length(), (j[0] - self.base).dot(n) / 3.0]
    }
}

/// Gauss's rule on `[0, 1]`: places and weights, from the zeros of Legendre's polynomial by Newton's method.
fn gauss(n: usize) -> Vec<[f64; 2]> {
    let legendre = |x: f64| {
        let (mut a, mut b) = (1.0, x);
        for k in 2..=n {
            let k = k as f64;
            (a, b) = (b, ((2.0 * k - 1.0) * x * b - (k - 1.0) * a) / k);
        }
        (b, n as f64 * (x * b - a) / (x * x - 1.0))
    };
    (0..n)
        .map(|k| {
            let mut x = (std::f64::consts::PI * (k as f64 + 0.75) / (n as f64 + 0.5)).cos();
            for _ in 0..20 {
                let (p, d) = legendre(x);
                x -= p / d;
            }
            let d = legendre(x).1;
            [0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * d * d)]
        })
        .collect()
}

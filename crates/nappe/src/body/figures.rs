//! Area and volume of trimmed faces, from the exact surfaces and edges.
//!
//! By Green's theorem `∬ f dx dy = ∮ F dy` with `F = ∫ f dx` over the region of the parameters. F is found by quadrature along x, the
//! border by quadrature along each chord of each edge, at points that are projected to the surface: no triangle is
//! involved, and the result is as accurate as the surfaces are smooth.

use super::mesh::Task;
use super::region::{Corner, Region, Step};
use super::triangulate::{Failure, triangulate};
use super::{Body, BodyMeshError, FaceError, Loop, Shell};
use crate::box3::Box3;
use crate::breaks::Limit;
use crate::measure::Measured;
use crate::mesh::{Certainty, MeshOptions};
use crate::parallel;
use crate::surface::Dir;
use glam::DVec3;
use rustc_hash::{FxHashMap, FxHashSet};

/// Area and volume of a body.
#[derive(Clone, Debug)]
pub struct BodyFigures {
    /// The area of each face, or why it has none.
    pub areas: Vec<Result<Measured, FaceError>>,
    /// For each shell what it encloses, negative if normals point inwards. `None` if it is not said to be closed, or is not:
    /// each edge of its faces must be used exactly twice, in opposite directions, and no face twice; also if a face of it
    /// has no area, or is turned round.
    pub volumes: Vec<Option<Measured>>,
    /// Faces of which loops run the wrong way round: they were turned to bound anything.
    pub turned_round: Vec<usize>,
}

/// Points of quadrature along a chord, and of the coarser rule that it is compared with.
const ALONG: [usize; 2] = [7, 5];
/// The same along a part of x, and the parts of the domain.
const ACROSS: [usize; 2] = [12, 8];
const PARTS: f64 = 12.0;
/// How near the parameter of a piece of the border is found at which it crosses a line.
const CROSSING: f64 = 1e-12;
/// Relative rounding of sums.
const ROUNDING: f64 = 1e-12;
/// A closed edge no larger than this share of the body is a point, as at a pole: nothing is open there.
const POINT: f64 = 1e-9;

/// The areas of faces, and what closed shells enclose. The errors are estimates: along the border and across the region two rules of
/// quadrature are compared; the distance of the edges from the surfaces counts over their length, and where two edges do
/// not meet the gap counts over the chords beside it, which are joined by a straight line in the parameters. Loops must bound a region as
/// they must for [`mesh`](super::mesh()). Cost: some thousand evaluations for each chord of a coarse mesh.
///
/// # Errors
/// The body is not sound. A face has its own error if its loops bound no region, or if an edge ends farther from its vertex
/// than a thousandth of the body and than its own tolerance.
pub fn figures(body: &Body) -> Result<BodyFigures, BodyMeshError> {
    let options = MeshOptions::default();
    let task = Task::new(body, &options)?;
    let hull = super::mesh::hull(body);
    let base = hull.mid();
    let shared = task.shared();
    let face = |i: usize| -> Result<([Measured; 2], bool), FaceError> {
        let mut region = task.region(i)?;
        meets(&task, i)?;
        // Triangles of any size tell whether the polygons bound a region, which is looked at before they are near anything.
        let polygons = region.polygons.clone();
        let any = f64::INFINITY;
        match triangulate(
            &task.charts[i],
            &mut region,
            &shared,
            any,
            options.max_triangles,
        ) {
            Err(Failure::Region(e)) => return Err(e.into()),
            Err(Failure::TooMany(max)) => return Err(FaceError::TooMany { max }),
            Ok(_) | Err(Failure::NotReached(_)) => {}
        }
        region.polygons = polygons;
        let integral = Integral::new(&task, i, base);
        Ok((integral.over(&region)?, region.turned_round))
    };
    let threads = parallel::all_threads();
    let found = parallel::each(threads, body.faces.len(), face, |_| false);
    let grain = POINT * hull.diagonal();
    let volume = |shell: &Shell| {
        if !shell.closed || !is_closed(body, shell, grain) {
            return None;
        }
        let one = |&(f, kept): &(usize, bool)| {
            let ([_, flux], turned_round) = *found[f].as_ref().ok()?;
            let sign = if kept == body.faces[f].forward {
                1.0
            } else {
                -1.0
            };
            (!turned_round).then_some(Measured {
                value: sign * flux.value,
                ..flux
            })
        };
        let parts: Option<Vec<Measured>> = shell.faces.iter().map(one).collect();
        Some(parts?.into_iter().sum())
    };
    let volumes = body.shells.iter().map(volume).collect();
    let is_turned = |i: &usize| matches!(found[*i], Ok((_, true)));
    let turned_round = (0..found.len()).filter(is_turned).collect();
    let areas = found.into_iter().map(|f| f.map(|f| f.0[0])).collect();
    Ok(BodyFigures {
        areas,
        volumes,
        turned_round,
    })
}

/// Refuses edges of a face that end too far from their vertices to bound anything.
fn meets(task: &Task, face: usize) -> Result<(), FaceError> {
    for edge in task.loops[face].iter().flatten().map(|c| c.edge) {
        let e = &task.body.edges[edge];
        let allowed = task.tol.max(e.tolerance);
        for (p, v) in e.curve.ends().into_iter().zip(e.vertices) {
            let distance = p.distance(task.body.vertices[v].point);
            if distance > allowed {
                let why = format!(
                    "its curve ends {distance:e} away from vertex {v}, more than {allowed:e}"
                );
                return Err(FaceError::Edge { edge, why });
            }
        }
    }
    Ok(())
}

/// Whether the faces of a shell, as it takes them, leave no edge open: the normals then agree too. Closed edges within
/// `grain` are points.
fn is_closed(body: &Body, shell: &Shell, grain: f64) -> bool {
    let mut faces = FxHashSet::default();
    let mut uses: FxHashMap<usize, [usize; 2]> = FxHashMap::default();
    for &(f, kept) in &shell.faces {
        if !faces.insert(f) {
            return false;
        }
        for l in &body.faces[f].loops {
            if let Loop::Edges(coedges) = l {
                for c in coedges {
                    uses.entry(c.edge).or_default()[usize::from(c.forward == kept)] += 1;
                }
            }
        }
    }
    let is_point = |e: usize| {
        let e = &body.edges[e];
        let [a, b] = e.vertices;
        a == b && e.curve.bounds(e.curve.domain()).diagonal() <= grain
    };
    !faces.is_empty() && uses.iter().all(|(&e, n)| *n == [1, 1] || is_point(e))
}

/// The greatest box of edges and vertices of a body, and of its faces that are whole surfaces.
pub fn extent(body: &Body) -> Box3 {
    super::mesh::hull(body)
}

struct Integral<'a> {
    task: &'a Task<'a>,
    face: usize,
    base: DVec3,
    along: [Vec<[f64; 2]>; 2],
    across: [Vec<[f64; 2]>; 2],
}

/// Of the area, and of a third of the flux of `r - base`.
type Pair = [f64; 2];

/// Sums over pieces of the border.
#[derive(Default)]
struct Total {
    sum: Pair,
    /// The sums of absolute values, whose rounding counts.
    size: Pair,
    error: Pair,
    /// The area that is between edges and surface, or between ends of edges.
    loose: f64,
}

/// A place on a piece of the border, dy by the parameter of the piece, and how far off the edge is there times its length.
type Place = ([f64; 2], f64, f64);

impl<'a> Integral<'a> {
    fn new(task: &'a Task<'a>, face: usize, base: DVec3) -> Self {
        Self {
            task,
            face,
            base,
            along: ALONG.map(gauss),
            across: ACROSS.map(gauss),
        }
    }

    /// Area and a third of the flux of `r - base`.
    fn over(&self, region: &Region) -> Result<[Measured; 2], FaceError> {
        let corners = || region.polygons.iter().flatten();
        let start = corners().map(|c| c.xy[0]).fold(f64::INFINITY, f64::min);
        let mut total = Total::default();
        for polygon in &region.polygons {
            let n = polygon.len();
            let steps: Vec<(&Corner, [f64; 2])> = (0..n)
                .map(|k| (&polygon[k], polygon[(k + 1) % n].xy))
                .collect();
            let ends: Vec<[[f64; 2]; 2]> = steps
                .iter()
                .map(|&(c, next)| self.ends(region, c, next))
                .collect();
            for (k, &(c, next)) in steps.iter().enumerate() {
                self.piece(region, start, &mut total, |s| self.at(region, c, next, s));
                let after = (k + 1) % n;
                self.bridge(region, start, &mut total, [ends[k], ends[after]]);
            }
        }
        for fan in &region.fans {
            let (from, to) = (fan.ring[0].0, fan.ring[fan.ring.len() - 1].0);
            let height = (fan.y - from[1]).abs();
            self.piece(region, from[0], &mut total, |s| {
                let y = from[1] + (fan.y - from[1]) * s;
                ([to[0], y], height, 0.0)
            });
        }
        let Total {
            sum,
            size,
            mut error,
            loose,
        } = total;
        let reach = 0.5 * super::mesh::hull(self.task.body).diagonal();
        error[0] += loose;
        error[1] += loose * reach / 3.0;
        let found = [0, 1].map(|k| Measured {
            value: sum[k],
            certainty: Certainty::Estimated(error[k] + ROUNDING * size[k]),
        });
        if found.iter().any(|m| !m.value.is_finite()) {
            let deviation = f64::INFINITY;
            return Err(FaceError::NotReached { deviation });
        }
        Ok(found)
    }

    /// Adds the integral of F dy over a piece of the border with a parameter from 0 to 1, cut where F is not smooth.
    fn piece(&self, region: &Region, start: f64, total: &mut Total, at: impl Fn(f64) -> Place) {
        let cuts = self.cuts(region, &at);
        for part in cuts.windows(2) {
            let width = part[1] - part[0];
            self.part(region, start, total, |s| {
                let (xy, slope, off) = at(part[0] + width * s);
                (xy, slope * width, off * width)
            });
        }
    }

    /// Where a piece crosses lines of y at which the surface is not smooth, with its ends.
    fn cuts(&self, region: &Region, at: &impl Fn(f64) -> Place) -> Vec<f64> {
        let y = |s: f64| at(s).0[1];
        let (a, b) = (y(0.0), y(1.0));
        let mut cuts = vec![0.0];
        if a != b {
            for line in self.breaks(region, 1, [a.min(b), a.max(b)]) {
                let (mut low, mut high) = (0.0, 1.0);
                // As if y grew evenly, which it most often does; else by halves.
                for guess in [(line - a) / (b - a), 0.5] {
                    for step in [0.0, -CROSSING, CROSSING] {
                        let s: f64 = (guess + step).clamp(low, high);
                        let is_before = (y(s) < line) == (a < line);
                        *(if is_before { &mut low } else { &mut high }) = s;
                    }
                }
                while high - low > CROSSING {
                    let s = 0.5 * (low + high);
                    let is_before = (y(s) < line) == (a < line);
                    *(if is_before { &mut low } else { &mut high }) = s;
                }
                cuts.push(0.5 * (low + high));
            }
        }
        cuts.push(1.0);
        cuts.sort_by(f64::total_cmp);
        cuts
    }

    /// Breaks of the surface by x (`d` is 0) or y inside a range of the unrolled plane.
    fn breaks(&self, region: &Region, d: usize, [lo, hi]: [f64; 2]) -> Vec<f64> {
        let plane = region.plane;
        let lifts: Vec<f64> = match plane.period[d] {
            Some(p) => (-3..=3).map(|k| f64::from(k) * p).collect(),
            None => vec![0.0],
        };
        let dir = if (d == 0) == plane.turned {
            Dir::V
        } else {
            Dir::U
        };
        let breaks = self.task.charts[self.face].surface.breaks(dir);
        // y is -u in a turned plane.
        let sign = if plane.turned && d == 1 { -1.0 } else { 1.0 };
        let places = breaks
            .iter()
            .flat_map(|b| lifts.iter().map(move |l| sign * b.at + l));
        places.filter(|&c| lo < c && c < hi).collect()
    }

    /// Adds the integral of F dy where it is smooth, by a parameter from 0 to 1.
    fn part(&self, region: &Region, start: f64, total: &mut Total, at: impl Fn(f64) -> Place) {
        let mut rules = [[0.0; 2]; 2];
        for (r, rule) in rules.iter_mut().enumerate() {
            for &[s, w] in &self.along[r] {
                let (xy, slope, off) = at(s);
                if r == 0 {
                    total.loose += w * off;
                }
                if slope == 0.0 {
                    continue;
                }
                let (f, e) = self.along_x(region, start, xy);
                for k in 0..2 {
                    rule[k] += w * f[k] * slope;
                    if r == 0 {
                        total.error[k] += w * e[k] * slope.abs();
                    }
                }
            }
        }
        let [fine, coarse] = rules;
        for k in 0..2 {
            total.sum[k] += fine[k];
            total.size[k] += fine[k].abs();
            total.error[k] += (fine[k] - coarse[k]).abs();
        }
    }

    /// The place at a share of the way from a corner to the next one.
    fn at(&self, region: &Region, c: &Corner, next: [f64; 2], s: f64) -> Place {
        let guess = [0, 1].map(|d| c.xy[d] + (next[d] - c.xy[d]) * s);
        let Step::Edge { edge, t } = c.step else {
            return (guess, next[1] - c.xy[1], 0.0);
        };
        let chart = &self.task.charts[self.face];
        let dt = t[1] - t[0];
        let curve = &self.task.body.edges[edge].curve;
        let jet = curve.jet(t[0] + dt * s, Limit::Above, 1);
        let uv = chart.nearest(jet.d[0], region.plane.uv(guess));
        let d = self.slope(uv, jet.d[0], jet.d[1] * dt);
        let off = chart.point(uv).distance(jet.d[0]);
        let way = off * jet.d[1].length() * dt.abs();
        (region.plane.xy(uv), region.plane.xy(d)[1], way)
    }

    /// Where the border starts and ends between a corner and the next one: edges need not end at their vertices.
    fn ends(&self, region: &Region, c: &Corner, next: [f64; 2]) -> [[f64; 2]; 2] {
        let Step::Edge { edge, t } = c.step else {
            return [c.xy, next];
        };
        let chart = &self.task.charts[self.face];
        let curve = &self.task.body.edges[edge].curve;
        let guesses = [c.xy, next];
        [0, 1].map(|k| {
            let guess = region.plane.uv(guesses[k]);
            region.plane.xy(chart.nearest(curve.point(t[k]), guess))
        })
    }

    /// Closes the border between two steps. Without it the sums would be wrong by the gap times the way to `start`. Edges
    /// that miss each other may be as wrong all along: as far as the chords beside the gap that counts as error.
    fn bridge(
        &self,
        region: &Region,
        start: f64,
        total: &mut Total,
        [before, after]: [[[f64; 2]; 2]; 2],
    ) {
        let (from, to) = (before[1], after[0]);
        if from == to {
            return;
        }
        self.piece(region, start, total, |s| {
            let xy = [0, 1].map(|d| from[d] + (to[d] - from[d]) * s);
            (xy, to[1] - from[1], 0.0)
        });
        let length = |[a, b]: [[f64; 2]; 2]| {
            let [a, b] = [a, b].map(|xy| self.task.charts[self.face].point(region.plane.uv(xy)));
            a.distance(b)
        };
        let gap = length([from, to]);
        total.loose += gap * (gap + length(before) + length(after));
    }

    /// The parameters' derivative of the point nearest to one that moves by `d`.
    fn slope(&self, uv: [f64; 2], p: DVec3, d: DVec3) -> [f64; 2] {
        let j = self.task.charts[self.face].jet(uv, 2);
        let r = j[0] - p;
        let g = [j[1].dot(d), j[2].dot(d)];
        let plain = [j[1].dot(j[1]), j[1].dot(j[2]), j[2].dot(j[2])];
        let full = [0, 1, 2].map(|k| plain[k] + r.dot(j[3 + k]));
        // On the surface second derivatives do not count; they may be infinite.
        let slopes = [full, plain].map(|[a, b, c]| {
            let det = a * c - b * b;
            [(c * g[0] - b * g[1]) / det, (a * g[1] - b * g[0]) / det]
        });
        let found = slopes.into_iter().find(|s| s.iter().all(|s| s.is_finite()));
        found.unwrap_or([0.0; 2])
    }

    /// Both integrands integrated along x up to a place, and what two rules differ by.
    fn along_x(&self, region: &Region, start: f64, [x, y]: [f64; 2]) -> (Pair, Pair) {
        let chart = &self.task.charts[self.face];
        let plane = region.plane;
        let whole = chart.domain[usize::from(plane.turned)];
        let mut cuts = vec![start, x];
        cuts.extend(self.breaks(region, 0, [start.min(x), start.max(x)]));
        cuts.sort_by(f64::total_cmp);
        let (mut total, mut error) = ([0.0; 2], [0.0; 2]);
        for w in cuts.windows(2) {
            let width = w[1] - w[0];
            let parts = (width / whole.width() * PARTS).ceil().max(1.0);
            for part in 0..parts as usize {
                let [fine, coarse] = [0, 1].map(|r| {
                    let mut sum = [0.0; 2];
                    for &[s, weight] in &self.across[r] {
                        let at = w[0] + width * (part as f64 + s) / parts;
                        let f = self.integrands(plane.uv([at, y]));
                        for k in 0..2 {
                            sum[k] += weight * f[k] * width / parts;
                        }
                    }
                    sum
                });
                for k in 0..2 {
                    total[k] += fine[k];
                    error[k] += (fine[k] - coarse[k]).abs();
                }
            }
        }
        let sign = if x < start { -1.0 } else { 1.0 };
        (total.map(|t| sign * t), error)
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

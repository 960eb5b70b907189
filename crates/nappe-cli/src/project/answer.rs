//! What is asked about each point, and the columns of the answers.

use super::points;
use crate::table::{Block, Cell, Column};
use nappe::DVec3;
use nappe::query::{Finder, Locus, Nearest, QueryError, SignedFinder};
use nappe::surface::in_parallel;

/// What is asked about each point.
pub(crate) struct Question {
    pub(crate) asked: Asked,
    /// The names of the surfaces, or curves.
    pub(crate) names: Vec<String>,
    pub(crate) of_curves: bool,
}

/// Which answer is wanted.
pub(crate) enum Asked {
    /// The nearest point.
    One(Finder),
    /// All nearest points.
    All(Finder),
    /// The nearest point, and the side.
    Signed(SignedFinder),
}

/// How well a point was answered.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Status {
    /// Within the tolerance.
    Proven,
    /// With this gap, which is wider.
    Wide(f64),
    /// The row could not be read.
    Unreadable,
    /// There is no answer.
    Failed(QueryError),
}

impl Status {
    fn word(&self) -> &'static str {
        match self {
            Status::Proven => "ok",
            Status::Wide(_) => "gap",
            Status::Unreadable => "unreadable",
            Status::Failed(QueryError::Point { .. }) => "not finite",
            Status::Failed(QueryError::NoDistance { .. }) => "no distance",
            Status::Failed(_) => "no answer",
        }
    }
}

/// One row of the output.
pub(super) struct Answer {
    /// The row of the block it belongs to.
    pub(super) row: usize,
    pub(super) status: Status,
    found: Option<Found>,
}

struct Found {
    nearest: Nearest,
    /// The distance with its sign, where one is asked for and defined.
    signed: Option<f64>,
    /// How wide the locus is, and whether it is one place, where all are asked for.
    locus: Option<(f64, bool)>,
}

/// The answers for a block.
pub(super) struct Answers<'a> {
    question: &'a Question,
    holds: Vec<Holds>,
    others: usize,
    points: Vec<DVec3>,
    pub(super) list: Vec<Answer>,
}

/// A factor on the tolerance for its rounding.
const ROUNDING: f64 = 1.0 + 1e-9;

impl Question {
    fn tol(&self) -> f64 {
        match &self.asked {
            Asked::One(finder) | Asked::All(finder) => finder.tol(),
            Asked::Signed(finder) => finder.finder().tol(),
        }
    }

    /// Answers all rows of a block with so many other columns, on all cores.
    pub(super) fn answer(&self, block: &Block, others: usize) -> Answers<'_> {
        let points = points(block);
        let threads = rayon::current_num_threads();
        let found: Vec<Result<Vec<Found>, QueryError>> = match &self.asked {
            Asked::One(finder) => {
                let all = finder.nearest_many(&points, threads).into_iter();
                all.map(|found| found.map(|n| vec![Found::of(n)])).collect()
            }
            Asked::Signed(finder) => {
                let all = finder.nearest_many(&points, threads).into_iter();
                let of = |s: nappe::query::Signed| Found {
                    signed: s.distance,
                    ..Found::of(s.nearest)
                };
                all.map(|found| found.map(|s| vec![of(s)])).collect()
            }
            Asked::All(finder) => {
                let all = all_nearest(finder, &points, threads).into_iter();
                let of = |l: Locus| Found {
                    locus: Some((l.hull.diagonal(), l.isolated)),
                    ..Found::of(l.nearest)
                };
                all.map(|found| found.map(|loci| loci.into_iter().map(of).collect()))
                    .collect()
            }
        };
        let tol = self.tol() * ROUNDING;
        let mut list = Vec::with_capacity(found.len());
        for (row, found) in found.into_iter().enumerate() {
            let none = |status| Answer {
                row,
                status,
                found: None,
            };
            match found {
                _ if block.bad.binary_search(&row).is_ok() => list.push(none(Status::Unreadable)),
                Err(error) => list.push(none(Status::Failed(error))),
                Ok(all) => list.extend(all.into_iter().map(|found| {
                    let gap = found.nearest.certainty.error();
                    Answer {
                        row,
                        status: if gap <= tol {
                            Status::Proven
                        } else {
                            Status::Wide(gap)
                        },
                        found: Some(found),
                    }
                })),
            }
        }
        Answers {
            question: self,
            holds: self.holds(others),
            others,
            points,
            list,
        }
    }
}

fn all_nearest(
    finder: &Finder,
    points: &[DVec3],
    threads: usize,
) -> Vec<Result<Vec<Locus>, QueryError>> {
    let mut out = vec![Ok(Vec::new()); points.len()];
    in_parallel(threads, points, 1, &mut out, |points, out| {
        for (&p, out) in points.iter().zip(out) {
            *out = finder.all_nearest(p, finder.tol());
        }
    });
    out
}

impl Found {
    fn of(nearest: Nearest) -> Found {
        Found {
            nearest,
            signed: None,
            locus: None,
        }
    }
}

/// What a column holds.
#[derive(Clone, Copy)]
enum Holds {
    /// A coordinate of the given point.
    Given(usize),
    /// One of the table's other columns.
    Other(usize),
    Distance,
    Signed,
    Name,
    Parameter(usize),
    Coordinate(usize),
    Gap,
    Extent,
    Locus,
    Status,
}

impl Question {
    /// The columns in their order; the table has so many others.
    fn holds(&self, others: usize) -> Vec<Holds> {
        use Holds::*;
        let mut all = vec![Given(0), Given(1), Given(2)];
        all.extend((0..others).map(Other));
        all.push(Distance);
        if matches!(self.asked, Asked::Signed(_)) {
            all.push(Signed);
        }
        all.extend([Name, Parameter(0)]);
        if !self.of_curves {
            all.push(Parameter(1));
        }
        all.extend([Coordinate(0), Coordinate(1), Coordinate(2), Gap]);
        if matches!(self.asked, Asked::All(_)) {
            all.extend([Extent, Locus]);
        }
        all.push(Status);
        all
    }
}

/// The columns of the output.
pub(super) fn columns(question: &Question, others: &[String]) -> Vec<Column> {
    let numbers = Column::some_numbers;
    let of = |holds| match holds {
        Holds::Given(d) => numbers(["px", "py", "pz"][d]),
        Holds::Other(k) => Column::texts(&others[k]),
        Holds::Distance => numbers("distance"),
        Holds::Signed => numbers("signed"),
        Holds::Name if question.of_curves => Column::texts("curve"),
        Holds::Name => Column::texts("surface"),
        Holds::Parameter(_) if question.of_curves => numbers("t"),
        Holds::Parameter(d) => numbers(["u", "v"][d]),
        Holds::Coordinate(d) => numbers(["x", "y", "z"][d]),
        Holds::Gap => numbers("gap"),
        Holds::Extent => numbers("extent"),
        Holds::Locus => Column::texts("locus"),
        Holds::Status => Column::texts("status"),
    };
    question.holds(others.len()).into_iter().map(of).collect()
}

impl Answers<'_> {
    /// What stands in a row and a column of the output.
    pub(super) fn cell<'a>(&'a self, block: &'a Block, row: usize, column: usize) -> Cell<'a> {
        let answer = &self.list[row];
        let of = |number: fn(&Found) -> Option<f64>| answer.found.as_ref().and_then(number);
        let nearest = |number: &dyn Fn(&Nearest) -> f64| {
            let found = answer.found.as_ref();
            found.map(|f| number(&f.nearest))
        };
        let number = match self.holds[column] {
            Holds::Given(d) => Some(self.points[answer.row][d]),
            Holds::Distance => nearest(&|n| n.distance),
            Holds::Signed => of(|f| f.signed),
            Holds::Parameter(d) => nearest(&|n| n.uv[d]),
            Holds::Coordinate(d) => nearest(&|n| n.point[d]),
            Holds::Gap => nearest(&|n| n.certainty.error()),
            Holds::Extent => of(|f| f.locus.map(|l| l.0)),
            Holds::Other(k) => return text(block.others.get(answer.row * self.others + k)),
            Holds::Name => {
                let name = |f: &'a Found| Cell::Text(&self.question.names[f.nearest.surface]);
                return answer.found.as_ref().map_or(Cell::Missing, name);
            }
            Holds::Locus => {
                let isolated = answer.found.as_ref().and_then(|f| f.locus);
                let word = |(_, isolated)| if isolated { "point" } else { "spread" };
                return isolated.map_or(Cell::Missing, |l| Cell::Text(word(l)));
            }
            Holds::Status => return Cell::Text(answer.status.word()),
        };
        match number {
            Some(x) if x.is_finite() => Cell::Number(x),
            _ => Cell::Missing,
        }
    }
}

/// No text is a missing one.
fn text(text: &str) -> Cell<'_> {
    if text.is_empty() {
        Cell::Missing
    } else {
        Cell::Text(text)
    }
}

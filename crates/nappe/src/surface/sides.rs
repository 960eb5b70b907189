//! The four sides and corners of a surface, by name.

use super::Dir;
use std::fmt;

/// A side of a surface: an end of one parameter's range.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub enum Side {
    /// v at its lower end; runs along u.
    South,
    /// v at its upper end; runs along u.
    North,
    /// u at its lower end; runs along v.
    West,
    /// u at its upper end; runs along v.
    East,
}

impl Side {
    /// All four, in the order of the enumeration.
    pub const ALL: [Side; 4] = [Side::South, Side::North, Side::West, Side::East];

    /// The parameter that varies along the side.
    pub fn along(self) -> Dir {
        match self {
            Side::South | Side::North => Dir::U,
            Side::West | Side::East => Dir::V,
        }
    }

    /// The parameter that is constant on the side.
    pub fn across(self) -> Dir {
        match self {
            Side::South | Side::North => Dir::V,
            Side::West | Side::East => Dir::U,
        }
    }

    /// True if the constant parameter is at its upper end.
    pub fn is_upper(self) -> bool {
        matches!(self, Side::North | Side::East)
    }

    /// The name in model files.
    pub fn name(self) -> &'static str {
        match self {
            Side::South => "south",
            Side::North => "north",
            Side::West => "west",
            Side::East => "east",
        }
    }
}

impl fmt::Display for Side {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A corner of a surface: both parameters at an end.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub enum Corner {
    /// u and v at their lower ends.
    SouthWest,
    /// u at its upper, v at its lower end.
    SouthEast,
    /// u at its lower, v at its upper end.
    NorthWest,
    /// u and v at their upper ends.
    NorthEast,
}

impl Corner {
    /// All four.
    pub const ALL: [Corner; 4] = [
        Corner::SouthWest,
        Corner::SouthEast,
        Corner::NorthWest,
        Corner::NorthEast,
    ];

    /// 0 or 1 for the lower or upper end of u and of v.
    pub fn ends(self) -> [usize; 2] {
        match self {
            Corner::SouthWest => [0, 0],
            Corner::SouthEast => [1, 0],
            Corner::NorthWest => [0, 1],
            Corner::NorthEast => [1, 1],
        }
    }

    /// The two sides that meet there: first the one along u, then the one along v.
    pub fn sides(self) -> [Side; 2] {
        let [u, v] = self.ends();
        [[Side::South, Side::North][v], [Side::West, Side::East][u]]
    }
}

impl fmt::Display for Corner {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [a, b] = self.sides();
        write!(f, "{a}-{b}")
    }
}

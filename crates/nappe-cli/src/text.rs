//! Tables and numbers for people.

pub(crate) use nappe::significant as number;

use nappe::surface::Dir;
use std::fmt::{self, Write};

/// A table in plain text: a heading, a rule, rows.
#[derive(Clone, Debug)]
pub(crate) struct Table {
    columns: usize,
    rows: Vec<Vec<String>>,
    headed: bool,
}

impl Table {
    /// A table with a heading line.
    pub(crate) fn headed(columns: impl IntoIterator<Item = impl Into<String>>) -> Table {
        let heading: Vec<String> = columns.into_iter().map(Into::into).collect();
        Table {
            columns: heading.len(),
            rows: vec![heading],
            headed: true,
        }
    }

    /// A table of names and values, without a heading.
    pub(crate) fn of_facts() -> Table {
        Table {
            columns: 2,
            rows: Vec::new(),
            headed: false,
        }
    }

    /// Adds a row. Panics if it does not have one cell for each column.
    pub(crate) fn row(&mut self, cells: impl IntoIterator<Item = impl Into<String>>) {
        let cells: Vec<String> = cells.into_iter().map(Into::into).collect();
        assert_eq!(
            cells.len(),
            self.columns,
            "one cell for each column of the table"
        );
        self.rows.push(cells);
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width = |s: &str| s.chars().count();
        let widths: Vec<usize> = (0..self.columns)
            .map(|c| self.rows.iter().map(|r| width(&r[c])).max().unwrap_or(0))
            .collect();
        for (i, row) in self.rows.iter().enumerate() {
            let mut line = String::new();
            for (cell, &w) in row.iter().zip(&widths) {
                if !line.is_empty() {
                    line.push_str("  ");
                }
                write!(line, "{cell:<w$}")?;
            }
            if i > 0 {
                f.write_char('\n')?;
            }
            f.write_str(line.trim_end())?;
            if i == 0 && self.headed {
                let rule = widths.iter().sum::<usize>() + 2 * (widths.len() - 1);
                write!(f, "\n{}", "─".repeat(rule))?;
            }
        }
        Ok(())
    }
}

/// What is said of a surface that jumps at a parameter.
pub(crate) fn torn((dir, at): (Dir, f64)) -> String {
    format!("torn at {dir} = {}: it jumps there", number(at, 6))
}

/// A number with all its digits, as short as it can be told from its neighbours.
pub(crate) fn exactly(x: f64) -> String {
    if x == 0.0 || (1e-5..1e16).contains(&x.abs()) || !x.is_finite() {
        x.to_string()
    } else {
        format!("{x:e}")
    }
}

/// A bound that is not rounded down: the number, or the next with as many digits.
pub(crate) fn bound(x: f64, digits: usize) -> String {
    let nearest = number(x, digits);
    if !x.is_finite() || nearest.parse::<f64>().is_ok_and(|n| n >= x) {
        return nearest;
    }
    // Half a step of the last digit more makes the rounding go up.
    let step = 10f64.powi(x.abs().log10().floor() as i32 + 1 - digits as i32);
    number(x + step / 2.0, digits)
}

/// A positive bound from below, that is not rounded up.
pub(crate) fn bound_below(x: f64, digits: usize) -> String {
    let nearest = number(x, digits);
    if !x.is_finite() || x <= 0.0 || nearest.parse::<f64>().is_ok_and(|n| n <= x) {
        return nearest;
    }
    let step = 10f64.powi(x.log10().floor() as i32 + 1 - digits as i32);
    number(x - step / 2.0, digits)
}

/// The size of a file.
pub(crate) fn bytes(n: u64) -> String {
    match n {
        0..1_000 => format!("{n} B"),
        1_000..1_000_000 => format!("{} kB", number(n as f64 / 1e3, 3)),
        _ => format!("{} MB", number(n as f64 / 1e6, 3)),
    }
}

/// A whole number with its digits in groups of three.
pub(crate) fn count(n: usize) -> String {
    let digits = n.to_string();
    let mut grouped = String::with_capacity(digits.len() + digits.len() / 3);
    for (i, d) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            grouped.push(',');
        }
        grouped.push(d);
    }
    grouped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_digits_asked_for() {
        for (x, digits, text) in [
            (0.0, 3, "0"),
            (1.0 / 3.0, 3, "0.333"),
            (1234.5678, 6, "1234.57"),
            (1_000_000.0, 3, "1000000"),
            (-2.5e-7, 4, "-2.5e-7"),
            (9.9996, 4, "10"),
            (1e22, 4, "1e22"),
            (0.000_123_456, 3, "0.000123"),
            (f64::NAN, 3, "NaN"),
        ] {
            assert_eq!(number(x, digits), text);
        }
    }

    #[test]
    fn bounds_are_not_rounded_down() {
        for (x, text) in [
            (0.12345, "0.124"),
            (0.12355, "0.124"),
            (0.125, "0.125"),
            (9.991e-9, "1e-8"),
            (123_456.7, "123457"),
            (0.0, "0"),
        ] {
            assert_eq!(bound(x, 3), text);
            assert!(text.parse::<f64>().unwrap() >= x);
        }
    }

    #[test]
    fn bounds_from_below_are_not_rounded_up() {
        for (x, text) in [
            (0.12355, "0.123"),
            (0.12345, "0.123"),
            (9.996, "9.99"),
            (10.0, "10"),
            (0.0, "0"),
        ] {
            assert_eq!(bound_below(x, 3), text);
            assert!(text.parse::<f64>().unwrap() <= x);
        }
    }

    #[test]
    fn counts_are_grouped() {
        assert_eq!(count(7), "7");
        assert_eq!(count(123), "123");
        assert_eq!(count(1_234_567), "1,234,567");
    }

    #[test]
    fn tables_are_aligned() {
        let mut t = Table::headed(["name", "n"]);
        t.row(["a", "10"]);
        t.row(["bcdef", "7"]);
        assert_eq!(t.to_string(), "name   n\n─────────\na      10\nbcdef  7");
    }
}

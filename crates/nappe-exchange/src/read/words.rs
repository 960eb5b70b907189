//! Text as words between white space, with the line of each.

use super::{Fault, number, shown};
use glam::DVec3;

/// What is left of a text.
pub(super) struct Words<'a> {
    rest: &'a str,
    line: usize,
}

impl<'a> Words<'a> {
    /// The words of a text whose first line has the given number.
    pub(super) fn new(text: &'a str, line: usize) -> Self {
        Self { rest: text, line }
    }

    /// The next word; `None` at the end.
    pub(super) fn next(&mut self) -> Option<&'a str> {
        let start = self.rest.find(|c: char| !c.is_whitespace())?;
        let (space, rest) = self.rest.split_at(start);
        self.line += space.matches('\n').count();
        let end = rest.find(char::is_whitespace).unwrap_or(rest.len());
        let (word, rest) = rest.split_at(end);
        self.rest = rest;
        Some(word)
    }

    /// The next word without taking it.
    pub(super) fn peek(&self) -> Option<&'a str> {
        self.rest.split_whitespace().next()
    }

    /// The line of the word taken last.
    pub(super) fn line(&self) -> usize {
        self.line
    }

    /// A fault at the word taken last.
    pub(super) fn fault(&self, what: impl Into<String>) -> Fault {
        Fault::line(self.line, what)
    }

    /// The next word, which must be there.
    pub(super) fn word(&mut self, what: &str) -> Result<&'a str, Fault> {
        self.next()
            .ok_or_else(|| self.fault(format!("the file ends where {what} should be")))
    }

    /// A finite number.
    pub(super) fn real(&mut self, what: &str) -> Result<f64, Fault> {
        let word = self.word(what)?;
        number(word).ok_or_else(|| {
            self.fault(format!(
                "`{}` should be {what}, a finite number",
                shown(word)
            ))
        })
    }

    pub(super) fn reals<const N: usize>(&mut self, what: &str) -> Result<[f64; N], Fault> {
        let mut all = [0.0; N];
        for x in &mut all {
            *x = self.real(what)?;
        }
        Ok(all)
    }

    pub(super) fn point(&mut self, what: &str) -> Result<DVec3, Fault> {
        Ok(DVec3::from_array(self.reals(what)?))
    }

    /// A whole number that is not negative.
    pub(super) fn whole(&mut self, what: &str) -> Result<usize, Fault> {
        let word = self.word(what)?;
        word.parse().map_err(|_| {
            self.fault(format!(
                "`{}` should be {what}, a whole number",
                shown(word)
            ))
        })
    }

    /// How many things follow, each of at least so many numbers: never more than the rest of the text can hold.
    pub(super) fn count(&mut self, what: &str, each: usize) -> Result<usize, Fault> {
        let n = self.whole(&format!("the number of {what}"))?;
        self.holds(n, what, each)?;
        Ok(n)
    }

    /// Fails if the rest cannot hold so many things of so many numbers each.
    pub(super) fn holds(&self, n: usize, what: &str, each: usize) -> Result<(), Fault> {
        // A digit and what parts it from the next one.
        let most = self.rest.len() / 2 + 1;
        if n.checked_mul(each).is_none_or(|needed| needed > most) {
            return Err(self.fault(format!(
                "{n} {what} are announced, but only {} bytes follow",
                self.rest.len()
            )));
        }
        Ok(())
    }
}

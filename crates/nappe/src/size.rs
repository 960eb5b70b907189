//! How large and how small geometry may be.

/// The largest coordinate, radius or other length, in any unit. Areas, curvatures and distances to them are made of
/// products of up to ten lengths: those of 10^±30 stay within the range of doubles (10^±308), and the points within
/// that of the 32-bit numbers of files (10^±38).
pub const LARGEST_LENGTH: f64 = 1e30;
/// The smallest extent of what is not a point, for the same reason.
pub const SMALLEST_EXTENT: f64 = 1e-30;

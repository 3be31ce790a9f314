//! Which law fits: Tabor's parameter.

use super::Law;

/// Below this Tabor parameter DMT's limit holds (attraction reaches farther than the neck).
pub const DMT_BELOW: f64 = 0.1;

/// Above this Tabor parameter JKR's limit holds (the neck reaches farther than attraction).
pub const JKR_ABOVE: f64 = 5.0;

/// Where `auto` changes from DMT to JKR: the middle of the gap between the two limits on a
/// logarithmic scale, `sqrt(0.1 * 5)`. In the gap neither law is exact (true pull-off forces lie
/// between `-3/2 pi w R` and `-2 pi w R`), and [`super::Warning::BetweenLaws`] says so.
pub const AUTO_BOUNDARY: f64 = 0.707_106_781_186_547_5;

/// Adhesion is negligible where its largest pull, `2 pi w R`, is below this share of the load:
/// the default accuracy of a run.
pub const NEGLIGIBLE_ADHESION: f64 = 1e-3;

/// Tabor's parameter `mu = (R w^2/(E*^2 z0^3))^(1/3)`, `E* = 3K/4`: height of the elastic neck over
/// the range `z0` of the attraction (Tabor 1977).
///
/// ```
/// use afmsweep_model::contact::tabor_parameter;
/// // E* = 1 GPa, R = 8 nm, w = 0.05 J/m^2, z0 = 1/2 nm: (8e-9 * 0.0025/(1e18 * 1.25e-28))^(1/3)
/// assert!((tabor_parameter(4e9 / 3.0, 8e-9, 0.05, 5e-10) / 0.16f64.cbrt() - 1.0).abs() < 1e-14);
/// ```
pub fn tabor_parameter(modulus: f64, radius: f64, work: f64, range: f64) -> f64 {
    let ratio = work / (0.75 * modulus * range);
    (radius / range * ratio * ratio).cbrt()
}

/// The adhesive law whose limit is nearer on a logarithmic scale.
pub(super) fn fitting_law(tabor: f64) -> Law {
    if tabor < AUTO_BOUNDARY { Law::Dmt } else { Law::Jkr }
}

//! What lots of specimens scatter by: the assumed scatter of few specimens, and of another lot.
//!
//! ln sd is taken as normal over lots, by restricted likelihood with the error `1/√(2(n-1))` of each; so is a life whose scatter nobody measured. Its
//! quantiles of 5 and 95 % are those of Student's t of [`FREEDOM`] within 1.3 %.

/// Median of sd over five lots with a published scatter: 2024-T3 (Virkler 1979), 7075 (riss.kr 1f5105914b45a124), Alloy A (Hudak 1978; Meeker and
/// Escobar 1998), 7050-T7451 (White 2018) and 10Ni steel (Clark and Hudak 1975; ASTM E647).
pub const MEDIAN: f64 = 0.116;
pub const DEVIATION: f64 = 0.435;
/// Degrees of freedom of a scatter that is assumed.
pub const FREEDOM: f64 = 6.0;
/// Standard deviation of ln rate between lots: root mean square of that of steels in air at R < 0.5 and above, mean + 2 sd over mean rate 1.70 and
/// 2.20 of all lots and laboratories together (BS 7910:2013), without the scatter within a lot.
pub const BETWEEN_LOTS: f64 = 0.316;

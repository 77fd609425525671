//! What lots of specimens scatter by: the assumed scatter of few specimens, and of another lot.
//!
//! ln sd is taken as normal over lots, by restricted likelihood with the error `1/√(2(n-1))` of each; so is a life whose scatter nobody measured. Its
//! quantiles of 5 and 95 % are those of Student's t of [`FREEDOM`] within 1.3 %.

/// A lot, or a laboratory's tests, under one load.
pub struct TestedLot {
    /// Material and source.
    pub name: &'static str,
    /// Specimens.
    pub specimens: u32,
    /// Standard deviation of ln life, of C(T) of 7075 from its coefficient of variation, of the round robin of ln rate.
    pub deviation: f64,
}

/// Lots with a published scatter; half of the panels, which is what the repository has.
pub const LOTS: &[TestedLot] = &[
    TestedLot { name: "2024-T3, M(T) (Virkler 1979)", specimens: 34, deviation: 0.071 },
    TestedLot { name: "7075, C(T), coefficient of variation 0.15 (riss.kr 1f5105914b45a124)", specimens: 26, deviation: 0.149 },
    TestedLot { name: "Alloy A to 32 mm (Hudak 1978; Meeker and Escobar 1998)", specimens: 21, deviation: 0.194 },
    TestedLot { name: "7050-T7451, C(T) under a spectrum (White 2018)", specimens: 3, deviation: 0.052 },
    TestedLot {
        name: "10Ni steel, one laboratory, 2 sd of rate 27 % (Clark and Hudak 1975; ASTM E647)",
        specimens: 15,
        deviation: 0.135,
    },
];

/// Median of sd over [`LOTS`].
pub const MEDIAN: f64 = 0.116;
/// Standard deviation of ln sd over them.
pub const DEVIATION: f64 = 0.435;
/// Degrees of freedom of a scatter that is assumed.
pub const FREEDOM: f64 = 6.0;

/// BS 7910:2013, steels in air: mean + 2 sd over mean rate, R < 0.5 and R ≥ 0.5, of all lots and laboratories together.
pub const MEAN_PLUS_TWO: [f64; 2] = [1.70, 2.20];
/// Standard deviation of ln rate between lots: root mean square of both, without the scatter within a lot.
pub const BETWEEN_LOTS: f64 = 0.316;

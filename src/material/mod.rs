//! What the plate is made of: elastic constants and strengths.

pub mod library;
mod read;

pub use read::from_value;

crate::kinds! {
    /// Plane state of the plate.
    pub enum Plane for "material.plane" {
        Stress = "stress": "thin plate, no stress across the thickness",
        Strain = "strain": "thick plate, no strain across the thickness",
    }
}

/// Elastic constants and strengths, SI.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Name in `data/materials`, or "inline".
    pub name: String,
    /// Young's modulus E, Pa.
    pub youngs_modulus: f64,
    /// Poisson's ratio ν.
    pub poisson_ratio: f64,
    /// Plane stress or plane strain.
    pub plane: Plane,
    /// Yield strength, Pa.
    pub yield_strength: Option<f64>,
    /// Fracture toughness, Pa√m.
    pub toughness: Option<f64>,
    /// Fracture energy G_c, J/m².
    pub fracture_energy: Option<f64>,
    /// Density ρ, kg/m³.
    pub density: Option<f64>,
    /// Tensile strength f_t, Pa.
    pub tensile_strength: Option<f64>,
}

impl Material {
    /// A material of which nothing is known but its elastic constants: E in Pa, ν.
    pub fn elastic(youngs_modulus: f64, poisson_ratio: f64, plane: Plane) -> Material {
        Material {
            name: "inline".to_owned(),
            youngs_modulus,
            poisson_ratio,
            plane,
            yield_strength: None,
            toughness: None,
            fracture_energy: None,
            density: None,
            tensile_strength: None,
        }
    }

    /// Shear modulus G = E / (2 (1+ν)), Pa.
    pub fn shear_modulus(&self) -> f64 {
        self.youngs_modulus / (2.0 * (1.0 + self.poisson_ratio))
    }

    /// E' of `K = √(E' G)`: E in plane stress, E/(1-ν²) in plane strain, Pa.
    pub fn plane_modulus(&self) -> f64 {
        match self.plane {
            Plane::Stress => self.youngs_modulus,
            Plane::Strain => self.youngs_modulus / (1.0 - self.poisson_ratio * self.poisson_ratio),
        }
    }
}

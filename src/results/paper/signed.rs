//! Data of a report that no result has: laboratory, customer, persons, test conditions of ASTM E647, section 10.

use std::path::Path;

use toml::Table;

use perilife_base::error::Result;
use perilife_base::input::{Document, Folder, Sections};
use perilife_base::keys::{Section, key, section};

/// Name of the section with these data.
const SECTION: &str = "report";

perilife_base::keys! {
    /// Section `[report]` of a file of report data; `None` is printed as "not recorded".
    #[derive(Debug, Clone, Default)]
    pub struct Signed {
        laboratory: Option<String> = key("laboratory", "Laboratory: name, address, accreditation");
        customer: Option<String> = key("customer", "Customer: name, contact");
        project: Option<String> = key("project", "Project");
        number: Option<String> = key("number", "Report number");
        revision: Option<String> = key("revision", "Revision");
        revision_reason: Option<String> = key("revision_reason", "Reason for the revision");
        date: Option<String> = key("date", "Date of issue");
        operator: Option<String> = key("operator", "Operator: tested or prepared by");
        reviewer: Option<String> = key("reviewer", "Reviewer");
        approver: Option<String> = key("approver", "Approver");
        product_form: Option<String> = key("product_form", "Product form and heat treatment");
        orientation: Option<String> = key("orientation", "Crack plane orientation: L-T, T-L, ...; location in the product");
        notch: Option<String> = key("notch", "Notch: form, preparation");
        precracking: Option<String> = key("precracking", "Precracking: final ΔK, R and crack size");
        machine: Option<String> = key("machine", "Test machine, load cell");
        waveform: Option<String> = key("waveform", "Waveform and frequency");
        environment: Option<String> = key("environment", "Environment: medium, temperature, humidity");
        crack_measurement: Option<String> = key("crack_measurement", "Crack size measurement: method, equipment");
        crack_resolution: Option<String> = key("crack_resolution", "Resolution of crack size");
        interruptions: Option<String> = key("interruptions", "Interruptions: occurrences that could affect the data");
    }
}

impl Signed {
    /// Reads section `[report]` of a TOML file; `set` are overrides `report.KEY=VALUE`.
    /// Errors: a file that cannot be read; an unknown key; a value that is not text.
    pub fn read(file: Option<&Path>, set: &[String]) -> Result<Self> {
        let document = match file {
            Some(path) => Document::read(path, set)?,
            None => Document::parse("", SECTION, Folder::none(), set)?,
        };
        let read = || section(Sections::of(&document.table, &[SECTION], &[])?.optional(SECTION), SECTION);
        read().map_err(|error| document.locate(error))
    }

    /// From the keys of section `[report]`.
    /// Errors: an unknown key; a value that is not text.
    pub fn of(keys: Table) -> Result<Self> {
        section(&keys.into(), SECTION)
    }

    /// Report number with its revision.
    pub(super) fn number_words(&self) -> Option<String> {
        let revision = self.revision.as_ref().map_or_else(String::new, |revision| format!(", revision {revision}"));
        Some(format!("{}{revision}", self.number.as_ref()?))
    }

    /// The test conditions that ASTM E647 asks for, with their labels.
    pub(super) fn conditions(&self) -> impl Iterator<Item = (&'static str, Option<&str>)> {
        let [form, orientation, notch] = [&self.product_form, &self.orientation, &self.notch];
        let [precracking, machine, waveform] = [&self.precracking, &self.machine, &self.waveform];
        let [environment, interruptions] = [&self.environment, &self.interruptions];
        let [method, resolution] = [&self.crack_measurement, &self.crack_resolution];
        let all = [form, orientation, notch, precracking, machine, waveform, environment, method, resolution, interruptions];
        Self::KEYS[Self::KEYS.len() - all.len()..].iter().zip(all).map(|(key, value)| (key.label_and_hint().0, value.as_deref()))
    }
}

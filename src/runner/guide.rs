//! The guide: Markdown of `src/guide` and of two documents that other places need too, in the order of the index.
#![allow(rustdoc::broken_intra_doc_links, rustdoc::bare_urls, reason = "brackets of TOML and addresses in tables are not links")]

/// Declares the pages: a module documented by the text, and a row of the list.
macro_rules! pages {
    ($($name:ident = $file:literal),+ $(,)?) => {
        /// Name and Markdown of every page, the index first.
        pub const PAGES: &[(&str, &str)] = &[$((stringify!($name), include_str!($file))),+];
        $(#[doc = include_str!($file)] pub mod $name {})+
    };
}

pages! {
    index = "../guide/index.md",
    install = "../guide/install.md",
    laboratory = "../guide/laboratory.md",
    engineer = "../guide/engineer.md",
    python = "../python/README.md",
    tables = "../guide/tables.md",
    fitting = "../guide/fitting.md",
    cracks = "../guide/cracks.md",
    loads = "../guide/loads.md",
    method = "../guide/method.md",
    validity = "../guide/validity.md",
    spectrum = "../guide/spectrum.md",
    inspections = "../guide/inspections.md",
    units = "../guide/units.md",
    service = "../guide/service.md",
    gallery = "../guide/gallery.md",
    keys = "../guide/keys.md",
    commands = "../guide/commands.md",
    files = "../guide/files.md",
    http = "../guide/http.md",
    accuracy = "../guide/accuracy.md",
    validation = "../../tests/VALIDATION.md",
    own_tests = "../guide/own_tests.md",
    theory = "../guide/theory.md",
    theory_k = "../guide/theory_k.md",
    theory_points = "../guide/theory_points.md",
    theory_nodes = "../guide/theory_nodes.md",
    theory_laws = "../guide/theory_laws.md",
    theory_growth = "../guide/theory_growth.md",
    theory_fits = "../guide/theory_fits.md",
    theory_scenes = "../guide/theory_scenes.md",
    glossary = "../guide/glossary.md",
}

pub fn page(name: &str) -> Option<&'static str> {
    PAGES.iter().find(|(page, _)| *page == name).map(|(_, text)| *text)
}

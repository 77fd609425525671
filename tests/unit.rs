//! Does each part do its job?

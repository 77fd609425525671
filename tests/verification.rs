//! Is the mathematics solved right?

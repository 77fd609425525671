//! Does it match the world?

//! Do the doors work?

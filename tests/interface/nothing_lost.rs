//! Nothing of the user's is lost: what lies in his folders, what he paid for, and what made it.

mod ends;
mod files;
mod folders;

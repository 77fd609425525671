//! Nothing of the user's is lost: what lies in his folders, what he paid for, and what made it.

#[path = "nothing_lost/ends.rs"]
mod ends;
#[path = "nothing_lost/files.rs"]
mod files;
#[path = "nothing_lost/folders.rs"]
mod folders;

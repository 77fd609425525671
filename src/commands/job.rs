//! `perilife job`: one job of a worker, in a process of its own.

use perilife_base::error::Result;
use perilife_service::worker::child;

/// Arguments of `perilife job`: none, since all comes over the socket of the worker.
#[derive(Debug, clap::Args)]
pub struct Args {}

pub fn run(_: &Args) -> Result<()> {
    child::take()
}

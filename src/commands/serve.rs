//! `perilife serve`: the HTTP service and its web page.

use std::net::{SocketAddr, ToSocketAddrs};
use std::num::NonZeroU32;
use std::path::PathBuf;

use super::console::Console;
use super::worker;
use perilife_base::error::Result;
use perilife_service::api::{Limits, Security};
use perilife_service::{Settings, serve};

/// Arguments of `perilife serve`.
#[derive(Debug, clap::Args)]
#[command(
    after_long_help = "Page: / with drawings, fits, runs as they go on and remaining life. Interface: /docs, for programs /openapi.json. A script submits by\n  curl -H \"content-type: application/toml\" --data-binary @case.toml localhost:8080/v1/predictions\n\
                       and asks /v1/predictions/ID/remaining?crack_length_mm=20&factor=3 for the cycles that are left and the inspection interval.\n\
                       Watching: /healthz (alive), /readyz (takes jobs), /metrics for Prometheus, the log by -v or RUST_LOG.\n\
                       Without tokens it answers this machine alone. To let others in: perilife token add, --listen, and a proxy with TLS before it."
)]
pub struct Args {
    /// Address; beyond this machine it needs tokens (`perilife token`) and a proxy that adds TLS
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "127.0.0.1:8080", value_parser = address, help_heading = "Service")]
    pub listen: SocketAddr,
    /// Ask for tokens even on this machine
    #[arg(long, help_heading = "Service")]
    pub require_token: bool,
    /// Believe what a proxy says of a request, and let in without a token who comes through it
    #[arg(long, help_heading = "Service")]
    pub trust_proxy: bool,
    /// Where the service is reached from outside, such as `https://life.example.org`
    #[arg(long, value_name = "URL", value_parser = public_url, help_heading = "Service")]
    pub public_url: Option<String>,
    /// Append a line of JSON for every change and every refusal
    #[arg(long, value_name = "FILE", help_heading = "Service")]
    pub audit_log: Option<PathBuf>,
    /// Largest body of a request, MiB
    #[arg(long, value_name = "MIB", default_value_t = 32, value_parser = clap::value_parser!(u32).range(1..=1024), help_heading = "Limits")]
    pub body_mib: u32,
    /// Most points of a plate; an archive for ParaView, where one is asked for, has up to some 3000 bytes for each
    #[arg(long, value_name = "COUNT", default_value_t = 1_000_000, help_heading = "Limits")]
    pub points: u32,
    /// Most jobs of one owner that wait
    #[arg(long, value_name = "COUNT", default_value_t = 1000, help_heading = "Limits")]
    pub queued: u32,
    /// Most MiB of one owner's jobs: inputs, results, checkpoints, and what waiting jobs may write
    #[arg(long, value_name = "MIB", default_value_t = 102_400, value_parser = clap::value_parser!(u32).range(1..), help_heading = "Limits")]
    pub quota_mib: u32,
    /// Most connections at a time, three quarters of them from one address; beyond them only health is answered
    #[arg(long, value_name = "COUNT", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..=100_000), help_heading = "Limits")]
    pub connections: u32,
    /// Most requests a second of one caller
    #[arg(long, value_name = "COUNT", default_value = "5000", help_heading = "Limits")]
    pub requests_per_second: NonZeroU32,
    /// Most of them that submit, check or upload
    #[arg(long, value_name = "COUNT", default_value = "1000", help_heading = "Limits")]
    pub writes_per_second: NonZeroU32,
    /// Where jobs and results are kept, and who runs them.
    #[command(flatten)]
    pub work: worker::Work,
    /// What is printed.
    #[command(flatten)]
    pub console: Console,
}

/// An address with a port; a name is looked up, and stands for its address of the fourth version where it has one.
fn address(text: &str) -> std::result::Result<SocketAddr, String> {
    let wrong = |why: &str| format!("{why}; give ADDRESS:PORT or NAME:PORT, for example 127.0.0.1:8080 or localhost:8080");
    let Some((host, port)) = text.rsplit_once(':') else { return Err(wrong("it has no port")) };
    if port.parse::<u16>().is_err() {
        return Err(wrong("the port is not 0 to 65535"));
    }
    if host.is_empty() {
        return Err(wrong("it has no address; 0.0.0.0 is every one of this machine"));
    }
    let found = text.to_socket_addrs().map_err(|error| wrong(&format!("the name is not known here ({error})")))?;
    let found: Vec<SocketAddr> = found.collect();
    let chosen = found.iter().find(|one| one.is_ipv4()).or(found.first());
    chosen.copied().ok_or_else(|| wrong("the name has no address"))
}

/// A URL of HTTP without a path, which is where a page and its scripts are looked for.
fn public_url(text: &str) -> std::result::Result<String, String> {
    let url = text.trim_end_matches('/');
    let host = url.strip_prefix("https://").or_else(|| url.strip_prefix("http://"));
    let is_fine = host.is_some_and(|host| !host.is_empty() && !host.contains(['/', '?', '#', '@', ' ']));
    let wrong = || "it is no address such as https://life.example.org: a scheme and a host, without a path".to_owned();
    is_fine.then(|| url.to_owned()).ok_or_else(wrong)
}

/// Runs `perilife serve`, until it is asked to stop.
pub fn run(args: &Args) -> Result<()> {
    let limits = Limits {
        body_bytes: (args.body_mib as usize) << 20,
        points: f64::from(args.points),
        case_bytes: args.work.settings().memory as f64,
        queued: i64::from(args.queued),
        quota_bytes: i64::from(args.quota_mib) << 20,
        connections: args.connections as usize,
        requests_per_second: args.requests_per_second,
        writes_per_second: args.writes_per_second,
        ..Limits::default()
    };
    let settings = Settings {
        listen: args.listen,
        database: args.work.place.made()?,
        security: Security {
            needs_token: args.require_token,
            trusts_proxy: args.trust_proxy,
            public_url: args.public_url.clone(),
        },
        audit_log: args.audit_log.clone(),
        limits,
        workers: args.work.settings(),
    };
    serve(&settings, |address| args.console.note(&format!("perilife {} at http://{address}", env!("CARGO_PKG_VERSION"))))
}

//! `perilife serve`: the HTTP service and its web page.

use std::net::{SocketAddr, ToSocketAddrs};
use std::num::NonZeroU32;
use std::path::PathBuf;

use super::console::Console;
use super::worker;
use perilife_base::error::{Result, fail_if};
use perilife_service::api::{Limits, Security};
use perilife_service::{Settings, serve};

#[derive(Debug, clap::Args)]
#[command(
    after_long_help = "Web page: /. API: /docs, for programs /openapi.json. Submit a case by\n  curl -H \"content-type: application/toml\" --data-binary @case.toml localhost:8080/v1/predictions\n\
                       Remaining life and inspection interval: /v1/predictions/ID/remaining?crack_length_mm=20&factor=3\n\
                       Each point of a plate takes up to 3000 bytes in a ParaView archive.\n\
                       Monitoring: /healthz (alive), /readyz (accepts jobs), /metrics (Prometheus), log by -v or RUST_LOG.\n\
                       Without tokens only local requests are accepted. For remote access: `perilife token add`, --listen, and a TLS proxy."
)]
pub struct Args {
    /// Address and port; remote access needs tokens and a TLS proxy
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "127.0.0.1:8080", value_parser = address, help_heading = "Service")]
    pub listen: SocketAddr,
    /// Require a token for local requests too
    #[arg(long, help_heading = "Service")]
    pub require_token: bool,
    /// Trust X-Forwarded-For, and accept proxied requests without a token
    #[arg(long, help_heading = "Service")]
    pub trust_proxy: bool,
    /// Public URL of the service, as browsers see it
    #[arg(long, value_name = "URL", value_parser = public_url, help_heading = "Service")]
    pub public_url: Option<String>,
    /// Append a JSON line per change and refusal
    #[arg(long, value_name = "FILE", help_heading = "Service")]
    pub audit_log: Option<PathBuf>,
    /// Maximum size of a request body, MiB
    #[arg(long, value_name = "MIB", default_value_t = 32, value_parser = clap::value_parser!(u32).range(1..=1024), help_heading = "Limits")]
    pub body_mib: u32,
    /// Maximum number of points of a plate
    #[arg(long, value_name = "COUNT", default_value_t = 1_000_000, help_heading = "Limits")]
    pub points: u32,
    /// Maximum queued jobs per owner
    #[arg(long, value_name = "COUNT", default_value_t = 1000, help_heading = "Limits")]
    pub queued: u32,
    /// Storage quota per owner, MiB
    #[arg(long, value_name = "MIB", default_value_t = 102_400, value_parser = clap::value_parser!(u32).range(1..), help_heading = "Limits")]
    pub quota_mib: u32,
    /// Maximum connections (three quarters of them per address)
    #[arg(long, value_name = "COUNT", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..=100_000), help_heading = "Limits")]
    pub connections: u32,
    /// Rate limit per client, requests/s
    #[arg(long, value_name = "COUNT", default_value = "5000", help_heading = "Limits")]
    pub requests_per_second: NonZeroU32,
    /// Rate limit per client for submit, check and upload, requests/s
    #[arg(long, value_name = "COUNT", default_value = "1000", help_heading = "Limits")]
    pub writes_per_second: NonZeroU32,
    /// Where jobs and results are kept, and who runs them.
    #[command(flatten)]
    pub work: worker::Work,
    #[command(flatten)]
    pub console: Console,
}

/// An address with a port; a name is looked up, and stands for its address of the fourth version where it has one.
fn address(text: &str) -> std::result::Result<SocketAddr, String> {
    let wrong = |why: &str| format!("{why}; give ADDRESS:PORT or NAME:PORT, for example 127.0.0.1:8080 or localhost:8080");
    let Some((host, port)) = text.rsplit_once(':') else { return Err(wrong("it has no port")) };
    fail_if!(port.parse::<u16>().is_err(), wrong("the port is not 0 to 65535"));
    fail_if!(host.is_empty(), wrong("it has no address; 0.0.0.0 is every one of this machine"));
    let found = text.to_socket_addrs().map_err(|error| wrong(&format!("unknown host name ({error})")))?;
    let found: Vec<SocketAddr> = found.collect();
    let chosen = found.iter().find(|one| one.is_ipv4()).or(found.first());
    chosen.copied().ok_or_else(|| wrong("the name has no address"))
}

/// A URL of HTTP without a path, which is where a page and its scripts are looked for.
fn public_url(text: &str) -> std::result::Result<String, String> {
    let url = text.trim_end_matches('/');
    let host = url.strip_prefix("https://").or_else(|| url.strip_prefix("http://"));
    let is_fine = host.is_some_and(|host| !host.is_empty() && !host.contains(['/', '?', '#', '@', ' ']));
    let wrong = || "not a URL such as https://life.example.org (scheme and host, no path)".to_owned();
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

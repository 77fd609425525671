//! nginx with the configuration of `data/deploy` before a service of a test, where the machine has it.

use std::fs;
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use tempfile::TempDir;

use crate::support::installed::{end, free_ports, is_root, or_skipped};

const PROGRAM: &str = "/usr/sbin/nginx";
const PATIENCE: Duration = Duration::from_secs(20);
pub const DELIVERED: &str = include_str!("../../data/deploy/nginx.conf");

/// A proxy, stopped and removed when dropped.
pub struct Nginx {
    process: Option<Child>,
    folder: TempDir,
    /// `http://...`: the same server without TLS, which the tests do not speak.
    pub url: String,
    /// Port of the one with TLS.
    pub tls_port: u16,
}

impl Nginx {
    /// The delivered configuration with other ports, names and certificate, not started, where the machine has it.
    pub fn configured(service: &str) -> Option<Nginx> {
        or_skipped("nginx", Self::try_configure(service))
    }

    /// Starts it before the service at this address.
    pub fn before(service: &str) -> Option<Nginx> {
        let mut nginx = Self::configured(service)?;
        let quiet = || Stdio::null();
        nginx.process = Some(nginx.program().stdin(quiet()).stdout(quiet()).stderr(quiet()).spawn().unwrap());
        let (address, begun) = (nginx.url.trim_start_matches("http://").to_owned(), Instant::now());
        while TcpStream::connect(&address).is_err() {
            assert!(begun.elapsed() < PATIENCE, "nginx does not start: {}", nginx.log());
            std::thread::sleep(Duration::from_millis(20));
        }
        Some(nginx)
    }

    fn try_configure(service: &str) -> Result<Nginx, String> {
        if !Path::new(PROGRAM).is_file() {
            return Err(format!("{PROGRAM} is not installed (Debian: apt-get install nginx-light)"));
        }
        let folder = tempfile::Builder::new().prefix("perilife-nginx").tempdir().map_err(|error| error.to_string())?;
        let here = folder.path().display();
        let certificate = Command::new("openssl")
            .args(["req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "1", "-subj", "/CN=perilife.example.org"])
            .args(["-keyout", &format!("{here}/privkey.pem"), "-out", &format!("{here}/fullchain.pem")])
            .output()
            .map_err(|error| format!("openssl, for a certificate: {error}"))?;
        assert!(certificate.status.success(), "{}", String::from_utf8_lossy(&certificate.stderr));
        let [redirecting, tls_port, plain] = free_ports::<3>();
        let mut text = DELIVERED.to_owned();
        for (delivered, here) in [
            ("server 127.0.0.1:8080;", format!("server {};", service.trim_start_matches("http://"))),
            ("listen 80;", format!("listen 127.0.0.1:{redirecting};")),
            ("listen 443 ssl http2;", format!("listen 127.0.0.1:{tls_port} ssl http2; listen 127.0.0.1:{plain};")),
            ("listen [::]:80;", String::new()),
            ("listen [::]:443 ssl http2;", String::new()),
            ("/etc/perilife/tls/", format!("{here}/")),
        ] {
            assert!(text.contains(delivered), "{delivered}");
            text = text.replace(delivered, &here);
        }
        fs::write(folder.path().join("perilife.conf"), text).map_err(|error| error.to_string())?;
        let places: String = ["client_body", "proxy", "fastcgi", "uwsgi", "scgi"]
            .map(|what| format!("    {what}_temp_path {here}/{what};\n"))
            .concat();
        let user = if is_root() { "user root;\n" } else { "" };
        let around = format!(
            "{user}daemon off;\nmaster_process on;\npid {here}/pid;\nerror_log {here}/error.log;\nevents {{ worker_connections 256; }}\n\
             http {{\n{places}    access_log off;\n    include {here}/perilife.conf;\n}}\n"
        );
        fs::write(folder.path().join("nginx.conf"), around).map_err(|error| error.to_string())?;
        Ok(Nginx { process: None, folder, url: format!("http://127.0.0.1:{plain}"), tls_port })
    }

    fn program(&self) -> Command {
        let mut command = Command::new(PROGRAM);
        command.arg("-c").arg(self.folder.path().join("nginx.conf")).arg("-p").arg(self.folder.path());
        command.arg("-e").arg(self.folder.path().join("error.log"));
        command
    }

    /// What `nginx -t` says.
    pub fn checked(&self) -> Output {
        self.program().arg("-t").output().unwrap()
    }

    fn log(&self) -> String {
        fs::read_to_string(self.folder.path().join("error.log")).unwrap_or_default()
    }
}

impl Drop for Nginx {
    fn drop(&mut self) {
        // The master ends its workers, if it is asked to.
        self.process.iter_mut().for_each(|process| end(process, PATIENCE));
    }
}

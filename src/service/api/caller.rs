//! Who asks; and who has changed what, and who was refused: a line of JSON each, appended to a file.

use std::fs::{File, OpenOptions};
use std::io::Write as _;
use std::net::IpAddr;
use std::os::unix::fs::OpenOptionsExt;
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::time::SystemTime;

use axum::http::{Method, StatusCode};
use serde_json::json;

use crate::problem::{Answer, Problem};
use crate::store::Role;
use perilife_base::error::{Error, Result};

/// Who asks.
#[derive(Debug, Clone, PartialEq)]
pub struct Caller {
    /// Name of the token; empty where none is needed.
    pub name: String,
    /// What he may do.
    pub role: Role,
    /// Hash of the token; empty where none is needed.
    pub token: String,
}

impl Caller {
    /// Refuses who may not.
    pub fn must_be(&self, role: Role) -> Answer<()> {
        if self.role >= role {
            return Ok(());
        }
        let detail = format!("requires role {role}; your token has {}", self.role);
        Err(Problem::new(StatusCode::FORBIDDEN, "Forbidden", detail))
    }

    /// Refuses who may not do something with a job of this owner.
    pub fn must_own(&self, owner: &str) -> Answer<()> {
        self.must_be(if owner == self.name { Role::Run } else { Role::Admin })
    }
}

/// The file that it is written to.
#[derive(Debug)]
pub struct Audit(Mutex<File>);

impl Audit {
    /// Appends to a file, which nobody else may read if it is made now.
    pub fn open(path: &Path) -> Result<Audit> {
        let file = OpenOptions::new().create(true).append(true).mode(0o600).open(path);
        Ok(Audit(Mutex::new(file.map_err(|error| Error::file(path, "cannot append to", error))?)))
    }

    /// Writes down a request that changed something, or that was refused for who made it.
    pub fn write(&self, caller: Option<&Caller>, address: IpAddr, method: &Method, path: &str, status: StatusCode) {
        let is_read = matches!(*method, Method::GET | Method::HEAD);
        if is_read && ![StatusCode::UNAUTHORIZED, StatusCode::FORBIDDEN].contains(&status) {
            return;
        }
        let line = json!({
            "time": humantime::format_rfc3339_millis(SystemTime::now()).to_string(),
            "caller": caller.map(|caller| caller.name.as_str()), "role": caller.map(|caller| caller.role.name()),
            "address": address.to_string(), "method": method.as_str(), "path": path, "status": status.as_u16(),
        });
        let mut file = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        // In one call, so that lines of two processes do not mix.
        if let Err(error) = file.write_all(format!("{line}\n").as_bytes()) {
            tracing::error!("the audit log cannot be written: {error}");
        }
    }
}

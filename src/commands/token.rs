//! `perilife token`: who may use a service that asks for tokens.

use serde_json::json;

use super::console::Console;
use super::worker::Place;
use perilife_base::error::{Result, input};
use perilife_service::job::time;
use perilife_service::store::Role;
use perilife_service::{with_store, without_password};

#[derive(Debug, clap::Args)]
pub struct Args {
    /// What to do.
    #[command(subcommand)]
    pub task: Task,
    /// Where the service keeps its jobs.
    #[command(flatten)]
    pub place: Place,
    #[command(flatten)]
    pub console: Console,
}

/// What to do with tokens.
#[derive(Debug, clap::Subcommand)]
pub enum Task {
    /// Create a token; it is shown only once
    Add {
        /// Name of the user
        name: String,
        /// Role: read, run (own jobs) or admin (all jobs)
        #[arg(long, value_enum)]
        role: Role,
        /// Days until it expires [default: never]
        #[arg(long, value_name = "DAYS", value_parser = clap::value_parser!(u32).range(1..=36_500))]
        days: Option<u32>,
    },
    /// List names, roles and expiry
    List,
    /// Remove a token
    Remove {
        /// Name of the user
        name: String,
    },
}

pub fn run(args: &Args) -> Result<()> {
    let may_make = matches!(args.task, Task::Add { .. });
    let (url, console) = (if may_make { args.place.made()? } else { args.place.url()? }, &args.console);
    match &args.task {
        Task::Add { name, role, days } => {
            if name.is_empty() || name.chars().any(char::is_control) {
                return Err(input("NAME", format!("{name:?}"), "is not a name", "give a word"));
            }
            let secret = with_store(&url, async |store| store.add_token(name, *role, *days).await)?;
            let taken = || input("NAME", name, "has a token already", "remove it first: perilife token remove NAME");
            let secret = secret.ok_or_else(taken)?;
            console.note(&format!("{name}: token for {}", without_password(&url)));
            console.result(&format!("{secret}\n"))?;
            console.object(&json!({ "name": name, "role": role, "token": secret }))
        }
        Task::List => {
            let tokens = with_store(&url, async |store| store.tokens().await)?;
            let end = |ms: Option<i64>| ms.map_or_else(|| "never expires".to_owned(), |ms| format!("expires {}", time(ms)));
            let lines = tokens.iter().map(|token| {
                format!(
                    "{:<24} {:<6} made {}, {}\n",
                    token.name,
                    token.role.name(),
                    time(token.created_ms),
                    end(token.expires_ms)
                )
            });
            console.result(&lines.collect::<String>())?;
            let objects = tokens.iter().map(|token| {
                json!({ "name": token.name, "role": token.role, "created": time(token.created_ms), "expires": token.expires_ms.map(time) })
            });
            console.object(&json!({ "tokens": objects.collect::<Vec<_>>() }))
        }
        Task::Remove { name } => {
            if !with_store(&url, async |store| store.remove_token(name).await)? {
                return Err(input("NAME", name, "has no token", "see perilife token list"));
            }
            console.say(&format!("{name}: token removed"));
            console.object(&json!({ "removed": name }))
        }
    }
}

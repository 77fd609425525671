//! The service: calibrate, predict and watch from a browser or a script, losing nothing.
//!
//! Knows: the store, workers, HTTP, the page.
//! Must not know: mechanics; every job runs through `runner`.
//!
//! Imports `runner` and what it imports.
//!
//! Three parts that know each other only through the [`store`]: the [`api`] takes jobs in and shows them, [`worker`]s run them by
//! the functions that the commands call, and the store is where a job exists. One process may have both ([`serve`]), or many
//! machines share one PostgreSQL ([`work`]).
//!
//! A job is accepted once it is committed, claimed by one worker at a time (a number that grows with every claim fences off one
//! that was taken for dead and is not), run in a process of its own with so much memory and time, kept alive by signs of life, taken
//! up from its last checkpoint wherever its worker died, and finished once, together with its files, in one transaction. After a crash a prediction goes on to the same curve, bit for bit on
//! the same kind of processor; a calibration, which takes seconds, begins anew. The same `Idempotency-Key` makes no second job while
//! the first is kept. A database that is gone or a disk that is full is a 503 until it is back.
//!
//! Owners of tokens take turns, so that nobody's thousand jobs keep the others waiting. Of tokens only hashes are kept; bodies, files,
//! points, waiting jobs and requests a second are limited, and files go out in parts, so that readers who do not read cost little.

pub mod api;
pub mod job;
pub mod problem;
pub mod store;
pub mod worker;

use std::convert::Infallible;
use std::future::Future;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use api::{App, Audit, Crowded, Limits, Place, Places, Security};
use axum::Router;
use axum::body::Body;
use axum::extract::ConnectInfo;
use axum::http::Request;
use hyper::body::Incoming;
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::server::graceful::GracefulShutdown;
use store::{DatabaseFile, Store, Upgrade};
use tokio::net::{TcpListener, TcpStream};
use tokio::runtime::{Builder, Runtime};
use tokio::signal::unix::{SignalKind, signal};
use tokio::sync::{Notify, OwnedSemaphorePermit, Semaphore};
use tokio_io_timeout::TimeoutStream;
use tower::ServiceExt;
use worker::Workers;

use perilife_base::error::{Error, Result, input};

/// Connections to the database beyond those of the workers.
const CONNECTIONS: u32 = 8;
/// Time in which input that is being looked at is left when the process stops.
const LAST_LOOKS: Duration = Duration::from_secs(1);
/// Time between two forgettings of callers that were not heard of.
const FORGET_EVERY: Duration = Duration::from_secs(60);

#[derive(Debug, Clone)]
pub struct Settings {
    pub listen: SocketAddr,
    /// `sqlite://FILE` or `postgres://...`.
    pub database: String,
    /// Who is let in; whoever listens to other machines needs tokens in any case.
    pub security: Security,
    /// File to which changes and refusals are appended.
    pub audit_log: Option<PathBuf>,
    pub limits: Limits,
    /// Workers of this process; `jobs` 0 has none.
    pub workers: worker::Settings,
}

/// Serves until the process is asked to stop (SIGINT, SIGTERM); `ready` is told the address once it answers.
pub fn serve(settings: &Settings, ready: impl FnOnce(SocketAddr)) -> Result<()> {
    let runtime = runtime()?;
    let served = runtime.block_on(async {
        let store = open(&settings.database, CONNECTIONS + settings.workers.jobs as u32, Upgrade::Allowed).await?;
        let needs_token = settings.security.needs_token || !settings.listen.ip().is_loopback();
        let audit = settings.audit_log.as_deref().map(Audit::open).transpose()?;
        if needs_token && store.tokens().await.map_err(|error| database(&settings.database, error))?.is_empty() {
            let remedy = "make one first: perilife token add NAME --role admin";
            let problem = "requires tokens, and there are none";
            return Err(input("--listen", settings.listen, problem, remedy));
        }
        let cannot = |error| Error::file(Path::new(&settings.listen.to_string()), "cannot listen", error);
        let listener = TcpListener::bind(settings.listen).await.map_err(cannot)?;
        let address = listener.local_addr().map_err(cannot)?;

        let wake = Arc::new(Notify::new());
        let workers = Workers::start(store.clone(), settings.workers.clone(), Arc::clone(&wake)).map_err(threads)?;
        let security = Security { needs_token, ..settings.security.clone() };
        let mut app = App::new(store.clone(), settings.limits.clone(), security, settings.workers.clone(), wake);
        app.audit = audit.map(Arc::new);
        app.disks = Arc::new(disks(settings));
        api::start_counting();
        let forgetting = tokio::spawn(forget_callers(app.clone()));
        ready(address);

        let stopping = async {
            asked_to_stop().await;
            app.stop();
        };
        let trusts_proxy = settings.security.trusts_proxy;
        listen(listener, api::router(app.clone()), settings.limits.connections, trusts_proxy, stopping).await;
        tracing::info!("stopping: jobs go on from their checkpoints at the next start");
        forgetting.abort();
        workers.stop().await;
        store.close().await;
        Ok(())
    });
    // Nobody waits any more for what is still being looked at.
    runtime.shutdown_timeout(LAST_LOOKS);
    served
}

/// Works for a service of another process until this one is asked to stop.
pub fn work(url: &str, settings: &worker::Settings, ready: impl FnOnce()) -> Result<()> {
    runtime()?.block_on(async {
        let store = open(url, 1 + settings.jobs as u32, Upgrade::Refused).await?;
        let workers = Workers::start(store.clone(), settings.clone(), Arc::new(Notify::new())).map_err(threads)?;
        ready();
        asked_to_stop().await;
        tracing::info!("stopping: jobs go on from their checkpoints elsewhere");
        workers.stop().await;
        store.close().await;
        Ok(())
    })
}

/// Folders that a service writes to: of the database file, and of temporary files where it runs jobs.
fn disks(settings: &Settings) -> Vec<(&'static str, PathBuf)> {
    let store = DatabaseFile::of(&settings.database).map(|file| file.folder());
    let temporary = (settings.workers.jobs > 0).then(std::env::temp_dir);
    [("store", store), ("temporary", temporary)].into_iter().filter_map(|(name, place)| Some((name, place?))).collect()
}

pub fn with_store<T>(url: &str, task: impl AsyncFnOnce(&Store) -> store::Result<T>) -> Result<T> {
    runtime()?.block_on(async {
        let store = open(url, 1, Upgrade::Refused).await?;
        let done = task(&store).await.map_err(|error| database(url, error));
        store.close().await;
        done
    })
}

fn runtime() -> Result<Runtime> {
    Builder::new_multi_thread().enable_all().build().map_err(threads)
}

async fn open(url: &str, connections: u32, upgrade: Upgrade) -> Result<Store> {
    Store::open(url, connections, upgrade).await.map_err(|error| database(url, error))
}

/// A database that cannot be used; passwords in its URL are not repeated.
fn database(url: &str, error: sqlx::Error) -> Error {
    Error::file(Path::new(&without_password(url)), "cannot use the database", std::io::Error::other(error))
}

pub fn without_password(url: &str) -> String {
    let Some((scheme, rest)) = url.split_once("://") else { return "the database".to_owned() };
    // Query parameters may hold passwords as well.
    let rest = rest.split('?').next().unwrap_or_default();
    if scheme == "sqlite" {
        // The path of a file, as its owner writes it.
        return percent_encoding::percent_decode_str(rest).decode_utf8_lossy().into_owned();
    }
    match rest.rsplit_once('@') {
        Some((user, place)) => format!("{scheme}://{}@{place}", user.split(':').next().unwrap_or_default()),
        None => format!("{scheme}://{rest}"),
    }
}

fn threads(error: std::io::Error) -> Error {
    Error::file(Path::new("threads"), "cannot be started", error)
}

async fn asked_to_stop() {
    let terminated = async {
        match signal(SignalKind::terminate()) {
            Ok(mut terminate) => drop(terminate.recv().await),
            // Without it the other signal is what is left.
            Err(_) => std::future::pending().await,
        }
    };
    tokio::select! {
        _ = tokio::signal::ctrl_c() => {}
        () = terminated => {}
    }
}

async fn forget_callers(app: App) {
    loop {
        tokio::time::sleep(FORGET_EVERY).await;
        app.forget_callers();
        api::sum_up();
    }
}

/// Time in which the head of a request must have come; also that for which an idle connection is kept. Less as connections run out.
const HEAD_WITHIN: Duration = Duration::from_secs(10);
/// The same on a connection of the reserve.
const RESERVED_WITHIN: Duration = Duration::from_secs(1);
/// Least time for the head, in which one that was sent at once has come.
const HEAD_LEAST: Duration = Duration::from_millis(50);
/// Time for which an answer may wait for its reader to take some of it.
const TAKEN_WITHIN: Duration = Duration::from_secs(30);
/// Time that requests have to end when the process is to stop.
const LAST_ANSWERS: Duration = Duration::from_secs(10);
/// Connections beyond those for everybody, over which those who watch over the service are answered.
const RESERVE: usize = 64;
/// Time before another try when the system gives no connection, most likely because it has no more file handles.
const TRY_EVERY: Duration = Duration::from_millis(200);

/// Serves until `stop` is ready, then lets requests end. `trusts_proxy`: who connects from this machine speaks for everybody.
async fn listen(listener: TcpListener, router: Router, connections: usize, trusts_proxy: bool, stop: impl Future<Output = ()>) {
    let graceful = GracefulShutdown::new();
    let room = Arc::new(Semaphore::new(connections));
    let reserve = Arc::new(Semaphore::new(RESERVE));
    let of_address = Places::new((3 * connections / 4).max(1));
    tokio::pin!(stop);
    loop {
        // Whoever comes when even the reserve is taken waits in the queue of the system.
        let next = async { (listener.accept().await, Arc::clone(&reserve).acquire_owned().await) };
        tokio::select! {
            () = &mut stop => break,
            (accepted, spare) = next => match (accepted, spare) {
                (Ok((stream, address)), Ok(spare)) => {
                    let is_everybody = trusts_proxy && address.ip().is_loopback();
                    let own = if is_everybody { None } else { of_address.take(&address.ip().to_string()) };
                    let place = Arc::clone(&room).try_acquire_owned().ok().filter(|_| is_everybody || own.is_some());
                    let crowded = place.is_none().then_some(Crowded);
                    let head_within = match (crowded, &own) {
                        (Some(_), _) => within(RESERVED_WITHIN, reserve.available_permits(), RESERVE),
                        (None, Some(own)) if own.left * connections < room.available_permits() * of_address.most() => {
                            within(HEAD_WITHIN, own.left, of_address.most())
                        }
                        (None, _) => within(HEAD_WITHIN, room.available_permits(), connections),
                    };
                    let held = Held { address, crowded, head_within, _places: (place.unwrap_or(spare), own) };
                    take(stream, held, router.clone(), &graceful);
                }
                (Err(error), _) => {
                    tracing::warn!("no connection can be taken: {error}");
                    tokio::time::sleep(TRY_EVERY).await;
                }
                // Never closed.
                (_, Err(_)) => break,
            },
        }
    }
    drop(listener);
    // Who keeps a connection open for ever does not keep the process.
    let _ = tokio::time::timeout(LAST_ANSWERS, graceful.shutdown()).await;
}

/// A part of a time: that of places that are free.
fn within(time: Duration, free: usize, all: usize) -> Duration {
    time.mul_f64(free as f64 / all.max(1) as f64).max(HEAD_LEAST)
}

/// What a connection holds as long as it is open.
struct Held {
    address: SocketAddr,
    crowded: Option<Crowded>,
    head_within: Duration,
    _places: (OwnedSemaphorePermit, Option<Place>),
}

fn take(stream: TcpStream, held: Held, router: Router, graceful: &GracefulShutdown) {
    // Waiting for more to send would only cost time: what is large comes in large parts.
    let _ = stream.set_nodelay(true);
    let (address, crowded) = (held.address, held.crowded);
    let service = service_fn(move |request: Request<Incoming>| {
        let mut request = request.map(Body::new);
        request.extensions_mut().insert(ConnectInfo(address));
        if let Some(crowded) = crowded {
            request.extensions_mut().insert(crowded);
        }
        let answer = router.clone().oneshot(request);
        async move { Ok::<_, Infallible>(answer.await.unwrap_or_else(|never| match never {})) }
    });
    let mut builder = http1::Builder::new();
    builder.timer(TokioTimer::new()).header_read_timeout(held.head_within).keep_alive(crowded.is_none());
    let mut stream = TimeoutStream::new(stream);
    stream.set_write_timeout(Some(TAKEN_WITHIN));
    let connection = graceful.watch(builder.serve_connection(TokioIo::new(Box::pin(stream)), service));
    tokio::spawn(async move {
        // Its trouble is the client's, who is gone.
        let _ = connection.await;
        drop(held);
    });
}

//! Connections: so many at a time, none that only pretends to ask, all ended in order when the process stops.

use std::convert::Infallible;
use std::future::Future;
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::body::Body;
use axum::extract::ConnectInfo;
use axum::http::Request;
use hyper::body::Incoming;
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::server::graceful::GracefulShutdown;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio_io_timeout::TimeoutStream;
use tower::ServiceExt;

use super::api::{Crowded, Place, Places};

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
pub async fn serve(
    listener: TcpListener,
    router: Router,
    connections: usize,
    trusts_proxy: bool,
    stop: impl Future<Output = ()>,
) {
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

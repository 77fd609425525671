//! Places of which there are so many: for each caller, for each role, for all.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use tokio::sync::{OwnedSemaphorePermit, Semaphore};

use super::caller::Caller;
use crate::service::problem::{Answer, Problem};
use crate::service::store::Role;

/// Counts what each has taken; who comes when all of his are taken gets none.
#[derive(Debug, Clone)]
pub struct Places(Arc<Counted>);

#[derive(Debug)]
struct Counted {
    most: usize,
    taken: Mutex<HashMap<String, usize>>,
}

/// A place; given back when dropped.
#[derive(Debug)]
pub struct Place {
    places: Places,
    key: String,
}

impl Places {
    /// So many for each key.
    pub fn new(most: usize) -> Self {
        Places(Arc::new(Counted { most, taken: Mutex::default() }))
    }

    /// How many there are for each key.
    pub fn most(&self) -> usize {
        self.0.most
    }

    /// A place of this key, if one is free.
    pub fn take(&self, key: &str) -> Option<Place> {
        let mut taken = self.0.taken.lock().unwrap_or_else(PoisonError::into_inner);
        let count = taken.entry(key.to_owned()).or_default();
        if *count >= self.0.most {
            return None;
        }
        *count += 1;
        Some(Place { places: self.clone(), key: key.to_owned() })
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        let mut taken = self.places.0.taken.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(count) = taken.get_mut(&self.key) {
            *count -= 1;
            if *count == 0 {
                taken.remove(&self.key);
            }
        }
    }
}

/// Places for bodies in memory: who waits for one does so behind those of his own, then of his role, then of all, so that nobody's slow
/// bodies keep the others waiting.
#[derive(Debug, Clone)]
pub struct BodyPlaces {
    most_of_caller: usize,
    of_callers: Arc<Mutex<HashMap<String, Arc<Semaphore>>>>,
    of_readers: Arc<Semaphore>,
    of_all: Arc<Semaphore>,
}

/// Room for one body; given back when dropped.
#[derive(Debug)]
pub struct BodyPlace {
    _held: Vec<OwnedSemaphorePermit>,
}

impl BodyPlaces {
    /// So many for each caller, for all who may only read, and for all.
    pub fn new(of_caller: usize, of_readers: usize, of_all: usize) -> Self {
        BodyPlaces {
            most_of_caller: of_caller,
            of_callers: Arc::default(),
            of_readers: Arc::new(Semaphore::new(of_readers)),
            of_all: Arc::new(Semaphore::new(of_all)),
        }
    }

    /// Waits for room for one more body of a caller.
    pub async fn wait(&self, caller: &Caller) -> Answer<BodyPlace> {
        let own = {
            let mut callers = self.of_callers.lock().unwrap_or_else(PoisonError::into_inner);
            let own = callers.entry(caller.name.clone()).or_insert_with(|| Arc::new(Semaphore::new(self.most_of_caller)));
            Arc::clone(own)
        };
        let of_role = (caller.role == Role::Read).then(|| Arc::clone(&self.of_readers));
        let mut held = Vec::with_capacity(3);
        for places in [Some(own), of_role, Some(Arc::clone(&self.of_all))].into_iter().flatten() {
            // Never closed, and if it were: come back later.
            let stops = |_| Problem::too_many("the server is about to stop", 5);
            held.push(places.acquire_owned().await.map_err(stops)?);
        }
        Ok(BodyPlace { _held: held })
    }

    /// Forgets callers who have no body in memory.
    pub fn forget(&self) {
        let most = self.most_of_caller;
        let in_use = |places: &Arc<Semaphore>| Arc::strong_count(places) > 1 || places.available_permits() < most;
        self.of_callers.lock().unwrap_or_else(PoisonError::into_inner).retain(|_, places| in_use(places));
    }
}

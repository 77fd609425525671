//! The folder of a run: made beside its place, or within it where it cannot be replaced, and put there when it is whole.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::leftovers::{self, OLD, PARTIAL, lock_of, parent_of, temporary_beside, visible_beside};
use super::lock::{Lock, Refused, Share};
use super::marker::{MARKER, Marker, RunKind};
use super::pending::{self, Pending};
use super::place::{Room, folder_for, is_mounted, occupied, room};
use super::rescue::{elsewhere, has_files};
use super::{said, swap};
use crate::error::{Error, Result, input};
use crate::input::Provenance;

/// An output folder in the making. Until [`OutputFolder::finish`] it stands under a temporary name; dropped before that (an error, a
/// panic) it leaves nothing behind.
#[derive(Debug)]
pub struct OutputFolder {
    /// As given by the user.
    name: PathBuf,
    target: PathBuf,
    kind: RunKind,
    partial: PathBuf,
    /// Within the target: something is mounted there, or its parent takes no new names.
    is_inside: bool,
    /// Folders above the target that did not exist before, deepest first; removed again if nothing comes of the run.
    new_parents: Vec<PathBuf>,
    warning: Option<String>,
    is_finished: bool,
    // In the order in which they end.
    _in_the_making: Vec<Pending>,
    lock: Option<Lock>,
}

/// A folder in its place. Nobody else writes there while this lives.
#[derive(Debug)]
pub struct Finished {
    target: PathBuf,
    _lock: Option<Lock>,
}

impl Finished {
    /// Makes a folder of another run in it, by its name there, a part of this one.
    ///
    /// # Errors
    /// [`Error::File`] if the marker cannot be written.
    pub fn adopt(&self, run: &str) -> Result<()> {
        let Some(mut marker) = Marker::read(&self.target) else { return Ok(()) };
        marker.files.insert(format!("{run}/"));
        super::write_file(&self.target.join(MARKER), marker.text().as_bytes())
    }
}

impl OutputFolder {
    /// Claims `path` for a run that read nothing and writes little.
    pub fn create(path: &Path, kind: RunKind) -> Result<OutputFolder> {
        Self::claim(path, kind, &Provenance::default(), Room::default())
    }

    /// Claims `path` for a run of this kind, before anything is computed. It may be new, empty, or the result of an earlier run of that
    /// kind, which stays until [`OutputFolder::finish`]. What processes left there that were killed goes.
    ///
    /// # Errors
    /// [`Error::Input`] if the path is a file, holds anything this program did not make, results of another kind or an input of this
    /// run, or if another process writes there; [`Error::File`] if it cannot be written or has no room.
    pub fn claim(path: &Path, kind: RunKind, read: &Provenance, wanted: Room) -> Result<OutputFolder> {
        let cannot = |e| Error::file(path, "cannot create the folder", e);
        let target = folder_for(path, kind, read)?;
        let parent = parent_of(&target);
        let is_new = |above: &&Path| !above.as_os_str().is_empty() && !above.exists();
        let new_parents: Vec<PathBuf> = parent.ancestors().take_while(is_new).map(PathBuf::from).collect();
        let in_the_making = new_parents.iter().rev().map(|above| Pending::empty(above)).collect();
        // From here on the value itself tidies up, whatever fails.
        let mut folder = OutputFolder {
            name: path.to_path_buf(),
            kind,
            partial: PathBuf::new(),
            is_inside: target.is_dir() && is_mounted(&target),
            target,
            new_parents,
            warning: None,
            is_finished: false,
            _in_the_making: in_the_making,
            lock: None,
        };
        fs::create_dir_all(&parent).map_err(cannot)?;
        folder.take_lock().map_err(|refused| match refused {
            Refused::Impossible(error) => cannot(error),
            Refused::Taken(holder) => taken("--out", path, &holder),
        })?;
        // It may have changed while it was not locked.
        let target = folder_for(path, kind, read)?;
        folder.lock.iter().for_each(|lock| leftovers::remove_beside(&folder.within(), lock));
        folder.partial = temporary_beside(&folder.within(), PARTIAL);
        let (pending, ()) = Pending::tree_by(&folder.partial, || fs::create_dir(&folder.partial)).map_err(cannot)?;
        folder._in_the_making.push(pending);
        let marker = Marker { kind, files: Default::default() };
        fs::write(folder.partial.join(MARKER), marker.text())
            .map_err(|e| Error::file(path, "cannot write into the folder", e))?;
        folder.warning = room(path, if folder.is_inside { &target } else { &parent }, wanted)?;
        Ok(folder)
    }

    /// What temporary names stand beside: the target, or a name in it.
    fn within(&self) -> PathBuf {
        if self.is_inside { self.target.join("perilife") } else { self.target.clone() }
    }

    /// Takes the lock beside the target; in it where its parent takes no new names.
    fn take_lock(&mut self) -> std::result::Result<(), Refused> {
        let lock = match Lock::take(&lock_of(&self.within()), Share::Alone) {
            Err(Refused::Impossible(_)) if !self.is_inside && self.target.is_dir() => {
                self.is_inside = true;
                Lock::take(&lock_of(&self.within()), Share::Alone)
            }
            lock => lock,
        };
        self.lock = Some(lock?);
        Ok(())
    }

    /// Where to write until the folder is finished.
    pub fn path(&self) -> &Path {
        &self.partial
    }

    /// Where the results will stand, as the user named it.
    pub fn name(&self) -> &Path {
        &self.name
    }

    /// What the user should know of the place before the run.
    pub fn warning(&self) -> Option<&str> {
        self.warning.as_deref()
    }

    /// Has the files of the run written. If that fails, what there is stays under a visible name; where nothing could be written it is
    /// tried in the current folder, and in the one for temporary files.
    pub fn fill<T>(&mut self, write: impl Fn(&Path) -> Result<T>) -> Result<T> {
        let error = match write(&self.partial) {
            Ok(done) => return Ok(done),
            Err(error) => error,
        };
        if has_files(&self.partial) {
            return Err(match self.show() {
                Ok(visible) => said(error, &format!("what there is stands in {}", visible.display())),
                Err(trouble) => said(error, &format!("what there is cannot be kept: {trouble}")),
            });
        }
        match elsewhere(self.kind, &self.target, &write) {
            Some(other) => Err(said(error, &format!("what there is stands in {}", other.display()))),
            None => Err(error),
        }
    }

    /// Puts the folder in its place; the files of an earlier run go, and nothing else.
    ///
    /// # Errors
    /// [`Error::File`] if it cannot be put there, or if something has appeared there meanwhile: that stays, and the results get a
    /// visible name, which the message says.
    pub fn finish(mut self) -> Result<Finished> {
        let put = {
            // Folded up before or after, not in between.
            let _held = pending::hold();
            self.list().map_err(|e| e.to_string()).and_then(|()| self.put())
        };
        match put {
            Ok(()) => {
                self.is_finished = true;
                Ok(Finished { target: self.target.clone(), _lock: self.lock.take() })
            }
            Err(why) => {
                let place = match self.show() {
                    Ok(visible) => format!("the results stand in {}", visible.display()),
                    Err(trouble) => format!("the results are lost: {trouble}"),
                };
                Err(Error::file(&self.name, "cannot put the results in place", io::Error::other(format!("{why}; {place}"))))
            }
        }
    }

    /// Writes the marker with all files.
    fn list(&self) -> io::Result<()> {
        let marker = Marker::of(self.kind, &self.partial)?;
        fs::write(self.partial.join(MARKER), marker.text())
    }

    /// Asks again what stands at the target, on the folder as it is now, and takes its place.
    fn put(&self) -> std::result::Result<(), String> {
        let words = |error: io::Error| error.to_string();
        if let Some((problem, _)) = occupied(&self.target, self.kind).map_err(words)? {
            return Err(format!("it {problem}, and that stays"));
        }
        if self.is_inside {
            return swap::move_into(&self.partial, &self.target).map_err(words);
        }
        swap::replace(&self.partial, &self.target, &temporary_beside(&self.target, OLD))
    }

    /// Gives what was written a visible name.
    fn show(&mut self) -> io::Result<PathBuf> {
        let _ = self.list();
        let visible = visible_beside(&self.within());
        {
            let _held = pending::hold();
            fs::rename(&self.partial, &visible)?;
        }
        self.is_finished = true;
        // As the user writes it, unless links lead elsewhere.
        let named = self.name.with_file_name(visible.file_name().unwrap_or_default());
        Ok(if named.exists() { named } else { visible })
    }
}

/// Another process has the lock of what an option names.
pub(super) fn taken(option: &str, path: &Path, holder: &str) -> Error {
    let problem = format!("is in use by another run: {holder}");
    input(option, path.display(), problem, "wait for its end, or give another name")
}

impl Drop for OutputFolder {
    fn drop(&mut self) {
        if self.is_finished {
            return;
        }
        if !self.partial.as_os_str().is_empty() {
            let _ = fs::remove_dir_all(&self.partial);
        }
        // Its file stands in what may be a new folder.
        self.lock = None;
        for parent in &self.new_parents {
            // Removes empty folders only, so nothing another program put there is lost.
            let _ = fs::remove_dir(parent);
        }
    }
}

//! Folders of results: that of a run, made beside its place and put there when it is whole; that of a sweep, which stays between calls.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::lock::{Lock, Share};
use super::marker::{InputOf, MARKER, Marker, OLD, PARTIAL, RunKind, parent_of, temporary_beside, visible_beside};
use super::pending::{self, Pending};
use super::place::{Room, folder_for, occupied, room};
use super::{said, write_file};
use perilife_base::error::{Error, Result};
use perilife_base::input::Provenance;

/// An output folder in the making. Until [`OutputFolder::finish`] it stands under a temporary name; dropped before that (an error, a
/// panic) it leaves nothing behind.
#[derive(Debug)]
pub struct OutputFolder {
    /// As given by the user.
    name: PathBuf,
    target: PathBuf,
    kind: RunKind,
    input: Option<InputOf>,
    partial: PathBuf,
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
    pub fn adopt(&self, run: &str) -> Result<()> {
        let Some(mut marker) = Marker::read(&self.target) else { return Ok(()) };
        marker.files.insert(format!("{run}/"));
        write_file(&self.target.join(MARKER), marker.text().as_bytes())
    }
}

impl OutputFolder {
    /// Claims `path` for a run that read nothing and writes little.
    pub fn create(path: &Path, kind: RunKind) -> Result<OutputFolder> {
        Self::claim(path, kind, &Provenance::default(), Room::default(), false)
    }

    /// Claims `path` for a run of this kind, before anything is computed. It may be new, empty, or the result of an earlier run of that
    /// kind, which stays until [`OutputFolder::finish`]; one of another input only by `force`. What processes left there that were killed goes.
    /// Errors: [`Error::Input`] if the path is a file, a mount point, holds anything this program did not make, results of
    /// another kind, of another input, or an input of this run, or if another process writes there; [`Error::File`] if it cannot be written or has
    /// no room.
    pub fn claim(path: &Path, kind: RunKind, read: &Provenance, wanted: Room, force: bool) -> Result<OutputFolder> {
        let cannot = |e| Error::file(path, "cannot create the folder", e);
        let target = folder_for(path, kind, read)?;
        let input = InputOf::of(read);
        if let Some(other) =
            Marker::read(&target).filter(|_| !force).and_then(|marker| Some(marker.other_input(input.as_ref())?.to_owned()))
        {
            let (problem, remedy) =
                (format!("holds {} of another input, {other}", kind.words()), "give another folder, or --force to replace it");
            return Err(perilife_base::error::input("--out", path.display(), problem, remedy));
        }
        let parent = parent_of(&target);
        let is_new = |above: &&Path| !above.as_os_str().is_empty() && !above.exists();
        let new_parents: Vec<PathBuf> = parent.ancestors().take_while(is_new).map(PathBuf::from).collect();
        let in_the_making = new_parents.iter().rev().map(|above| Pending::empty(above)).collect();
        // From here on the value itself tidies up, whatever fails.
        let mut folder = OutputFolder {
            name: path.to_path_buf(),
            kind,
            input,
            partial: PathBuf::new(),
            target,
            new_parents,
            warning: None,
            is_finished: false,
            _in_the_making: in_the_making,
            lock: None,
        };
        fs::create_dir_all(&parent).map_err(cannot)?;
        folder.lock = Some(Lock::of("--out", path, "cannot create the folder", &folder.target, Share::Alone)?);
        // It may have changed while it was not locked.
        folder_for(path, kind, read)?;
        folder.partial = temporary_beside(&folder.target, PARTIAL);
        let (pending, ()) = Pending::tree_by(&folder.partial, || fs::create_dir(&folder.partial)).map_err(cannot)?;
        folder._in_the_making.push(pending);
        let marker = Marker::listing(kind, &[]);
        fs::write(folder.partial.join(MARKER), marker.text())
            .map_err(|e| Error::file(path, "cannot write into the folder", e))?;
        folder.warning = room(path, &parent, wanted)?;
        Ok(folder)
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

    /// Writes these files by their names, and finishes.
    /// Errors: files that cannot be written.
    pub fn write(mut self, files: &[(&str, &str)]) -> Result<()> {
        self.fill(|path| files.iter().try_for_each(|(name, text)| write_file(&path.join(name), text.as_bytes())))?;
        self.finish().map(drop)
    }

    /// Has the files of the run written. If that fails, what there is stays under a visible name.
    pub fn fill<T>(&mut self, write: impl FnOnce(&Path) -> Result<T>) -> Result<T> {
        let error = match write(&self.partial) {
            Ok(done) => return Ok(done),
            Err(error) => error,
        };
        // More than its marker: tables that hold something.
        let size = |file: &String| fs::metadata(self.partial.join(file)).map_or(0, |there| there.len());
        if !Marker::of(RunKind::Predict, &self.partial).is_ok_and(|marker| marker.files.iter().any(|file| size(file) > 0)) {
            return Err(error);
        }
        Err(match self.show() {
            Ok(visible) => said(error, &format!("what there is stands in {}", visible.display())),
            Err(trouble) => said(error, &format!("what there is cannot be kept: {trouble}")),
        })
    }

    /// Puts the folder in its place; the files of an earlier run go, and nothing else.
    /// Errors: [`Error::File`] if it cannot be put there, or if something has appeared there meanwhile: that stays, and the
    /// results get a visible name, which the message says.
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
        let marker = Marker { input: self.input.clone(), ..Marker::of(self.kind, &self.partial)? };
        fs::write(self.partial.join(MARKER), marker.text())
    }

    /// Asks again what stands at the target, on the folder as it is now, and takes its place, from which the files of an earlier run
    /// go. What appears there in the last moment stays.
    fn put(&self) -> std::result::Result<(), String> {
        let words = |error: io::Error| error.to_string();
        let (partial, target) = (&self.partial, &self.target);
        if let Some((problem, _)) = occupied(target, self.kind).map_err(words)? {
            return Err(format!("it {problem}, and that stays"));
        }
        if fs::symlink_metadata(target).is_err() {
            return fs::rename(partial, target).map_err(words);
        }
        let old = temporary_beside(target, OLD);
        fs::rename(target, &old).map_err(words)?;
        if let Err(error) = fs::rename(partial, target) {
            // The earlier result goes back; should that fail as well, it still stands under its temporary name.
            let _ = fs::rename(&old, target);
            return Err(words(error));
        }
        if let Some(marker) = Marker::read(&old) {
            let _ = marker.remove_from(&old);
        }
        if fs::remove_dir(&old).is_err() && old.exists() {
            let visible = visible_beside(target);
            let _ = fs::rename(&old, &visible);
            tracing::warn!("what appeared in {} in the last moment stands in {}", target.display(), visible.display());
        }
        Ok(())
    }

    /// Gives what was written a visible name.
    fn show(&mut self) -> io::Result<PathBuf> {
        let _ = self.list();
        let visible = visible_beside(&self.target);
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

/// The folder of a sweep, filled run by run; locked while this lives.
#[derive(Debug)]
pub struct StandingFolder {
    target: PathBuf,
    _lock: Lock,
}

impl StandingFolder {
    /// Opens the folder of an earlier call, or makes one with `marker` and these files.
    pub fn open(path: &Path, marker: &Marker, read: &Provenance, share: Share, first: &[(&str, Vec<u8>)]) -> Result<Self> {
        let action = "cannot create the folder";
        let target = folder_for(path, marker.kind, read)?;
        fs::create_dir_all(parent_of(&target)).map_err(|error| Error::file(path, action, error))?;
        let lock = Lock::of("--out", path, action, &target, share)?;
        if !target.join(MARKER).is_file() {
            begin(path, &target, marker, first)?;
        }
        // It may have changed while it was not locked.
        folder_for(path, marker.kind, read)?;
        Ok(StandingFolder { target, _lock: lock })
    }

    /// Takes part in a folder that is there.
    pub fn join(path: &Path) -> Result<Self> {
        let action = "cannot use this folder";
        let target = fs::canonicalize(path).map_err(|error| Error::file(path, action, error))?;
        let lock = Lock::of("DIR", path, action, &target, Share::Parts)?;
        Ok(StandingFolder { target, _lock: lock })
    }

    pub fn path(&self) -> &Path {
        &self.target
    }
}

/// Makes the folder of a sweep, whole from the first moment on.
fn begin(name: &Path, target: &Path, marker: &Marker, first: &[(&str, Vec<u8>)]) -> Result<()> {
    let cannot = |error| Error::file(name, "cannot create the folder", error);
    let fill = |folder: &Path| -> Result<()> {
        first.iter().try_for_each(|(file, content)| write_file(&folder.join(file), content))?;
        write_file(&folder.join(MARKER), marker.text().as_bytes())
    };
    if target.is_dir() {
        return fill(target);
    }
    let partial = temporary_beside(target, PARTIAL);
    let (_pending, ()) = Pending::tree_by(&partial, || fs::create_dir(&partial)).map_err(cannot)?;
    let done = fill(&partial).and_then(|()| match fs::rename(&partial, target) {
        // Another part was first.
        Err(error) if matches!(error.kind(), io::ErrorKind::DirectoryNotEmpty | io::ErrorKind::AlreadyExists) => Ok(()),
        renamed => renamed.map_err(cannot),
    });
    let _ = fs::remove_dir_all(&partial);
    done
}

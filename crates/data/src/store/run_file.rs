//! The results file of a run that writes down each portion when it has ended.

use super::journal::{self, Journal, Kind, MAGIC};
use super::{Earlier, Results, StoreError, Writer, share, write};
use std::path::Path;

/// A reserved place for the results of a run, and the journal of the run beside it: the file with the ending `.partial`.
#[derive(Debug)]
pub struct RunFile {
    writer: Writer,
    scene_text: String,
}

impl RunFile {
    /// Reserves `path` for results of the scene `scene_text`, as [`Writer::create`]; with the journal of an earlier run where
    /// that is to be gone on with. What is torn off at its end is taken away.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn create(
        path: &Path,
        scene_text: &str,
        earlier: Earlier,
    ) -> Result<(Self, Option<Journal>), StoreError> {
        let mut writer = Writer::reserve(path, scene_text, earlier)?;
        let mut known = None;
        if earlier == Earlier::GoneOnWith && journal::is_at(writer.partial()) {
            let bytes = writer.contents()?;
            let read = Journal::read(bytes);
            let spoilt = |why| StoreError::Journal { path: writer.partial().to_path_buf(), why };
            let read = read.map_err(spoilt)?;
            writer.cut(read.sound())?;
            known = Some(read);
        }
        Ok((Self { writer, scene_text: scene_text.to_owned() }, known))
    }

    /// Begins the journal anew.
    ///
    /// # Errors
    /// What the disk says.
    pub fn begin(&mut self, header: &str) -> Result<(), StoreError> {
        self.writer.cut(0)?;
        let mut bytes = MAGIC.to_vec();
        bytes.extend(self.record(Kind::Header, header.as_bytes())?);
        self.writer.append(&bytes, false)
    }

    /// Appends a record: it outlasts the program at once, and a power cut a second later.
    ///
    /// # Errors
    /// What the disk says; then nothing of it was kept.
    pub fn append(&mut self, kind: Kind, own: &[u8]) -> Result<(), StoreError> {
        let bytes = self.record(kind, own)?;
        self.writer.append(&bytes, true)
    }

    fn record(&self, kind: Kind, own: &[u8]) -> Result<Vec<u8>, StoreError> {
        let long = || StoreError::inconsistent("a portion is too long for a record");
        journal::written(kind, own).ok_or_else(long)
    }

    /// Puts the results in place and takes the journal away.
    ///
    /// # Errors
    /// See [`StoreError`]; then the journal stays.
    pub fn finish(self, results: &Results) -> Result<(), StoreError> {
        let image = write::image(results, &self.scene_text, self.writer.partial())?;
        self.writer.finish_beside(&[image.bytes()])
    }

    /// Puts a file that holds the journal itself in place: that of a share of a run. `title` is what it says of itself.
    ///
    /// # Errors
    /// See [`StoreError`]; then the journal stays.
    pub fn finish_share(mut self, title: &str) -> Result<(), StoreError> {
        let journal = self.writer.contents()?;
        let image = share::image(&journal, title, &self.scene_text, self.writer.partial())?;
        let image = image.bytes();
        self.writer.finish_beside(&[image, &share::seal(image)])
    }

    /// Where the journal is.
    pub fn partial(&self) -> &Path {
        self.writer.partial()
    }

    /// The folder that was made for the file, if one had to be.
    pub fn made_folder(&self) -> Option<&Path> {
        self.writer.made_folder()
    }
}

//! The results file of a run that writes down each portion when it has ended.

use super::bytes::Bytes;
use super::hdf5_image::Hdf5Image;
use super::journal::{self, Journal, MAGIC, RecordKind};
use super::{ExistingFile, Results, StoreError, Writer, share, write};
use std::fs::File;
use std::ops::Range;
use std::path::Path;

/// A reserved place for the results of a run, and the journal of the run beside it: the file with the ending `.partial`.
#[derive(Debug)]
pub struct RunFile {
    writer: Writer,
    scene_text: String,
    /// The journal to be read from: the writer moves about in its own.
    journal: Bytes,
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
        earlier: ExistingFile,
    ) -> Result<(Self, Option<Journal>), StoreError> {
        let mut writer = Writer::reserve(path, scene_text, earlier)?;
        let mut known = None;
        if earlier == ExistingFile::GoneOnWith && journal::is_at(writer.partial()) {
            let read = journal::open(writer.partial())?;
            writer.cut(read.sound())?;
            known = Some(read);
        }
        let journal =
            File::open(writer.partial()).map_err(|e| StoreError::io(writer.partial(), "read", e))?;
        let journal = Bytes::of_file(journal);
        Ok((Self { writer, scene_text: scene_text.to_owned(), journal }, known))
    }

    /// Begins the journal anew.
    ///
    /// # Errors
    /// What the disk says.
    pub fn begin(&mut self, header: &str) -> Result<(), StoreError> {
        self.writer.cut(0)?;
        let (head, tail) = around(RecordKind::Header, header.as_bytes())?;
        self.writer.append(&[&MAGIC, &head, header.as_bytes(), &tail], false).map(|_| ())
    }

    /// Appends a record: it outlasts the program at once, and a power cut a second later. Gives where its bytes are.
    ///
    /// # Errors
    /// What the disk says; then nothing of it was kept.
    pub fn append(&mut self, kind: RecordKind, own: &[u8]) -> Result<Range<u64>, StoreError> {
        let (head, tail) = around(kind, own)?;
        let at = self.writer.append(&[&head, own, &tail], true)?;
        Ok(journal::own(at, own.len()))
    }

    /// Some of the bytes of a record that was appended, as they are now.
    ///
    /// # Errors
    /// They cannot be read, or are none of the record's.
    pub fn appended(&self, at: &Range<u64>, part: &Range<usize>) -> Result<Vec<u8>, StoreError> {
        let unread = |why| StoreError::Journal { path: self.partial().to_path_buf(), why };
        journal::read_part(&self.journal, at, part).map_err(unread)
    }

    /// Puts the results in place and takes the journal away.
    ///
    /// # Errors
    /// See [`StoreError`]; then the journal stays.
    pub fn finish(self, results: &Results) -> Result<(), StoreError> {
        let image = write::image(results, &self.scene_text, self.writer.partial())?;
        self.finish_image(&image)
    }

    /// The same of results that are laid out already.
    ///
    /// # Errors
    /// See [`StoreError`]; then the journal stays.
    pub fn finish_image(self, image: &Hdf5Image) -> Result<(), StoreError> {
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

/// See [`journal::around`].
fn around(kind: RecordKind, own: &[u8]) -> Result<([u8; journal::HEAD], [u8; journal::TAIL]), StoreError> {
    journal::around(kind, own).ok_or_else(|| StoreError::inconsistent("a portion is too long for a record"))
}

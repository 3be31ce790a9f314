//! Checks the part of a file that the HDF5 library trusts too much.
//!
//! Variable-length text lies in "global heap" collections, which carry no checksum. One spoilt size there
//! sends the library (1.10 to 2.0) into an endless loop, so the sizes are walked through before it sees them.
//! A collection is `GCOL`, version 1, three zero bytes and its size; then objects: number (2 bytes), uses (2),
//! zeros (4), size (8), and the bytes padded to a multiple of 8. Number 0 is free space up to the end, its
//! size with its own head.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};

const MARK: &[u8; 8] = b"GCOL\x01\0\0\0";
/// Bytes of the head of a collection, and of an object.
const HEAD: u64 = 16;
const BLOCK: usize = 1 << 20;

/// True if all collections of the file can be walked through.
pub(super) fn is_sound(file: &mut File) -> io::Result<bool> {
    let length = file.metadata()?.len();
    file.rewind()?;
    let (mut block, mut start, mut places) = (Vec::new(), 0u64, Vec::new());
    loop {
        let read = file.by_ref().take(BLOCK as u64).read_to_end(&mut block)?;
        let found = block.windows(MARK.len()).enumerate().filter(|(_, bytes)| bytes == MARK);
        places.extend(found.map(|(at, _)| start + at as u64));
        if read < BLOCK {
            break;
        }
        // A mark may lie across the end of a block.
        let gone = block.len() - (MARK.len() - 1);
        start += gone as u64;
        block.drain(..gone);
    }
    for place in places {
        if !walk(file, place, length)? {
            return Ok(false);
        }
    }
    Ok(true)
}

fn number(file: &mut File, at: u64) -> io::Result<u64> {
    let mut bytes = [0u8; 8];
    file.seek(SeekFrom::Start(at))?;
    file.read_exact(&mut bytes)?;
    Ok(u64::from_le_bytes(bytes))
}

/// Walks through the collection at `place`, as the library will.
fn walk(file: &mut File, place: u64, length: u64) -> io::Result<bool> {
    if length - place < HEAD {
        return Ok(false);
    }
    let end = match place.checked_add(number(file, place + 8)?) {
        Some(end) if end <= length => end,
        _ => return Ok(false),
    };
    let mut at = place + HEAD;
    while at + HEAD <= end {
        // Number, uses and zeros in one.
        let object = number(file, at)? & 0xffff;
        let size = number(file, at + 8)?;
        let whole = match object {
            0 => size,
            _ => match size.checked_next_multiple_of(8) {
                Some(padded) => padded.saturating_add(HEAD),
                None => return Ok(false),
            },
        };
        if whole < HEAD || whole > end - at {
            return Ok(false);
        }
        at += whole;
    }
    Ok(true)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    /// A file of this many zeros, then a collection with one object that claims `size` bytes.
    fn file(before: usize, size: u64) -> File {
        let mut file = tempfile::tempfile().unwrap();
        file.write_all(&vec![0; before]).unwrap();
        file.write_all(MARK).unwrap();
        for word in [64, 1, size, 7, 0, 64 - 40] {
            file.write_all(&u64::to_le_bytes(word)).unwrap();
        }
        file.write_all(&[0; 64]).unwrap();
        file
    }

    #[test]
    fn sizes_are_checked_wherever_the_collection_lies() {
        for before in [0, 1, 100, BLOCK - 9, BLOCK - 3, BLOCK, BLOCK + 4, 2 * BLOCK + 5] {
            assert!(is_sound(&mut file(before, 8)).unwrap(), "{before}");
            for size in [u64::MAX, u64::MAX - 15, u64::MAX - 31, 1 << 63, 60] {
                assert!(!is_sound(&mut file(before, size)).unwrap(), "{before} {size}");
            }
        }
        assert!(is_sound(&mut tempfile::tempfile().unwrap()).unwrap());
    }
}

//! Chunks of numbers, packed as the library's filters would pack them (shuffle, deflate, Fletcher-32), many at once.
//!
//! Most bytes of measured numbers are noise, on which deflate spends most of its time in vain. Once the bytes of a chunk are
//! shuffled, those of one place lie together, and a few of them tell whether they become fewer; if not they are stored as they
//! are, which deflate allows for.

use hdf5::types::TypeDescriptor;
use hdf5::{Dataset, H5Type};
use rayon::prelude::*;
use zlib_rs::{Deflate, DeflateFlush};

/// How hard deflate looks for what it has seen before.
const LEVEL: i32 = 2;
/// Bytes that are tried, and the share of them that has to be left for the others to be stored as they are.
const TRIED: usize = 4096;
const NOISE: f64 = 0.98;
/// Chunks of each thread that are packed before they are written.
const EACH: usize = 2;

/// Whether numbers of this type can be packed here.
pub(super) fn is_number<T: H5Type>() -> bool {
    use TypeDescriptor::{Float, Integer, Unsigned};
    matches!(T::type_descriptor(), Integer(_) | Unsigned(_) | Float(_)) && cfg!(target_endian = "little")
}

/// Fills a dataset of this shape, which is cut into chunks along its rows and has the three filters, with numbers.
pub(super) fn write<T: H5Type>(
    dataset: &Dataset,
    (shape, chunk): (&[usize], &[usize]),
    data: &[T],
) -> hdf5::Result<()> {
    // SAFETY: numbers have no bytes that are not theirs, and any byte may be read.
    let bytes = unsafe { std::slice::from_raw_parts(data.as_ptr().cast::<u8>(), size_of_val(data)) };
    let width = size_of::<T>();
    let whole = width * chunk.iter().product::<usize>();
    // Before the dimension that chunks are cut along, they are one place wide.
    let cut = chunk.iter().position(|places| *places > 1).unwrap_or(0);
    let stretch = width * shape[cut..].iter().product::<usize>();
    let stretches = bytes.chunks(stretch).enumerate();
    let pieces: Vec<(usize, &[u8])> = stretches
        .flat_map(|(n, all)| {
            all.chunks(whole).enumerate().map(move |(c, piece)| ((n * stretch + c * whole) / width, piece))
        })
        .collect();
    for some in pieces.chunks(EACH * rayon::current_num_threads()) {
        let pack = |packer: &mut Packer, (_, piece): &(usize, &[u8])| packer.packed(piece, (width, whole));
        let packed: Vec<Vec<u8>> = some.par_iter().map_init(Packer::new, pack).collect();
        some.iter()
            .zip(packed)
            .try_for_each(|((first, _), one)| put(dataset, &place(*first, shape), &one))?;
    }
    Ok(())
}

/// Where the number that is so many numbers behind the first one stands.
fn place(number: usize, shape: &[usize]) -> Vec<u64> {
    let (mut left, mut place) = (number, vec![0; shape.len()]);
    for (at, length) in place.iter_mut().zip(shape).rev() {
        (*at, left) = ((left % length) as u64, left / length);
    }
    place
}

/// Writes a packed chunk that begins there.
fn put(dataset: &Dataset, place: &[u64], packed: &[u8]) -> hdf5::Result<()> {
    let _lock = hdf5_sys::LOCK.lock();
    // SAFETY: the lock is held, the dataset is open, its place has as many numbers as it has dimensions, and the bytes are
    // as many as is told.
    let written = unsafe {
        let own = hdf5_sys::h5p::H5P_DEFAULT;
        hdf5_sys::h5d::H5Dwrite_chunk(
            dataset.id(),
            own,
            0,
            place.as_ptr(),
            packed.len(),
            packed.as_ptr().cast(),
        )
    };
    if written < 0 { Err("a chunk could not be written".into()) } else { Ok(()) }
}

/// What packs chunk after chunk.
struct Packer {
    deflate: Deflate,
    shuffled: Vec<u8>,
    room: Vec<u8>,
}

impl Packer {
    fn new() -> Self {
        Self { deflate: Deflate::new(LEVEL, false, 15), shuffled: Vec::new(), room: Vec::new() }
    }

    /// Numbers of so many bytes each as the bytes of a chunk, which has room for `whole` of them; what is missing are zeros.
    fn packed(&mut self, numbers: &[u8], (width, whole): (usize, usize)) -> Vec<u8> {
        let mut shuffled = std::mem::take(&mut self.shuffled);
        shuffled.clear();
        shuffled.resize(whole, 0);
        let length = whole / width;
        for (n, plane) in shuffled.chunks_exact_mut(length).enumerate() {
            let bytes = numbers[n..].iter().step_by(width);
            plane.iter_mut().zip(bytes).for_each(|(place, byte)| *place = *byte);
        }
        // The head of a zlib stream whose window is the largest.
        let mut packed = vec![0x78, 0x01];
        shuffled.chunks(length).for_each(|plane| self.append(plane, &mut packed));
        // An empty block that is the last one.
        packed.extend([1, 0, 0, 0xff, 0xff]);
        packed.extend(zlib_rs::adler32::adler32(1, &shuffled).to_be_bytes());
        packed.extend(fletcher32(&packed).to_le_bytes());
        self.shuffled = shuffled;
        packed
    }

    /// Appends bytes as blocks of a deflated stream, which end with a whole byte.
    fn append(&mut self, plane: &[u8], packed: &mut Vec<u8>) {
        let tried = &plane[plane.len() / 2..][..TRIED.min(plane.len() / 4)];
        let is_noise = |left: usize| left as f64 > NOISE * tried.len() as f64;
        if !tried.is_empty() && self.deflated(tried).is_none_or(|left| is_noise(left.len())) {
            return stored(plane, packed);
        }
        match self.deflated(plane) {
            Some(deflated) => packed.extend(deflated),
            None => stored(plane, packed),
        }
    }

    /// Bytes deflated by themselves; none where they would become more.
    fn deflated(&mut self, bytes: &[u8]) -> Option<&[u8]> {
        self.deflate.reset();
        self.room.resize(bytes.len().max(64), 0);
        self.deflate.compress(bytes, &mut self.room, DeflateFlush::SyncFlush).ok()?;
        let (taken, given) = (self.deflate.total_in() as usize, self.deflate.total_out() as usize);
        // Where there is no room left, something may be missing.
        (taken == bytes.len() && given < self.room.len()).then(|| &self.room[..given])
    }
}

/// Appends bytes as they are: blocks with their lengths, twice.
fn stored(bytes: &[u8], packed: &mut Vec<u8>) {
    for block in bytes.chunks(usize::from(u16::MAX)) {
        let length = block.len() as u16;
        packed.push(0);
        packed.extend(length.to_le_bytes());
        packed.extend((!length).to_le_bytes());
        packed.extend(block);
    }
}

/// The checksum of Fletcher (IEEE Trans. Commun. 30 (1982) 247) over words of 16 bits, the higher byte first, as HDF5 has it.
fn fletcher32(bytes: &[u8]) -> u32 {
    /// Words whose sums have room before they are folded.
    const FOLDED: usize = 360;
    let fold = |sum: u32| (sum & 0xffff) + (sum >> 16);
    let (mut first, mut second) = (0u32, 0u32);
    for some in bytes.chunks(2 * FOLDED) {
        for word in some.chunks(2) {
            first += u32::from(word[0]) << 8 | word.get(1).map_or(0, |low| u32::from(*low));
            second += first;
        }
        (first, second) = (fold(first), fold(second));
    }
    fold(second) << 16 | fold(first)
}

#[cfg(test)]
mod tests {
    use super::super::super::hdf5_image::in_memory;
    use super::super::chunk_shape::chunk;
    use super::*;

    /// Numbers of all kinds: noise, repetitions, one number, few of them.
    fn numbers(count: usize) -> Vec<f64> {
        let noise = |n: usize| f64::from_bits((n as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 2);
        let one = |n: usize| match n * 8 / count.max(1) {
            0 | 1 => noise(n),
            2 | 3 => 1.0 + (n % 100) as f64,
            4 | 5 => f64::NAN,
            _ => 1e-9 * n as f64,
        };
        (0..count).map(one).collect()
    }

    /// The library reads what was packed here, whatever the shape, and finds the same as in what it has packed itself.
    #[test]
    fn the_library_reads_what_was_packed() {
        if !hdf5::filters::deflate_available() {
            return;
        }
        for shape in
            [&[600][..], &[65_536], &[200_001], &[3, 50_000], &[2, 70_000, 2], &[400, 300, 10], &[5, 1, 9000]]
        {
            let file = in_memory().expect("there is memory");
            let all = numbers(shape.iter().product());
            let made = |name: &str| {
                let builder = file.new_dataset::<f64>().shape(shape.to_vec()).chunk(chunk(shape));
                builder.shuffle().deflate(1).fletcher32().create(name).expect("it can be made")
            };
            let (ours, theirs) = (made("ours"), made("theirs"));
            write(&ours, (shape, &chunk(shape)), &all).expect("there is memory");
            theirs.write_raw(&all).expect("there is memory");
            let bits = |dataset: &Dataset| -> Vec<u64> {
                dataset.read_raw::<f64>().expect("it is sound").into_iter().map(f64::to_bits).collect()
            };
            assert_eq!(bits(&ours), bits(&theirs), "{shape:?}");
            assert!(ours.storage_size() as f64 <= 1.1 * theirs.storage_size() as f64 + 100.0, "{shape:?}");
            assert_eq!(ours.num_chunks(), theirs.num_chunks(), "{shape:?}");
        }
    }

    /// Types of every width.
    #[test]
    fn codes_are_packed_as_well() {
        let file = in_memory().expect("there is memory");
        let codes: Vec<u8> = (0..150_000u32).map(|n| (n / 7 % 5) as u8).collect();
        let builder = file.new_dataset::<u8>().shape([codes.len()]).chunk([65_536]);
        let dataset = builder.shuffle().deflate(1).fletcher32().create("codes").expect("it can be made");
        write(&dataset, (&[codes.len()], &[65_536]), &codes).expect("there is memory");
        assert_eq!(dataset.read_raw::<u8>().expect("it is sound"), codes);
    }

    #[test]
    fn places_count_through_the_last_dimension_first() {
        assert_eq!(place(0, &[4, 5]), [0, 0]);
        assert_eq!(place(13, &[4, 5]), [2, 3]);
    }
}

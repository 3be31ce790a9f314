//! Texts between a page and this library, over plain memory.

/// Room for a text of the page, which [`run`] takes back.
#[unsafe(no_mangle)]
pub extern "C" fn room(length: usize) -> *mut u8 {
    Box::into_raw(vec![0u8; length].into_boxed_slice()).cast()
}

/// Runs the scene whose text the page has put into its room. The answer begins with its length in bytes (u32, little-endian);
/// [`give_back`] frees it.
///
/// # Safety
/// `text` is what `room(length)` gave, and is given once.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn run(text: *mut u8, length: usize) -> *mut u8 {
    // SAFETY: as above.
    let text = unsafe { Box::from_raw(std::ptr::slice_from_raw_parts_mut(text, length)) };
    let told = super::answer(&String::from_utf8_lossy(&text));
    let mut answer = Vec::with_capacity(4 + told.len());
    answer.extend((told.len() as u32).to_le_bytes());
    answer.extend(told.as_bytes());
    Box::into_raw(answer.into_boxed_slice()).cast()
}

/// Frees an answer.
///
/// # Safety
/// `answer` is what [`run`] gave, and is given back once.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn give_back(answer: *mut u8) {
    // SAFETY: as above.
    unsafe {
        let length = 4 + answer.cast::<u32>().read_unaligned() as usize;
        drop(Box::from_raw(std::ptr::slice_from_raw_parts_mut(answer, length)));
    }
}

//! The heap: one array, from which memory is taken and never given back.

use core::alloc::{GlobalAlloc, Layout};
use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicUsize, Ordering};

/// Its size in bytes.
const SIZE: usize = 1 << 20;

/// The heap and what was taken of it.
struct Heap {
    memory: UnsafeCell<[u8; SIZE]>,
    taken: AtomicUsize,
    asked: AtomicUsize,
}

#[global_allocator]
static HEAP: Heap = Heap { memory: UnsafeCell::new([0; SIZE]), taken: AtomicUsize::new(0), asked: AtomicUsize::new(0) };

/// How often memory was asked for.
pub fn asked() -> usize {
    HEAP.asked.load(Ordering::Relaxed)
}

// SAFETY: no two threads write the same bytes, since each piece of the array is handed out once.
unsafe impl Sync for Heap {}

// SAFETY: each piece that is handed out lies in the array, is aligned as asked, and overlaps no other.
unsafe impl GlobalAlloc for Heap {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        self.asked.fetch_add(1, Ordering::Relaxed);
        let base = self.memory.get().cast::<u8>();
        let mut taken = self.taken.load(Ordering::Relaxed);
        loop {
            let gap = (base as usize + taken).wrapping_neg() % layout.align();
            let Some(end) = taken.checked_add(gap).and_then(|from| from.checked_add(layout.size())) else {
                return core::ptr::null_mut();
            };
            if end > SIZE {
                return core::ptr::null_mut();
            }
            match self.taken.compare_exchange(taken, end, Ordering::Relaxed, Ordering::Relaxed) {
                Ok(_) => return base.wrapping_add(taken + gap),
                Err(now) => taken = now,
            }
        }
    }

    unsafe fn dealloc(&self, _: *mut u8, _: Layout) {}
}

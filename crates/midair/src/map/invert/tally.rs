//! Counting the rays that an inversion traces.

use std::cell::Cell;

thread_local! {
    static RAYS: Cell<u64> = const { Cell::new(0) };
}

/// One more ray on this thread.
pub(super) fn count_ray() {
    RAYS.set(RAYS.get().wrapping_add(1));
}

/// What `work` returns, with the rays that it traced. It must stay on its thread: no parallel iterator within.
pub(super) fn counted<T>(work: impl FnOnce() -> T) -> (T, u64) {
    let before = RAYS.get();
    let made = work();
    (made, RAYS.get().wrapping_sub(before))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_works_own_rays_are_counted() {
        count_ray();
        let (made, rays) = counted(|| {
            (0..7).for_each(|_| count_ray());
            "made"
        });
        assert_eq!((made, rays), ("made", 7));
    }
}

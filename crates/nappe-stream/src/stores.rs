//! The stores themselves, for each instruction set.

use crate::LINE;
#[cfg(target_arch = "x86_64")]
use pulp::{
    bytemuck::cast,
    x86::{V3, V4},
};

/// Instructions that parts of lines are written with. A value proves that the machine has them: [`Base`] is everywhere, the
/// others are the tokens of `pulp`.
pub trait Stores<A>: sealed::Store<A> {}

impl<A, S: sealed::Store<A>> Stores<A> for S {}

/// What every machine of the target has.
#[derive(Clone, Copy, Debug)]
pub struct Base;

/// So many numbers that a line of the cache is divided into: an array of one, four or eight.
pub trait Part: sealed::Part {}

impl<A: sealed::Part> Part for A {}

mod sealed {
    #[allow(
        unsafe_code,
        reason = "streaming stores are not to be had in any other way"
    )]
    pub trait Store<A>: Copy {
        /// Writes a part of a line without reading the line first.
        ///
        /// # Safety
        ///
        /// `to` starts at a multiple of its size, and there is a fence before the places are reached in any other way, on
        /// the same thread.
        unsafe fn store(self, to: &mut A, from: A);
    }

    pub trait Part: Copy {
        /// All whole parts of a slice.
        fn parts(x: &mut [f64]) -> &mut [Self];
    }
}

macro_rules! part {
    ($n:literal) => {
        impl sealed::Part for [f64; $n] {
            #[inline(always)]
            fn parts(x: &mut [f64]) -> &mut [Self] {
                const { assert!(LINE.is_multiple_of($n)) };
                x.as_chunks_mut().0
            }
        }
    };
}

part!(1);
part!(4);
part!(8);

/// A single number is stored plainly: nothing large is written in this way.
#[allow(unsafe_code, reason = "as the trait")]
impl sealed::Store<[f64; 1]> for Base {
    #[inline(always)]
    unsafe fn store(self, to: &mut [f64; 1], from: [f64; 1]) {
        *to = from;
    }
}

#[allow(unsafe_code, reason = "as the trait")]
impl sealed::Store<[f64; 4]> for Base {
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    unsafe fn store(self, to: &mut [f64; 4], from: [f64; 4]) {
        use std::arch::x86_64::{_mm_set_pd, _mm_stream_pd};
        let (to, from) = (to.as_chunks_mut::<2>().0, from.as_chunks::<2>().0);
        for (to, from) in to.iter_mut().zip(from) {
            // SAFETY: both instructions are part of the base of x86-64. `to` is an array of two numbers that is borrowed
            // exclusively, so there are 16 bytes to write, and it starts at a multiple of 16: the part starts at one of 32,
            // and pairs are 16 bytes apart. The caller sees to the fence.
            unsafe { _mm_stream_pd(to.as_mut_ptr(), _mm_set_pd(from[1], from[0])) };
        }
    }

    /// Elsewhere this is plain copying.
    #[cfg(not(target_arch = "x86_64"))]
    #[inline(always)]
    unsafe fn store(self, to: &mut [f64; 4], from: [f64; 4]) {
        *to = from;
    }
}

#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code, reason = "as the trait")]
impl sealed::Store<[f64; 4]> for V3 {
    #[inline(always)]
    unsafe fn store(self, to: &mut [f64; 4], from: [f64; 4]) {
        // SAFETY: the token proves that there is AVX. `to` is borrowed exclusively, has 32 bytes to write and starts at a
        // multiple of 32. The caller sees to the fence.
        unsafe { self.avx._mm256_stream_pd(to.as_mut_ptr(), cast(from)) };
    }
}

#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code, reason = "as the trait")]
impl sealed::Store<[f64; 8]> for V4 {
    #[inline(always)]
    unsafe fn store(self, to: &mut [f64; 8], from: [f64; 8]) {
        // SAFETY: the token proves that there is AVX-512. `to` is borrowed exclusively, has 64 bytes to write and starts at
        // a multiple of 64. The caller sees to the fence.
        unsafe { self.avx512f._mm512_stream_pd(to.as_mut_ptr(), cast(from)) };
    }
}

/// Has the address of a place translated, while other things go on: stores that come soon find it. A processor runs less
/// than a page ahead of its stores, so it would wait at the beginning of each page.
#[allow(unsafe_code, reason = "the instruction takes any pointer")]
#[inline(always)]
pub(crate) fn find(place: &f64) {
    // SAFETY: the instruction is part of the base of x86-64, and changes nothing that a program can see.
    #[cfg(target_arch = "x86_64")]
    unsafe {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        _mm_prefetch::<_MM_HINT_T0>(std::ptr::from_ref(place).cast());
    }
}

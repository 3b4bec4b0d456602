/// EIKONAL_CLONES compiles a function twice, for baseline x86-64 and for x86-64-v3 (AVX2). The loader picks the
/// version.
///
/// Both versions return the same bits. The project is built with -ffp-contract=off, so neither version fuses a
/// multiplication with an addition. A function with this attribute may use only + - * / sqrt, conversions and integer
/// operations, in a fixed order. It must not call libm, and it must not contain a sum that the compiler may reorder.
/// tests/noise/math/portable_math_test.cpp and the program tests under an emulated old processor check the guarantee.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(EIKONAL_SANITIZED)
#define EIKONAL_CLONES __attribute__((target_clones("default", "arch=x86-64-v3")))
#else
#define EIKONAL_CLONES
#endif

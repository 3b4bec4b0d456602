/// EIKONAL_CLONES compiles a function twice, for baseline x86-64 and for x86-64-v3 (AVX2), and picks at load time.
///
/// Guarantee: both versions return the same bits. The project is built with -ffp-contract=off, so neither fuses a
/// multiplication with an addition, and such functions use only + - * / sqrt, conversions and integer operations in
/// a fixed order (no reductions that the compiler may reorder, no calls into libm). tests/portable_math_test.cpp and
/// the program tests under an emulated old processor hold the guarantee to its word.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(EIKONAL_SANITIZED)
#define EIKONAL_CLONES __attribute__((target_clones("default", "arch=x86-64-v3")))
#else
#define EIKONAL_CLONES
#endif

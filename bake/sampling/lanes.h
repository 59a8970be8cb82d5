#pragma once
// Eight numbers at once, by the vectors of GCC and clang: without AVX these are two registers of four.
//
// All of it is inlined, so that files compiled for different instruction sets share nothing of it.
#include <cmath>
#include <cstdint>
#include <cstring>
#ifdef __AVX2__
#include <immintrin.h>
#endif

namespace apertura {

constexpr int kLanes = 8;
using Floats [[gnu::vector_size(sizeof(float) * kLanes)]] = float;
using Mask [[gnu::vector_size(sizeof(int32_t) * kLanes)]] = int32_t;  // -1 true, 0 false

#define APERTURA_INLINE [[gnu::always_inline]] inline

APERTURA_INLINE Floats load(const float* from) {
    Floats out;
    std::memcpy(&out, from, sizeof out);
    return out;
}
APERTURA_INLINE void store(float* to, const Floats& value) { std::memcpy(to, &value, sizeof value); }
APERTURA_INLINE Floats all(float x) { return Floats{} + x; }
APERTURA_INLINE Floats larger(const Floats& a, const Floats& b) { return a > b ? a : b; }

APERTURA_INLINE Floats root(Floats x) {
    for (int l = 0; l < kLanes; ++l) x[l] = std::sqrt(x[l]);
    return x;
}

APERTURA_INLINE bool any(const Mask& mask) {
#ifdef __AVX2__
    return !_mm256_testz_si256(__m256i(mask), __m256i(mask));
#else
    int32_t either = 0;
    for (int l = 0; l < kLanes; ++l) either |= mask[l];
    return either != 0;
#endif
}

#undef APERTURA_INLINE

}  // namespace apertura

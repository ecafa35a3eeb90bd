#pragma once
// Batches of floats as wide as the code is compiled for: eight, or sixteen with AVX-512. Each lane is computed as a scalar would be, so
// both give the same bits.
#include "simd/lanes.hpp"
#ifdef __AVX512F__
#include <immintrin.h>
#endif

namespace masonry::simd {

#ifndef __AVX512F__

using Wide = Floats;

MASONRY_INLINE FloatPack quarterOf(const Wide& a, int quarter) { return quarter == 0 ? lowOf(a) : highOf(a); }

#else

using Wide = float __attribute__((vector_size(64)));
using WideMask = int __attribute__((vector_size(64)));
constexpr unsigned allWide = 0xffff;

MASONRY_INLINE unsigned bitsOf(const WideMask& mask) { return _mm512_movepi32_mask(__m512i(mask)); }
MASONRY_INLINE bool any(const WideMask& mask) { return bitsOf(mask) != 0; }
MASONRY_INLINE Wide root(const Wide& a) { return Wide(_mm512_sqrt_ps(__m512(a))); }
template <int quarter>
MASONRY_INLINE FloatPack quarterOf(const Wide& a)
{
	return FloatPack(_mm512_extractf32x4_ps(__m512(a), quarter));
}
MASONRY_INLINE FloatPack quarterOf(const Wide& a, int quarter)
{
	return quarter == 0 ? quarterOf<0>(a) : quarter == 1 ? quarterOf<1>(a) : quarter == 2 ? quarterOf<2>(a) : quarterOf<3>(a);
}

// Transposes each quarter by itself.
MASONRY_INLINE void transpose(Wide& a, Wide& b, Wide& c, Wide& d)
{
	const __m512 ab0 = _mm512_unpacklo_ps(__m512(a), __m512(b)), ab1 = _mm512_unpackhi_ps(__m512(a), __m512(b)),
	             cd0 = _mm512_unpacklo_ps(__m512(c), __m512(d)), cd1 = _mm512_unpackhi_ps(__m512(c), __m512(d));
	constexpr int low = 0x44, high = 0xee;
	a = Wide(_mm512_shuffle_ps(ab0, cd0, low));
	b = Wide(_mm512_shuffle_ps(ab0, cd0, high));
	c = Wide(_mm512_shuffle_ps(ab1, cd1, low));
	d = Wide(_mm512_shuffle_ps(ab1, cd1, high));
}
template <int>
MASONRY_INLINE void gather(const FloatPack* from, const unsigned* body, Wide& a, Wide& b, Wide& c, Wide& d)
{
	Wide* row[4] = {&a, &b, &c, &d};
	for (int i = 0; i < 4; ++i) {
		__m512 packs = _mm512_castps128_ps512(__m128(packAt(from, body[i])));
		packs = _mm512_insertf32x4(packs, __m128(packAt(from, body[i + 4])), 1);
		packs = _mm512_insertf32x4(packs, __m128(packAt(from, body[i + 8])), 2);
		*row[i] = Wide(_mm512_insertf32x4(packs, __m128(packAt(from, body[i + 12])), 3));
	}
	transpose(a, b, c, d);
}
template <int quarter>
MASONRY_INLINE void scatterQuarter(const Wide* row[4], FloatPack* to, const unsigned* body, unsigned free)
{
	for (int i = 0; i < 4; ++i)
		if (free == allWide || free >> (4 * quarter + i) & 1)
			const_cast<FloatPack&>(packAt(to, body[4 * quarter + i])) = quarterOf<quarter>(*row[i]);
}
template <int>
MASONRY_INLINE void scatter(Wide a, Wide b, Wide c, Wide d, FloatPack* to, const unsigned* body, unsigned free)
{
	transpose(a, b, c, d);
	const Wide* row[4] = {&a, &b, &c, &d};
	scatterQuarter<0>(row, to, body, free);
	scatterQuarter<1>(row, to, body, free);
	scatterQuarter<2>(row, to, body, free);
	scatterQuarter<3>(row, to, body, free);
}

#endif

constexpr int quartersOfWide = widthOf<Wide> / width; // groups of contacts in a batch

} // namespace masonry::simd

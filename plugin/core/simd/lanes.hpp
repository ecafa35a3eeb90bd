#pragma once
// Batches of numbers: four doubles (Lanes), or eight floats (Floats) where the next solve corrects the error. Each lane is computed as a
// scalar would be, so the bits do not depend on the vector width of the processor. Functions marked MASONRY_LANES are compiled for several
// widths, and the widest that the processor has is chosen when the program starts.

#include <cstddef>
#include <cstring>
#include <new>
#include <type_traits>
#include <vector>

#pragma GCC diagnostic ignored "-Wpsabi" // lanes are passed between inlined functions only

#ifdef __SANITIZE_ADDRESS__ // one version is enough for sanitizers, and compiles a minute faster
#define MASONRY_LANES
#else
#define MASONRY_LANES __attribute__((target_clones("arch=x86-64-v4", "avx2", "default")))
#endif
#define MASONRY_INLINE __attribute__((always_inline)) inline

namespace masonry::simd {

constexpr int width = 4;
using Lanes = double __attribute__((vector_size(32)));
using Mask = long __attribute__((vector_size(32))); // -1: true

constexpr int floatWidth = 8;
using Floats = float __attribute__((vector_size(32)));
using FloatMask = int __attribute__((vector_size(32)));

constexpr Lanes noMass {1, 1, 1, 0}; // times a pack: its components alone
// Code for wide vectors relies on this alignment and code for narrow ones does not demand it, so structures of lanes state it.
constexpr std::size_t alignment = 32;

template <class T>
struct AlignedAllocator {
	using value_type = T;
	AlignedAllocator() = default;
	template <class U>
	AlignedAllocator(const AlignedAllocator<U>&)
	{
	}
	T* allocate(std::size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), of)); }
	void deallocate(T* p, std::size_t) { ::operator delete(p, of); }
	bool operator==(const AlignedAllocator&) const { return true; }
	bool operator!=(const AlignedAllocator&) const { return false; }

private:
	static constexpr std::align_val_t of {alignof(T) > alignment ? alignof(T) : alignment};
};

template <class T>
using Array = std::vector<T, AlignedAllocator<T>>;
using LaneArray = Array<Lanes>;

MASONRY_INLINE Lanes all(double value) { return value - Lanes {}; }
// Chooses lane by lane. Structures of several vectors have overloads of their own.
template <class M, class L>
MASONRY_INLINE std::enable_if_t<!std::is_class_v<L>, L> select(const M& mask, const L& a, const L& b)
{
	return mask ? a : b;
}
template <class L>
MASONRY_INLINE L larger(const L& a, const L& b)
{
	return select(a > b, a, b);
}
template <class L>
MASONRY_INLINE L smaller(const L& a, const L& b)
{
	return select(a < b, a, b);
}
template <class L>
MASONRY_INLINE L size(const L& a)
{
	return select(a < 0, -a, a);
}
template <class L>
MASONRY_INLINE L length(const L& a)
{
	return size(a);
}
// A bit for each lane.
constexpr unsigned char allLanes = 15;
MASONRY_INLINE unsigned char bitsOf(const Mask& mask)
{
	const Mask bits = mask & Mask {1, 2, 4, 8};
	return (unsigned char)(bits[0] | bits[1] | bits[2] | bits[3]);
}
MASONRY_INLINE Mask maskOf(unsigned char bits) { return (Mask {bits, bits, bits, bits} & Mask {1, 2, 4, 8}) != 0; }

MASONRY_INLINE bool any(const Mask& mask) { return (mask[0] | mask[1] | mask[2] | mask[3]) != 0; }
MASONRY_INLINE Lanes root(const Lanes& a)
{
	return Lanes {__builtin_sqrt(a[0]), __builtin_sqrt(a[1]), __builtin_sqrt(a[2]), __builtin_sqrt(a[3])};
}
MASONRY_INLINE double largest(const Lanes& a)
{
	const double low = a[0] > a[1] ? a[0] : a[1], high = a[2] > a[3] ? a[2] : a[3];
	return low > high ? low : high;
}

MASONRY_INLINE void transpose(Lanes& a, Lanes& b, Lanes& c, Lanes& d)
{
	const Lanes ab0 = __builtin_shuffle(a, b, Mask {0, 4, 2, 6}), ab1 = __builtin_shuffle(a, b, Mask {1, 5, 3, 7});
	const Lanes cd0 = __builtin_shuffle(c, d, Mask {0, 4, 2, 6}), cd1 = __builtin_shuffle(c, d, Mask {1, 5, 3, 7});
	a = __builtin_shuffle(ab0, cd0, Mask {0, 1, 4, 5});
	b = __builtin_shuffle(ab1, cd1, Mask {0, 1, 4, 5});
	c = __builtin_shuffle(ab0, cd0, Mask {2, 3, 6, 7});
	d = __builtin_shuffle(ab1, cd1, Mask {2, 3, 6, 7});
}
// gather reads packs of bodies into one lane a body; scatter writes those of free bodies back. A body has `packs` packs.
template <int packs>
MASONRY_INLINE void gather(const Lanes* from, const int* body, Lanes& a, Lanes& b, Lanes& c, Lanes& d)
{
	a = from[packs * body[0]], b = from[packs * body[1]], c = from[packs * body[2]], d = from[packs * body[3]];
	transpose(a, b, c, d);
}
template <int packs>
MASONRY_INLINE void scatter(Lanes a, Lanes b, Lanes c, Lanes d, Lanes* to, const int* body, unsigned free)
{
	transpose(a, b, c, d);
	const Lanes* row[width] = {&a, &b, &c, &d};
	for (int i = 0; i < width; ++i)
		if (free == allLanes || free >> i & 1)
			to[packs * body[i]] = *row[i];
}

// Copies all numbers of one lane of a structure of lanes.
template <class T>
void copyLane(const T& from, int i, T& to, int j)
{
	static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % sizeof(Lanes) == 0);
	const auto* source = reinterpret_cast<const char*>(&from) + i * sizeof(double);
	auto* target = reinterpret_cast<char*>(&to) + j * sizeof(double);
	for (std::size_t at = 0; at < sizeof(T); at += sizeof(Lanes))
		std::memcpy(target + at, source + at, sizeof(double));
}

} // namespace masonry::simd

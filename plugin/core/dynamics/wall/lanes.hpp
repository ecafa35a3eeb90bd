#pragma once
// Four doubles side by side. Each lane is computed as a scalar would be, so that the bits do not depend on the vector width that the
// processor has; functions marked MASONRY_LANES are compiled for several and the widest is picked when the program starts.

#include <cstddef>
#include <cstring>
#include <new>
#include <type_traits>
#include <vector>

#pragma GCC diagnostic ignored "-Wpsabi" // lanes are passed between inlined functions only

#ifdef __SANITIZE_ADDRESS__ // checked once is enough, and takes a minute less to compile
#define MASONRY_LANES
#else
#define MASONRY_LANES __attribute__((target_clones("arch=x86-64-v4", "avx2", "default")))
#endif
#define MASONRY_INLINE __attribute__((always_inline)) inline

namespace masonry::rigid::wall {

constexpr int width = 4;
using Lanes = double __attribute__((vector_size(32)));
using Mask = long long __attribute__((vector_size(32))); // -1: true

// Code for wide vectors counts on this alignment, code for narrow ones does not ask for it: structures of lanes state it.
constexpr std::size_t alignment = 32;

template <class T>
struct AlignedAllocator {
	using value_type = T;
	AlignedAllocator() = default;
	template <class U>
	AlignedAllocator(const AlignedAllocator<U>&)
	{
	}
	T* allocate(std::size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), std::align_val_t(alignment))); }
	void deallocate(T* p, std::size_t) { ::operator delete(p, std::align_val_t(alignment)); }
	bool operator==(const AlignedAllocator&) const { return true; }
	bool operator!=(const AlignedAllocator&) const { return false; }
};

using LaneArray = std::vector<Lanes, AlignedAllocator<Lanes>>;

MASONRY_INLINE Lanes all(double value) { return Lanes {value, value, value, value}; }
MASONRY_INLINE Lanes larger(const Lanes& a, const Lanes& b) { return a > b ? a : b; }
MASONRY_INLINE Lanes smaller(const Lanes& a, const Lanes& b) { return a < b ? a : b; }
MASONRY_INLINE Lanes size(const Lanes& a) { return a < 0 ? -a : a; }
MASONRY_INLINE Lanes length(const Lanes& a) { return size(a); }
MASONRY_INLINE Lanes select(const Mask& mask, const Lanes& a, const Lanes& b) { return mask ? a : b; }
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

// All numbers of a lane of a structure of lanes.
template <class T>
void copyLane(const T& from, int i, T& to, int j)
{
	static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % sizeof(Lanes) == 0);
	const auto* source = reinterpret_cast<const char*>(&from) + i * sizeof(double);
	auto* target = reinterpret_cast<char*>(&to) + j * sizeof(double);
	for (std::size_t at = 0; at < sizeof(T); at += sizeof(Lanes))
		std::memcpy(target + at, source + at, sizeof(double));
}

} // namespace masonry::rigid::wall

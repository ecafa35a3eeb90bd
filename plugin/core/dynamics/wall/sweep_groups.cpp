#if defined(MASONRY_WIDE_SWEEPS) && !defined(__SANITIZE_ADDRESS__) // processors with AVX-512 take sweep_groups_wide.cpp
#define MASONRY_LOOP __attribute__((target_clones("avx2", "default")))
#else
#define MASONRY_LOOP MASONRY_LANES
#endif
#include "dynamics/wall/sweep_groups_impl.hpp"

namespace masonry::rigid::wall {

template <class K>
std::unique_ptr<SweepGroups<K>> narrowSweepGroups()
{
	return std::make_unique<SweepGroupsHere<K>>();
}
template std::unique_ptr<SweepGroups<Plane>> narrowSweepGroups();
template std::unique_ptr<SweepGroups<Space>> narrowSweepGroups();

template <class K>
std::unique_ptr<SweepGroups<K>> sweepGroups()
{
#ifdef MASONRY_WIDE_SWEEPS
	if (__builtin_cpu_supports("x86-64-v4"))
		return wideSweepGroups<K>();
#endif
	return narrowSweepGroups<K>();
}
template std::unique_ptr<SweepGroups<Plane>> sweepGroups();
template std::unique_ptr<SweepGroups<Space>> sweepGroups();

} // namespace masonry::rigid::wall

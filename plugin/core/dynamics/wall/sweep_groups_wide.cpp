// Compiled for AVX-512, whatever else is: what other files use must not be compiled here.
#ifdef MASONRY_WIDE_SWEEPS
#define MASONRY_LOOP
#include "dynamics/wall/sweep_groups_impl.hpp"

namespace masonry::rigid::wall {

template <class K>
std::unique_ptr<SweepGroups<K>> wideSweepGroups()
{
	return std::unique_ptr<SweepGroups<K>>(new SweepGroupsHere<K>);
}
template std::unique_ptr<SweepGroups<Plane>> wideSweepGroups();
template std::unique_ptr<SweepGroups<Space>> wideSweepGroups();

} // namespace masonry::rigid::wall
#endif

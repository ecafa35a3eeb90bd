#include "dynamics/wall/structures.hpp"
#include <algorithm>

namespace masonry::rigid::wall {

namespace {

Structure joined(const Structure& a, const Structure& b)
{
	return {std::max(a.mode, b.mode), std::min(a.quiet, b.quiet), std::max(a.patience, b.patience), std::min(a.stay, b.stay),
	        std::max(a.mayHold, b.mayHold)};
}

} // namespace

template <class K>
bool Structures<K>::find(const RigidSystem<K>& s)
{
	if (s.lists == list && s.pairs.size() == pairs && s.bodies.size() == of.size())
		return false;
	list = s.lists;
	pairs = s.pairs.size();
	const std::vector<int> before = std::move(of);
	const std::vector<Structure> old = std::move(all);
	of = islandNumbers(s);
	if (std::any_of(s.drives.begin(), s.drives.end(), [](const BaseDrive* drive) { return drive->ordered(); }))
		for (int& number : of)
			number = std::min(number, 0);
	const int count = of.empty() ? 0 : 1 + *std::max_element(of.begin(), of.end());
	all.assign(count, {});
	inFlight.assign(count, 1);
	std::vector<char> known(count, 0);
	for (size_t b = 0; before.size() == of.size() && b < of.size(); ++b)
		if (of[b] >= 0 && before[b] >= 0) {
			Structure& one = all[of[b]];
			one = known[of[b]] ? joined(one, old[before[b]]) : old[before[b]];
			known[of[b]] = 1;
		}
	for (const ContactPair<K>& pair : s.pairs)
		inFlight[std::max(of[pair.body1], of[pair.body2])] = 0;
	return true;
}

template <class K>
bool Structures<K>::letReturn()
{
	const auto moves = [](const Structure& one) { return one.mode == WallMode::moving; };
	const auto isReady = [=](const Structure& one) { return moves(one) && one.quiet >= one.patience; };
	const long ready = std::count_if(all.begin(), all.end(), isReady);
	if (ready == 0 || (sinceReturn < shortest && ready < std::count_if(all.begin(), all.end(), moves)))
		return false;
	for (Structure& one : all)
		if (isReady(one)) {
			one.mode = WallMode::still;
			one.quiet = one.stay = 0;
			one.mayHold = std::min(2 * one.mayHold, tolerance::wall::held);
		}
	sinceReturn = 0;
	return true;
}

template <class K>
void Structures<K>::endStep(const std::vector<double>& motion, double rest, double shortestPatience, double h)
{
	shortest = shortestPatience;
	sinceReturn += h;
	for (size_t k = 0; k < all.size(); ++k) {
		Structure& one = all[k];
		if (one.mode == WallMode::still) {
			one.stay += h;
			continue;
		}
		if (one.stay >= 0) { // has just left
			one.patience = one.stay < 10 * one.patience ? 2 * one.patience : shortest;
			one.patience = std::max(one.patience, shortest);
			one.stay = -1;
		}
		one.quiet = motion[k] <= rest && !inFlight[k] ? one.quiet + h : 0;
	}
}

template <class K>
bool Structures<K>::any(WallMode mode) const
{
	return std::any_of(all.begin(), all.end(), [=](const Structure& one) { return one.mode == mode; });
}

template <class K>
std::vector<char> Structures<K>::bodies(WallMode mode) const
{
	std::vector<char> result;
	for (const int number : of)
		result.push_back(number >= 0 && all[number].mode == mode);
	return result;
}

template class Structures<Plane>;
template class Structures<Space>;

} // namespace masonry::rigid::wall

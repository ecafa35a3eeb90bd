#include "dynamics/wall/structures.hpp"
#include <algorithm>

namespace masonry::rigid::wall {

namespace {

Structure joined(const Structure& a, const Structure& b)
{
	return {std::max(a.mode, b.mode),   std::min(a.quiet, b.quiet),     std::max(a.patience, b.patience), std::min(a.stay, b.stay),
	        std::min(a.whole, b.whole), std::max(a.mayHold, b.mayHold), std::max(a.pace, b.pace)};
}

} // namespace

template <class K>
bool Structures<K>::find(const RigidSystem<K>& s)
{
	if (!returned && s.lists == list && s.pairs.size() == pairs && s.bodies.size() == of.size())
		return false;
	returned = false;
	if (s.bodies.size() != of.size()) {
		of = islandNumbers(s);
		all.assign(s.bodies.size(), {});
	}
	regroup(s);
	return true;
}

template <class K>
void Structures<K>::regroup(const RigidSystem<K>& s)
{
	std::vector<int> now = islandNumbers<K>(s, [this](const ContactPair<K>& pair) { return !isCut(pair); });
	if (areOrdered(s.drives))
		for (int& number : now)
			number = std::min(number, 0);
	std::vector<Structure> next(now.empty() ? 0 : 1 + *std::max_element(now.begin(), now.end()));
	std::vector<char> known(next.size(), 0);
	for (size_t b = 0; b < now.size(); ++b)
		if (now[b] >= 0 && of[b] >= 0) {
			Structure& one = next[now[b]];
			one = known[now[b]] ? joined(one, all[of[b]]) : all[of[b]];
			known[now[b]] = 1;
		}
	of = std::move(now);
	all = std::move(next);
	takePairs(s);
	if (joinUnborne(s))
		regroup(s);
}

// What has no base of its own goes with what moves beside it. True: there was some.
template <class K>
bool Structures<K>::joinUnborne(const RigidSystem<K>& s)
{
	std::vector<char> borne(all.size(), 0), beside(all.size(), 0);
	for (const ContactPair<K>& pair : s.pairs) {
		const int a = of[pair.body1], b = of[pair.body2];
		if (a < 0 && b < 0)
			continue;
		if (a < 0 || b < 0)
			borne[std::max(a, b)] |= !pair.beside;
		else if (isCut(pair))
			beside[all[a].mode == WallMode::still ? a : b] = 1;
	}
	bool some = false;
	for (size_t k = 0; k < all.size(); ++k)
		if (beside[k] && !borne[k]) {
			all[k].mode = WallMode::moving;
			some = true;
		}
	return some;
}

template <class K>
void Structures<K>::takePairs(const RigidSystem<K>& s)
{
	list = s.lists;
	pairs = s.pairs.size();
	inFlight.assign(all.size(), 1);
	for (const ContactPair<K>& pair : s.pairs)
		for (const int number : {of[pair.body1], of[pair.body2]})
			if (number >= 0)
				inFlight[number] = 0;
}

template <class K>
bool Structures<K>::setOff(const RigidSystem<K>& s, const std::vector<char>& bodies)
{
	std::vector<int> left(all.size(), 0), part(all.size(), -1);
	for (size_t b = 0; b < of.size(); ++b)
		if (of[b] >= 0 && !bodies[b])
			++left[of[b]];
	for (size_t b = 0; b < of.size(); ++b) {
		if (of[b] < 0 || !bodies[b])
			continue;
		const int whole = of[b];
		if (left[whole] == 0) {
			all[whole].mode = WallMode::moving;
			continue;
		}
		if (part[whole] < 0) {
			part[whole] = int(all.size());
			all.push_back(all[whole]);
			all.back().mode = WallMode::moving;
			all[whole].whole = 0;
		}
		of[b] = part[whole];
	}
	regroup(s);
	return std::any_of(s.pairs.begin(), s.pairs.end(),
	                   [&](const ContactPair<K>& pair) { return bodies[pair.body1] != bodies[pair.body2] && isCut(pair); });
}

template <class K>
bool Structures<K>::letReturn()
{
	const auto moves = [](const Structure& one) { return one.mode == WallMode::moving; };
	const auto isReady = [=](const Structure& one) { return moves(one) && one.quiet >= std::max(one.patience, 1.) * shortest; };
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
	returned = true;
	return true;
}

template <class K>
void Structures<K>::endStep(const std::vector<double>& motion, double rest, double shortestPatience, double h)
{
	shortest = shortestPatience;
	sinceReturn += h;
	for (size_t k = 0; k < all.size(); ++k) {
		Structure& one = all[k];
		one.whole += h;
		one.pace = motion[k] / (tolerance::wall::slow * rest);
		if (one.mode == WallMode::still) {
			one.stay += h;
			continue;
		}
		if (one.stay >= 0) { // has just left
			one.patience = one.stay < 10 * one.patience * shortest ? 2 * one.patience : 1;
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

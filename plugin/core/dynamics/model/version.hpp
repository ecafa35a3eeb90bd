#pragma once
// Versions tell whether what was made from a thing is still up to date.
#include <utility>

namespace masonry {

// Counts the changes of a thing. It stands beside the thing, and whoever changes the thing calls changed().
class Version {
public:
	void changed() { ++number; }

private:
	friend class Follower;
	int number {0};
};

// Stands beside what is made from a thing, and keeps the version that it was made from: at first none.
class Follower {
public:
	bool isUpToDate(const Version& version) const { return seen == version.number; }
	// From now on this version. Returns whether it is another one than before.
	bool follow(const Version& version) { return std::exchange(seen, version.number) != version.number; }

private:
	int seen {-1};
};

} // namespace masonry

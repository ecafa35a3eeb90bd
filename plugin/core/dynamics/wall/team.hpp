#pragma once
// Threads that share the parts of a wall. What is done does not depend on who does it: nor do the bits, on how many there are.
//
// The caller takes every part that no helper has begun, so that it waits for a helper only while that is at work: a helper whose processor
// is taken by another program is missed, not waited for. One that is interrupted at work is, and then the caller goes on alone for a while:
// longer each time that this happens again soon.
// Between two calls a helper spins, then lets others go first, then sleeps.
#include <memory>

namespace masonry::rigid::wall {

class Team {
public:
	static constexpr int mostParts = 16;

	Team() = default;
	Team(const Team&) = delete;
	~Team();

	void setThreads(int count); // the caller's is one of them

	// work(part) for 0 .. parts - 1; returns when all are done.
	template <class Work>
	void each(int parts, const Work& work)
	{
		const auto call = [](const void* context, int part) { (*static_cast<const Work*>(context))(part); };
		if (parts > 1 && helpers > 0 && alone == 0)
			return share(parts, call, &work);
		if (alone > 0)
			--alone;
		for (int part = 0; part < parts; ++part)
			work(part);
	}

private:
	using Call = void (*)(const void*, int);
	struct Board;
	static constexpr int shortestRest = 64, longestRest = 8192; // some steps; some hundreds

	void share(int parts, Call call, const void* context);

	std::shared_ptr<Board> board; // helpers may outlive the team, and a fork of the process has none
	int helpers {0};
	int alone {0};                            // calls to come without helpers
	int rest {shortestRest}, undisturbed {0}; // calls without helpers the next time; calls since the last
};

} // namespace masonry::rigid::wall

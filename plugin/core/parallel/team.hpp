#pragma once
// Threads that share the parts of a loop. The results have the same bits for any number of threads, since no part depends on who does it.
//
// The caller takes every part that no helper has begun, so it waits only for helpers that are at work. If another program takes the
// processor of a helper before it begins, the caller does that part too. If a helper is interrupted at work, the caller waits for it and
// then works alone for a while; the while doubles each time that this happens again soon.
// Between two calls a helper spins, then yields, then sleeps.
#include <algorithm>
#include <memory>

namespace masonry::parallel {

class Team {
public:
	static constexpr int maxParts = 16;

	Team() = default;
	Team(const Team&) = delete;
	~Team();

	void setThreads(int count); // with the caller's own

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

	// work(begin, end) for equal shares of 0 .. size - 1. Shares of few do not repay that threads meet.
	template <class Work>
	void eachShare(size_t size, const Work& work)
	{
		constexpr size_t least = 256;
		const size_t count = std::clamp<size_t>(size / least, 1, maxParts);
		each(int(count), [&](int k) { work(size * k / count, size * (k + 1) / count); });
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

} // namespace masonry::parallel

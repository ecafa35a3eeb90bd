#pragma once
// Loops shared by threads, in fixed shares.
#include <omp.h>
#include <utility>
#include <vector>

namespace masonry::rigid::wall {

struct Share {
	int thread, threads;

	std::pair<int, int> of(int begin, int end) const
	{
		const long size = end - begin;
		return {begin + int(size * thread / threads), begin + int(size * (thread + 1) / threads)};
	}
	// Waits until all threads have come here.
	void meet() const
	{
		if (threads == 1)
			return;
#pragma omp barrier
	}
};

template <class Work>
void inParallel(int threads, const Work& work)
{
	if (threads == 1) { // a team of one would still call the system at each meeting
		work(Share {0, 1});
		return;
	}
#pragma omp parallel num_threads(threads)
	work(Share {omp_get_thread_num(), omp_get_num_threads()});
}

// work(begin, end) for each colour in turn; its pairs in shares.
template <class Work>
void byColour(const std::vector<int>& colourEnd, const Share& share, const Work& work)
{
	int begin = 0;
	for (const int end : colourEnd) {
		const auto [first, last] = share.of(begin, end);
		work(first, last);
		share.meet();
		begin = end;
	}
}

} // namespace masonry::rigid::wall

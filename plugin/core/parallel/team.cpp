#include "parallel/team.hpp"
#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <thread>

namespace masonry::parallel {

namespace {

constexpr int spins = 1000;      // some 50 us: longer than the caller is by itself within a step
constexpr int yields = 1000;     // about a step
constexpr int lateYields = 1000; // many times as long as a part: the helper has been interrupted

void pause()
{
#ifdef __x86_64__
	__builtin_ia32_pause();
#endif
}

constexpr size_t cacheLine = 64;

} // namespace

// A part belongs to whom it changes from an earlier round to this: one who is late finds it changed, whatever it has read of the call.
struct Team::Board {
	alignas(cacheLine) std::atomic<std::uint64_t> round {0}; // number of the call
	std::atomic<Call> call {nullptr};
	std::atomic<const void*> context {nullptr};
	std::atomic<int> threads {1};
	std::atomic<bool> over {false};
	alignas(cacheLine) std::atomic<std::uint64_t> taken[maxParts] {};
	alignas(cacheLine) std::atomic<int> done {0};
	std::atomic<int> asleep {0};
	std::mutex mutex;
	std::condition_variable news;

	// Own parts first, then those of others. Parts that the call does not have are taken already.
	void takeParts(std::uint64_t now, int parts, int thread)
	{
		const int first = parts * thread / threads.load(std::memory_order_relaxed);
		for (int k = 0; k < maxParts; ++k) {
			const int part = (first + k) % maxParts;
			std::uint64_t before = taken[part].load(std::memory_order_relaxed);
			if (before >= now || !taken[part].compare_exchange_strong(before, now, std::memory_order_acq_rel))
				continue;
			call.load(std::memory_order_relaxed)(context.load(std::memory_order_relaxed), part);
			done.fetch_add(1, std::memory_order_release);
		}
	}

	void help(int thread)
	{
		std::uint64_t last = 0;
		for (int idle = 0; !over.load(std::memory_order_relaxed); ++idle) {
			const std::uint64_t now = round.load(std::memory_order_acquire);
			if (now != last) {
				takeParts(now, size.load(std::memory_order_relaxed), thread);
				last = now;
				idle = 0;
			} else if (idle < spins)
				pause();
			else if (idle < spins + yields)
				std::this_thread::yield();
			else {
				std::unique_lock<std::mutex> lock(mutex);
				++asleep;
				news.wait(lock, [&] { return round.load() != last || over.load(); });
				--asleep;
				idle = 0;
			}
		}
	}

	void wake()
	{
		if (asleep.load() == 0)
			return;
		std::lock_guard<std::mutex> lock(mutex);
		news.notify_all();
	}

	std::atomic<int> size {0}; // parts of the call
};

Team::~Team() { setThreads(1); }

void Team::setThreads(int count)
{
	count = std::clamp(count, 1, maxParts);
	if (helpers == count - 1)
		return;
	if (board) {
		board->over.store(true);
		board->wake();
		board.reset();
	}
	helpers = count - 1;
	if (helpers == 0)
		return;
	board = std::make_shared<Board>();
	board->threads.store(count);
	for (int thread = 1; thread < count; ++thread)
		std::thread([thread, board = board] { board->help(thread); }).detach();
}

void Team::share(int parts, Call call, const void* context)
{
	Board& b = *board;
	const std::uint64_t now = b.round.load(std::memory_order_relaxed) + 1;
	b.call.store(call, std::memory_order_relaxed);
	b.context.store(context, std::memory_order_relaxed);
	b.size.store(parts, std::memory_order_relaxed);
	b.done.store(0, std::memory_order_relaxed);
	for (int part = parts; part < maxParts; ++part)
		b.taken[part].store(now, std::memory_order_relaxed);
	b.round.store(now);
	b.wake();
	b.takeParts(now, parts, 0);
	bool late = false;
	for (int idle = 0; b.done.load(std::memory_order_acquire) < parts; ++idle)
		if (idle < spins)
			pause();
		else {
			std::this_thread::yield();
			late = idle > spins + lateYields;
		}
	if (late) {
		alone = rest;
		rest = std::min(2 * rest, longestRest);
		undisturbed = 0;
	} else if (++undisturbed > longestRest)
		rest = shortestRest;
}

} // namespace masonry::parallel

// Rate and error of the exact histories, side by side: one core, against the references of tests/oracle.
#include "oracle/artificial_record.hpp"
#include "oracle/free_rocking.hpp"
#include "rocking/history.hpp"
#include <benchmark/benchmark.h>

using namespace masonry;

namespace {

const RockingBlock block(0.3, 1.5);
constexpr int halfCycles = 30;

// Largest error of the peaks, relative to each peak (or to the largest), and of the impact times, relative.
template <typename Impacts>
void report(benchmark::State& state, const History& history, const Impacts& exact, bool toLargest)
{
	double peakError = 0, timeError = 0, largest = 0;
	for (const auto& peak : exact.peaks)
		largest = std::max(largest, double(peak));
	for (size_t i = 0; i < exact.peaks.size(); i++) {
		const double scale = toLargest ? largest : double(exact.peaks[i]);
		peakError = std::max(peakError, std::abs(double(std::abs(history.peakAngles[i]) - exact.peaks[i])) / scale);
		timeError = std::max(timeError, std::abs(double(history.impactTimes[i] - exact.impactTimes[i]) / double(exact.impactTimes[i])));
	}
	state.counters["histories/s"] = benchmark::Counter(double(state.iterations()), benchmark::Counter::kIsRate);
	state.counters["impacts"] = double(history.impactTimes.size());
	state.counters["peak_error"] = peakError;
	state.counters["time_error"] = timeError;
}

HistoryOptions options(double restitution, Restoring restoring)
{
	HistoryOptions result;
	result.restitution = restitution;
	result.restoring = restoring;
	return result;
}

struct FreeReference { // the names of ForcedHistory
	std::vector<long double> peaks, impactTimes;
	FreeReference(const oracle::Impacts& impacts) : peaks(impacts.peaks), impactTimes(impacts.times) {}
};

const oracle::Block reference {0.3, 1.5, 9.81};

void freeRocking(benchmark::State& state, Restoring restoring, oracle::Moment moment)
{
	HistoryOptions start = options(0.9, restoring);
	start.initialAngle = 0.9 * block.criticalAngle;
	start.halfCycles = halfCycles;
	for (auto _ : state)
		benchmark::DoNotOptimize(simulate(block, BaseMotion(), start));
	report(state, simulate(block, BaseMotion(), start),
	       FreeReference(oracle::freeRocking(reference, moment, 0.9, start.initialAngle, halfCycles)), false);
}

void pulseTrain(benchmark::State& state, Restoring restoring, oracle::Moment moment)
{
	HistoryOptions start = options(0.7, restoring);
	start.halfCycles = halfCycles;
	const PulseTrain train {0.0125 * block.gravity};
	for (auto _ : state)
		benchmark::DoNotOptimize(simulate(block, train, start));
	report(state, simulate(block, train, start), FreeReference(oracle::pulseTrain(reference, moment, 0.7, train.impulse, halfCycles)),
	       false);
}

// 2000 samples at 0.01 s, peak acceleration 0.29 g; until the block rests after the record.
void record(benchmark::State& state)
{
	const oracle::ArtificialRecord accelerogram(unsigned(state.range(0)), 0.29 * block.gravity, 2000, 0.01);
	const BaseMotion motion = motion::record(0.01, accelerogram.samples);
	const HistoryOptions start = options(0.9, Restoring::Exact);
	for (auto _ : state)
		benchmark::DoNotOptimize(simulate(block, motion, start));
	report(state, simulate(block, motion, start), accelerogram.rocking(0.3, 1.5, 9.81, 0.9, 1e-3L), true);
}

BENCHMARK_CAPTURE(freeRocking, exact, Restoring::Exact, oracle::Moment::Exact);
BENCHMARK_CAPTURE(freeRocking, linear, Restoring::Linear, oracle::Moment::Linear);
BENCHMARK_CAPTURE(freeRocking, constant, Restoring::Constant, oracle::Moment::Constant);
BENCHMARK_CAPTURE(pulseTrain, exact, Restoring::Exact, oracle::Moment::Exact);
BENCHMARK_CAPTURE(pulseTrain, linear, Restoring::Linear, oracle::Moment::Linear);
BENCHMARK_CAPTURE(pulseTrain, constant, Restoring::Constant, oracle::Moment::Constant);
BENCHMARK(record)->Arg(1)->Arg(2)->Arg(3);

} // namespace

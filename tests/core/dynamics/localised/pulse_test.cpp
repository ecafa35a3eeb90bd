// One block on a base that moves: pulses and records, against integrations of the rocking equation.
#include "core/dynamics/localised/rigid_rig.hpp"
#include "oracle/artificial_record.hpp"
#include "oracle/free_rocking.hpp"
#include <catch.hpp>
#include <utility>

using namespace rig;

namespace {

constexpr double b = 0.3, a = 1.5; // half sizes, m

struct History {
	std::vector<double> peaks; // largest |angle| before each impact
	std::vector<Impact> impacts;
	double angle;
};

History shake(RigidSystem<Plane>& s, double h, double end)
{
	LocalisedStep<Plane> step;
	History history;
	Peaks peaks;
	double largest = 0;
	while (s.time < end - h / 2) {
		const StepReport report = step.advance(s, h);
		REQUIRE((report.converged && !report.diverged && report.unlocalised == 0));
		for (const Impact& impact : s.impacts) {
			history.impacts.push_back(impact);
			history.peaks.push_back(std::exchange(largest, 0.));
		}
		peaks.take(s.time, s.bodies[1].pose.angle, s.bodies[1].velocity[2]);
		for (const double peak : peaks.found)
			largest = std::max(largest, std::abs(peak));
		peaks.found.clear();
	}
	history.angle = s.bodies[1].pose.angle;
	return history;
}

} // namespace

TEST_CASE("The resonant pulse train gives the exact peaks, and the velocities of Eq. 7")
{
	const double restitution = 0.7, impulse = 0.0125 * g;
	const int n = 30;
	const auto exact = oracle::pulseTrain({b, a, g}, oracle::Moment::Exact, restitution, impulse, n);
	ResonantTrain train(impulse);
	auto s = rockingBlock(b, a, 0, restitution);
	moveBase(s, train);
	const double atStart = balance(s);
	const auto history = shake(s, 1e-3, double(exact.times[n - 1]) + 0.1);
	REQUIRE(history.peaks.size() >= n);
	double peaks = 0, velocities = 0, speed = 0;
	const double first = 3 * g * a / (4 * (a * a + b * b)) * impulse / g;
	for (int i = 0; i < n; ++i) {
		peaks = std::max(peaks, std::abs(history.peaks[i] / double(exact.peaks[i]) - 1));
		speed = restitution * speed + (i == 0 ? 1 : 2) * first;
		velocities = std::max(velocities, std::abs(history.impacts[i].joint.before / speed - 1));
	}
	CAPTURE(peaks, velocities);
	CHECK(peaks < 3e-6);
	// Third order in the step, like the energy balance, which misses by the same share: 4.9e-8 at 2e-3 s, 7.7e-10 at 5e-4 s.
	CHECK(velocities < 2e-8);
	CHECK(s.bodies[0].pose.position.x() == Approx(train.displacement(s.time)).epsilon(1e-14));
	CHECK(std::abs(balance(s) - atStart) < 1e-6 * s.baseWork);
}

namespace {

// Free rocking between Dirac pulses that raise the block: Runge-Kutta-Fehlberg 7(8), impacts by bisection.
class PulsedRocking {
public:
	std::vector<double> impactTimes;

	explicit PulsedRocking(oracle::Long restitution) : restitution(restitution) {}

	oracle::Long angle() const { return state[0]; }
	oracle::Long turnsTo() const { return side; }

	void jump(oracle::Long size) { state[1] += 3 / (4 * R) * std::cos(alpha - std::abs(state[0])) * size; }

	void run(oracle::Long end)
	{
		const oracle::Long step = 1e-3L;
		while (time < end) {
			const oracle::Long length = std::min(step, end - time);
			oracle::State next = advanced(length);
			oracle::Long taken = length;
			if (next[0] * side < 0) {
				oracle::Long low = 0, high = length;
				for (int k = 0; k < 80; ++k) {
					const oracle::Long middle = (low + high) / 2;
					(advanced(middle)[0] * side < 0 ? high : low) = middle;
				}
				taken = low;
				next = {0, advanced(low)[1] * restitution};
				side = -side;
				impactTimes.push_back(double(time + low));
			}
			state = next;
			time += taken;
		}
	}

private:
	oracle::State advanced(oracle::Long length) const
	{
		const auto equation = [this](const oracle::State& y, oracle::State& rate, oracle::Long) {
			rate = {y[1], -p2 * std::sin(side * alpha - y[0])};
		};
		return oracle::rungeKutta(equation, state, 0, length);
	}

	const oracle::Long restitution, R = std::sqrt(oracle::Long(a) * a + oracle::Long(b) * b), p2 = 3 * oracle::Long(g) / (4 * R),
	                                alpha = std::atan(oracle::Long(b) / a);
	oracle::State state {};
	oracle::Long side {1}, time {0};
};

} // namespace

TEST_CASE("Dirac pulses at given instants, inside steps and at their ends")
{
	// m/s, along x towards the side to which the block is turned
	const std::vector<std::pair<double, double>> pulses {{0, 0.3},     {0.1, 0.1},     {0.20037, 0.15},
	                                                     {0.92, 0.05}, {1.2003, 0.06}, {1.60013, 0.08}};
	const double restitution = 0.9, end = 1.8;
	PulsedRocking exact(restitution);
	ScheduledMotion motion;
	for (const auto& [t, size] : pulses) {
		exact.run(t);
		exact.jump(size * exact.turnsTo());
		motion.append({t, size * double(exact.turnsTo())});
	}
	exact.run(end);
	auto s = rockingBlock(b, a, 0, restitution);
	moveBase(s, motion);
	const double atStart = balance(s);
	const auto history = shake(s, 1e-3, end);
	REQUIRE(history.impacts.size() == exact.impactTimes.size());
	double times = 0;
	for (size_t i = 0; i < exact.impactTimes.size(); ++i)
		times = std::max(times, std::abs(history.impacts[i].time - exact.impactTimes[i]));
	CAPTURE(times, history.angle, double(exact.angle()));
	// Second order; a pulse inside a step splits it.
	CHECK(times < 1e-5);
	CHECK(std::abs(history.angle - double(exact.angle())) < 5e-6 * std::atan(b / a));
	CHECK(std::abs(balance(s) - atStart) < 1e-6 * s.baseWork);
}

namespace {

struct Difference {
	double times {0}, peaks {0}; // s; relative to the largest peak
	size_t impacts;
};

// Of the peaks before the impacts.
Difference differenceFrom(const oracle::ForcedHistory& exact, const History& history)
{
	Difference difference;
	difference.impacts = exact.impactTimes.size();
	REQUIRE(history.impacts.size() >= difference.impacts);
	const double largest = double(*std::max_element(exact.peaks.begin(), exact.peaks.end()));
	for (size_t i = 0; i < difference.impacts; ++i) {
		difference.times = std::max(difference.times, std::abs(history.impacts[i].time - double(exact.impactTimes[i])));
		difference.peaks = std::max(difference.peaks, std::abs(history.peaks[i] - double(exact.peaks[i])) / largest);
	}
	return difference;
}

Difference underPulse(bool halfSine, double h)
{
	const double amplitude = (halfSine ? 0.45 : 0.3) * g, duration = 0.35, restitution = 0.9, end = 4;
	ScheduledMotion motion;
	if (halfSine)
		motion.append({0, 0, 0, 0, amplitude, M_PI / duration});
	else
		motion.append({0, 0, amplitude});
	motion.append({duration});
	const auto acceleration = [&](size_t interval, oracle::Long t) -> oracle::Long {
		if (interval > 0)
			return 0;
		return halfSine ? amplitude * std::sin(oracle::Long(M_PI / duration) * t) : oracle::Long(amplitude);
	};
	const oracle::Long lifted = halfSine ? std::asin(oracle::Long(g) * b / a / amplitude) / oracle::Long(M_PI / duration) : 0;
	const auto exact = oracle::ForcedRocking(b, a, g, restitution, acceleration, 2000).run({lifted, duration, end}, 1e-3L);
	auto s = rockingBlock(b, a, 0, restitution);
	moveBase(s, motion);
	return differenceFrom(exact, shake(s, h, end));
}

} // namespace

TEST_CASE("Half-sine and rectangular pulses")
{
	const bool halfSine = GENERATE(true, false);
	const Difference difference = underPulse(halfSine, 1e-3), fine = underPulse(halfSine, 1e-4);
	CAPTURE(halfSine, difference.impacts, difference.times, difference.peaks, fine.times, fine.peaks);
	CHECK(difference.impacts >= 5);
	// Where a block lifts off inside a step it does so with the mean acceleration of that step: a second order error whose size depends on
	// the instant. A rectangular pulse lifts it at its start.
	CHECK(difference.peaks < (halfSine ? 3e-5 : 3e-6));
	CHECK(difference.times < (halfSine ? 5e-5 : 2e-6));
	CHECK(fine.peaks < (halfSine ? 3e-7 : 3e-8));
	CHECK(fine.times < (halfSine ? 5e-7 : 2e-8));
}

TEST_CASE("A record that is linear between samples")
{
	const oracle::ArtificialRecord record(5, 0.35 * g, 600, 0.01);
	const double restitution = 0.9;
	const auto exact = record.rocking(b, a, g, restitution, 1e-2L);
	ScheduledMotion motion;
	for (size_t i = 0; i + 1 < record.samples.size(); ++i)
		motion.append({double(i) * record.dt, 0, record.samples[i], (record.samples[i + 1] - record.samples[i]) / record.dt});
	motion.append({double(record.samples.size() - 1) * record.dt});
	auto s = rockingBlock(b, a, 0, restitution);
	moveBase(s, motion);
	const auto history = shake(s, 1e-3, double(exact.impactTimes.back()) + 0.05);
	const Difference difference = differenceFrom(exact, history);
	CAPTURE(difference.impacts, difference.times, difference.peaks, history.impacts.size());
	CHECK(difference.impacts >= 5);
	// Looser than for a single pulse: the block lifts off inside steps, more than once; its part in this error has not been isolated.
	CHECK(difference.peaks < 3e-4);
	CHECK(difference.times < 1e-4);
}

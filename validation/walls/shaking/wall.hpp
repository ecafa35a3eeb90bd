#pragma once
// The wall that all programs shake, and what is measured of it: running bond of blocks 1.0 x 0.5 x 0.5 m, half blocks at the ends, head
// joints touching, friction 0.7, on a base that rests and then moves with a sine of 2 Hz along the wall.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <stdexcept>
#include <string>
#include <vector>

constexpr double gravity = 9.81, density = 2000, friction = 0.7, thickness = 0.5, timeStep = 1e-3;

struct Block {
	double length, height; // m; 0.5 m thick
	double x, z;           // m, of its centre
	int course;
};

inline std::vector<Block> wall(int courses, int perLevel)
{
	std::vector<Block> blocks;
	for (int c = 0; c < courses; ++c) {
		const double z = 0.25 + 0.5 * c;
		const bool odd = c % 2 == 1;
		if (odd) {
			blocks.push_back({0.5, 0.5, 0.25, z, c});
			blocks.push_back({0.5, 0.5, perLevel - 0.25, z, c});
		}
		for (int i = 0; i < perLevel - odd; ++i)
			blocks.push_back({1, 0.5, i + 0.5 + 0.5 * odd, z, c});
	}
	return blocks;
}

// Command line: courses, blocks per course, amplitude (g), seconds of rest, seconds of shaking.
struct Request {
	int courses, perLevel;
	double amplitude, rest, shaking;

	Request(int argc, char** argv)
	{
		if (argc != 6)
			throw std::runtime_error("usage: <courses> <blocks per course> <amplitude, g> <rest, s> <shaking, s>");
		courses = std::atoi(argv[1]);
		perLevel = std::atoi(argv[2]);
		amplitude = std::atof(argv[3]);
		rest = std::atof(argv[4]);
		shaking = std::atof(argv[5]);
	}
	double baseVelocity(double t) const
	{
		const double w = 4 * M_PI, since = std::max(0., t - rest);
		return amplitude * gravity / w * (1 - std::cos(w * since));
	}
	double basePosition(double t) const
	{
		const double w = 4 * M_PI, since = std::max(0., t - rest);
		return amplitude * gravity / w * (since - std::sin(w * since) / w);
	}
};

// World: moveBase(t, dt), step(dt), places() of the blocks (x, z), base() in x. Prints a line for each phase:
// solver,phase,blocks,CPU s per simulated s,drift (mm, largest at the end),sink per joint (mm, mean of the top course)
template <class World>
void measure(const std::string& solver, const Request& request, World& world)
{
	const auto blocks = wall(request.courses, request.perLevel);
	const auto start = world.places();
	long k = 0;
	double atEndOfRest = 0;
	for (const auto& [phase, seconds] : {std::pair("rest", request.rest), std::pair("shaken", request.shaking)}) {
		const long steps = std::lround(seconds / timeStep);
		const std::clock_t begin = std::clock();
		for (long end = k + steps; k < end; ++k) {
			world.moveBase(request, k * timeStep);
			world.step();
		}
		const double cpu = double(std::clock() - begin) / CLOCKS_PER_SEC / seconds;
		const auto now = world.places();
		double drift = 0, sink = 0;
		int inTop = 0;
		for (size_t b = 0; b < blocks.size(); ++b) {
			drift = std::max(drift, std::abs(now[b][0] - start[b][0] - world.base()));
			if (blocks[b].course == request.courses - 1) {
				sink += (start[b][1] - now[b][1]) / request.courses;
				++inTop;
			}
		}
		sink /= inTop;
		std::printf("%s,%s,%zu,%.6g,%.6g,%.6g\n", solver.c_str(), phase, blocks.size(), cpu, 1e3 * drift, 1e3 * (sink - atEndOfRest));
		std::fflush(stdout);
	}
}

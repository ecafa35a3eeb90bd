#pragma once
// What the drivers share: the scene from the command line, the timed step loop, the output.
//
//   <driver> <folder> <half width> <half height> <depth> <start angle> <gravity> <duration> <time step>...
//
// One line per run goes to the standard output: solver,settings,time step,CPU seconds per simulated second,file. The file holds time
// and the block's angle (two doubles) at the start and after every step. Metres, seconds, radians; x along the base, z up; a
// positive angle turns the block's top towards +x.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <stdexcept>
#include <string>
#include <vector>

struct Scene {
	double halfWidth, halfHeight, depth, startAngle, gravity, duration;

	static constexpr double density = 2000; // kg/m^3; cancels out of the motion

	double mass() const { return density * 4 * halfWidth * halfHeight * depth; }

	// Centre of the block that stands on its edge x = +halfWidth, turned by startAngle.
	double startX() const { return halfWidth - halfWidth * std::cos(startAngle) + halfHeight * std::sin(startAngle); }
	double startZ() const { return halfHeight * std::cos(startAngle) + halfWidth * std::sin(startAngle); }
};

struct Request {
	std::string folder;
	Scene scene;
	std::vector<double> timeSteps;
};

inline Request parse(int argc, char** argv)
{
	if (argc < 9)
		throw std::invalid_argument("usage: driver folder half_width half_height depth start_angle gravity duration time_step...");
	std::vector<double> numbers;
	for (int i = 2; i < argc; ++i)
		numbers.push_back(std::stod(argv[i]));
	const Scene scene {numbers[0], numbers[1], numbers[2], numbers[3], numbers[4], numbers[5]};
	return {argv[1], scene, {numbers.begin() + 6, numbers.end()}};
}

inline double processSeconds()
{
	timespec now;
	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
	return now.tv_sec + 1e-9 * now.tv_nsec;
}

// Runs a fresh simulation several times, writes the history of the last one and prints the median CPU time of the step loop.
// `create` returns a new simulation: an object with step(dt) and angle().
template <class Create>
void measure(const Request& request, const std::string& solver, const std::string& settings, double dt, Create create)
{
	const long steps = std::lround(request.scene.duration / dt);
	std::array<double, 5> seconds;
	std::vector<std::array<double, 2>> history(steps + 1);
	for (double& taken : seconds) {
		auto simulation = create();
		history[0] = {0, simulation->angle()};
		const double start = processSeconds();
		for (long i = 1; i <= steps; ++i) {
			simulation->step(dt);
			history[i] = {i * dt, simulation->angle()};
		}
		taken = processSeconds() - start;
	}
	std::sort(seconds.begin(), seconds.end());

	static int number = 0;
	const std::string file = request.folder + "/" + std::to_string(number++) + ".f64";
	std::FILE* out = std::fopen(file.c_str(), "wb");
	if (!out || std::fwrite(history.data(), sizeof history[0], history.size(), out) != history.size() || std::fclose(out) != 0)
		throw std::runtime_error("cannot write " + file);
	std::printf("%s,%s,%.9g,%.4g,%s\n", solver.c_str(), settings.c_str(), dt, seconds[seconds.size() / 2] / request.scene.duration,
	            file.c_str());
	std::fflush(stdout);
}

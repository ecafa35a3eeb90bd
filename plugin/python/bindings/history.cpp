#include "expose.hpp"

namespace masonry::python {

namespace {
using Column = std::vector<double>;
using Table = std::vector<Column>;

// Everything that one run of a case needs, as Python hands it over.
struct Cases {
	Blocks blocks;
	const Motions &motions, &vertical;
	Column fromRight, fromLeft, initialAngle, initialVelocity, endTime;
	HistoryOptions common;

	History run(size_t i) const
	{
		HistoryOptions options = common;
		options.restitution = {fromRight[i], fromLeft[i]};
		options.initialAngle = initialAngle[i];
		options.initialVelocity = initialVelocity[i];
		options.endTime = endTime[i];
		const size_t place = motions.place(i);
		const BaseMotion upwards = vertical.motion(vertical.place(i));
		return motions.train ? simulate(blocks[i], motions.train(place), options, upwards)
		                     : simulate(blocks[i], motions.motion(place), options, upwards);
	}
};

Restoring restoringFromName(const std::string& name)
{
	if (name == "exact")
		return Restoring::Exact;
	if (name == "linear")
		return Restoring::Linear;
	if (name == "constant")
		return Restoring::Constant;
	throw std::invalid_argument("restoring = '" + name + "': must be 'exact', 'linear' or 'constant'");
}

Cases toCases(const py::object& blocks, const Motions& motions, const Motions& vertical, const py::object& columns,
              const std::string& restoring, int halfCycles)
{
	Cases cases {
	    toBlocks(blocks),     motions, vertical, toVector(columns[0]), toVector(columns[1]), toVector(columns[2]), toVector(columns[3]),
	    toVector(columns[4]), {}};
	cases.common.restoring = restoringFromName(restoring);
	if (halfCycles >= 0)
		cases.common.halfCycles = halfCycles;
	return cases;
}

py::dict simulateCases(const py::object& blocks, const Motions& motions, const Motions& vertical, const py::object& columns,
                       const std::string& restoring, int halfCycles)
{
	const Cases cases = toCases(blocks, motions, vertical, columns, restoring, halfCycles);
	const size_t n = cases.blocks.size();
	Table impactTimes(n), impactVelocities(n), peakAngles(n), peakTimes(n);
	std::vector<int> overturnHalfCycle(n);
	Column restTime(n), endTime(n), baseDisplacement(n);
	forEachCase(n, [&](size_t i) {
		History history = cases.run(i);
		overturnHalfCycle[i] = history.overturnHalfCycle;
		restTime[i] = history.restTime;
		endTime[i] = history.endTime;
		baseDisplacement[i] = history.baseDisplacement;
		impactTimes[i] = std::move(history.impactTimes);
		impactVelocities[i] = std::move(history.impactVelocities);
		peakAngles[i] = std::move(history.peakAngles);
		peakTimes[i] = std::move(history.peakTimes);
	});
	py::dict result;
	result["impact_times"] = toTable(impactTimes);
	result["impact_velocities"] = toTable(impactVelocities);
	result["peak_angles"] = toTable(peakAngles);
	result["peak_times"] = toTable(peakTimes);
	result["overturn_half_cycle"] = toArray(overturnHalfCycle);
	result["rest_time"] = toArray(restTime);
	result["end_time"] = toArray(endTime);
	result["base_displacement"] = toArray(baseDisplacement);
	return result;
}

np::ndarray overturns(const py::object& blocks, const Motions& motions, const Motions& vertical, const py::object& columns,
                      const std::string& restoring, int halfCycles)
{
	Cases cases = toCases(blocks, motions, vertical, columns, restoring, halfCycles);
	cases.common.onlyOverturning = true;
	std::vector<int> result(cases.blocks.size());
	forEachCase(result.size(), [&](size_t i) { result[i] = cases.run(i).overturned(); });
	return toArray(result);
}

py::tuple sampleCases(const py::object& blocks, const Motions& motions, const Motions& vertical, const py::object& columns,
                      const std::string& restoring, int halfCycles, const py::object& timesObject)
{
	Cases cases = toCases(blocks, motions, vertical, columns, restoring, halfCycles);
	cases.common.keepStates = true;
	const Column times = toVector(timesObject);
	Table angle(cases.blocks.size(), Column(times.size())), velocity = angle, displacement = angle;
	forEachCase(cases.blocks.size(), [&](size_t i) {
		const History history = cases.run(i);
		for (size_t j = 0; j < times.size(); j++) {
			std::tie(angle[i][j], velocity[i][j]) = history.sample(times[j]);
			displacement[i][j] = history.motion.displacement(times[j]);
		}
	});
	return py::make_tuple(toTable(angle), toTable(velocity), toTable(displacement));
}
} // namespace

void exposeHistory()
{
	using py::args;
	// columns = (restitution of impacts that end a turn about the right edge, about the left one, initial angle, initial velocity, end
	// time); half_cycles < 0: no limit
	py::def("simulate", simulateCases, args("blocks", "motions", "vertical", "columns", "restoring", "half_cycles"),
	        "histories as a dict of arrays");
	py::def("overturns", overturns, args("blocks", "motions", "vertical", "columns", "restoring", "half_cycles"),
	        "1 where the block overturns");
	py::def("sample", sampleCases, args("blocks", "motions", "vertical", "columns", "restoring", "half_cycles", "t"),
	        "angle, angular velocity, base displacement at times t, one row a case");
}

} // namespace masonry::python

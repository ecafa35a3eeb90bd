#pragma once
// Ties (dynamics/model/tie.hpp) of walls. With u = -dL/dt the rate of a tie's row, which is E V in the packs of the contacts, u- that
// before the step and p its impulse, the pull on its ends,
//
//     u + (a/b) u- - (pretension + k e)/(k h b) + p/(k h^2 b) = 0        between the bounds of p: 0 (-infinity) and h strength
//
// TieSolve adds to a solve of the structure without ties what makes this right: with Y = A^-1 E^T and C the compliances, p changes by q and
// V by Y q, and (E Y + C) q is what the laws are missed by, for all ties whose p is between its bounds.
#include "dynamics/model/rigid_system.hpp"
#include "dynamics/wall/body_lanes.hpp"
#include <Eigen/Core>
#include <algorithm>
#include <functional>
#include <limits>

namespace masonry::wall {

template <class K>
struct TieArms {
	std::array<int, 2> body;                        // prescribed ones have no mass in the packs
	std::array<std::array<Lanes, packs<K>>, 2> arm; // E

	template <class Archive>
	void serialize(Archive& archive)
	{
		archive(body, arm);
	}

	double rate(const LaneArray& v) const { return along(v, 0) + along(v, 1); }
	// The prescribed bodies alone give this rate.
	double baseRate(const LaneArray& v) const
	{
		double sum = 0;
		for (int end = 0; end < 2; ++end)
			sum += isFree(v, end) ? 0 : along(v, end);
		return sum;
	}
	// Adds the momentum that an impulse gives to the free bodies.
	void push(double p, const LaneArray& velocity, LaneArray& momentum) const
	{
		for (int end = 0; end < 2; ++end)
			for (int k = 0; k < packs<K> && isFree(velocity, end); ++k)
				momentum[packs<K> * body[end] + k] += p * arm[end][k];
	}
	// 1/m of the free bodies along the row, 1/kg.
	double perMass(const LaneArray& velocity) const
	{
		double sum = 0;
		for (int end = 0; end < 2; ++end)
			for (const Lanes& a : arm[end])
				sum += velocity[packs<K> * body[end]][3] * (a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
		return sum;
	}
	// The largest difference, as by a turn in rad; infinite between other bodies.
	double change(const TieArms& other) const
	{
		if (body != other.body)
			return std::numeric_limits<double>::infinity();
		double most = 0;
		for (int end = 0; end < 2; ++end)
			for (int k = 0; k < packs<K>; ++k)
				most = std::max(most, largest(simd::size(noMass * (arm[end][k] - other.arm[end][k]))));
		return most;
	}

private:
	bool isFree(const LaneArray& v, int end) const { return v[packs<K> * body[end]][3] > 0; }
	double along(const LaneArray& v, int end) const
	{
		double sum = 0;
		for (int k = 0; k < packs<K>; ++k) {
			const Lanes product = arm[end][k] * v[packs<K> * body[end] + k];
			sum += product[0] + product[1] + product[2];
		}
		return sum;
	}
};

template <class K>
struct TieRow : TieArms<K> {
	int tie;                 // number in the system
	double bias, compliance; // m/s; 1/kg
	double least, most;      // bounds of the impulse, N s
	double impulse;          // in: first guess; out: result. N s

	// The tie's work on its bodies in the step, by the mean of the velocities before and after it, J.
	double work(const LaneArray& before, const LaneArray& after) const { return impulse * (this->rate(before) + this->rate(after)) / 2; }
	bool breaks() const { return impulse >= most; }
};

// The unbroken ties of free bodies, for a step of length h. `before`: velocities before it.
template <class K>
std::vector<TieRow<K>> tieRows(const RigidSystem<K>& system, const BodyLanes<K>& bodies, const LaneArray& before, double h);

template <class K>
class TieSolve {
public:
	// For these rows; `solve` is x = A^-1 x. Y stays while A does, and while the rows have hardly turned: only increments enter.
	void prepare(const std::vector<TieRow<K>>& rows, const LaneArray& velocity, bool isNewMatrix,
	             const std::function<void(LaneArray&)>& solve);
	// After a solve that changes the velocities by `change`: adds what the ties change. Returns by how much they then miss their laws, as
	// the largest velocity that their impulses lack, m/s.
	double hold(std::vector<TieRow<K>>& rows, const LaneArray& velocity, const std::vector<int>& freePacks, LaneArray& change) const;

	// The next step needs this from the last; Y is made of it anew.
	template <class Archive>
	void serialize(Archive& archive)
	{
		archive(known);
	}

private:
	std::vector<TieArms<K>> known;   // that Y is of
	std::vector<LaneArray> response; // Y, by row
	Eigen::MatrixXd coupling;        // E Y
	Eigen::MatrixXd stiffness;       // E Y + C
};

} // namespace masonry::wall

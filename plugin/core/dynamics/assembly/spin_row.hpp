#pragma once
// A row that prescribes the spin of one body against another about an axis: e.(w2 - w1) = target. The couple that does so acts on body 2
// along e and on body 1 against it. In the packs of the contacts e.w = arm.V.
#include "dynamics/wall/wall_contacts.hpp"

namespace masonry::rigid::assembly {

// e.w of a body by its packs; in the plane e is along z.
inline std::array<wall::Lanes, 1> spinArm(const wall::WallContacts<Plane>& c, int body, const Vector3& axis)
{
	return {wall::Lanes {0, 0, axis.z() / c.gyration[body][0], 0}};
}
inline std::array<wall::Lanes, 2> spinArm(const wall::WallContacts<Space>& c, int body, const Vector3& axis)
{
	const wall::Lanes* rows = &c.pose[4 * body]; // R; W = rho R^T w
	const wall::Lanes local = axis[0] * rows[0] + axis[1] * rows[1] + axis[2] * rows[2];
	return {wall::all(0), wall::noMass * local * rows[3]};
}

template <class K>
struct SpinRow {
	using Arm = std::array<wall::Lanes, wall::packs<K>>;

	int body1, body2;
	Arm arm1, arm2;
	double target;       // rad/s
	double baseSpin {0}; // rad/s, about the axis: the couple times it is the work of the prescribed bodies
	int face {-1};       // of body 2: the points of its joint
	double couple {0};   // result: N m s
	bool capped {false}; // result: the row was dropped, since its joint would gain energy

	SpinRow(const wall::WallContacts<K>& contacts, int body1, int body2, const Vector3& axis, double target)
	    : body1(body1), body2(body2), arm1(spinArm(contacts, body1, axis)), arm2(spinArm(contacts, body2, axis)), target(target)
	{
	}
	// e.(w2 - w1) of velocities in packs.
	double rate(const wall::LaneArray& v) const { return along(v, body2, arm2) - along(v, body1, arm1); }
	// The rate on which the couple works, beyond the work of the base.
	double rateAgainstBase(const wall::LaneArray& v) const
	{
		const auto moves = [&](int body) { return v[wall::packs<K> * body][3] > 0; };
		return (moves(body2) ? along(v, body2, arm2) : 0) - (moves(body1) ? along(v, body1, arm1) : 0) - baseSpin;
	}
	// Adds the momentum that a couple gives to the free bodies.
	void push(double couple, const wall::LaneArray& velocity, wall::LaneArray& momentum) const
	{
		for (int k = 0; k < wall::packs<K>; ++k) {
			const size_t p1 = wall::packs<K> * body1 + k, p2 = wall::packs<K> * body2 + k;
			if (velocity[p1][3] > 0)
				momentum[p1] -= couple * arm1[k];
			if (velocity[p2][3] > 0)
				momentum[p2] += couple * arm2[k];
		}
	}

private:
	static double along(const wall::LaneArray& v, int body, const Arm& arm)
	{
		double sum = 0;
		for (int k = 0; k < wall::packs<K>; ++k) {
			const wall::Lanes product = arm[k] * v[wall::packs<K> * body + k];
			sum += product[0] + product[1] + product[2];
		}
		return sum;
	}
};

} // namespace masonry::rigid::assembly

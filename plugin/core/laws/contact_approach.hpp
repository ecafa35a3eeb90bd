#pragma once
// The solution of contact_problem.hpp nearest to the impulses given, from far away.
//
// Without slip the law of a point jumps where it begins to press, so that Newton's steps tell nothing. There every point is first tied: it
// presses or parts, and does not slip in either case. That problem is convex. Then, round by round,
//
//     a point that parts loses its tie, and gets it back if it presses again without friction;
//     one that neither parts nor presses, though its tie carries, must press by a small share of that.
//
// Rounds in which nothing changes leave a solution of the laws. All points are judged at once: the order of the points decides nothing, and
// a scene that is its own mirror image stays so.
#include "laws/contact_root.hpp"

namespace masonry {

template <class K>
class ContactApproach {
public:
	ContactApproach(ContactState<K>& state, ContactRoot<K>& root) : s(state), root(root) {}

	// Impulses and velocities that meet the laws. False: none found, and the impulses are those given.
	bool find(double tolerance, SolveReport& report)
	{
		given.clear();
		for (int i = 0; i < s.nPoints; ++i)
			given.push_back(s.rows[i].impulse);
		if (search(tolerance, report))
			return true;
		restoreGiven();
		return false;
	}

private:
	using Rows = typename ContactRows<K>::Rows;

	void restoreGiven()
	{
		for (int i = 0; i < s.nPoints; ++i)
			s.rows[i].impulse = given[i];
		s.applyImpulses();
	}

	bool search(double tolerance, SolveReport& report)
	{
		constexpr int maxRounds = 12, maxCentres = 8;
		constexpr int maxTied = 100; // points; structures with more of them seldom have a solution without slip, and rounds take long
		root.begin(tolerance);
		speed = 0;
		int ties = 0;
		for (int i = 0; i < s.nPoints; ++i) {
			speed = std::max(speed, s.relativeVelocity(s.rows[i]).norm());
			ties += s.rows[i].law.kind == PointLaw::NoSlip;
		}
		if (ties > maxTied)
			return false;
		if (ties > 0)
			for (int i = 0; i < s.nPoints; ++i)
				if (s.rows[i].law.kind == PointLaw::NoSlip)
					root.setLaw(i, PointLaw::Tied, 0);
		if (!root.descend(false, report))
			return false;
		for (int round = 0; ties > 0; ++round) {
			// The points that neither part nor press are known once the centre has arrived.
			if (!root.moveCentre(report) || !root.moveCentre(report))
				return false;
			if (!judge(tolerance))
				break;
			if (round == maxRounds)
				return false;
			restoreGiven();
			if (!root.descend(true, report))
				return false;
		}
		for (int k = 0; k < maxCentres; ++k) {
			for (int i = 0; k == 0 && ties > 0 && i < s.nPoints; ++i)
				if (s.rows[i].law.kind == PointLaw::NoSlip)
					root.setLaw(i, presses(i, tolerance) ? s.rows[i].law : PointLaw {}, 0);
			root.takeNext();
			report.residual = s.residual();
			if (report.residual <= tolerance)
				return true;
			if (!root.moveCentre(report))
				return false;
		}
		return false;
	}

	bool presses(int i, double tolerance) const { return root.next(i)[0] * s.points[i].alone.trace > tolerance; }

	// Laws of the next round. False: they stay.
	bool judge(double tolerance)
	{
		// Share of the tie's impulse that a point presses with at least. Larger: forces move; smaller: round-off decides who presses.
		constexpr double share = 1e-6;
		constexpr double parting = 1e-6; // of the largest velocity that impulses have to take away: what parts faster does part
		bool changed = false;
		for (int i = 0; i < s.nPoints; ++i) {
			if (s.rows[i].law.kind != PointLaw::NoSlip)
				continue;
			const Rows &p = root.next(i), u = root.velocityAt(i);
			if (root.law(i).kind != PointLaw::Tied) {
				if (presses(i, tolerance)) {
					root.setLaw(i, PointLaw::Tied, 0);
					changed = true;
				}
				continue;
			}
			const double least = root.least(i), tie = share * p.template tail<K::rows - 1>().norm();
			if (p[0] > (least > 0 ? least : tie) || tie == 0)
				continue;
			const bool pushedAway = least > 0 && root.parts(i);
			if (u[0] > parting * speed || pushedAway)
				root.setLaw(i, {}, 0);
			else if (least == 0)
				root.setLaw(i, PointLaw::Tied, tie);
			else
				continue;
			changed = true;
		}
		return changed;
	}

	ContactState<K>& s;
	ContactRoot<K>& root;
	std::vector<Rows> given; // impulses
	double speed {0};        // m/s
};

} // namespace masonry

#pragma once
// The step of a wall that moves: substeps of length s, each of
//
//     V += s M^-1 f + M^-1 J^T p        p of the last substep
//     sweeps over the points
//     q += s V, gaps with it
//     as many sweeps: p for the next, impacts taken off
//
// An open point may close, u_n >= -gap/s, in all sweeps; a closed one does not, u_n >= 0. (Without the gap in the second half, corners that
// approach stop short, and piers do not rock as they should.) One sweep carries an impulse one course on: what the courses miss of each
// other falls as 1/substeps^2, and loads that lag behind like that bounce. So a sweep takes a little off what an impulse differs from its
// mean over the last steps, which lets no load that stays sink. A wall that is about to stand would be kept in motion by that, joint by
// joint: there it fades, and in space more sweeps take its place. Over many sweeps loads spread as by diffusion, and their number grows as
// the courses squared, where a structure is slender faster: with two, the first peak of a column of 48 that rocks is 10 % off, not 1, and
// what is lost while loads lag counts as impacts that were none. Where blocks carry heavier ones it grows as those are heavier and higher
// up (burden). Friction goes by the mean of loads that lag (frictionBound() in sweep.hpp): with the bound of the moment the top of a wall
// of 32 courses at 1 g goes 39 % too far.
//
// What the courses miss of each other lets points that carry sink. One that is too deep must part by a share of it in the sweeps before the
// move; those after the move let go the velocity that this has given. What is left is taken off at the end of the step (lift.hpp).
//
// The sweeps compute in floats, eight or sixteen pairs side by side (sweep_groups.hpp). Gaps start anew in every step, and velocities are
// in double precision what the loads and the impulses of each substep give: rounding does not add up.
//
// Substeps of one iteration after Macklin et al. (2019); parting before the move, sweeps after it, after Catto (2024).
#include "dynamics/wall/structures.hpp"
#include "dynamics/wall/sweep_groups.hpp"

namespace masonry::rigid::wall {

// What a step of a millisecond takes at the default tolerance.
struct Effort {
	int substeps, fewestSweeps;               // before the move of a substep, and after it
	double relaxationBefore, relaxationAfter; // of all sweeps but the last, which must not overdo: an impact would bounce
	// Of the difference of an impulse from its mean over the last substeps: what all sweeps before the move take off, and all after it, in
	// a structure of many courses. And what a substep takes into the mean.
	double damping, inMean;
};
// Over-relaxed, loads cross the courses in fewer sweeps. Of 48 motions of broad walls (many blocks in every course) of 28 to 34 courses
// near 1 g none is astray, with the three sweeps that these take, and the tops are 3 % off; with five substeps five go 30 to 60 % too far,
// with two sweeps fourteen. Up to 26 courses two do (50 motions: 4 % off, at most 14). The others rock: with fewer substeps they lose of
// their peaks, in proportion, and a column of twelve that is over-relaxed so gains 0.5 %. With as many sweeps as courses nothing is
// over-relaxed: it would gain nothing, and blocks that meet face to face bounce by 1 %.
// Damping. More: joints give way by it, and many of them upon another sway (with 0.09 the first peak of a column of 48 is 2.5 % too low);
// less: loads that lag bounce, and what stands on them loses friction: with 0.05 the tops of walls of 28 to 34 courses go 40 to 60 % too
// far in 4 of the 48 motions. More into the mean: loads bounce longer than the mean, which then follows them (with 0.06 tops of walls of 32
// courses go half as far again, with 0.04 the first peak of the column is 3.6 % too low); less: it lags behind the motion, and friction
// with it. Both together, 0.09 and 0.04 for 0.075 and 0.02: against Gauss-Seidel the tops of 33 broad walls are 5 % off, not 7, and the
// corners that follow 9 %, not 14. In space walls that should rest then creep on.
template <class K>
constexpr Effort effortFor(bool broad)
{
	constexpr bool inPlane = K::dimension == 2;
	return broad ? Effort {6, 2, 1.4, 1.7, inPlane ? 0.09 : 0.075, inPlane ? 0.04 : 0.02} : Effort {8, 3, 1.2, 1.2, 0.075, 0.02};
}

struct SubstepReport {
	double residual {0}; // largest change of an impulse by the last sweep, as the velocity that it gives its point, m/s
	double loss {0};     // to friction since begin(), J
	LaneArray motion;    // of the pairs, by group: largest relative velocity of a point, closed or open, m/s
};

template <class K>
class Substeps {
public:
	// From the contacts' velocities and impulses. `structures`: that their bodies are of; `finer`: how many times more substeps than at the
	// default tolerance; `fall`: what gravity gives in a substep, m/s; `gravity`: its direction.
	void begin(WallContacts<K>& contacts, const Structures<K>& structures, double finer, double fall, const typename K::Vector& gravity);
	// `load` is the change of velocity in a substep by external forces, per body. Into the contacts' velocities and shift.
	void substep(WallContacts<K>& contacts, const LaneArray& load, double s, bool isLast);
	// After each substep: what friction has taken, and the impulses that the next one starts from.
	void handOn(WallContacts<K>& contacts);
	// Gaps and impulses into the contacts.
	void end(WallContacts<K>& contacts);

	// Of one lane's point of the contacts, N s: normal and tangential.
	Eigen::Matrix<double, K::rows, 1> impulse(int group, int lane, int point) const
	{
		Eigen::Matrix<double, K::rows, 1> rows;
		points->impulse(places[group].group, width * places[group].quarter + lane, point, rows.data());
		return rows;
	}
	void setGap(int group, int lane, int point, double gap)
	{
		points->setGap(places[group].group, width * places[group].quarter + lane, point, gap);
	}

	SubstepReport report; // of the last substep of the step

private:
	struct Place {
		int group, quarter;
	};
	void arrange(const WallContacts<K>& contacts);
	void sumImpulses(int part);

	Effort effort {effortFor<K>(false)};
	int sweeps {1};     // before the move, and after it
	int mostSweeps {1}; // where they go on
	bool edges {false};
	float lumps {0};   // frictionBound()
	float damped {0};  // damping of this step
	double fall {0};   // what gravity gives in a substep, m/s
	float inMean {0};  // what a substep takes into the mean of an impulse
	double impact {0}; // of an upright joint (HandOn), m/s; without gravity none is upright
	FloatPack up {};   // direction
	std::unique_ptr<SweepGroups<K>> points {sweepGroups<K>()};
	std::vector<Quarters> quarters; // of their groups
	std::vector<Place> places;      // of the contacts' groups
	std::vector<Part> parts;        // as the contacts', but for their members
	Array<FloatPack> known;         // of the bodies: (share of what is too deep that a substep takes off, -, -, 1/m)
	Array<FloatPack> velocity;      // of the bodies
	Array<FloatPack> contactPart;   // of it: what the impulses of the last substep gave
	LaneArray loss;                 // to friction since begin(), J; by part
};

} // namespace masonry::rigid::wall

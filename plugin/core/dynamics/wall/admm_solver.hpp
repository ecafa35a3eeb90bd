#pragma once
// The contact laws of a whole structure in one step, by the alternating direction method of multipliers (ADMM) with one factorisation that
// is kept over many steps. There is one method for blocks that stand and for blocks that move.
//
// Unknown are the velocities V at the end of the step, the impulses p and the relative velocities z that the laws allow. J maps V to the
// relative velocities at the points, b is the bias of each point, R its penalty, w = J V + b, and A = M + J^T J / R over all points in
// reach, whatever their state:
//
//     V += A^-1 [ M (V_free - V) + J^T (p + (z - w)/R) ]
//     y   = p - (a w + (1 - a) z)/R                                   a = 1.7: over-relaxation
//     p_n = max(0, y_n), of prescribed bodies that move up to a limit (ContactPoints::limitMoved)
//     g  += theta (p_n - g)                                           friction bound, damped
//     p_t = y_t within |p_t| <= mu g
//     z   = (p - y) R
//
// until w = z, g = p_n where points slide, and V hardly changes. A does not depend on which points stick, slide or part, so that it need
// not be factorised when states change. Only residuals are corrected, so that A may be of slightly other positions: where a body has turned
// by an angle since, V misses the momentum equation by about that angle times its last change.
//
// The method is that of Boyd et al. (Foundations and Trends in Machine Learning 3, 2011); for contact with friction see Acary, Bremond and
// Huber (2018) and Carpentier, Le Lidec and Montaut (RSS 2024). These choices are ours; docs/tuning.md has what failed instead:
//
//     R by load       R = d r/(1 + l): d is the mean of J M^-1 J^T over the rows of the point, l its filtered normal impulse in units of
//                     the impulse that stops it alone after the fall of one step. R p is then a velocity of about the same size at light
//                     and heavy points. A uniform R suits either a wall that slides or one that rocks. While nothing moves, r is a
//                     tenth: an impulse that changes by q leaves w - z = R q, and one iteration is enough if that is small. A step that
//                     does not end soon with it goes on with the r of motion.
//     damped bound    With the bound mu p_n, sliding points run into a limit cycle whose residual does not fall.
//     start           V starts from the velocities before the step and a guess of their change. It stops where w = z, so that what slides
//                     with a steady acceleration would lag by a multiple of the tolerance in each step without one.
//                     Points without an impulse start from the velocity that they have, z = (max(0, w_n), w_t): their bias changes in each
//                     step. Points that slide keep z_n and start with z_t = w_t. Others keep z, as they keep p.
//
// Rows that prescribe a spin (SpinRow) are held in each iteration: with Y = A^-1 E^T, the couples c change by
// (E Y)^-1 (target - E V) and V by Y times that, so that E V is the target to round-off. A does not know of them.
//
// Ties (TieRow) are elastic: A does not know of them either, and after each solve their impulses obey their laws at once (TieSolve), so
// that the solution of the other laws is the same as if A contained them.
//
// Mortar (mortar_rows.hpp): points of rigid joints have a shifted cone and a small R; rows of those that crack are in A, and their laws are
// taken in the same pass. Only impulses that miss the strength by a small share of it are good enough, where R is so small.
// An impulse that stays at the strength gains a share R of its speed in an iteration: R of mortar that gives way is its speed over its
// impulse, and is looked at every some iterations.
//
// An instant (StepContext::instant) is the same problem without forces: impacts with rows, and jumps of the base. Points in touch start as
// ones that stick, z_t = 0: a base that jumps under a block which it only slides along is a solution too, and where nothing slips not the
// one that is meant. Its impulses come where nothing has pressed in the steps before, so that R follows those that it has found after some
// iterations; the next step makes A anew.
//
// Biases. A point with a gap may close within the step: b_n = gap/h. Of a penetration, and of a slip that unfinished iterations have left
// at a point that sticks, a share is taken back in each step: b = share x/h. A penetration with which a point was found stays, and so does
// one that a limit has let happen.
#include "dynamics/wall/admm_passes.hpp"
#include "dynamics/wall/wall_matrix.hpp"

namespace masonry::wall {

// Tables of docs/tuning.md: (a) settings near the onset of motion, (b) softness of contacts at rest, (c) other settings, (d) impacts,
// (e) mortar of rigid blocks, (f) few blocks and first steps.
struct AdmmSettings {
	double tolerance {1e-3};   // largest |w - z| relative to the speed that gravity gives in a step. Larger: joints drift and sink
	bool strictForces {false}; // the same holds for errors of impulses, as velocities; then a step takes up to `first` iterations
	int iterations {20};       // (a) at most in a step, beside the reserve. Fewer: excursions are too small
	int small {100}; // (f) blocks below which a step takes more of them, in inverse proportion. Smaller: walls of some tens of blocks in
	                 // space go up to 14 % too little; larger: more CPU time
	int few {6};     // (f) blocks up to which a step in which something moves goes on to fewTolerance, up to `first` iterations while its
	                 // residual falls, then by FewBlocks. Fewer: what slides without friction gains energy; more: more CPU time
	double fewTolerance {1e-9}; // (f) as `tolerance`, which may be smaller. Larger: blocks that fly past others feel them
	int least {10};     // (c) iterations of a step, unless its residual is below `early`. Fewer: p lags behind what turns, and energy rises
	double early {0.1}; // (c) of the tolerance. Smaller: more iterations at rest; larger: as with fewer `least` iterations
	int reserve {50};   // (d) times `iterations` that quiet steps save for impacts at most. 0: walls under impacts drift
	int first {3000};   // (f) iterations of a step that starts without impulses, at most. Fewer: heavy blocks fall into what bears them
	int ofInstant {40}; // (d) iterations with which an impact or a base pulse goes on to instantTolerance; more of them below `small`
	                    // blocks, as in a step. Fewer: single blocks land less right
	double instantTolerance {1e-6}; // (d) largest |w - z| of an instant relative to the velocities that change; at least as in a step
	double instantEnough {5e-3};    // (d) the same after these iterations. Larger: the next steps take up more of it
	int maxOfInstant {1000};        // (d) iterations of an instant at most
	double softness {0.2};          // (a) r. Larger: high walls go too far; smaller: low walls that begin to move do not go far enough
	double soundSoftness {3e-5};    // (e) r of points that sound mortar holds. Larger: unfinished iterations crack it; smaller: rounding of
	                                // the factorisation
	double soundShare {0.01};       // (e) of the tension that they bear, by which an impulse may miss. Larger: cracks come late
	double restSoftness {0.02};  // (b) r while a structure of more than `small` blocks rests. Larger: one that is shaken and stands drifts,
	                             // and takes more iterations; smaller: its forces are less right, so that it begins to move too early
	int restMost {10};           // (c) iterations until a step at rest goes on with `softness`. More: the onset of motion costs more
	double follows {0.1};        // (c) share by which R may differ from that of the loads. Smaller: more factorisations
	double restFollows {0.8};    // (c) the same at rest, where few iterations are enough
	double minSoftness {1e-5};   // (c) of d, at the most loaded points. Smaller: rounding of the factorisation in single precision
	double relaxation {1.7};     // (a) a, 1 to 2. Larger: residuals oscillate; smaller: they fall more slowly
	double boundShare {0.3};     // (a) theta. 1: sliding points run into a limit cycle; smaller: friction lags
	double pullBack {0.2};       // (c) share of a penetration or of a slip that a step takes back. Larger: shivering; smaller: drift
	double reach {0.016};        // (a) gap relative to the smallest half size within which points are in A. Smaller: more factorisations
	double filterTime {0.125};   // (a) of the filtered load, relative to sqrt(smallest half size / gravity)
	double refactorTime {0.125}; // (c) relative to the same, after which R follows the loads
	double turned {0.03}; // (c) change of a point's rows, as by a turn in rad, after which A is made anew. Smaller: more factorisations
	double leftPenetration {5e-6}; // (c) relative to the smallest half size, which is not taken back. 0: blocks at rest never come to rest
};

template <class K>
class AdmmSolver {
public:
	// Solves a step from the contacts' velocities and states; an instant starts without impulses.
	SolverStatus solve(const AdmmProblem<K>& problem, const AdmmSettings& settings, AdmmResults<K>& results);
	// The next solve goes on as that of a first step: R follows the loads that it finds.
	void restart() { cold = true; }
	// The next solve of these contacts needs this from the last.
	template <class Archive>
	void serialize(Archive& archive, const ContactSet<K>& contacts)
	{
		archive(age, saved, cold, atRest);
		penalties.resize(contacts.points().groups().size());
		for (GroupPenalty<K>& ofGroup : penalties)
			for (Penalty& penalty : ofGroup)
				archive(penalty.resistance, penalty.stiffness);
		matrix.serialize(archive, contacts);
		archive(ties, soundInA);
	}

private:
	using Problem = AdmmProblem<K>;
	using Results = AdmmResults<K>;
	Pass<K> passOf(const Problem& problem, const Part& part, const Step& step, Results& results);
	bool isOutdated(const Problem& problem, const AdmmSettings& settings, Results& results);
	bool isMortarOutdated(const Problem& problem, const AdmmSettings& settings, Results& results) const;
	bool isMortarFar(const Problem& problem, const AdmmSettings& settings, int iterations, Results& results);
	double usualIterations(const AdmmSettings& settings) const;
	bool hasAtMost(int blocks) const;
	bool goesOn(const StepContext& step, const AdmmSettings& settings, const SolverStatus& status, bool falls) const;
	void makeMatrix(const Problem& problem, const AdmmSettings& settings, bool started, Results& results);
	void start(const Problem& problem, const AdmmSettings& settings, Results& results);
	double iterate(const Problem& problem, const AdmmSettings& settings, int number, Results& results);
	void prepareSpins(const Problem& problem);
	void holdSpins(Results& results);
	void prepareRows(const Problem& problem, bool isNewMatrix);
	void pushRows(const Problem& problem, Results& results);

	WallMatrix<K> matrix;
	std::vector<GroupPenalty<K>> penalties; // by group
	double turn {0};                        // by which rows of a point have changed since A was made, at most
	Follower compared;                      // the contacts that `turn` is of
	LaneArray free, force;
	std::vector<LaneArray> response; // Y, by row
	Eigen::MatrixXd perSpin;         // (E Y)^-1
	TieSolve<K> ties;
	Array<Strength<K>> soundInA; // strengths of rigid joints when A was made
	double age {0};              // s, since R was last compared with the loads
	double saved {0};            // iterations
	bool cold {true};            // the loads are not known: no step has been solved, or all contacts change at once
	bool ofInstant {false};      // R is that of an instant
	bool atRest {false};         // R is that of a structure at rest
};

} // namespace masonry::wall

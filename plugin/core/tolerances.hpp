#pragma once
// Every tolerance of the physics, each relative to a size or a speed of the scene: a scene scaled in length and
// time gives the scaled answer. One line of consequence each. A value that was compared with others names its table in docs/tuning.md.

namespace masonry::tolerance {

// --- shapes (shape/) ---
namespace shape {
// Distance of a vertex from the line or plane of its neighbours, relative to the size of the shape, within which it is none. Larger: faces
// that meet at a small angle become one; smaller: round-off of the points that are given makes vertices.
constexpr double flat = 1e-9;
} // namespace shape

// --- impulses at one instant (impact/) ---
// Relative pivot below which a contact row counts as redundant. Larger: real rows are dropped; smaller: round-off of
// redundant rows becomes impulses.
constexpr double rank = 1e-10;
// Residual of an impulse problem relative to the largest approach speed. Larger: corners penetrate after an impact.
constexpr double impulse = 1e-11;
// Compliance of a contact, relative to its own response, from which rigid contacts are approached. Larger: more steps until they are
// rigid; smaller: round-off decides how redundant contacts share an impulse.
constexpr double softness = 1e-7;
// The same where the solver of many points gets no nearer: with friction the redundant points of many faces leave it little but
// round-off to go by. Larger: blocks of a wall creep into each other by this share of their speed.
constexpr double impulseEnough = 1e-8;
// Gain of kinetic energy relative to the kinetic energy before an impact that is round-off, not physics. Smaller: the
// energy cap acts on C = 1 impacts that only round off.
constexpr double energyGain = 1e-11;
// Residual of an impulse problem relative to the largest speed of its points above which the rows of the restitution law
// give way. Larger: a landing corner may go on into its support by this share of its speed.
constexpr double noSolution = 1e-6;
// Length of the old support relative to its distance from the new one above which it is an edge, not a corner; and distance from an edge or
// a corner, relative to the same or to the size of the joint, up to which a loaded point belongs to it (joints/pivot.hpp).
constexpr double pivotEdge = 1e-6;

// --- compliant joints (dynamics/compliant/) ---
// Least area that the stiffness of a joint is taken from, relative to the smaller face. A sliver of overlap, an edge or a
// corner gets the stiffness of this share of the face; smaller: corners sink in.
constexpr double minPatchArea = 0.1;
// Points that close within this distance of each other, relative to the size of the joint, close at one instant. A model
// parameter: which corner of a nearly flat landing comes first is decided by it.
constexpr double mergedClosing = 1e-6;
// A rocking impact slower than this share of sqrt(g/R) ends the rocking (the Zeno end). Larger: the last, smallest
// half cycles are lost; peaks above it do not change.
constexpr double restSpeed = 1e-4;
// Speed relative to a jump of the base above which a point parts from its support at the jump; below it is round-off.
constexpr double parting = 1e-9;
// |cos| of the angle between the normal of a pair and gravity below which the pair is upright when it is found. It is then a head joint,
// unless it bears a block (joints/joint_table.hpp). Larger: leaning beds beside others lose their restitution.
constexpr double uprightJoint = 0.1;
// Part of the largest wanted displacement by which settled gaps may miss theirs. Larger: springs start to vibrate.
constexpr double settle = 1e-9;
// Energy that settling may put into the joints, relative to what they store: the pivot forces of a new phase differ by
// that much at most. Smaller: squat blocks at low restitution start a half cycle with a vibration; larger: a stack that
// comes apart can gain energy.
constexpr double settlingGain = 0.5;
// The same where a joint that was closed lifts: the edge carries what the face did, four times as deep, and if all go as deep there is 16
// times the energy; and the base presses. Smaller: the pivot carries a part of the weight and the block falls into it, again and again.
constexpr double liftingGain = 16;
// How far settling may move a point, relative to the compression of the springs: points that lie nearly in a line ask for turns of
// any size. Smaller: half cycles of stacks start with a vibration; larger: blocks jump.
constexpr double settlingReach = 10;
// Energy that all steps of a run may make, or lose, though nothing accounts for it: share of what is turned over, and of what lifts all
// blocks by their size. Smaller: coarse but sound runs are reported; larger: a run may be wrong by so much in silence.
constexpr double madeShare = 0.05, madeLift = 1e-4;
// The share of what is turned over that compliant joints may make. Smaller: what sound runs with many landings make adds up to it; larger:
// wrong runs are silent.
constexpr double madeByJoints = 7.5e-3;

// Residual of the contact laws, relative to the speed that gravity gives in a step, that is like a millionth of the weight: a step that
// misses them by less says nothing.
constexpr double negligible = 1e-6;

// Share of the step within which two instants are one.
constexpr double instant = 1e-9;
// Angle, rad, by which a block may turn in a step, or in a part of one. Larger: fast spins gain energy.
constexpr double partTurn = 0.25;

// --- method `localised` (dynamics/localised/) ---
namespace localised {
// Share of the stray velocities of points in touch that a steady step takes off. Larger: round-off of the solver is damped sooner; 0: an
// error once made changes its sign for ever.
constexpr double damping = 1. / 16;
// Gap relative to the smallest half size that is zero: ends the search for an impact and the closing of gaps. Larger: impact
// times are wrong by gap / approach speed.
constexpr double gap = 1e-13;
// Speed relative to sqrt(g * smallest half size) at which a penetration is taken off where lifting costs more energy than the contacts
// lose. Larger: a block rises with its weight times this speed; smaller: penetrations, up to the merged gap, stay longer.
constexpr double closingSpeed = 5e-9;
// Energy that the spins may gain in a step over the work on them, relative to the weight times the smallest half size. Smaller: more passes
// over a step.
constexpr double spinEnergy = 1e-11;
// Energy, relative to the same, that a step may give where it takes stray velocities off. Larger: round-off decides more often whether it
// does; smaller: the solver's errors stay in blocks at rest.
constexpr double strayEnergy = 1e-13;
// Relative velocity at a point, relative to what gravity gives in a step, that is zero: a point that parts more slowly
// stays in touch. Smaller: round-off opens closed joints; larger: the first such part of a hop is lost.
constexpr double parting = 1e-6;
// Part of a step, relative to the whole, that is too short to tell accelerations, or whether a loaded point parts: what is left of the
// velocity errors of the step before, relative to the speed that gravity gives in a whole step, is more than its weight gives in the part.
// Smaller values lose the pivot of a block just before it lands, and with it its restitution; larger: a point parts that much later.
constexpr double shortPart = 0.02;
constexpr double stray = 0.01;
// Slip speed, relative to what gravity gives in a whole step, from which on the end of the slip is localised inside the step. The place of
// a point that stops from less is wrong by at most half the product of speed and step, g dt^2/2000. Larger: stops lose the second order;
// smaller: where a structure stops, each of its points stops at an instant of its own, microseconds apart.
constexpr double slowSlip = 1e-3;
// Way relative to the smaller half size by which blocks near each other may pass in a part of a step; and how many parts a step may have at
// most. Larger way: blocks meet with the wrong features; smaller: ordinary steps are divided, at the cost of so many steps. More parts:
// steps beyond all reason take long before they are told of.
constexpr double partWay = 1, maxParts = 1000;
// Energy that a step may make or lose: share of what moves and of what acts in it, and of what lifts all blocks by the smallest half size.
// Smaller: sound steps are told of; larger: wrong ones are not.
constexpr double madeShare = 0.05, madeLift = 1e-4;
// The same for the instant at which a varying acceleration of the base sets in motion what rests; and share of gravity by which the
// acceleration must vary in a step for it to be sought. Larger: that instant is wrong by as much; smaller: more trials.
constexpr double release = 1e-6;
// Share of gravity by which the acceleration of the base must vary in a step to be sought for where blocks turn. Smaller: shaken stacks
// cost more.
constexpr double jump = 0.05;
// Free blocks of a structure in which it is sought. More: in walls contacts lose their force in most steps, though nothing moves, and each
// time it takes some twenty trials to find that out.
constexpr int maxReleased = 5;
} // namespace localised

// --- exact history of one block (rocking/) ---
// A rocking impact slower than this share of sqrt(g/R) ends the rocking (infinitely many impacts in finite time follow).
// Peaks lost are below 1e-16 lambda rad; larger: a block that is lifted again during its last hops starts with an error.
constexpr double zenoSpeed = 1e-8;
// An impact and a pulse closer than this share of the time elapsed (at least 1/p) happen at one instant, the impact first.
constexpr double oneInstant = 1e-12;

} // namespace masonry::tolerance

// --- shapes (shape/) --- lengths relative to the diagonal of the box around the points of the shape
namespace masonry::tolerance::shape {

// Distance within which points are one, vertices lie in one plane and a given vertex lies on the hull. Smaller: faces from files with
// single precision are split into triangles, whose contact points come and go; larger: fine details are lost.
constexpr double plane = 1e-6;
// Distance of vertices from the plane of their face that is round-off. Vertices that are farther off are moved onto it. Smaller: shapes
// that are turned lose the last digits of their vertices; larger: a block stands on three of its four vertices.
constexpr double precise = 1e-13;
// The same for vertices of what is a box. Smaller: boxes that have been turned miss the search for boxes.
constexpr double box = 1e-12;
// Product of inertia, relative to the sum of the moments, that is none. Larger: inertia is wrong by as much; smaller: round-off turns axes.
constexpr double product = 1e-13;
// Difference of two moments, relative to the same, and product between them, that makes them equal: their axes stay as they are given.
// Smaller: the noise of single precision turns the axes of square blocks.
constexpr double equalMoments = 1e-6;

} // namespace masonry::tolerance::shape

// --- contact patches of convex blocks (contact/) --- lengths relative to the smaller thickness of the two
namespace masonry::tolerance::contact {

// Separation that a face must gain before it takes over as reference. Smaller: round-off chooses the normal of faces
// that tie; larger: a face that has slid off its support keeps the normal longer.
constexpr double reference = 1e-7;
// Share of the penetration that adds to it. Smaller: a compressed joint of equal blocks changes its normal while it
// rocks; it must stay below 1.
constexpr double depthShare = 0.5;
// Gain of alignment (cosine) before another face becomes incident. Only a block tilted by 45 degrees notices.
constexpr double incident = 1e-7;
// A vertex this far beyond an edge lies on the edge. Smaller: round-off makes edge crossings out of vertices.
constexpr double slack = 1e-7;
// A vertex that was a corner of the patch stays one up to this far beyond the edge, so that elastic slip in the joint
// changes no feature. Larger: lever arms are wrong by as much.
constexpr double vertexReach = 1e-4;
// Depth below the foot of a part that stands on another one, and height above it, relative to the thinnest part, within which a body is
// looked for off the part below. Smaller: what has sunk deeper goes into the foot; larger: its features may be those of a body that is
// lifted by as much.
constexpr double sunk = 1e-2;
// Distance from a notch between two parts, relative to the thinnest part, within which a corner of another body meets the faces of both.
// Larger: corners there carry points that are open; smaller: what slides down one face in a step is seen when it is in the other.
constexpr double notch = 0.02;
// Overlaps narrower than this are no contact. Smaller: blocks that meet corner to corner push each other sideways;
// larger: a block sliding off an edge falls that much too early.
constexpr double sliver = 1e-4;
// Separation that edge across edge must gain over the best face (the share below of the penetration is added, or
// depthShare where a face was the reference before). Larger: the gap jumps by as much where a vertex slides off an edge.
constexpr double edge = 1e-6;
constexpr double edgeShare = 0.1;
// Penetration up to which a face contact is taken without a look at the edges. Larger: a corner that meets a corner from
// the side can be taken for one from above, deeper by as much; smaller: closed joints cost the nine edge axes.
constexpr double shallow = 1e-4;
// Angle (rad) within which a normal counts as that of a face: no edge across edge between nearly parallel faces, whose
// patch has the right gaps and a normal wrong by at most this angle. Half of it where the edges touched before.
constexpr double faceAngle = 0.1;
// Sine of the angle between two edges below which they are parallel. Smaller: round-off divided by it enters the normal.
constexpr double parallelEdges = 1e-3;

// Least component of the common normal of two crossing edges along the faces' normal and along the sum of the outward normals
// beside either edge (1 or more where edges touch), for the crossing to be a contact point. Smaller: points push to the side, at 0
// to the wrong side; larger: yawed blocks lose corners while they rock.
constexpr double crossing = 0.2;

// Sine of the angle between two faces from which on one leans on the border of the other. Larger: a vertex that slides over that border is
// kicked by it; smaller: vertices of flat joints come and go.
constexpr double leans = 1e-3;
// Sine of the angle between two faces from which on a corner on a corner has both normals. Larger: the friction of corners is one-sided by
// this angle; smaller: a flat joint carries more rows.
constexpr double cornerSpread = 0.02;
// Distance from that border, relative to the smallest half size, within which such a vertex is none of the contact. Larger: where the block
// falls back on its face, that carries it so far from its end; smaller: what slides farther in a step is kicked.
constexpr double passing = 0.02;
// Penetration, relative to the smallest half size, by features that a pair did not have at the start of a step, from which on the step is
// done in parts. Larger: blocks are so deep in each other where a corner passes another; smaller: features that change within the reach of
// vertices (contact::vertexReach) divide steps.
constexpr double unseen = vertexReach;

} // namespace masonry::tolerance::contact

// --- contact problem (laws/) ---
namespace masonry::tolerance::contactProblem {

// Softness R of a point in Newton's first step, relative to its own response. Larger: more steps until the impulses are those
// of rigid contact; smaller: more changes of state in the first.
constexpr double softness = 1e-2;
// The smallest that it falls to. Larger: tall columns and large mass ratios converge linearly; smaller: round-off of the
// factorisation.
constexpr double minSoftness = 1e-9;
// The softness of a first step from impulses close to the solution. Larger: a second centre, more changes of state; smaller: round-off
// decides the states of unloaded points.
constexpr double resumedSoftness = 3e-9;
// Relative distance from the friction cone at which an impulse given is taken to slip. Larger: sticking points start as slipping;
// smaller: round-off makes slipping ones stick. Either costs a factorisation.
constexpr double onCone = 1e-9;
// Share of the friction limit within which a point counts as sliding.
constexpr double cone = 1e-9;
// Weights of all blocks of a structure with which a body of prescribed motion presses where no motion obeys the laws. Larger: it takes more
// energy to go into a block that it jams; smaller: it goes into blocks that it could still push.
constexpr double maxWeights = 10;

} // namespace masonry::tolerance::contactProblem

// --- method `wall` (dynamics/wall/), beside AdmmSettings (admm_solver.hpp) ---
namespace masonry::tolerance::wall {

// Relative movement of a pair, relative to the smallest half size, after which the features in touch are looked up again. Larger: a vertex
// that has slid over the end of a face is held there that much longer; smaller: walls that move spend their time on it.
constexpr double search = 1e-3;
// Distance past the end of its face, relative to the smallest half size, at which a vertex is looked up again at once. Larger: the normal
// of the wrong face may hold a joint closed; smaller, down to contact::slack, within which a vertex still lies on the end: what the solver
// leaves at rest has points looked up, and walls in space are factorised more often. Table: what failed in wall.
constexpr double leftFace = 10 * contact::slack;
// Share of the velocities that an impact changes by which its points may miss the contact laws. Larger: blocks that go into each other
// are not told of; smaller: sound impacts are.
constexpr double missedImpact = 1e-2;
// Angle, rad, by which a block may turn while nothing moves before normals and arms follow. Larger: forces and gaps are so much askew.
constexpr double turned = 1e-7;
// Gap relative to the smallest half size up to which a point takes part in an impact or a base pulse. Larger: points that are open carry
// impulses; smaller: some of the points that close together are left out.
constexpr double touching = 1e-4;
// Relative velocity of points in reach, relative to the speed of rest (restSpeed sqrt(g half size)), above which blocks count as moving.
// Larger: frames stay while blocks creep; smaller: what the solver leaves at rest counts as motion.
constexpr double motion = 5;
// Depth of a pair relative to the smallest half size above which a step in which blocks move takes it off by positions, and the depth that
// it leaves. Larger: blocks are deeper in each other; smaller: loaded points sink a little in each step, and lifting them costs time;
// nearer to each other: a wall that comes to rest is lifted again and again.
constexpr double penetration = 1.15e-5;
constexpr double lifted = 5.75e-6;
// Depth above which a step that takes penetrations off cannot be trusted. Larger: blocks that sink into each other are not told of;
// smaller: those that hit hard are.
constexpr double sunk = 1e-3;
// Depth at the start of a step above which it cannot be trusted: the limit of validation/stability. Larger: thin blocks that go far in a
// step are found in others without a word; smaller: towers that collapse are told of (3e-3 in steps of 1 ms).
constexpr double foundDeep = 1e-2;
// Energy that a step may seem to make: share of what moves and what the forces do in it, and of what lifts all blocks by the smallest half
// size. Where both are zero it may seem to make that of a speed: of blocks that go so far in a step, relative to the smallest half size.
// Smaller: the errors of sound steps, 1e-3 of what is lost, or rounding, are reported; larger: a wall that flies apart is not.
constexpr double createdShare = 0.1, createdLift = 1e-4, createdTravel = 1e-9;
// The same as pivotEdge, relative to the smallest half size: steps leave blocks up to 1e-5 of it from where they touch. Larger: narrow
// patches rock; smaller: rocking joints of walls lose their restitution.
constexpr double pivot = 1e-3;

} // namespace masonry::tolerance::wall

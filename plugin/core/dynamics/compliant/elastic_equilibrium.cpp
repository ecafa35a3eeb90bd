#include "dynamics/compliant/elastic_equilibrium.hpp"
#include "dynamics/compliant/instant.hpp"
#include "dynamics/compliant/settling.hpp"
#include "impact/impulse_problem.hpp" // axesAlong
#include "tolerances.hpp"
#include <Eigen/SparseCholesky>
#include <limits>
#include <tuple>

namespace masonry {

namespace {

using Rows = Eigen::Matrix<double, 3, 12>; // normal and two tangents, by displacement and turn of body 1, then of body 2

struct Spring { // of a point that may carry
	int contact, point, body1, body2;
	double gap, weight, normal, shear; // m, share of the face, N/m: of the point's own springs (joint_contact.hpp: r k_n A w_i)
	Rows rows;
	double raised {0}; // what the rest of the face adds to its depth, m: (1 - r) sum N_j / (r k_n A)
	bool closed {true}, slips {false};
	Vector2 friction {Vector2::Zero()}; // where it slips: on body 2, N
	Vector3 change {Vector3::Zero()};   // along the rows, m
	Vector3 before {Vector3::Zero()};   // the same in the last turn

	Vector3 stiffness() const { return {closed ? normal : 0, closed && !slips ? shear : 0, closed && !slips ? shear : 0}; }
	// This stiffness stands in for a spring that carries nothing, so that no body is without any. It pulls back to where the last turn has
	// left the point, and its force goes to zero. Larger: more turns.
	Vector3 standIn() const
	{
		constexpr double share = 1e-2;
		return share * (Vector3(normal, shear, shear) - stiffness());
	}

	double depth() const { return -gap - change[0]; }
	double force() const { return normal * (depth() + raised); } // of the normal springs where it carries, N
	Vector2 pull() const { return -shear * change.tail<2>(); }   // of the shear spring, on body 2, N
};

std::vector<Spring> springsOf(const JointSystem& s, const std::vector<HeldPoint>& points)
{
	std::vector<Spring> springs;
	const ImpulsePoints<Space> places = impulsePoints(s.contacts, points);
	for (size_t k = 0; k < points.size(); ++k) {
		const auto [c, i] = std::pair(points[k].contact, points[k].point);
		const JointContact& contact = s.contacts[c];
		Spring spring {c,
		               i,
		               contact.body1,
		               contact.body2,
		               contact.patch.points[i].gap,
		               contact.patch.points[i].weight,
		               contact.turnShare * contact.normalStiffness() * contact.patch.points[i].weight,
		               contact.shearStiffness(i),
		               Rows::Zero()};
		const Matrix3 axes = axesAlong(contact.patch.normal);
		for (const auto& [body, sign, column] : {std::tuple(contact.body1, -1., 0), std::tuple(contact.body2, 1., 6)}) {
			const Vector3 arm = contact.position(i) - s.bodies[body].pose.position;
			spring.rows.block<3, 3>(0, column) = sign * axes;
			for (int row = 0; row < 3; ++row)
				spring.rows.block<1, 3>(row, column + 3) =
				    sign * (row == 0 ? arm : Vector3(arm + places[k].grip)).cross(axes.row(row).transpose()).transpose();
		}
		springs.push_back(spring);
	}
	return springs;
}

struct Face { // the springs [begin, end) of one contact
	size_t begin, end;
	double turnShare, stiffness; // r; k_n A, N/m
};

class Equilibrium {
public:
	Equilibrium(const JointSystem& s, const RigidAcceleration& rates, const std::vector<HeldPoint>& points)
	    : springs(springsOf(s, points)), system(s)
	{
		std::vector<char> isHeld(s.bodies.size(), 0);
		for (const Spring& spring : springs)
			isHeld[spring.body1] = isHeld[spring.body2] = 1;
		for (size_t b = 0; b < s.bodies.size(); ++b)
			place.push_back(isHeld[b] && !s.bodies[b].prescribed ? size++ : -1);
		for (size_t k = 0; k < springs.size(); ++k) {
			const JointContact& contact = s.contacts[springs[k].contact];
			if (k == 0 || springs[k].contact != springs[k - 1].contact)
				faces.push_back({k, k, contact.turnShare, contact.normalStiffness()});
			++faces.back().end;
		}
		loads = Eigen::VectorXd::Zero(6 * size);
		for (size_t b = 0; b < s.bodies.size(); ++b)
			if (const RigidBody<Space>& body = s.bodies[b]; place[b] >= 0) {
				const Matrix3 axes = body.pose.orientation.toRotationMatrix();
				loads.segment<3>(6 * place[b]) = body.force.head<3>() - body.mass * rates.linear[b];
				loads.segment<3>(6 * place[b] + 3) =
				    body.force.tail<3>() - axes * body.inertia.asDiagonal() * axes.transpose() * rates.angular[b];
			}
	}

	// Returns whether the springs hold the bodies.
	bool solve()
	{
		constexpr int most = 200; // turns: up to ten for plain walls, 30 where a wall has openings
		for (int turn = 0; turn < most; ++turn) {
			if (!displace())
				return false;
			if (!updateStates())
				return true;
		}
		return false;
	}

	Eigen::VectorXd displacements;
	std::vector<Spring> springs;

	Eigen::Matrix<double, 6, 1> displacement(int body) const
	{
		return place[body] < 0 ? Eigen::Matrix<double, 6, 1>::Zero()
		                       : Eigen::Matrix<double, 6, 1>(displacements.segment<6>(6 * place[body]));
	}

private:
	bool displace()
	{
		std::vector<Eigen::Triplet<double>> entries;
		Eigen::VectorXd right = loads;
		const auto add = [&](const Spring& spring, const Eigen::Matrix<double, 12, 12>& block, const Eigen::Matrix<double, 12, 1>& given) {
			const int first[2] {place[spring.body1], place[spring.body2]};
			for (int a = 0; a < 2; ++a) {
				if (first[a] < 0)
					continue;
				right.segment<6>(6 * first[a]) += given.segment<6>(6 * a);
				for (int b = 0; b < 2; ++b)
					for (int row = 0; first[b] >= 0 && row < 6; ++row)
						for (int column = 0; column < 6; ++column)
							entries.emplace_back(6 * first[a] + row, 6 * first[b] + column, block(6 * a + row, 6 * b + column));
			}
		};
		for (const Spring& spring : springs) {
			const Vector3 stiffness = spring.stiffness(), standIn = spring.standIn();
			add(spring, spring.rows.transpose() * (stiffness + standIn).asDiagonal() * spring.rows,
			    spring.rows.transpose() *
			        (Vector3(-stiffness[0] * spring.gap, spring.friction.x(), spring.friction.y()) + standIn.cwiseProduct(spring.change)));
		}
		for (const Face& face : faces) { // the springs that its points share
			Eigen::Matrix<double, 12, 1> row = Eigen::Matrix<double, 12, 1>::Zero();
			double gap = 0;
			for (size_t k = face.begin; k < face.end; ++k)
				if (springs[k].closed) {
					row += springs[k].weight * springs[k].rows.row(0).transpose();
					gap += springs[k].weight * springs[k].gap;
				}
			const double stiffness = sharedStiffness(face);
			add(springs[face.begin], stiffness * row * row.transpose(), -stiffness * gap * row);
		}
		Eigen::SparseMatrix<double> K(6 * size, 6 * size);
		K.setFromTriplets(entries.begin(), entries.end());
		const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(K);
		if (factor.info() != Eigen::Success)
			return false;
		displacements = factor.solve(right);
		constexpr double accurate = 1e-9; // relative residual. A singular matrix, of a body that can turn about its points, leaves more
		if (!((K * displacements - right).norm() <= accurate * right.norm()))
			return false;
		for (Spring& spring : springs) {
			Eigen::Matrix<double, 12, 1> x;
			x << displacement(spring.body1), displacement(spring.body2);
			spring.before = spring.change;
			spring.change = spring.rows * x;
		}
		for (const Face& face : faces) {
			double depth = 0;
			for (size_t k = face.begin; k < face.end; ++k)
				if (springs[k].closed)
					depth += springs[k].weight * springs[k].depth();
			for (size_t k = face.begin; k < face.end; ++k)
				springs[k].raised = sharedStiffness(face) * depth / (face.turnShare * face.stiffness);
		}
		return true;
	}

	// Returns the stiffness of the springs that the closed points share, N/m: (1 - r) r k_n A / (1 - (1 - r) w).
	double sharedStiffness(const Face& face) const
	{
		double weights = 0;
		for (size_t k = face.begin; k < face.end; ++k)
			weights += springs[k].closed ? springs[k].weight : 0;
		return (1 - face.turnShare) * face.turnShare * face.stiffness / (1 - (1 - face.turnShare) * weights);
	}

	// Opens and closes points, and lets them slip as far as friction asks. Returns whether any force has changed.
	bool updateStates()
	{
		double deepest = 0, stiffest = 0;
		for (const Spring& spring : springs) {
			deepest = std::max(deepest, spring.depth());
			stiffest = std::max(stiffest, spring.normal);
		}
		bool changed = false;
		for (Spring& spring : springs) {
			changed |= spring.standIn().cwiseProduct(spring.change - spring.before).norm() > tolerance::settle * stiffest * deepest;
			const bool closes = spring.depth() + spring.raised > (spring.closed ? 0 : tolerance::settle * deepest);
			changed |= closes != spring.closed;
			spring.closed = closes;
			const double bound = system.contacts[spring.contact].law.friction * std::max(0., spring.force());
			const Vector2 pull = spring.pull(), earlier = spring.friction;
			spring.slips = closes && pull.norm() > bound;
			spring.friction = spring.slips ? Vector2(bound / pull.norm() * pull) : Vector2(Vector2::Zero());
			changed |= (spring.friction - earlier).norm() > tolerance::settle * stiffest * deepest;
		}
		return changed;
	}

	const JointSystem& system;
	std::vector<Face> faces;
	std::vector<int> place; // of a body among those that the springs hold; -1: none
	int size {0};
	Eigen::VectorXd loads; // force, then moment, by such body
};

} // namespace

std::pair<std::vector<HeldPoint>, std::vector<HeldPoint>> divideByRest(const JointSystem& s, const RigidAcceleration& rates)
{
	constexpr double still = 1e-6; // of gravity. Larger: a block that begins to rock is taken for one that stands
	const double level = still * s.gravity.norm();
	std::vector<char> moves(s.bodies.size(), 0);
	const auto bodiesOf = [&](const HeldPoint& p) { return std::pair(s.contacts[p.contact].body1, s.contacts[p.contact].body2); };
	for (const HeldPoint& p : rates.points) {
		const auto [a, b] = bodiesOf(p);
		const auto at = [&](int body) {
			return Vector3(rates.linear[body] +
			               rates.angular[body].cross(s.contacts[p.contact].position(p.point) - s.bodies[body].pose.position));
		};
		if (!((at(a) - at(b)).norm() <= level && (rates.linear[a] - rates.linear[b]).norm() <= level))
			moves[a] = moves[b] = 1;
	}
	for (bool spreads = true; spreads;) {
		spreads = false;
		for (const HeldPoint& p : rates.points) {
			const auto [a, b] = bodiesOf(p);
			if (moves[a] != moves[b] && !s.bodies[a].prescribed && !s.bodies[b].prescribed)
				moves[a] = moves[b] = spreads = true;
		}
	}
	std::pair<std::vector<HeldPoint>, std::vector<HeldPoint>> result;
	for (const HeldPoint& p : rates.points) {
		const auto [a, b] = bodiesOf(p);
		const bool isMoving = (moves[a] && !s.bodies[a].prescribed) || (moves[b] && !s.bodies[b].prescribed);
		(isMoving ? result.second : result.first).push_back(p);
	}
	return result;
}

bool findElasticEquilibrium(JointSystem& s, const RigidAcceleration& rates, const std::vector<HeldPoint>& points)
{
	if (points.empty())
		return true;
	Equilibrium equilibrium(s, rates, points);
	if (!equilibrium.solve())
		return false;
	const Bodies<Space> before = s.bodies;
	for (size_t b = 0; b < s.bodies.size(); ++b) {
		const auto moved = equilibrium.displacement(int(b));
		RigidBody<Space> moving = s.bodies[b]; // over unit time
		moving.velocity = moved;
		moving.advance(1);
		s.bodies[b].pose = moving.pose;
	}
	moveContacts(s, before);
	for (JointContact& contact : s.contacts)
		holdForces(contact);
	return true;
}

void startAtEquilibrium(JointSystem& s)
{
	double size = 0;
	for (const JointContact& contact : s.contacts)
		size = std::max(size, std::sqrt(contact.patch.nominalArea));
	const auto near = [&](const JointContact& contact, int i) { return contact.patch.points[i].gap <= tolerance::mergedClosing * size; };
	// The dense solver's forces are those of least norm: without self-stress, and symmetric where the scene is.
	constexpr size_t maxDense = 100;
	std::vector<HeldPoint> held = selectPoints(s.contacts, near);
	const ImpulseSolver<Space> solve = held.size() <= maxDense ? solveImpulses<Space> : solveSparsely<Space>;
	const RigidAcceleration rates = accelerations(s, std::move(held), solve);
	const auto [resting, others] = divideByRest(s, rates);
	const bool isFound = findElasticEquilibrium(s, rates, resting);
	settle(s, isFound ? others : rates.points, std::numeric_limits<double>::infinity()); // whatever energy it takes
	goForth(s, rates, 0.);                                                               // velocities go half a step back
}

} // namespace masonry

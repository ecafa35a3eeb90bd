#include "dynamics/compliant/time_step.hpp"
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>
#include <limits>

namespace masonry {

namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

struct BodyMatrices {
	Matrix6 stiffness = Matrix6::Zero(), damping = Matrix6::Zero(); // about the centre, global axes
	bool hasFreeNeighbour {false};
};

// Adds J^T k J, but for its lower left quarter, of a point at the end of the arm, J = (1, -arm x): the rows of k (arm x) are those of k,
// each times (cross) the arm.
void addPoint(Matrix6& sum, const Vector3& arm, const Matrix3& point)
{
	const Matrix3 turned = point.rowwise().cross(arm);
	sum.topLeftCorner<3, 3>() += point;
	sum.topRightCorner<3, 3>() -= turned;
	sum.bottomRightCorner<3, 3>() += turned.colwise().cross(arm);
}

// Along a tie its stiffness, across it that of its force, N/L.
void addTie(std::vector<BodyMatrices>& result, const Bodies<Space>& bodies, const Tie<Space>& tie)
{
	const auto line = Tie<Space>::line(tie, bodies[tie.body1].pose, bodies[tie.body2].pose);
	if (tie.broken || !(line.length > 0))
		return;
	const Matrix3 along = line.direction * line.direction.transpose();
	const Matrix3 stiffness = tie.stiffness * along + std::max(0., tie.force) / line.length * (Matrix3::Identity() - along);
	for (const auto& [b, end] : {std::pair(tie.body1, line.end1), std::pair(tie.body2, line.end2)}) {
		if (bodies[b].prescribed)
			continue;
		result[b].hasFreeNeighbour |= !bodies[tie.body1].prescribed && !bodies[tie.body2].prescribed;
		addPoint(result[b].stiffness, end - bodies[b].pose.position, stiffness);
	}
}

// A joint with mortar may have so many times the normal stiffness and the dashpots of its closed face. While an edge of it still presses,
// all fibres of its mortar may pull already: of a rectangle that is 1.95 times the closed face at worst, of a triangle 1.96, of convex
// polygons that are far from regular up to 2.07 (docs/mortar.md, validation/mortar/stiffest.py). Both together are twice the face at most,
// but for polygons whose points and fibres turn about different axes. Shear acts at the fibres alone, and turns less stiffly than at the
// corners.
constexpr double withMortar = 2.1;

// Those of a body whose neighbours move freely are doubled. The result holds until the next call: it keeps its memory from step to step.
const std::vector<BodyMatrices>& bodyMatrices(const Bodies<Space>& bodies, const std::vector<JointContact>& contacts, const Ties& ties)
{
	thread_local std::vector<BodyMatrices> result;
	result.assign(bodies.size(), {});
	for (const JointContact& contact : contacts) {
		const bool bothFree = !bodies[contact.body1].prescribed && !bodies[contact.body2].prescribed;
		const double mass = reducedMass(bodies[contact.body1], bodies[contact.body2]), turnShare = contact.turnShare;
		const Vector3& n = contact.patch.normal;
		const auto tensor = [&n](double normal, double shear) -> Matrix3 {
			return (normal - shear) * n * n.transpose() + shear * Matrix3::Identity();
		};
		// A share of the normal springs and dashpots of a closed face acts at the points, and the rest at their centroid.
		const double pulls = contact.law.hasMortar || contact.isBonded() ? withMortar : 1;
		const double k = pulls * contact.normalStiffness(), c = pulls * contact.dampingNormal(mass), cShear = contact.dampingShear(mass);
		const Matrix3 stiffness = tensor(turnShare * k, contact.law.shearStiffness * contact.stiffnessArea()),
		              damping = tensor(turnShare * c, cShear);
		for (int b : {contact.body1, contact.body2}) {
			if (bodies[b].prescribed)
				continue;
			result[b].hasFreeNeighbour |= bothFree;
			const auto add = [&](const Vector3& place, const Matrix3& stiffnessThere, const Matrix3& dampingThere) {
				const Vector3 arm = place - bodies[b].pose.position;
				addPoint(result[b].stiffness, arm, stiffnessThere);
				addPoint(result[b].damping, arm, dampingThere);
			};
			Vector3 centroid = Vector3::Zero();
			for (int i = 0; i < contact.size(); ++i) {
				const double weight = contact.patch.points[i].weight;
				const Vector3 place = contact.position(i);
				centroid += weight * place;
				add(place, weight * stiffness, weight * damping);
			}
			add(centroid, tensor((1 - turnShare) * k, 0), tensor((1 - turnShare) * c, 0));
		}
	}
	for (const Tie<Space>& tie : ties)
		addTie(result, bodies, tie);
	for (BodyMatrices& ofBody : result)
		for (Matrix6* sum : {&ofBody.stiffness, &ofBody.damping}) {
			sum->bottomLeftCorner<3, 3>() = sum->topRightCorner<3, 3>().transpose();
			if (ofBody.hasFreeNeighbour)
				*sum *= 2;
		}
	return result;
}

Matrix6 massMatrix(const RigidBody<Space>& body)
{
	const Matrix3 axes = body.pose.orientation.toRotationMatrix();
	Matrix6 mass = Matrix6::Zero();
	mass.topLeftCorner<3, 3>() = body.mass * Matrix3::Identity();
	mass.bottomRightCorner<3, 3>() = axes * body.inertia.asDiagonal() * axes.transpose();
	return mass;
}

} // namespace

double criticalTimeStep(const Bodies<Space>& bodies, const std::vector<JointContact>& contacts, const Ties& ties)
{
	const auto& matrices = bodyMatrices(bodies, contacts, ties);
	double highest = 0; // omega^2
	for (size_t b = 0; b < bodies.size(); ++b) {
		if (bodies[b].prescribed)
			continue;
		const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix6> solver(matrices[b].stiffness, massMatrix(bodies[b]),
		                                                               Eigen::EigenvaluesOnly);
		highest = std::max(highest, solver.eigenvalues().maxCoeff());
	}
	return highest > 0 ? 2 / std::sqrt(highest) : std::numeric_limits<double>::infinity();
}

double largestTimeStep(const Bodies<Space>& bodies, const std::vector<JointContact>& contacts, const Ties& ties)
{
	constexpr int halvings = 10;
	double refused = criticalTimeStep(bodies, contacts, ties); // without dashpots: above what is stable
	double accepted = std::isfinite(refused) ? 0 : refused;
	for (int k = 0; k < halvings && accepted < refused; ++k) {
		const double middle = 0.5 * (accepted + refused);
		(isStableTimeStep(bodies, contacts, ties, middle) ? accepted : refused) = middle;
	}
	return accepted;
}

double chosenTimeStep(const Bodies<Space>& bodies, const std::vector<JointContact>& contacts, const Ties& ties, double fraction)
{
	constexpr double ofLargest =
	    0.75; // larger: it becomes unstable where blocks move a little; smaller: scenes without need take a shorter step
	return std::min(fraction * criticalTimeStep(bodies, contacts, ties), ofLargest * largestTimeStep(bodies, contacts, ties));
}

bool isStableTimeStep(const Bodies<Space>& bodies, const std::vector<JointContact>& contacts, const Ties& ties, double dt, double undamped)
{
	const auto& matrices = bodyMatrices(bodies, contacts, ties);
	for (size_t b = 0; b < bodies.size(); ++b) {
		if (bodies[b].prescribed)
			continue;
		const Matrix6 mass = 4 * massMatrix(bodies[b]);
		const auto isPositive = [](const Matrix6& rest) { return Eigen::LLT<Matrix6>(rest).info() == Eigen::Success; };
		if (!isPositive(mass - 2 * dt * matrices[b].damping - dt * dt * matrices[b].stiffness) ||
		    (undamped > dt && !isPositive(mass - undamped * undamped * matrices[b].stiffness)))
			return false;
	}
	return true;
}

} // namespace masonry

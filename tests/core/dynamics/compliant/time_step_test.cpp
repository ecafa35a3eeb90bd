// The stable time step of assembled blocks against the eigenvalues of one step of the whole scheme, by dense matrices.
#include "dynamics/compliant/time_step.hpp"
#include <Eigen/Eigenvalues>
#include <catch.hpp>
#include <cmath>
#include <random>

using namespace masonry;

namespace {

struct Assembly {
	Bodies<Space> bodies;
	std::vector<JointContact> contacts;
	Ties ties;
	std::mt19937 random;

	explicit Assembly(unsigned seed) : random(seed) {}

	double uniform(double from, double to) { return std::uniform_real_distribution<double>(from, to)(random); }
	Vector3 anyVector(double size) { return size * Vector3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)); }

	void addBody(bool prescribed)
	{
		RigidBody<Space> body;
		body.mass = std::pow(10, uniform(1, 4));
		const Vector3 half {uniform(0.05, 1), uniform(0.05, 1), uniform(0.05, 1)}, s = half.cwiseAbs2();
		body.inertia = body.mass / 3 * Vector3(s.y() + s.z(), s.x() + s.z(), s.x() + s.y());
		body.pose.position = anyVector(1);
		body.pose.orientation = Quaternion(Eigen::AngleAxisd(uniform(0, 3), anyVector(1).normalized()));
		body.prescribed = prescribed;
		bodies.push_back(body);
	}

	// With points anywhere near both bodies: what a joint may be at most.
	void join(int body1, int body2, double dampingRatio)
	{
		JointContact contact;
		contact.body1 = body1;
		contact.body2 = body2;
		contact.law = {std::pow(10, uniform(8, 11)), std::pow(10, uniform(8, 11)), dampingRatio, 0.5, 0};
		contact.points.resize(1 + size_t(uniform(0, 8)));
		contact.patch.points.resize(contact.points.size());
		contact.patch.normal = anyVector(1).normalized();
		contact.patch.area = contact.patch.nominalArea = uniform(0.01, 1);
		const Vector3 middle = 0.5 * (bodies[body1].pose.position + bodies[body2].pose.position);
		for (int i = 0; i < contact.size(); ++i) {
			PatchPoint& point = contact.patch.points[i];
			point.position1 = point.position2 = middle + anyVector(0.5);
			point.weight = 1. / contact.size();
		}
		followPatch(contact);
		contacts.push_back(contact);
	}

	// A taut tie between any points of two bodies, as stiff as a joint, that carries no force.
	void tie(int body1, int body2)
	{
		Tie<Space> made;
		made.body1 = body1;
		made.body2 = body2;
		made.point1 = anyVector(0.5);
		made.point2 = anyVector(0.5);
		made.stiffness = std::pow(10, uniform(7, 10));
		ties.push_back(made);
	}

	// Largest modulus of the eigenvalues of a step (velocities half a step behind, dashpots by those velocities), over all free bodies.
	double amplification(double dt) const
	{
		std::vector<int> free;
		for (size_t b = 0; b < bodies.size(); ++b)
			if (!bodies[b].prescribed)
				free.push_back(int(b));
		const int n = 6 * int(free.size());
		Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(n, n), stiffness = mass, damping = mass;
		for (size_t k = 0; k < free.size(); ++k) {
			const RigidBody<Space>& body = bodies[free[k]];
			mass.block<3, 3>(6 * k, 6 * k) = body.mass * Matrix3::Identity();
			mass.block<3, 3>(6 * k + 3, 6 * k + 3) = body.inverseInertia().inverse();
		}
		for (const JointContact& contact : contacts) {
			const double inverse = bodies[contact.body1].inverseMass() + bodies[contact.body2].inverseMass();
			// The face turns as if springs of the share r stood at its points and the rest at their centroid (joint_contact.hpp).
			const double turnShare = contact.turnShare;
			Vector3 centroid = Vector3::Zero();
			for (int i = 0; i < contact.size(); ++i)
				centroid += contact.patch.points[i].weight * contact.patch.points[i].position1;
			for (int i = 0; i <= contact.size(); ++i) {
				const Vector3 place = i < contact.size() ? contact.patch.points[i].position1 : centroid;
				// Relative velocity of the point for a unit velocity of each coordinate.
				Eigen::MatrixXd rates = Eigen::MatrixXd::Zero(3, n);
				for (size_t k = 0; k < free.size(); ++k)
					for (int axis = 0; axis < 6; ++axis) {
						RigidBody<Space> moving = bodies[free[k]];
						moving.velocity = Space::Velocity::Unit(axis);
						const Vector3 at = moving.velocityAt(place);
						rates.col(6 * int(k) + axis) = (contact.body2 == free[k] ? at : Vector3(Vector3::Zero())) -
						                               (contact.body1 == free[k] ? at : Vector3(Vector3::Zero()));
					}
				const Eigen::RowVectorXd along = contact.patch.normal.transpose() * rates;
				const Eigen::MatrixXd across = rates - contact.patch.normal * along;
				const double shear = i < contact.size() ? contact.patch.points[i].weight : 0;
				const double weight = i < contact.size() ? turnShare * shear : 1 - turnShare;
				const double kn = contact.law.normalStiffness * contact.patch.area, ks = contact.law.shearStiffness * contact.patch.area;
				const double zeta = contact.law.dampingRatio;
				stiffness += weight * kn * along.transpose() * along + shear * ks * across.transpose() * across;
				damping += 2 * zeta / std::sqrt(inverse) *
				           (weight * std::sqrt(kn) * along.transpose() * along + shear * std::sqrt(ks) * across.transpose() * across);
			}
		}
		for (const Tie<Space>& made : ties) {
			const auto line = Tie<Space>::line(made, bodies[made.body1].pose, bodies[made.body2].pose);
			Eigen::RowVectorXd rate = Eigen::RowVectorXd::Zero(n); // of its length
			for (size_t k = 0; k < free.size(); ++k)
				for (int axis = 0; axis < 6; ++axis) {
					RigidBody<Space> moving = bodies[free[k]];
					moving.velocity = Space::Velocity::Unit(axis);
					if (made.body1 == free[k])
						rate[6 * int(k) + axis] += line.direction.dot(moving.velocityAt(line.end1));
					if (made.body2 == free[k])
						rate[6 * int(k) + axis] -= line.direction.dot(moving.velocityAt(line.end2));
				}
			stiffness += made.stiffness * rate.transpose() * rate;
		}
		const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(n, n), kept = one - dt * mass.ldlt().solve(damping);
		const Eigen::MatrixXd pushed = -dt * dt * mass.ldlt().solve(stiffness);
		Eigen::MatrixXd step(2 * n, 2 * n); // of x and u = dt v: u' = kept u + pushed x, x' = x + u'
		step << one + pushed, kept, pushed, kept;
		return Eigen::EigenSolver<Eigen::MatrixXd>(step, false).eigenvalues().cwiseAbs().maxCoeff();
	}

	// Bisection between a stable and an unstable step.
	template <class Stable>
	static double largest(double first, Stable stable)
	{
		double good = first, bad = first;
		while (!stable(good))
			good /= 2;
		while (stable(bad))
			bad *= 2;
		for (int k = 0; k < 40; ++k) {
			const double middle = 0.5 * (good + bad);
			(stable(middle) ? good : bad) = middle;
		}
		return good;
	}

	double accepted() const
	{
		return largest(1e-4, [&](double dt) { return isStableTimeStep(bodies, contacts, ties, dt); });
	}
	// Bodies that nothing holds have double eigenvalues 1, which round-off parts by its square root.
	double stable() const
	{
		return largest(1e-4, [&](double dt) { return amplification(dt) < 1 + 1e-5; });
	}
};

} // namespace

TEST_CASE("The step accepted for a block on a base is the largest stable one")
{
	for (unsigned seed = 0; seed < 40; ++seed) {
		Assembly assembly(seed);
		assembly.addBody(true);
		assembly.addBody(false);
		const double zeta = seed % 4 == 0 ? 0 : assembly.uniform(0, 1);
		for (unsigned k = 0; k <= seed % 3; ++k)
			assembly.join(0, 1, zeta);
		if (seed % 2 == 0)
			assembly.tie(int(seed % 4) / 2, 1 - int(seed % 4) / 2);
		INFO("seed " << seed << ", damping ratio " << zeta);
		CHECK(assembly.accepted() == Approx(assembly.stable()).epsilon(1e-4)); // by the modulus 1 + 1e-5 that counts as stable
		if (zeta == 0)
			CHECK(criticalTimeStep(assembly.bodies, assembly.contacts, assembly.ties) == Approx(assembly.stable()).epsilon(1e-4));
	}
}

TEST_CASE("The step accepted for blocks on each other is stable, and at least half of the largest")
{
	for (unsigned seed = 0; seed < 60; ++seed) {
		Assembly assembly(1000 + seed);
		const int free = 2 + int(seed % 4);
		assembly.addBody(true);
		const double zeta = seed % 4 == 0 ? 0 : assembly.uniform(0, 1);
		for (int b = 1; b <= free; ++b) {
			assembly.addBody(false);
			if (b > 1 || seed % 5 != 0) // every fifth stands on nothing
				assembly.join(b - 1, b, zeta);
			if (b > 1 && assembly.uniform(0, 1) < 0.5)
				assembly.join(b, int(assembly.uniform(0, b)), zeta);
			if (seed % 3 == 0)
				assembly.tie(b, b - 1);
		}
		const double accepted = assembly.accepted(), stable = assembly.stable();
		INFO("seed " << seed << ", " << free << " blocks, damping ratio " << zeta);
		CHECK(assembly.amplification(0.999 * accepted) < 1 + 1e-5);
		CHECK(accepted <= 1.0001 * stable);
		CHECK(accepted > 0.5 * stable); // doubled stiffness and damping: 1 / sqrt(2) without dashpots, 1 / 2 by dashpots alone
		CHECK(criticalTimeStep(assembly.bodies, assembly.contacts, assembly.ties) >= accepted * 0.999999);
	}
}

#include "dynamics/compliant/time_step.hpp"
#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

namespace masonry {

double criticalTimeStep(const std::vector<Body>& bodies, const std::vector<JointContact>& contacts)
{
	using Matrix6 = Eigen::Matrix<double, 6, 6>;
	std::vector<Matrix6> stiffness(bodies.size(), Matrix6::Zero());
	std::vector<double> factor(bodies.size(), 1.);
	for (const JointContact& contact : contacts) {
		const bool bothFree = !bodies[contact.body1].prescribed && !bodies[contact.body2].prescribed;
		for (int b : {contact.body1, contact.body2}) {
			if (bothFree)
				factor[b] = 2;
			for (int i = 0; i < contact.size; ++i) {
				const Vector3& n = contact.patch.normal;
				const Vector3 arm = contact.position(i) - bodies[b].pose.position;
				Eigen::Matrix<double, 3, 6> J;
				J.leftCols<3>().setIdentity();
				for (int k = 0; k < 3; ++k)
					J.block<1, 3>(k, 3) = arm.cross(Vector3(Vector3::Unit(k))).transpose();
				const double kn = contact.normalStiffness(i), ks = contact.shearStiffness(i);
				const Matrix3 point = (kn - ks) * n * n.transpose() + ks * Matrix3::Identity();
				stiffness[b] += J.transpose() * point * J;
			}
		}
	}
	double highest = 0; // omega^2
	for (size_t b = 0; b < bodies.size(); ++b) {
		if (bodies[b].prescribed)
			continue;
		Matrix6 mass = Matrix6::Zero();
		mass.topLeftCorner<3, 3>() = bodies[b].mass * Matrix3::Identity();
		mass.bottomRightCorner<3, 3>() = bodies[b].inverseInertia().inverse();
		const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix6> solver(stiffness[b], mass, Eigen::EigenvaluesOnly);
		highest = std::max(highest, factor[b] * solver.eigenvalues().maxCoeff());
	}
	return highest > 0 ? 2 / std::sqrt(highest) : std::numeric_limits<double>::infinity();
}

} // namespace masonry

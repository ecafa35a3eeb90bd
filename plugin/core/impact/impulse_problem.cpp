#include "impact/impulse_problem.hpp"
#include "tolerances.hpp"
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace masonry {

namespace {

	using Matrix = Eigen::MatrixXd;
	using Vector = Eigen::VectorXd;

	enum class State { open, stick, slip };

	// Rows: three a point (normal, two tangents), then one a couple, each couple multiplied by a length so that all rows
	// are velocities. u = G p + free, G = J M^-1 J^T.
	struct System {
		Matrix              J, G;
		Vector              free, p;
		int                 nPoints, nCouples;
		double              length; // of the couple rows, m
		std::vector<State>  states;
		Matrix              slipDirection; // column i: unit vector d of p_t of point i while it slips
		std::vector<double> slipTurn;      // beta = mu p_n / |y_t| of that point: how d turns with y_t
		std::vector<double> friction;

		Vector velocity() const { return G * p + free; }
	};

	// Rows: the normal and two tangents.
	Matrix3 frame(const Vector3& normal)
	{
		int smallest;
		normal.cwiseAbs().minCoeff(&smallest);
		Matrix3 axes;
		axes.row(0) = normal;
		axes.row(1) = normal.cross(Vector3(Vector3::Unit(smallest))).normalized();
		axes.row(2) = normal.cross(Vector3(axes.row(1)));
		return axes;
	}

	Matrix jacobian(const std::vector<Body>& bodies, const std::vector<ImpulsePoint>& points, const std::vector<CoupleRow>& couples, double length)
	{
		Matrix J = Matrix::Zero(3 * points.size() + couples.size(), 6 * bodies.size());
		int    row = 0;
		for (const auto& point : points) {
			const Matrix3 axes = frame(point.normal);
			for (int k = 0; k < 3; ++k) {
				const Vector3 axis = axes.row(k);
				for (int side = 0; side < 2; ++side) {
					const int    body = side ? point.body2 : point.body1;
					const double sign = side ? 1 : -1;
					J.block<1, 3>(row, 6 * body) = sign * axis.transpose();
					J.block<1, 3>(row, 6 * body + 3) = sign * (point.position - bodies[body].pose.position).cross(axis).transpose();
				}
				++row;
			}
		}
		for (const auto& couple : couples) {
			J.block<1, 3>(row, 6 * couple.body1 + 3) = -length * couple.axis.transpose();
			J.block<1, 3>(row, 6 * couple.body2 + 3) = length * couple.axis.transpose();
			++row;
		}
		return J;
	}

	Matrix inverseMassTimes(const std::vector<Body>& bodies, const Matrix& transposedJacobian)
	{
		Matrix result(transposedJacobian.rows(), transposedJacobian.cols());
		for (size_t i = 0; i < bodies.size(); ++i) {
			result.middleRows<3>(6 * i) = bodies[i].inverseMass() * transposedJacobian.middleRows<3>(6 * i);
			result.middleRows<3>(6 * i + 3) = bodies[i].inverseInertia() * transposedJacobian.middleRows<3>(6 * i + 3);
		}
		return result;
	}

	// Stiffness of one point's impulse against its own velocity, an upper bound: with r = 1/response the map below contracts.
	double response(const System& s, int i) { return s.G.block<3, 3>(3 * i, 3 * i).trace(); }

	// Newton step: least-norm solution of the laws, linear for the present states. A slipping point obeys u_n = 0 and
	//     p_t = mu p_n d(y_t),  y_t = p_t - r u_t,  d(y) = y/|y| ~ d + (1 - d d^T) y / |y_k|,
	// so  p_t - mu p_n d - beta (1 - d d^T)(p_t - r u_t) = 0 with beta from the last iterate.
	void solveForStates(System& s)
	{
		std::vector<int> active; // rows of p that may differ from zero
		for (int i = 0; i < s.nPoints; ++i)
			if (s.states[i] != State::open) active.insert(active.end(), { 3 * i, 3 * i + 1, 3 * i + 2 });
		for (int row = 3 * s.nPoints; row < s.p.size(); ++row)
			active.push_back(row);
		s.p.setZero();
		if (active.empty()) return;
		Matrix A(active.size(), s.p.size()); // on all of p first; velocity rows by default
		Vector b(active.size());
		for (size_t k = 0; k < active.size(); ++k) {
			A.row(k) = s.G.row(active[k]);
			b[k] = -s.free[active[k]];
		}
		for (size_t k = 0; k < active.size(); ++k) {
			const int i = active[k] / 3;
			if (i >= s.nPoints || s.states[i] != State::slip || active[k] % 3 != 1) continue;
			const Vector2         d = s.slipDirection.col(i);
			const Eigen::Matrix2d turn = s.slipTurn[i] * (Eigen::Matrix2d::Identity() - d * d.transpose());
			const double          stiffness = response(s, i); // 1/r: turns impulses into velocities, as in the other rows
			A.middleRows<2>(k) = turn * s.G.middleRows<2>(active[k]);
			b.segment<2>(k) = -turn * s.free.segment<2>(active[k]);
			A.block<2, 1>(k, 3 * i) -= stiffness * s.friction[i] * d;
			A.block<2, 2>(k, 3 * i + 1) += stiffness * (Eigen::Matrix2d::Identity() - turn);
		}
		Matrix reduced(active.size(), active.size());
		for (size_t k = 0; k < active.size(); ++k)
			reduced.col(k) = A.col(active[k]);
		Eigen::CompleteOrthogonalDecomposition<Matrix> decomposition;
		decomposition.setThreshold(tolerance::rank);
		decomposition.compute(reduced);
		Vector x = decomposition.solve(b);
		x += decomposition.solve(b - reduced * x); // one refinement: long arms on slender blocks cost four digits
		for (size_t k = 0; k < active.size(); ++k)
			s.p[active[k]] = x[k];
	}

	// Projection of p - r u on the friction cone of one point; also tells the state that it stands for.
	Vector3 project(const System& s, int i, const Vector3& u, State& state)
	{
		const Vector3 y = s.p.segment<3>(3 * i) - u / response(s, i);
		state = State::open;
		if (!(y[0] > 0)) return Vector3::Zero();
		const double size = y.tail<2>().norm(), bound = s.friction[i] * y[0];
		state = size > bound ? State::slip : State::stick;
		Vector3 result = y;
		if (size > bound) result.tail<2>() *= bound / size;
		return result;
	}

	double residual(const System& s)
	{
		const Vector u = s.velocity();
		double       worst = s.nCouples ? u.tail(s.nCouples).cwiseAbs().maxCoeff() : 0;
		for (int i = 0; i < s.nPoints; ++i) {
			State         ignored;
			const Vector3 step = s.p.segment<3>(3 * i) - project(s, i, u.segment<3>(3 * i), ignored);
			worst = std::max(worst, step.norm() * response(s, i));
		}
		return worst;
	}

	// States and slip directions for the next Newton step.
	void updateStates(System& s)
	{
		const Vector u = s.velocity();
		for (int i = 0; i < s.nPoints; ++i) {
			const Vector3 p = project(s, i, u.segment<3>(3 * i), s.states[i]);
			const Vector2 y = s.p.segment<2>(3 * i + 1) - u.segment<2>(3 * i + 1) / response(s, i);
			if (s.states[i] != State::slip || !(y.norm() > 0)) continue;
			s.slipDirection.col(i) = y.normalized();
			s.slipTurn[i] = p.tail<2>().norm() / y.norm();
		}
	}

	// Without slip some problems have no solution. The way out keeps every promise on energy: all points held, then the one
	// that pulls most let go, until none pulls. A point let go may still approach, which the residual tells.
	void letPullingPointsGo(System& s)
	{
		s.states.assign(s.nPoints, State::stick);
		for (int left = s.nPoints; left >= 0; --left) {
			solveForStates(s);
			int worst = -1;
			for (int i = 0; i < s.nPoints; ++i)
				if (s.p[3 * i] < 0 && (worst < 0 || s.p[3 * i] < s.p[3 * worst])) worst = i;
			if (worst < 0) return;
			s.states[worst] = State::open;
		}
	}

	// Residual that counts as zero: a share of the approach speed, and round-off of the products in G p.
	double target(const System& s)
	{
		const double roundOff = 64 * std::numeric_limits<double>::epsilon() * (s.G.cwiseAbs() * s.p.cwiseAbs()).maxCoeff();
		return tolerance::impulse * s.free.cwiseAbs().maxCoeff() + roundOff;
	}

	// The same laws point by point on the bodies' velocities, without any matrix: for more points than the dense solver can
	// bear. Stops when a sweep changes no velocity by more than the tolerance.
	ImpulseReport solveBySweeps(std::vector<Body>& bodies, std::vector<ImpulsePoint>& points, std::vector<CoupleRow>& couples)
	{
		std::vector<Matrix3> inverseInertia;
		for (const Body& body : bodies)
			inverseInertia.push_back(body.inverseInertia());
		const auto push = [&](int b, const Vector3& impulse, const Vector3& point) {
			bodies[b].velocity += bodies[b].inverseMass() * impulse;
			bodies[b].angularVelocity += inverseInertia[b] * (point - bodies[b].pose.position).cross(impulse);
		};
		const auto relative = [&](const ImpulsePoint& p) -> Vector3 { return bodies[p.body2].velocityAt(p.position) - bodies[p.body1].velocityAt(p.position) + p.bias; };
		std::vector<double> response; // trace of each point's own 3x3 block
		double              scale = 0;
		for (const ImpulsePoint& p : points) {
			double sum = 0;
			for (int b : { p.body1, p.body2 }) {
				const Vector3 arm = p.position - bodies[b].pose.position;
				const Matrix3 cross = (Matrix3() << 0, -arm.z(), arm.y(), arm.z(), 0, -arm.x(), -arm.y(), arm.x(), 0).finished();
				sum += 3 * bodies[b].inverseMass() - (cross * inverseInertia[b] * cross).trace();
			}
			response.push_back(sum);
			scale = std::max(scale, relative(p).norm());
		}
		constexpr int maxSweeps = 20000;
		ImpulseReport report { 0, 0. };
		for (; report.iterations < maxSweeps; ++report.iterations) {
			report.residual = 0;
			for (size_t i = 0; i < points.size(); ++i) {
				ImpulsePoint& p = points[i];
				const Vector3 trial = p.impulse - relative(p) / response[i];
				const double  normal = p.normal.dot(trial);
				Vector3       next = Vector3::Zero();
				if (normal > 0) {
					const Vector3 tangential = trial - normal * p.normal;
					const double  size = tangential.norm(), bound = p.friction * normal;
					next = normal * p.normal + (size > bound ? Vector3(tangential * (bound / size)) : tangential);
				}
				const Vector3 change = next - p.impulse;
				p.impulse = next;
				push(p.body1, -change, p.position);
				push(p.body2, change, p.position);
				report.residual = std::max(report.residual, change.norm() * response[i]);
			}
			for (CoupleRow& row : couples) {
				const double softness = row.axis.dot((inverseInertia[row.body1] + inverseInertia[row.body2]) * row.axis);
				const double spin = row.axis.dot(bodies[row.body2].angularVelocity - bodies[row.body1].angularVelocity);
				const double change = (row.target - spin) / softness;
				row.couple += change;
				bodies[row.body1].angularVelocity -= inverseInertia[row.body1] * row.axis * change;
				bodies[row.body2].angularVelocity += inverseInertia[row.body2] * row.axis * change;
			}
			if (report.residual <= tolerance::sweeps * scale) break;
		}
		return report;
	}

	int gaussSeidel(System& s)
	{
		constexpr int maxSweeps = 4000, checkEvery = 20;
		for (int sweep = 1; sweep <= maxSweeps; ++sweep) {
			for (int i = 0; i < s.nPoints; ++i) {
				State         ignored;
				const Vector3 u = s.G.middleRows<3>(3 * i) * s.p + s.free.segment<3>(3 * i);
				s.p.segment<3>(3 * i) = project(s, i, u, ignored);
			}
			for (int row = 3 * s.nPoints; row < s.p.size(); ++row)
				s.p[row] -= (s.G.row(row).dot(s.p) + s.free[row]) / s.G(row, row);
			if (sweep % checkEvery == 0 && residual(s) <= target(s)) return sweep;
		}
		return maxSweeps;
	}

} // namespace

ImpulseReport solveImpulses(std::vector<Body>& bodies, std::vector<ImpulsePoint>& points, std::vector<CoupleRow>& couples)
{
	if (points.empty() && couples.empty()) return { 0, 0. };
	constexpr size_t mostDense = 100; // points; the dense solver's cost grows with their cube
	if (points.size() > mostDense) return solveBySweeps(bodies, points, couples);
	System s;
	s.nPoints = int(points.size());
	s.nCouples = int(couples.size());
	s.length = 0;
	for (const auto& point : points)
		for (int body : { point.body1, point.body2 })
			if (!bodies[body].prescribed) s.length = std::max(s.length, (point.position - bodies[body].pose.position).norm());
	if (s.length == 0) s.length = 1;
	s.J = jacobian(bodies, points, couples, s.length);
	const Matrix perImpulse = inverseMassTimes(bodies, s.J.transpose());
	s.G = s.J * perImpulse;
	Vector v(6 * bodies.size());
	for (size_t i = 0; i < bodies.size(); ++i)
		v.segment<6>(6 * i) << bodies[i].velocity, bodies[i].angularVelocity;
	s.free = s.J * v;
	for (int i = 0; i < s.nPoints; ++i)
		s.free.segment<3>(3 * i) += frame(points[i].normal) * points[i].bias;
	for (int c = 0; c < s.nCouples; ++c)
		s.free[3 * s.nPoints + c] -= s.length * couples[c].target;
	s.p = Vector::Zero(s.J.rows());
	s.slipDirection = Matrix::Zero(2, s.nPoints);
	s.slipTurn.assign(s.nPoints, 0.);
	for (const auto& point : points) {
		s.friction.push_back(point.friction);
		s.states.push_back(point.holds ? State::stick : State::open);
	}

	constexpr int rounds = 6, maxNewton = 30;
	ImpulseReport report { 0, std::numeric_limits<double>::infinity() };
	bool          solved = false;
	Vector        best = s.p;
	const auto    keepBest = [&] {
		const double r = residual(s);
		solved = r <= target(s);
		if (!(r < report.residual)) return;
		report.residual = r;
		best = s.p;
	};
	for (int round = 0; round < rounds && !solved; ++round) {
		for (int k = 0; k < maxNewton && !solved; ++k, ++report.iterations) {
			solveForStates(s);
			keepBest();
			updateStates(s);
		}
		if (solved) break;
		s.p = best;
		report.iterations += gaussSeidel(s);
		keepBest();
		updateStates(s);
	}
	s.p = best;
	if (!solved && std::isinf(*std::max_element(s.friction.begin(), s.friction.end()))) {
		letPullingPointsGo(s);
		report.residual = residual(s);
	}

	v += perImpulse * s.p;
	for (size_t i = 0; i < bodies.size(); ++i) {
		if (bodies[i].prescribed) continue;
		bodies[i].velocity = v.segment<3>(6 * i);
		bodies[i].angularVelocity = v.segment<3>(6 * i + 3);
	}
	for (int i = 0; i < s.nPoints; ++i) {
		points[i].impulse = frame(points[i].normal).transpose() * s.p.segment<3>(3 * i);
	}
	for (int c = 0; c < s.nCouples; ++c)
		couples[c].couple = s.length * s.p[3 * s.nPoints + c];
	return report;
}

} // namespace masonry

#include "dynamics/rigid/smooth_step.hpp"
#include "tolerances.hpp"
#include <algorithm>

namespace masonry::rigid {

namespace {

	template <class K> typename K::Velocity prescribedVelocity(const RigidSystem<K>& s, const RigidBody<K>& body, double t)
	{
		typename K::Velocity v = body.velocity;
		if (body.drive >= 0) v.template head<K::dimension>() = s.driveDirections[body.drive] * s.drives[body.drive]->velocity(t);
		return v;
	}

	template <class K> typename K::Pose prescribedPose(const RigidSystem<K>& s, const RigidBody<K>& body, double h)
	{
		typename K::Pose pose = body.pose;
		K::advance(pose, body.velocity, h);
		if (body.drive >= 0) pose.position = body.origin + s.driveDirections[body.drive] * s.drives[body.drive]->displacement(s.time + h);
		return pose;
	}

	template <class K> InverseMass<K> inverseMass(const RigidBody<K>& body, const typename K::Pose& pose)
	{
		return { 1 / body.mass, K::inverseInertia(body.inertia, pose) };
	}

	// Turned by phi about the middle of the step, an arm r there moves by 2 sin(phi/2) (phi/|phi|) x r: the rows act on this chord, so that a
	// point at rest on average does not move at all.
	template <class K> double chord(const typename K::Velocity& mean, double h)
	{
		return 1 - mean.template tail<K::spins>().squaredNorm() * h * h / 24;
	}

	template <class K> Eigen::Matrix<double, K::rows, K::dof> jacobian(const ContactFrame<K>& frame, const typename K::Vector& center, double chord, double sign)
	{
		Eigen::Matrix<double, K::rows, K::dof> J;
		const typename K::Vector               arm = chord * (frame.position - center);
		for (int k = 0; k < K::rows; ++k) {
			const typename K::Vector axis = sign * frame.axes.row(k).transpose();
			J.row(k).template head<K::dimension>() = axis.transpose();
			J.row(k).template tail<K::spins>() = K::moment(arm, axis).transpose();
		}
		return J;
	}

	// The forces of more than three points on a face are not determined by its motion, but where it spins as it slides the friction couple
	// hangs on them: they start from linear pressure, that is from the least sum of squares with the same resultant and moments, so that the
	// solver's path does not decide. Points that would have to pull, or stick, are left as they are.
	template <class Rows> void spreadLinearly(Rows* begin, Rows* end, const std::vector<Vector3>& positions)
	{
		const int n = int(end - begin);
		Matrix3   squares = Matrix3::Zero();
		Vector3   sums = Vector3::Zero(), middle = Vector3::Zero();
		for (const Vector3& x : positions)
			middle += x / n;
		const Vector3 across = begin->J2.row(1).template head<3>(), beside = begin->J2.row(2).template head<3>();
		const auto    shape = [&](int i) { return Vector3(1, across.dot(positions[i] - middle), beside.dot(positions[i] - middle)); };
		for (int i = 0; i < n; ++i) {
			squares += shape(i) * shape(i).transpose();
			sums += begin[i].impulse[0] * shape(i);
		}
		if (!(squares.bottomRightCorner<2, 2>().determinant() > tolerance::rank * squares.bottomRightCorner<2, 2>().squaredNorm())) return;
		const Vector3 pressure = squares.ldlt().solve(sums);
		for (int i = 0; i < n; ++i)
			if (!(pressure.dot(shape(i)) > 0)) return;
		for (int i = 0; i < n; ++i)
			begin[i].impulse *= pressure.dot(shape(i)) / begin[i].impulse[0];
	}

} // namespace

template <class K> void SmoothStep<K>::predict(const RigidSystem<K>& s, double h)
{
	last.bodies.resize(s.bodies.size());
	solver.bodies.clear();
	for (size_t b = 0; b < s.bodies.size(); ++b) {
		const RigidBody<K>& body = s.bodies[b];
		auto&               next = last.bodies[b];
		if (body.prescribed) {
			next.unknown = -1;
			next.middle = prescribedPose(s, body, h / 2);
			next.end = prescribedPose(s, body, h);
			next.velocity = prescribedVelocity(s, body, s.time + h);
			next.mean = 0.5 * (body.velocity + next.velocity);
			continue;
		}
		next.unknown = int(solver.bodies.size());
		next.mean = body.velocity + 0.5 * h * increments[b];
		next.middle = next.predicted = body.pose;
		K::advance(next.middle, next.mean, h / 2);
		if constexpr (K::spins == 3) K::advance(next.predicted, next.mean, h);

		FreeBody<K> unknown;
		unknown.inverseMass = inverseMass(body, next.predicted);
		typename K::Velocity momentum = h * body.force;
		momentum.template head<K::dimension>() += body.mass * body.velocity.template head<K::dimension>();
		momentum.template tail<K::spins>() += K::angularMomentum(body.inertia, body.pose, body.velocity.template tail<K::spins>());
		unknown.free = unknown.inverseMass * momentum;
		solver.bodies.push_back(unknown);
	}
}

template <class K> void SmoothStep<K>::assemble(const RigidSystem<K>& s, double h)
{
	solver.points.clear();
	last.rows.clear();
	const auto isAnticipated = [&](int pair, int point) {
		return std::any_of(anticipated.begin(), anticipated.end(), [&](const PointRef& p) { return p.pair == pair && p.point == point; });
	};
	for (int c = 0; c < int(s.pairs.size()); ++c) {
		const ContactPair<K>& pair = s.pairs[c];
		const size_t          begin = solver.points.size();
		bool                  slides = true;
		positions.clear();
		for (int i = 0; i < pair.size; ++i) {
			const ContactPoint<K>& point = pair.points[i];
			if (!point.closed && (anticipated.empty() || !isAnticipated(c, i))) continue;
			const RigidBody<K>&   body1 = s.bodies[pair.body1];
			const RigidBody<K>&   body2 = s.bodies[pair.body2];
			const auto&           next1 = last.bodies[pair.body1];
			const auto&           next2 = last.bodies[pair.body2];
			const ContactFrame<K> frame = K::frame(point.feature, body1.halfSize, next1.middle, body2.halfSize, next2.middle);
			last.rows.push_back({ c, i });

			ContactRows<K> rows;
			rows.body1 = next1.unknown;
			rows.body2 = next2.unknown;
			rows.J1 = jacobian(frame, next1.middle.position, chord<K>(next1.mean, h), -1);
			rows.J2 = jacobian(frame, next2.middle.position, chord<K>(next2.mean, h), 1);
			rows.friction = pair.friction;
			rows.impulse = h * point.force;
			if (body1.prescribed) rows.offset += rows.J1 * next1.velocity;
			if (body2.prescribed) rows.offset += rows.J2 * next2.velocity;
			if (point.closed && !point.landing) {
				const auto error = rigid::relativeVelocity(point.frame, body1.pose.position, body1.velocity, body2.pose.position, body2.velocity);
				const auto now = (rows.J1 * body1.velocity + rows.J2 * body2.velocity).eval();
				rows.offset[0] += now[0] - tolerance::rigid::damping * error[0];
				if (!point.sliding)
					rows.offset.template tail<K::rows - 1>() += (now - tolerance::rigid::damping * error).template tail<K::rows - 1>();
				else if (!stopsInside)
					rows.offset.template tail<K::rows - 1>() += now.template tail<K::rows - 1>();
			} else if (!point.closed) {
				rows.offset[0] += 2 * (frame.gap - std::min(point.gap, 0.)) / h; // a penetration at the start is no approach: `project` closes it
			}
			solver.points.push_back(rows);
			if constexpr (K::maxPoints > 3) {
				positions.push_back(frame.position);
				slides &= point.sliding && point.force[0] > 0;
			}
		}
		if constexpr (K::maxPoints > 3)
			if (slides && positions.size() > 3) spreadLinearly(solver.points.data() + begin, solver.points.data() + solver.points.size(), positions);
	}
}

template <class K> void SmoothStep<K>::finish(const RigidSystem<K>& s, double h)
{
	for (size_t b = 0; b < s.bodies.size(); ++b) {
		const RigidBody<K>& body = s.bodies[b];
		auto&               next = last.bodies[b];
		if (body.prescribed) continue;
		next.velocity = solver.bodies[next.unknown].velocity;
		next.mean = 0.5 * (body.velocity + next.velocity);
		next.end = body.pose;
		K::advance(next.end, next.mean, h);
		if constexpr (K::spins == 3) { // the momentum is the state: the spin belongs to the orientation reached
			const auto spin = next.velocity.template tail<K::spins>();
			next.velocity.template tail<K::spins>() = K::inverseInertia(body.inertia, next.end) * K::angularMomentum(body.inertia, next.predicted, spin);
		}
	}
	first.resize(s.pairs.size());
	last.frames.clear();
	for (size_t c = 0; c < s.pairs.size(); ++c) {
		const ContactPair<K>& pair = s.pairs[c];
		first[c] = int(last.frames.size());
		for (int i = 0; i < pair.size; ++i)
			last.frames.push_back(K::frame(pair.points[i].feature, s.bodies[pair.body1].halfSize, last.bodies[pair.body1].end, s.bodies[pair.body2].halfSize,
			                               last.bodies[pair.body2].end));
	}
}

template <class K> void SmoothStep<K>::attempt(const RigidSystem<K>& s, double h)
{
	last.h = h;
	increments.resize(s.bodies.size());
	for (size_t b = 0; b < s.bodies.size(); ++b)
		increments[b] = s.fresh ? typename K::Velocity(K::Velocity::Zero()) : s.bodies[b].increment;
	// After an event the change of velocity in the last step, which can have been of any length, tells nothing: a second pass takes that
	// of the first.
	for (int pass = s.fresh ? 0 : 1; pass < 2; ++pass) {
		predict(s, h);
		assemble(s, h);
		last.solved = solver.solve(s.settings.tolerance * scales.stepSpeed(h));
		if (pass == 0)
			for (size_t b = 0; b < s.bodies.size(); ++b)
				if (!s.bodies[b].prescribed) increments[b] = (solver.bodies[last.bodies[b].unknown].velocity - s.bodies[b].velocity) / h;
	}
	finish(s, h);
}

// Sweeps over the loaded points, each moved back along its normal row (least motion, weighted by mass); the gaps follow linearly.
template <class K> void SmoothStep<K>::project(RigidSystem<K>& s)
{
	gaps.clear();
	double largest = 0;
	for (size_t r = 0; r < last.rows.size(); ++r) {
		const PointRef ref = last.rows[r];
		gaps.push_back(last.frames[first[ref.pair] + ref.point].gap);
		if (solver.points[r].impulse[0] > 0 || gaps.back() < 0) largest = std::max(largest, std::abs(gaps.back()));
	}
	const double enough = tolerance::rigid::gap * scales.length;
	if (!(largest > enough)) return;
	shifts.assign(solver.bodies.size(), K::Velocity::Zero());
	const int maxSweeps = last.rows.size() == 1 ? 1 : 20;
	for (int sweep = 0; sweep < maxSweeps && largest > enough; ++sweep) {
		largest = 0;
		for (size_t r = 0; r < last.rows.size(); ++r) {
			const ContactRows<K>& rows = solver.points[r];
			double                gap = gaps[r], softness = 0;
			typename K::Velocity  move1 = K::Velocity::Zero(), move2 = K::Velocity::Zero();
			if (rows.body1 >= 0) {
				move1 = solver.bodies[rows.body1].inverseMass * rows.J1.row(0).transpose();
				softness += rows.J1.row(0).dot(move1);
				gap += rows.J1.row(0).dot(shifts[rows.body1]);
			}
			if (rows.body2 >= 0) {
				move2 = solver.bodies[rows.body2].inverseMass * rows.J2.row(0).transpose();
				softness += rows.J2.row(0).dot(move2);
				gap += rows.J2.row(0).dot(shifts[rows.body2]);
			}
			if (!(rows.impulse[0] > 0) && gap >= 0) continue;
			largest = std::max(largest, std::abs(gap));
			if (rows.body1 >= 0) shifts[rows.body1] -= gap / softness * move1;
			if (rows.body2 >= 0) shifts[rows.body2] -= gap / softness * move2;
		}
	}
	for (size_t b = 0; b < s.bodies.size(); ++b)
		if (last.bodies[b].unknown >= 0) K::advance(last.bodies[b].end, shifts[last.bodies[b].unknown], 1.);
	for (size_t c = 0; c < s.pairs.size(); ++c)
		for (int i = 0; i < s.pairs[c].size; ++i)
			last.frames[first[c] + i] = K::frame(s.pairs[c].points[i].feature, s.bodies[s.pairs[c].body1].halfSize, last.bodies[s.pairs[c].body1].end,
			                                     s.bodies[s.pairs[c].body2].halfSize, last.bodies[s.pairs[c].body2].end);
}

template <class K> void SmoothStep<K>::accept(RigidSystem<K>& s)
{
	project(s);
	for (size_t r = 0; r < last.rows.size(); ++r) {
		const ContactRows<K>& rows = solver.points[r];
		const PointRef        ref = last.rows[r];
		const auto&           next1 = last.bodies[s.pairs[ref.pair].body1];
		const auto&           next2 = last.bodies[s.pairs[ref.pair].body2];
		const auto            mean1 = (rows.J1 * next1.mean).eval(), mean2 = (rows.J2 * next2.mean).eval(), slip = (mean1 + mean2).eval();
		s.impactDissip -= rows.impulse[0] * slip[0];
		s.frictDissip -= rows.impulse.template tail<K::rows - 1>().dot(slip.template tail<K::rows - 1>());
		if (next1.unknown < 0) s.baseWork -= rows.impulse.dot(mean1);
		if (next2.unknown < 0) s.baseWork -= rows.impulse.dot(mean2);
	}
	for (size_t b = 0; b < s.bodies.size(); ++b) {
		RigidBody<K>& body = s.bodies[b];
		const auto&   next = last.bodies[b];
		if (!body.prescribed) body.increment = (next.velocity - body.velocity) / last.h;
		body.pose = next.end;
		body.velocity = next.velocity;
	}
	s.time += last.h;
	s.fresh = false;

	const double still = tolerance::rigid::parting * scales.stepSpeed(last.h);
	size_t       row = 0;
	for (size_t c = 0; c < s.pairs.size(); ++c)
		for (int i = 0; i < s.pairs[c].size; ++i) {
			ContactPoint<K>& point = s.pairs[c].points[i];
			point.frame = last.frames[first[c] + i];
			point.gap = point.frame.gap;
			point.force.setZero();
			const bool acted = row < last.rows.size() && last.rows[row].pair == int(c) && last.rows[row].point == i;
			if (!acted) continue;
			const auto& rows = solver.points[row++];
			const auto  u = relativeVelocity(s, int(c), i);
			const bool  wasOpen = !point.closed;
			point.closed = rows.impulse[0] > 0 || u[0] <= still;
			point.landing = wasOpen && point.closed;
			s.fresh |= point.landing;
			if (!point.closed) continue;
			point.force = rows.impulse / last.h;
			point.sliding = rows.impulse[0] > 0 && u.template tail<K::rows - 1>().norm() > still
			        && rows.impulse.template tail<K::rows - 1>().norm() >= (1 - tolerance::rigid::cone) * rows.friction * rows.impulse[0];
		}
}

template <class K> Eigen::Matrix<double, K::rows, 1> SmoothStep<K>::relativeVelocity(const RigidSystem<K>& s, int pair, int point) const
{
	const auto& next1 = last.bodies[s.pairs[pair].body1];
	const auto& next2 = last.bodies[s.pairs[pair].body2];
	return rigid::relativeVelocity(last.frames[first[pair] + point], next1.end.position, next1.velocity, next2.end.position, next2.velocity);
}

template class SmoothStep<Plane>;
template class SmoothStep<Space>;

} // namespace masonry::rigid

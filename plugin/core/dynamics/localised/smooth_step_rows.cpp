// The contact problem of a step: its rows, and stray velocities, which alternate from step to step.
#include "dynamics/localised/smooth_step.hpp"
#include "dynamics/model/external_force.hpp"
#include "tolerances.hpp"
#include <algorithm>

namespace masonry::localised {

namespace {

template <class K>
Eigen::Matrix<double, K::rows, K::dof> jacobian(const ContactFrame<K>& frame, const typename K::Vector& center, double chord, double sign)
{
	Eigen::Matrix<double, K::rows, K::dof> J;
	const typename K::Vector pressed = chord * (frame.position - center), gripped = pressed + chord * frame.grip;
	for (int k = 0; k < K::rows; ++k) {
		const typename K::Vector axis = sign * frame.axes.row(k).transpose();
		J.row(k).template head<K::dimension>() = axis.transpose();
		J.row(k).template tail<K::spins>() = K::moment(k == 0 ? pressed : gripped, axis).transpose();
	}
	return J;
}

template <class K>
bool isMoved(const RigidBody<K>& body, const typename K::Velocity& next)
{
	return body.prescribed && !(body.velocity.isZero(0) && next.isZero(0));
}

// The forces of more than three points on a face are not determined by its motion, but where it spins as it slides the friction couple
// hangs on them: they start from linear pressure, that is from the least sum of squares with the same resultant and moments, so that the
// solver's path does not decide. Points that would have to pull, or stick, are left as they are, and so are those of corners, whose normals
// differ.
void spreadLinearly(ContactRows<Space>* rows, const std::vector<ContactFrame<Space>>& frames)
{
	const int n = int(frames.size());
	const auto turned = [&](const ContactFrame<Space>& frame) {
		return frame.axes.row(0).cross(frames.front().axes.row(0)).norm() > tolerance::contact::cornerSpread;
	};
	if (std::any_of(frames.begin(), frames.end(), turned))
		return;
	Matrix3 squares = Matrix3::Zero();
	Vector3 sums = Vector3::Zero(), middle = Vector3::Zero();
	for (const auto& frame : frames)
		middle += frame.position / n;
	const Vector3 across = rows->J2.row(1).head<3>(), beside = rows->J2.row(2).head<3>();
	const auto shape = [&](int i) {
		const Vector3 from = frames[i].position - middle;
		return Vector3(1, across.dot(from), beside.dot(from));
	};
	for (int i = 0; i < n; ++i) {
		squares += shape(i) * shape(i).transpose();
		sums += rows[i].impulse[0] * shape(i);
	}
	if (!(squares.bottomRightCorner<2, 2>().determinant() > tolerance::rank * squares.bottomRightCorner<2, 2>().squaredNorm()))
		return;
	const Vector3 pressure = squares.ldlt().solve(sums);
	for (int i = 0; i < n; ++i)
		if (!(pressure.dot(shape(i)) > 0))
			return;
	for (int i = 0; i < n; ++i)
		rows[i].impulse *= pressure.dot(shape(i)) / rows[i].impulse[0];
}

} // namespace

template <class K>
bool SmoothStep<K>::acts(const RigidSystem<K>& s, PointRef ref) const
{
	return s.pairs[ref.pair].points[ref.point].closed || contains(anticipated, ref);
}

// A share of the stray velocities, where the forces of the last step would do no work on it.
template <class K>
void SmoothStep<K>::dampStray(const RigidSystem<K>& s, double h)
{
	double work = 0;
	for (int c = 0; c < int(s.pairs.size()); ++c)
		for (int i = 0; i < s.pairs[c].size(); ++i) {
			if (!acts(s, {c, i}))
				continue;
			const ContactPoint<K>& point = s.pairs[c].points[i];
			stray.push_back(Impulse::Zero());
			if (!point.closed)
				continue;
			stray.back() = tolerance::localised::damping * localised::relativeVelocity(s, PointRef {c, i});
			if (point.sliding)
				stray.back().template tail<K::rows - 1>().setZero();
			work += 0.5 * h * point.force.dot(stray.back());
		}
	if (std::abs(work) > tolerance::localised::strayEnergy * weight)
		stray.clear();
}

// The stray velocity of the closed points that alternates from step to step, seen from a pass that took nothing off: half of what it
// changes by.
template <class K>
void SmoothStep<K>::findStray(const RigidSystem<K>& s)
{
	for (size_t r = 0; r < last.rows.size(); ++r) {
		const PointRef ref = last.rows[r];
		const ContactPoint<K>& point = s.pairs[ref.pair].points[ref.point];
		stray.push_back(Impulse::Zero());
		if (!point.closed)
			continue;
		stray.back() = 0.5 * (localised::relativeVelocity(s, ref) - relativeVelocity(s, ref.pair, ref.point));
		if (point.sliding || solver.points[r].slides())
			stray.back().template tail<K::rows - 1>().setZero();
	}
}

// Work of the impulses where the stray velocities are taken off, J.
template <class K>
double SmoothStep<K>::strayWork() const
{
	double work = 0;
	for (size_t r = 0; r < stray.size(); ++r)
		work += 0.5 * solver.points[r].impulse.dot(stray[r]);
	return work;
}

// A point that lands in a step does so as one of its pair that sticks, or as another that lands: at the height of that, and with its stray
// velocity. Otherwise the turn that lands it would have it slip, by more than the tolerance, and two points of a face that must not slip in
// different ways take any impulse. Returns that point's row, or -1.
template <class K>
int SmoothStep<K>::leader(const RigidSystem<K>& s, int pair) const
{
	int row = int(last.rows.size()), landing = -1;
	for (int i = 0; i < s.pairs[pair].size(); ++i) {
		if (!acts(s, {pair, i}))
			continue;
		const ContactPoint<K>& point = s.pairs[pair].points[i];
		if (point.closed && !point.sliding)
			return row;
		if (!point.closed && landing < 0)
			landing = row;
		++row;
	}
	return landing;
}

template <class K>
void SmoothStep<K>::assemble(const RigidSystem<K>& s, double h)
{
	solver.points.clear();
	solver.near.clear();
	last.rows.clear();
	for (int c = 0; c < int(s.pairs.size()); ++c) {
		const ContactPair<K>& pair = s.pairs[c];
		if (last.bodies[pair.body1].unknown >= 0 && last.bodies[pair.body2].unknown >= 0)
			solver.near.push_back({last.bodies[pair.body1].unknown, last.bodies[pair.body2].unknown});
		const size_t begin = solver.points.size();
		const int leads = leader(s, c);
		middles.clear();
		for (int i = 0; i < pair.size(); ++i)
			if (acts(s, {c, i})) {
				last.rows.push_back({c, i});
				middles.push_back(frameOf(pair.points[i], s.bodies[pair.body1], last.bodies[pair.body1].middle, s.bodies[pair.body2],
				                          last.bodies[pair.body2].middle));
			}
		bool slides = true;
		for (size_t k = 0; k < middles.size(); ++k) {
			const ContactPoint<K>& point = pair.points[last.rows[begin + k].point];
			ContactFrame<K> frame = middles[k];
			Impulse astray = stray.empty() ? Impulse::Zero() : stray[begin + k];
			if (!point.closed) {
				const ContactFrame<K>& other = middles[leads - begin];
				const typename K::Vector normal = frame.axes.row(0).transpose();
				frame.position -= normal * normal.dot(frame.position - other.position);
				if (!stray.empty())
					astray = frame.axes * (other.axes.transpose() * stray[leads]);
			}
			solver.points.push_back(rowsOf(s, last.rows[begin + k], frame, h, astray));
			slides &= point.sliding && solver.points.back().impulse[0] > 0;
		}
		if constexpr (K::dimension == 3)
			if (slides && middles.size() > 3)
				spreadLinearly(solver.points.data() + begin, middles);
	}
	addTies(s, h);
}

// Rows of a point in the middle of the step. The law holds for the mean velocity: offset is the relative velocity now, without what is
// astray.
template <class K>
ContactRows<K> SmoothStep<K>::rowsOf(const RigidSystem<K>& s, PointRef ref, const ContactFrame<K>& frame, double h, Impulse astray) const
{
	const ContactPair<K>& pair = s.pairs[ref.pair];
	const ContactPoint<K>& point = pair.points[ref.point];
	const RigidBody<K>&body1 = s.bodies[pair.body1], &body2 = s.bodies[pair.body2];
	const auto &next1 = last.bodies[pair.body1], &next2 = last.bodies[pair.body2];
	const size_t row = solver.points.size();
	ContactRows<K> rows;
	rows.body1 = next1.unknown;
	rows.body2 = next2.unknown;
	rows.J1 = jacobian(frame, next1.middle.position, chord<K>(next1.mean, h), -1);
	rows.J2 = jacobian(frame, next2.middle.position, chord<K>(next2.mean, h), 1);
	rows.law = pair.friction;
	rows.impulse = !guesses.empty() ? guesses[row] : partBases ? Impulse::Zero() : Impulse(h * point.force);
	if (body1.prescribed)
		rows.offset += rows.J1 * next1.velocity;
	if (body2.prescribed)
		rows.offset += rows.J2 * next2.velocity;
	Impulse now = rows.J1 * body1.velocity + rows.J2 * body2.velocity - astray;
	if (isMoved(body1, next1.velocity) || isMoved(body2, next2.velocity))
		rows.most = mass * (tolerance::contactProblem::maxWeights * scales.stepSpeed(h) + (point.closed ? 0 : std::max(0., -now[0]))) +
		            tolerance::contactProblem::maxWeights * externalForce(s) * h;
	if (!point.closed)
		now[0] = std::max(now[0] + astray[0] + 2 * std::max(point.gap, 0.) / h, 0.);
	if (point.sliding && stopsInside)
		now.template tail<K::rows - 1>().setZero();
	rows.offset += now;
	return rows;
}

template void SmoothStep<Plane>::dampStray(const RigidSystem<Plane>&, double);
template void SmoothStep<Space>::dampStray(const RigidSystem<Space>&, double);
template void SmoothStep<Plane>::findStray(const RigidSystem<Plane>&);
template void SmoothStep<Space>::findStray(const RigidSystem<Space>&);
template double SmoothStep<Plane>::strayWork() const;
template double SmoothStep<Space>::strayWork() const;
template void SmoothStep<Plane>::assemble(const RigidSystem<Plane>&, double);
template void SmoothStep<Space>::assemble(const RigidSystem<Space>&, double);

} // namespace masonry::localised

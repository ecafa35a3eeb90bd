#include "dynamics/wall/wall_step.hpp"
#include "dynamics/rigid/scales.hpp"
#include "tolerances.hpp"
#include <algorithm>

namespace masonry::rigid {

using wall::all;
using wall::Lanes;

namespace {

constexpr int coldSolves = 3000, returnSolves = 300, mostSolves = 16;

double restSpeed(const RigidSystem<Plane>& s, double length) { return tolerance::restSpeed * std::sqrt(scale::acceleration(s) * length); }

double untilKink(const RigidSystem<Plane>& s, double left, double dt)
{
	const double tiny = tolerance::rigid::instant * dt;
	double first = s.time + left;
	for (const BaseDrive* drive : s.drives)
		first = std::min(first, drive->nextKink(s.time + tiny, s.time + left - tiny));
	return first < s.time + left ? first - s.time : left;
}

void takeJumps(RigidSystem<Plane>& s)
{
	for (size_t d = 0; d < s.drives.size(); ++d)
		if (const double jump = s.drives[d]->jumpAt(s.time))
			for (auto& body : s.bodies)
				if (body.drive == int(d))
					body.velocity.head<2>() += jump * s.driveDirections[d];
}

Vector2 driven(const RigidSystem<Plane>& s, const RigidBody<Plane>& body, double t)
{
	return body.origin + s.driveDirections[body.drive] * s.drives[body.drive]->displacement(t);
}

} // namespace

template <class K>
StepReport WallStep<K>::advance(RigidSystem<K>& s, double dt)
{
	report = {};
	s.impacts.clear();
	takeJumps(s);
	for (double left = dt; left > 0 && !report.diverged;) {
		const double h = untilKink(s, left, dt);
		advancePart(s, h);
		left = h == left ? 0 : left - h;
		if (left > 0)
			takeJumps(s);
	}
	report.residual = std::max(report.velocityResidual, report.forceResidual);
	return report;
}

template <class K>
void WallStep<K>::advancePart(RigidSystem<K>& s, double h)
{
	auto& m = memoryOfModes;
	const double workBefore = s.baseWork;
	contacts.mostThreads = settings.threads;
	const bool newPoints = contacts.measure(s);
	const WallMode before = m.mode;
	if (m.mode == WallMode::still && !tryStill(s, h, newPoints))
		m.mode = WallMode::moving;
	if (m.mode == WallMode::moving)
		substeps(s, h, newPoints);
	report.mode = m.mode;
	report.switched |= m.started && before != m.mode;
	m.started = true;
	takeMotion(s, h, workBefore);
	choose(s, h);
	s.time += h;
	s.fresh = false;
	report.diverged = !std::isfinite(s.kineticEnergy());
}

// Velocities of the prescribed bodies that bring them where they belong after h.
template <class K>
void WallStep<K>::setBase(const RigidSystem<K>& s, double h)
{
	for (size_t b = 0; b < s.bodies.size(); ++b) {
		const auto& body = s.bodies[b];
		if (!body.prescribed || body.drive < 0)
			continue;
		const Vector2 mean = s.driveDirections[body.drive] *
		                     ((s.drives[body.drive]->displacement(s.time + h) - s.drives[body.drive]->displacement(s.time)) / h);
		contacts.velocity[b] = Lanes {mean.x(), mean.y(), contacts.velocity[b][2], 0};
	}
}

template <class K>
void WallStep<K>::setLoads(const RigidSystem<K>& s, double h)
{
	loads.assign(contacts.velocity.size(), all(0));
	for (size_t b = 0; b < s.bodies.size(); ++b) {
		const auto& body = s.bodies[b];
		const double perMass = contacts.velocity[b][3];
		loads[b] = h * perMass * Lanes {body.force[0], body.force[1], body.force[2] / contacts.gyration[b], 0};
	}
}

template <class K>
bool WallStep<K>::tryStill(RigidSystem<K>& s, double h, bool newPoints)
{
	const double stepSpeed = scale::stepSpeed(s, h), enough = settings.tolerance * stepSpeed;
	contacts.setUnit(h);
	setBase(s, h);
	setLoads(s, h);
	const double rest = restSpeed(s, contacts.length);
	if (memoryOfModes.stay == 0)
		kept.forget(contacts);
	kept.begin(contacts, loads, h, newPoints);
	const double forces = settings.strictForces ? enough : std::numeric_limits<double>::infinity();
	const int most = !memoryOfModes.started ? coldSolves : memoryOfModes.stay == 0 ? returnSolves : mostSolves;
	kept.iterate(settings.strictForces ? coldSolves : most, enough, forces);
	report.solves += kept.report.solves;
	report.factorisations += kept.report.factorisations;
	if (kept.report.velocity > tolerance::wall::still * stepSpeed || kept.report.motion > tolerance::wall::motion * rest) {
		kept.giveUp();
		return false;
	}
	report.velocityResidual = std::max(report.velocityResidual, kept.report.velocity);
	report.forceResidual = std::max(report.forceResidual, kept.report.force);
	kept.keepSlip();
	contacts.velocity = kept.velocity;
	s.baseWork += baseWork(s);
	shift.resize(kept.velocity.size());
	for (size_t b = 0; b < shift.size(); ++b)
		shift[b] = h * kept.velocity[b];
	for (size_t g = 0; g < contacts.groups.size(); ++g)
		for (int k = 0; k < 2; ++k)
			contacts.groups[g].point[k].gap += h * kept.rows[g][k].un;
	return true;
}

template <class K>
void WallStep<K>::substeps(RigidSystem<K>& s, double h, bool newPoints)
{
	const int count = substepCount();
	const double part = h / count, start = s.time;
	contacts.setUnit(part);
	setLoads(s, part);
	soft.begin(contacts);
	joints.find(s, contacts, newPoints);
	for (int k = 0; k < count; ++k) {
		s.time = start + k * part;
		setBase(s, part);
		report.events += land(s, part);
		soft.substep(contacts, loads, part, k + 1 == count);
		s.baseWork += baseWork(s);
	}
	joints.release(contacts);
	s.time = start;
	report.substeps += count;
	report.velocityResidual = std::max(report.velocityResidual, soft.report.residual);
	report.forceResidual = std::max(report.forceResidual, soft.report.residual);
	shift = soft.shift;
}

// What the courses miss of each other falls as the square of the substep.
template <class K>
int WallStep<K>::substepCount() const
{
	constexpr double few = 8, tolerance = 1e-3;
	return int(std::lround(std::max(1., few * std::sqrt(tolerance / settings.tolerance))));
}

// Rocking impacts, and the base pulses that answer them.
template <class K>
int WallStep<K>::land(RigidSystem<K>& s, double part)
{
	const size_t known = s.impacts.size();
	s.baseWork += joints.land(s, contacts, part);
	for (size_t k = known; k < s.impacts.size(); ++k)
		for (BaseDrive* drive : s.drives)
			drive->respond(s.impacts[k].block, s.time);
	return int(s.impacts.size() - known);
}

// Of the impulses that the prescribed bodies give, J.
template <class K>
double WallStep<K>::baseWork(const RigidSystem<K>& s) const
{
	double work = 0;
	for (const auto& [g, i] : contacts.onBase) {
		const wall::Group& group = contacts.groups[g];
		const bool first = s.bodies[group.body1[i]].prescribed;
		const Lanes& v = contacts.velocity[first ? group.body1[i] : group.body2[i]];
		for (const auto& p : group.point) {
			const double an = first ? p.a1n[i] : p.a2n[i], at = first ? p.a1t[i] : p.a2t[i];
			const double power =
			    p.pn[i] * (p.nx[i] * v[0] + p.ny[i] * v[1] + an * v[2]) + p.pt[i] * (p.nx[i] * v[1] - p.ny[i] * v[0] + at * v[2]);
			work += first ? power : -power;
		}
	}
	return work;
}

// What friction takes in the time of one set of impulses, J.
template <class K>
double WallStep<K>::slidingLoss() const
{
	double loss = 0;
	for (const wall::Group& group : contacts.groups)
		for (const auto& p : group.point)
			for (int i = 0; i < wall::width; ++i) {
				if (!(p.pn[i] > 0) || std::abs(p.pt[i]) < group.friction[i] * p.pn[i])
					continue;
				const Lanes &v1 = contacts.velocity[group.body1[i]], &v2 = contacts.velocity[group.body2[i]];
				loss -= p.pt[i] * (p.nx[i] * (v2[1] - v1[1]) - p.ny[i] * (v2[0] - v1[0]) + p.a2t[i] * v2[2] - p.a1t[i] * v1[2]);
			}
	return loss;
}

// Poses, velocities and points back into the system; energies.
template <class K>
void WallStep<K>::takeMotion(RigidSystem<K>& s, double h, double workBefore)
{
	const double end = s.time + h, before = s.kineticEnergy();
	double work = 0;
	for (size_t b = 0; b < s.bodies.size(); ++b) {
		auto& body = s.bodies[b];
		const double rho = contacts.gyration[b];
		if (body.prescribed && body.drive >= 0) {
			body.pose.position = driven(s, body, end);
			body.velocity.template head<2>() = s.driveDirections[body.drive] * s.drives[body.drive]->velocity(end);
			continue;
		}
		const Lanes &v = contacts.velocity[b], &moved = shift[b];
		const typename K::Velocity now(v[0], v[1], v[2] / rho);
		if (!body.prescribed)
			work += body.force[0] * moved[0] + body.force[1] * moved[1] + body.force[2] * moved[2] / rho;
		body.increment = (now - body.velocity) / h;
		body.velocity = now;
		body.pose.position += Vector2(moved[0], moved[1]);
		body.pose.setAngle(body.pose.angle + moved[2] / rho);
	}
	const int parts = report.mode == WallMode::still ? 1 : substepCount();
	const double friction = parts * slidingLoss();
	s.frictDissip += friction;
	s.impactDissip += before + work + (s.baseWork - workBefore) - s.kineticEnergy() - friction;
	takePoints(s, h / parts);
}

template <class K>
void WallStep<K>::takePoints(RigidSystem<K>& s, double unit)
{
	const double touching = tolerance::mergedClosing * contacts.length, perUnit = 1 / unit;
	for (size_t g = 0; g < contacts.groups.size(); ++g) {
		const wall::Group& group = contacts.groups[g];
		for (int i = 0; i < wall::width && contacts.features[g].pair[i] >= 0; ++i) {
			ContactPair<K>& pair = s.pairs[contacts.features[g].pair[i]];
			const Vector2& position = s.bodies[pair.body2].pose.position;
			const double rho = contacts.gyration[pair.body2];
			for (int k = 0; k < pair.size; ++k) {
				const wall::PointLanes& p = group.point[k];
				ContactPoint<K>& point = pair.points[k];
				const double nx = p.nx[i], ny = p.ny[i], along = rho * p.a2t[i], across = -rho * p.a2n[i];
				point.gap = p.gap[i];
				point.closed = p.pn[i] > 0 || p.gap[i] <= touching;
				point.sliding = p.pn[i] > 0 && std::abs(p.pt[i]) >= group.friction[i] * p.pn[i];
				point.landing = false;
				point.force = Vector2(p.pn[i] * perUnit, p.pt[i] * perUnit);
				point.frame.gap = p.gap[i];
				point.frame.axes << nx, ny, -ny, nx;
				point.frame.position = position + Vector2(along * nx - across * ny, along * ny + across * nx);
			}
		}
	}
}

template <class K>
void WallStep<K>::choose(const RigidSystem<K>& s, double h)
{
	auto& m = memoryOfModes;
	const double shortest = tolerance::wall::patience * std::sqrt(contacts.length / scale::acceleration(s));
	if (m.mode == WallMode::still) {
		m.stay += h;
		return;
	}
	if (m.stay >= 0) { // has just left
		m.patience = m.stay < 10 * m.patience ? 2 * m.patience : shortest;
		m.patience = std::max(m.patience, shortest);
		m.stay = -1;
	}
	m.quiet = soft.report.motion <= restSpeed(s, contacts.length) ? m.quiet + h : 0;
	if (m.quiet < m.patience)
		return;
	m.mode = WallMode::still;
	m.quiet = m.stay = 0;
}

template <class K>
size_t WallStep<K>::memory() const
{
	return contacts.groups.size() * (sizeof(wall::Group) + sizeof(wall::FeatureGroup) + 2 * sizeof(wall::KeptFactor::Row)) +
	       kept.factorBlocks() * 9 * (sizeof(double) + sizeof(float)) + contacts.velocity.size() * 10 * sizeof(Lanes);
}

template class WallStep<Plane>;

} // namespace masonry::rigid

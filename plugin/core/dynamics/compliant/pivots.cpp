#include "dynamics/compliant/pivots.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <cmath>
#include <limits>

namespace masonry {

namespace {

// Takes support and restitution from the contact.
void takeSupport(Closing& closing, const JointContact& contact, int block)
{
	closing.support = contact.body1 == block ? contact.body2 : contact.body1;
	closing.restitution = contact.law.restitution;
}

} // namespace

void unmuteInFlight(JointSystem& s, const Joint& joint)
{
	if (std::any_of(joint.points.begin(), joint.points.end(), [&](const PointRef& p) { return s.carries(p); }))
		return;
	// An old pivot on its way out, whose spring has been written off with the impact, would push again.
	for (const PointRef& p : joint.points)
		s.point(p).muted = s.point(p).muted && s.gap(p) < 0 && s.gapRate(p) > 0;
	for (int c : joint.contacts)
		updateSprings(s.contacts[c]);
}

void unmuteUpright(JointSystem& s, const std::vector<Joint>& joints)
{
	std::vector<bool> rocks(s.contacts.size(), false);
	for (const Joint& joint : joints)
		for (int c : joint.contacts)
			rocks[c] = true;
	for (size_t c = 0; c < s.contacts.size(); ++c) {
		if (rocks[c] || !s.contacts[c].rocking())
			continue;
		for (JointPoint& point : s.contacts[c].points)
			point.muted = false;
		updateSprings(s.contacts[c]);
	}
}

void muteOpenPoints(JointSystem& s, const Joint& joint)
{
	unmuteInFlight(s, joint);
	std::vector<PointRef> loaded, open;
	bool rocks = false;
	for (const PointRef& p : joint.points) {
		rocks |= s.point(p).muted;
		(s.carries(p) ? loaded : open).push_back(p);
	}
	if (rocks) { // a support that has come into reach since
		for (int c : joint.contacts) {
			JointContact& contact = s.contacts[c];
			const bool unused = std::none_of(joint.points.begin(), joint.points.end(),
			                                 [&](const PointRef& p) { return p.contact == c && (s.point(p).muted || !(s.gap(p) > 0)); });
			if (unused)
				std::for_each(contact.points.begin(), contact.points.end(), [](JointPoint& p) { p.muted = true; });
		}
		return;
	}
	if (loaded.empty() || open.empty() || !isPivot(s, joint, loaded))
		return;
	for (const PointRef& p : open)
		s.point(p).muted = true;
}

Closing findClosing(const JointSystem& s, const Joint& joint)
{
	Closing result;
	double pivotGap = 0, pivotRate = 0;
	int pivots = 0;
	Vector3 pivot = Vector3::Zero();
	for (const PointRef& p : joint.points) {
		if (!s.carries(p))
			continue;
		pivotGap += s.gap(p);
		pivotRate += s.gapRate(p);
		pivot += s.position(p);
		++pivots;
	}
	if (pivots == 0)
		return result;
	pivotGap /= pivots;
	pivotRate /= pivots;
	pivot /= pivots;
	result.depth = -pivotGap;

	std::vector<PointRef> candidates;
	const double merged = tolerance::mergedClosing * sizeOf(s, joint);
	bool crossed = false;
	for (const PointRef& p : joint.points) {
		if (!s.point(p).muted)
			continue;
		const double lift = s.gap(p) - pivotGap, rate = s.gapRate(p) - pivotRate;
		if (lift > merged || !(rate < 0))
			continue;
		candidates.push_back(p);
		if (lift > 0)
			continue;
		crossed = true;
		result.before = std::clamp(lift / rate, result.before, s.dt);
	}
	if (!crossed)
		return result;
	result.points = candidates;
	int landing = candidates.front().contact;
	for (const PointRef& p : candidates) {
		const double lever = (s.position(p) - pivot).norm();
		if (lever > result.lever) {
			result.lever = lever;
			landing = p.contact;
		}
	}
	takeSupport(result, s.contacts[landing], joint.block);
	return result;
}

Closing findLanding(const JointSystem& s, const Joint& joint)
{
	Closing result;
	double speed = 0;
	for (const PointRef& p : joint.points) {
		if (s.point(p).muted)
			continue;
		const double gap = s.gap(p), rate = s.gapRate(p);
		if (gap - rate * s.dt < 0)
			return {};
		if (gap < 0) {
			result.before = std::min(std::max(result.before, gap / rate), s.dt);
			speed = std::max(speed, -rate);
		}
	}
	const double size = sizeOf(s, joint);
	if (!(speed > tolerance::restSpeed * std::sqrt(s.gravity.norm() * size)))
		return {};
	double lowest = std::numeric_limits<double>::infinity();
	for (const PointRef& p : joint.points) {
		const double touching = s.gap(p) - s.gapRate(p) * result.before; // gap at that instant
		if (s.point(p).muted || touching > tolerance::mergedClosing * size)
			continue;
		result.points.push_back(p);
		if (touching < lowest) {
			lowest = touching;
			takeSupport(result, s.contacts[p.contact], joint.block);
		}
	}
	return result;
}

} // namespace masonry

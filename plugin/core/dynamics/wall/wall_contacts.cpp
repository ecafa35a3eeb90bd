#include "dynamics/wall/wall_contacts.hpp"
#include "dynamics/rigid/scales.hpp"
#include "dynamics/wall/threads.hpp"
#include "tolerances.hpp"
#include <algorithm>
#include <cmath>

namespace masonry::rigid::wall {

namespace {

constexpr int groupsPerThread = 256;  // fewer do not repay the meetings of the threads
constexpr double farAway = 1e30;      // m
constexpr double mostFriction = 1e12; // stands for noSlip: infinity times a zero impulse is no number

MASONRY_INLINE Lanes select(const Mask& mask, const Lanes& a, const Lanes& b) { return mask ? a : b; }

// Gap, normal and arms of a group's points; returns whether some pair has moved by more than `travel` since it was looked up.
MASONRY_INLINE bool locate(Group& group, const FeatureGroup& features, const Lanes* pose, const Lanes* velocity, const double* gyration,
                           double travel)
{
	const Bodies p1(pose, group.body1), p2(pose, group.body2); // position, cosine, sine
	Lanes mass1, mass2, rho1, rho2;
	for (int i = 0; i < width; ++i) {
		mass1[i] = velocity[group.body1[i]][3];
		mass2[i] = velocity[group.body2[i]][3];
		rho1[i] = gyration[group.body1[i]];
		rho2[i] = gyration[group.body2[i]];
	}
	const Lanes one = all(1), perRho1 = one / rho1, perRho2 = one / rho2;
	Lanes moved = all(0);
	for (int k = 0; k < 2; ++k) {
		const FeatureLanes& f = features.point[k];
		PointLanes& p = group.point[k];
		const Lanes vertexC = select(f.vertexOn1, p1.w, p2.w), vertexS = select(f.vertexOn1, p1.m, p2.m);
		const Lanes faceC = select(f.vertexOn1, p2.w, p1.w), faceS = select(f.vertexOn1, p2.m, p1.m);
		const Lanes awayX = select(f.vertexOn1, p1.x - p2.x, p2.x - p1.x), awayY = select(f.vertexOn1, p1.y - p2.y, p2.y - p1.y);
		const Lanes armX = vertexC * f.vertexX - vertexS * f.vertexY, armY = vertexS * f.vertexX + vertexC * f.vertexY;
		const Lanes outX = faceC * f.normalX - faceS * f.normalY, outY = faceS * f.normalX + faceC * f.normalY;
		const Lanes fromX = awayX + armX, fromY = awayY + armY; // the centre of the face's body
		const Lanes gap = outX * fromX + outY * fromY - f.faceDistance, shift = outX * fromY - outY * fromX;
		moved = larger(moved, size(gap - f.foundGap) + size(shift - f.foundShift));

		p.nx = select(f.vertexOn1, -outX, outX);
		p.ny = select(f.vertexOn1, -outY, outY);
		const Lanes r1x = select(f.vertexOn1, armX, fromX), r1y = select(f.vertexOn1, armY, fromY);
		const Lanes r2x = select(f.vertexOn1, fromX, armX), r2y = select(f.vertexOn1, fromY, armY);
		p.a1n = (r1x * p.ny - r1y * p.nx) * perRho1;
		p.a1t = (r1x * p.nx + r1y * p.ny) * perRho1;
		p.a2n = (r2x * p.ny - r2y * p.nx) * perRho2;
		p.a2t = (r2x * p.nx + r2y * p.ny) * perRho2;
		p.gap = select(f.present, gap, all(farAway));
		const Lanes none = all(0);
		p.massN = select(f.present, one / (mass1 + mass2 + mass1 * p.a1n * p.a1n + mass2 * p.a2n * p.a2n), none);
		p.massT = select(f.present, one / (mass1 + mass2 + mass1 * p.a1t * p.a1t + mass2 * p.a2t * p.a2t), none);
	}
	return largest(moved) > travel;
}

MASONRY_LANES void locateAll(Group* groups, const FeatureGroup* features, unsigned char* stale, size_t count, const Lanes* pose,
                             const Lanes* velocity, const double* gyration, double travel)
{
	for (size_t g = 0; g < count; ++g)
		stale[g] |= locate(groups[g], features[g], pose, velocity, gyration, travel);
}

} // namespace

bool WallContacts::samePairs(const RigidSystem<Plane>& s)
{
	if (s.pairs.size() != pairs.size() || velocity.size() != s.bodies.size() + 1)
		return false;
	for (size_t c = 0; c < pairs.size(); ++c)
		if (s.pairs[c].body1 != pairs[c][0] || s.pairs[c].body2 != pairs[c][1])
			return false;
	return true;
}

// Greedy in the order of the pairs, then packed by four.
void WallContacts::colour(const RigidSystem<Plane>& s)
{
	const int none = int(s.bodies.size());
	pairs.clear();
	for (const auto& pair : s.pairs)
		pairs.push_back({pair.body1, pair.body2});

	std::vector<std::vector<int>> ofColour;
	std::vector<std::vector<char>> used; // by colour, whether a body has a pair of it
	for (int c = 0; c < int(pairs.size()); ++c) {
		size_t k = 0;
		for (;; ++k) {
			if (k == ofColour.size()) {
				ofColour.emplace_back();
				used.emplace_back(s.bodies.size(), 0);
			}
			const auto taken = [&](int body) { return !s.bodies[body].prescribed && used[k][body]; };
			if (!taken(pairs[c][0]) && !taken(pairs[c][1]))
				break;
		}
		ofColour[k].push_back(c);
		used[k][pairs[c][0]] = used[k][pairs[c][1]] = 1;
	}

	groups.clear();
	features.clear();
	colourEnd.clear();
	for (const auto& members : ofColour) {
		for (size_t first = 0; first < members.size(); first += width) {
			Group group {};
			FeatureGroup feature {};
			for (int i = 0; i < width; ++i) {
				const bool filled = first + i < members.size();
				feature.pair[i] = filled ? members[first + i] : -1;
				group.body1[i] = filled ? pairs[members[first + i]][0] : none;
				group.body2[i] = filled ? pairs[members[first + i]][1] : none;
			}
			groups.push_back(group);
			features.push_back(feature);
		}
		colourEnd.push_back(int(groups.size()));
	}
	stale.assign(groups.size(), 1);
	onBase.clear();
	for (int g = 0; g < int(groups.size()); ++g)
		for (int i = 0; i < width && features[g].pair[i] >= 0; ++i)
			if (s.bodies[groups[g].body1[i]].prescribed || s.bodies[groups[g].body2[i]].prescribed)
				onBase.push_back({g, i});

	// Breadth first from the prescribed bodies.
	std::vector<int> level(s.bodies.size(), -1);
	for (size_t b = 0; b < s.bodies.size(); ++b)
		if (s.bodies[b].prescribed)
			level[b] = 0;
	depth = 0;
	for (bool grew = true; grew; ++depth) {
		grew = false;
		for (const auto& [a, b] : pairs)
			for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)})
				if (level[from] == depth && level[to] < 0) {
					level[to] = depth + 1;
					grew = true;
				}
	}
	--depth;
}

void WallContacts::takeBodies(const RigidSystem<Plane>& s)
{
	const size_t n = s.bodies.size();
	velocity.resize(n + 1);
	pose.resize(n + 1);
	gyration.resize(n + 1);
	for (size_t b = 0; b < n; ++b) {
		const auto& body = s.bodies[b];
		const double mass = body.prescribed ? 0 : 1 / body.mass;
		gyration[b] = body.prescribed ? 1 : std::sqrt(body.inertia[0] * mass);
		velocity[b] = Lanes {body.velocity[0], body.velocity[1], gyration[b] * body.velocity[2], mass};
		pose[b] = Lanes {body.pose.position.x(), body.pose.position.y(), body.pose.cosine, body.pose.sine};
	}
	velocity[n] = all(0);
	pose[n] = Lanes {0, 0, 1, 0};
	gyration[n] = 1;
}

void WallContacts::takePoint(const RigidSystem<Plane>& s, int g, int lane, int k)
{
	const ContactPair<Plane>& pair = s.pairs[features[g].pair[lane]];
	FeatureLanes& f = features[g].point[k];
	const bool present = k < pair.size;
	const PlaneFeature feature = present ? pair.points[k].feature : PlaneFeature {1, 0, 0}; // any will tell how far the pair moves
	const bool vertexOn1 = feature.vertexBody == 1;
	const Vector2 &vertexHalf = s.bodies[vertexOn1 ? pair.body1 : pair.body2].halfSize,
	              &faceHalf = s.bodies[vertexOn1 ? pair.body2 : pair.body1].halfSize;
	const int axis = feature.face / 2;
	f.vertexOn1[lane] = vertexOn1 ? -1 : 0;
	f.present[lane] = present ? -1 : 0;
	f.vertexX[lane] = feature.vertex & 1 ? vertexHalf.x() : -vertexHalf.x();
	f.vertexY[lane] = feature.vertex & 2 ? vertexHalf.y() : -vertexHalf.y();
	f.normalX[lane] = axis == 0 ? (feature.face % 2 ? 1 : -1) : 0;
	f.normalY[lane] = axis == 1 ? (feature.face % 2 ? 1 : -1) : 0;
	f.faceDistance[lane] = faceHalf[axis];
	f.foundGap[lane] = f.foundShift[lane] = 0;
	const Lanes *vertexPose = &pose[vertexOn1 ? pair.body1 : pair.body2], *facePose = &pose[vertexOn1 ? pair.body2 : pair.body1];
	const Vector2 from((*vertexPose)[0] - (*facePose)[0] + (*vertexPose)[2] * f.vertexX[lane] - (*vertexPose)[3] * f.vertexY[lane],
	                   (*vertexPose)[1] - (*facePose)[1] + (*vertexPose)[3] * f.vertexX[lane] + (*vertexPose)[2] * f.vertexY[lane]);
	const Vector2 out((*facePose)[2] * f.normalX[lane] - (*facePose)[3] * f.normalY[lane],
	                  (*facePose)[3] * f.normalX[lane] + (*facePose)[2] * f.normalY[lane]);
	f.foundGap[lane] = out.dot(from) - f.faceDistance[lane];
	f.foundShift[lane] = out.x() * from.y() - out.y() * from.x();
}

// A point that was there before keeps its state, and so does one that another feature of the same place takes over from.
bool WallContacts::lookUp(RigidSystem<Plane>& s, int g)
{
	const double samePlace = 2 * tolerance::wall::search * length, touching = tolerance::mergedClosing * length;
	bool changed = false;
	for (int lane = 0; lane < width && features[g].pair[lane] >= 0; ++lane) {
		ContactPair<Plane>& pair = s.pairs[features[g].pair[lane]];
		const auto &body1 = s.bodies[pair.body1], &body2 = s.bodies[pair.body2];
		FoundPoints<Plane> found;
		if (!Plane::findPoints(body1.halfSize, body1.pose, body2.halfSize, body2.pose, std::numeric_limits<double>::infinity(), pair.memory,
		                       found))
			found.size = 0;
		const ContactPair<Plane> before = pair;
		const Group& group = groups[g];
		const FeatureGroup state = features[g];
		pair.size = found.size;
		pair.face1 = found.face1;
		pair.face2 = found.face2;
		for (int k = 0; k < 2; ++k) {
			double pn = 0, pt = 0, zn = 0, zt = 0, slip = 0, zero = 0;
			if (k < found.size) {
				ContactPoint<Plane> point;
				point.feature = found.features[k];
				point.frame = Plane::frame(point.feature, body1.halfSize, body1.pose, body2.halfSize, body2.pose);
				point.gap = point.frame.gap;
				point.closed = point.gap <= touching;
				zero = std::min(0., point.gap);
				bool known = false, same = false;
				for (int j = 0; j < before.size && !same; ++j) {
					const ContactPoint<Plane>& old = before.points[j];
					same = old.feature == point.feature;
					if (!same && !((old.frame.position - point.frame.position).norm() <= samePlace))
						continue;
					known = true;
					point.closed = old.closed;
					point.sliding = old.sliding;
					point.force = old.force;
					const bool inGroup = state.point[j].present[lane];
					pn = inGroup ? group.point[j].pn[lane] : unit * old.force[0];
					pt = inGroup ? group.point[j].pt[lane] : unit * old.force[1];
					zn = state.point[j].zn[lane];
					zt = state.point[j].zt[lane];
					slip = state.point[j].slip[lane];
					zero = std::min(zero, state.point[j].zero[lane]);
				}
				changed |= !known || !same;
				pair.points[k] = point;
			}
			FeatureLanes& f = features[g].point[k];
			changed |= bool(f.present[lane]) != (k < found.size);
			takePoint(s, g, lane, k);
			f.zn[lane] = zn;
			f.zt[lane] = zt;
			f.slip[lane] = slip;
			f.zero[lane] = zero;
			groups[g].point[k].pn[lane] = pn;
			groups[g].point[k].pt[lane] = pt;
		}
		groups[g].friction[lane] = std::min(pair.friction, mostFriction);
	}
	return changed;
}

bool WallContacts::measure(RigidSystem<Plane>& s)
{
	length = scale::length(s);
	const double travel = tolerance::wall::search * length;
	bool changed = !samePairs(s);
	if (changed)
		colour(s);
	if (s.moved)
		std::fill(stale.begin(), stale.end(), 1);
	s.moved = false;
	takeBodies(s);
	threads = std::clamp(int(groups.size()) / groupsPerThread, 1, std::max(1, mostThreads));
	inParallel(threads, [&](const Share& share) {
		const auto [first, last] = share.of(0, int(groups.size()));
		locateAll(&groups[first], &features[first], &stale[first], last - first, pose.data(), velocity.data(), gyration.data(), travel);
	});
	for (size_t g = 0; g < groups.size(); ++g)
		if (stale[g]) {
			changed |= lookUp(s, int(g));
			stale[g] = 0;
			locateAll(&groups[g], &features[g], &stale[g], 1, pose.data(), velocity.data(), gyration.data(), travel);
		}
	return changed;
}

void WallContacts::setUnit(double h)
{
	if (h == unit)
		return;
	const Lanes factor = all(unit > 0 ? h / unit : 1);
	for (Group& group : groups)
		for (PointLanes& p : group.point) {
			p.pn *= factor;
			p.pt *= factor;
		}
	unit = h;
}

} // namespace masonry::rigid::wall

#include "dynamics/wall/kept_factor.hpp"
#include "dynamics/wall/threads.hpp"
#include "tolerances.hpp"
#include <algorithm>

namespace masonry::rigid::wall {

namespace {

using Row = KeptFactor::Row;

constexpr double relaxation = 1.6;
constexpr double pullBack = 0.2; // share of a slip, or of a penetration that has grown in this mode, that a step takes back

struct alignas(alignment) Largest {
	Lanes velocity, force, motion;
};

MASONRY_INLINE Lanes clip(const Lanes& value, const Lanes& bound) { return larger(smaller(value, bound), -bound); }

// Which points take part, R, and b. Returns whether another point touches than before.
MASONRY_LANES bool takeAll(Group* groups, const FeatureGroup* features, std::array<Row, 2>* rows, int begin, int end, double h,
                           double softness, double enter, double leave)
{
	const Lanes perH = all(1 / h), none = all(0);
	Mask different {0, 0, 0, 0};
	for (int g = begin; g < end; ++g)
		for (int k = 0; k < 2; ++k) {
			const FeatureLanes& f = features[g].point[k];
			PointLanes& p = groups[g].point[k];
			Row& row = rows[g][k];
			const Mask was = row.stiffness > 0;
			const Mask touches = f.present & (was ? p.gap < leave : p.gap < enter);
			different |= touches ^ was;
			const Lanes stiffness = p.massN * p.massT / ((p.massN + p.massT) * (0.5 * softness));
			row.stiffness = touches ? stiffness : none;
			row.resistance = touches ? all(1) / stiffness : none;
			const Lanes gap = p.gap - f.zero;
			row.bn = -gap * perH * (gap > 0 ? all(1) : all(pullBack));
			row.bt = -pullBack * perH * f.slip;
			row.bn = touches ? row.bn : none;
			p.pn = touches ? p.pn : none;
			p.pt = touches ? p.pt : none;
		}
	return (different[0] | different[1] | different[2] | different[3]) != 0;
}

// One pass over the points: the laws (not before the first solve), and the right-hand side of the next solve.
template <bool laws>
MASONRY_INLINE void passAll(Group* groups, FeatureGroup* features, std::array<Row, 2>* rows, int begin, int end, const Lanes* velocity,
                            Lanes* force, Largest& worst)
{
	for (int g = begin; g < end; ++g) {
		Group& group = groups[g];
		const Bodies v1(velocity, group.body1), v2(velocity, group.body2);
		Bodies f1(force, group.body1), f2(force, group.body2);
		const Lanes dx = v2.x - v1.x, dy = v2.y - v1.y;
		for (int k = 0; k < 2; ++k) {
			PointLanes& p = group.point[k];
			FeatureLanes& f = features[g].point[k];
			Row& row = rows[g][k];
			const Lanes un = p.nx * dx + p.ny * dy + p.a2n * v2.w - p.a1n * v1.w, ut = p.nx * dy - p.ny * dx + p.a2t * v2.w - p.a1t * v1.w;
			const Lanes wn = un - row.bn, wt = ut - row.bt;
			if constexpr (laws) {
				const Lanes yn = p.pn - (relaxation * wn - (relaxation - 1) * f.zn) * row.stiffness;
				const Lanes yt = p.pt - (relaxation * wt - (relaxation - 1) * f.zt) * row.stiffness;
				p.pn = larger(yn, all(0));
				p.pt = clip(yt, group.friction * p.pn);
				const Lanes zn = (p.pn - yn) * row.resistance, zt = (p.pt - yt) * row.resistance;
				const Lanes errorN = (zn - (2 - relaxation) * f.zn - (relaxation - 1) * wn) * row.stiffness;
				const Lanes errorT = (zt - (2 - relaxation) * f.zt - (relaxation - 1) * wt) * row.stiffness;
				const Lanes perMass = row.stiffness > 0 ? all(1) / p.massN : all(0);
				f.zn = zn;
				f.zt = zt;
				row.un = un;
				row.ut = ut;
				const Mask touches = row.stiffness > 0;
				const Lanes miss = larger(size(wn - zn), size(wt - zt)), motion = larger(size(un), size(ut));
				worst.velocity = larger(worst.velocity, touches ? miss : all(0));
				worst.motion = larger(worst.motion, f.present ? motion : all(0));
				worst.force = larger(worst.force, larger(size(errorN), size(errorT)) * perMass);
			}
			if constexpr (!laws) { // a point without an impulse is free to move as it does
				f.zn = p.pn > 0 ? f.zn : larger(wn, all(0));
				f.zt = p.pn > 0 ? f.zt : wt;
			}
			const Lanes qn = p.pn + (f.zn - wn) * row.stiffness, qt = p.pt + (f.zt - wt) * row.stiffness;
			const Lanes fx = p.nx * qn - p.ny * qt, fy = p.ny * qn + p.nx * qt;
			f1.x -= fx;
			f1.y -= fy;
			f1.w -= p.a1n * qn + p.a1t * qt;
			f2.x += fx;
			f2.y += fy;
			f2.w += p.a2n * qn + p.a2t * qt;
		}
		f1.store(force, group.body1, v1.m);
		f2.store(force, group.body2, v2.m);
	}
}

MASONRY_LANES void firstPass(Group* groups, FeatureGroup* features, std::array<Row, 2>* rows, int begin, int end, const Lanes* velocity,
                             Lanes* force, Largest& worst)
{
	passAll<false>(groups, features, rows, begin, end, velocity, force, worst);
}

MASONRY_LANES void lawPass(Group* groups, FeatureGroup* features, std::array<Row, 2>* rows, int begin, int end, const Lanes* velocity,
                           Lanes* force, Largest& worst)
{
	passAll<true>(groups, features, rows, begin, end, velocity, force, worst);
}

// M (V_free - V)
void inertia(const LaneArray& free, const LaneArray& velocity, LaneArray& force, int begin, int end)
{
	for (int b = begin; b < end; ++b)
		force[b] = velocity[b][3] > 0 ? (free[b] - velocity[b]) / all(velocity[b][3]) : all(0);
}

} // namespace

bool KeptFactor::takeRows(bool newPoints)
{
	const double deepest = 3., softest = 3e-3; // of r: waves of correction cross the courses in some sqrt(1/r) solves
	const double wanted = std::min(softest, deepest / (double(contacts->depth) * contacts->depth));
	const bool otherSoftness = wanted != softness;
	softness = wanted;
	if (rows.size() != contacts->groups.size())
		rows.assign(contacts->groups.size(), {});
	const double enter = tolerance::wall::touching * contacts->length;
	bool different = false;
	inParallel(contacts->threads, [&](const Share& share) {
		const auto [first, last] = share.of(0, int(rows.size()));
		const bool here =
		    takeAll(contacts->groups.data(), contacts->features.data(), rows.data(), first, last, h, softness, enter, 4 * enter);
#pragma omp critical
		different |= here;
	});
	return different || newPoints || otherSoftness;
}

// A, in the components (v, rho w).
void KeptFactor::factorise()
{
	const auto& c = *contacts;
	edges.clear();
	for (const Group& group : c.groups)
		for (int i = 0; i < width; ++i)
			if (c.velocity[group.body1[i]][3] > 0 && c.velocity[group.body2[i]][3] > 0)
				edges.push_back({group.body1[i], group.body2[i]});
	factor.setGraph(int(c.velocity.size()), edges);
	using Block = SymmetricFactor::Block;
	for (size_t b = 0; b < c.velocity.size(); ++b) {
		const double inverseMass = c.velocity[b][3];
		factor.addDiagonal(int(b), Block::Identity() * (inverseMass > 0 ? 1 / inverseMass : 1));
	}
	int edge = 0;
	for (size_t g = 0; g < c.groups.size(); ++g)
		for (int i = 0; i < width; ++i) {
			const Group& group = c.groups[g];
			Block k11 = Block::Zero(), k12 = Block::Zero(), k22 = Block::Zero();
			for (int k = 0; k < 2; ++k) {
				const PointLanes& p = group.point[k];
				const Eigen::Vector3d n1(-p.nx[i], -p.ny[i], -p.a1n[i]), n2(p.nx[i], p.ny[i], p.a2n[i]);
				const Eigen::Vector3d t1(p.ny[i], -p.nx[i], -p.a1t[i]), t2(-p.ny[i], p.nx[i], p.a2t[i]);
				const double stiffness = rows[g][k].stiffness[i];
				k11 += stiffness * (n1 * n1.transpose() + t1 * t1.transpose());
				k12 += stiffness * (n1 * n2.transpose() + t1 * t2.transpose());
				k22 += stiffness * (n2 * n2.transpose() + t2 * t2.transpose());
			}
			const bool free1 = c.velocity[group.body1[i]][3] > 0, free2 = c.velocity[group.body2[i]][3] > 0;
			if (free1)
				factor.addDiagonal(group.body1[i], k11);
			if (free2)
				factor.addDiagonal(group.body2[i], k22);
			if (free1 && free2)
				factor.addEdge(edge++, k12);
		}
	factor.factorise();
	++report.factorisations;
}

void KeptFactor::begin(WallContacts& c, const LaneArray& load, double step, bool newPoints)
{
	contacts = &c;
	h = step;
	report = {};
	before.resize(c.groups.size());
	for (size_t g = 0; g < c.groups.size(); ++g)
		for (int k = 0; k < 2; ++k)
			before[g][k] = {c.groups[g].point[k].pn, c.groups[g].point[k].pt, c.features[g].point[k].zn, c.features[g].point[k].zt};
	if (takeRows(newPoints))
		factorise();
	velocity = c.velocity;
	free.resize(velocity.size());
	force.resize(velocity.size());
	for (size_t b = 0; b < velocity.size(); ++b)
		free[b] = velocity[b] + load[b];
	inParallel(c.threads, [&](const Share& share) {
		const auto [first, last] = share.of(0, int(velocity.size()));
		inertia(free, velocity, force, first, last);
		share.meet();
		Largest none {};
		byColour(c.colourEnd, share, [&](int begin, int end) {
			firstPass(c.groups.data(), c.features.data(), rows.data(), begin, end, velocity.data(), force.data(), none);
		});
	});
}

void KeptFactor::forget(WallContacts& c)
{
	for (size_t g = 0; g < c.groups.size(); ++g)
		for (int k = 0; k < 2; ++k) {
			FeatureLanes& f = c.features[g].point[k];
			f.zn = f.zt = f.slip = all(0);
			f.zero = smaller(c.groups[g].point[k].gap, all(0));
		}
}

void KeptFactor::iterate(int most, double velocityResidual, double forceResidual)
{
	auto& c = *contacts;
	for (int k = 0; k < most; ++k) {
		factor.solve(force.data());
		Largest worst {all(0), all(0), all(0)};
		inParallel(c.threads, [&](const Share& share) {
			const Lanes noMass {1, 1, 1, 0};
			const auto [first, last] = share.of(0, int(velocity.size()));
			for (int b = first; b < last; ++b)
				velocity[b] += noMass * force[b];
			inertia(free, velocity, force, first, last);
			share.meet();
			Largest here {all(0), all(0), all(0)};
			byColour(c.colourEnd, share, [&](int begin, int end) {
				lawPass(c.groups.data(), c.features.data(), rows.data(), begin, end, velocity.data(), force.data(), here);
			});
#pragma omp critical
			{
				worst.velocity = larger(worst.velocity, here.velocity);
				worst.force = larger(worst.force, here.force);
				worst.motion = larger(worst.motion, here.motion);
			}
		});
		report.velocity = largest(worst.velocity);
		report.force = largest(worst.force);
		report.motion = largest(worst.motion);
		++report.solves;
		if (report.velocity <= velocityResidual && report.force <= forceResidual)
			return;
	}
}

void KeptFactor::keepSlip()
{
	auto& c = *contacts;
	for (size_t g = 0; g < c.groups.size(); ++g)
		for (int k = 0; k < 2; ++k) {
			const PointLanes& p = c.groups[g].point[k];
			Lanes& slip = c.features[g].point[k].slip;
			const Mask sticks = size(p.pt) < c.groups[g].friction * p.pn;
			slip = sticks ? slip + h * rows[g][k].ut : all(0);
		}
}

void KeptFactor::giveUp()
{
	auto& c = *contacts;
	for (size_t g = 0; g < c.groups.size(); ++g)
		for (int k = 0; k < 2; ++k) {
			PointLanes& p = c.groups[g].point[k];
			FeatureLanes& f = c.features[g].point[k];
			p.pn = before[g][k].pn;
			p.pt = before[g][k].pt;
			f.zn = before[g][k].zn;
			f.zt = before[g][k].zt;
		}
}

} // namespace masonry::rigid::wall

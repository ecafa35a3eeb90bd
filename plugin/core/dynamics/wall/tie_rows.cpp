#include "dynamics/wall/tie_rows.hpp"
#include <algorithm>
#include <cmath>

namespace masonry::wall {

template <class K>
std::vector<TieRow<K>> tieRows(const RigidSystem<K>& s, const BodyLanes<K>& bodies, const LaneArray& before, double h)
{
	std::vector<TieRow<K>> result;
	for (int t = 0; t < int(s.ties.size()); ++t) {
		const Tie<K>& tie = s.ties[t];
		if (tie.broken || !(bodies.isFree(tie.body1) || bodies.isFree(tie.body2)))
			continue;
		const typename K::Pose &pose1 = s.bodies[tie.body1].pose, &pose2 = s.bodies[tie.body2].pose;
		const auto line = Tie<K>::line(tie, pose1, pose2);
		if (!(line.length > 0))
			continue;
		const typename K::Vector arm1 = line.end1 - pose1.position, arm2 = line.end2 - pose2.position;
		TieRow<K> row;
		row.tie = t;
		row.body = {tie.body1, tie.body2};
		row.arm[0] = speedArm(bodies, tie.body1, -line.direction, arm1);
		row.arm[1] = speedArm(bodies, tie.body2, line.direction, arm2);
		const double stiff = tie.stiffness * h;
		const TieShares share = TieShares::ofLast(stiff * h * row.perMass(bodies.velocity()));
		row.compliance = 1 / (stiff * h * share.after);
		row.bias = share.before / share.after * row.rate(before) -
		           (tie.pretension + tie.stiffness * (line.length - tie.length)) / (stiff * share.after);
		row.least = tie.tensionOnly ? 0 : -std::numeric_limits<double>::infinity();
		row.most = h * tie.strength;
		row.impulse = std::clamp(h * tie.force, row.least, row.most);
		result.push_back(row);
	}
	return result;
}

template <class K>
void TieSolve<K>::prepare(const std::vector<TieRow<K>>& rows, const LaneArray& velocity, bool isNewMatrix,
                          const std::function<void(LaneArray&)>& solve)
{
	constexpr double turned = 1e-3; // by which rows may differ from those of Y. Larger: more iterations; smaller: more solves for Y
	const int n = int(rows.size());
	const auto isSame = [&](const TieRow<K>& row, const TieArms<K>& of) { return row.change(of) <= turned; };
	if (isNewMatrix || int(known.size()) != n || !std::equal(rows.begin(), rows.end(), known.begin(), isSame)) {
		known.assign(rows.begin(), rows.end());
		response.clear();
	}
	if (int(response.size()) != n) {
		response.resize(n);
		coupling.resize(n, n);
		for (int r = 0; r < n; ++r) {
			response[r].assign(velocity.size(), all(0));
			known[r].push(1, velocity, response[r]);
			solve(response[r]);
		}
		for (int r = 0; r < n; ++r)
			for (int k = 0; k < n; ++k)
				coupling(r, k) = known[r].rate(response[k]);
	}
	stiffness = coupling;
	for (int r = 0; r < n; ++r)
		stiffness(r, r) += rows[r].compliance;
}

template <class K>
double TieSolve<K>::hold(std::vector<TieRow<K>>& rows, const LaneArray& velocity, const std::vector<int>& freePacks,
                         LaneArray& change) const
{
	constexpr int maxSweeps = 100;
	constexpr double enough = 1e-9; // of the largest change. Smaller: sweeps that the next solve makes worthless
	const int n = int(rows.size());
	if (n == 0)
		return 0;
	Eigen::VectorXd miss(n), given(n);
	for (int r = 0; r < n; ++r) {
		given[r] = rows[r].impulse;
		miss[r] = rows[r].rate(velocity) + rows[r].rate(change) + rows[r].bias + rows[r].compliance * given[r];
	}
	for (int sweep = 0; sweep < maxSweeps; ++sweep) {
		double most = 0, moved = 0;
		for (int r = 0; r < n; ++r) {
			TieRow<K>& row = rows[r];
			const double next = std::clamp(row.impulse - miss[r] / stiffness(r, r), row.least, row.most), by = next - row.impulse;
			row.impulse = next;
			miss += by * stiffness.col(r);
			moved = std::max(moved, std::abs(by));
			most = std::max(most, std::abs(next - given[r]));
		}
		if (moved <= enough * most)
			break;
	}
	double worst = 0;
	for (int r = 0; r < n; ++r) {
		TieRow<K>& row = rows[r];
		const double lacking = std::clamp(row.impulse - miss[r] / stiffness(r, r), row.least, row.most) - row.impulse;
		worst = std::max(worst, std::abs(lacking) * (stiffness(r, r) - row.compliance));
		for (const int b : freePacks)
			change[b] += (row.impulse - given[r]) * response[r][b];
	}
	return worst;
}

template std::vector<TieRow<Plane>> tieRows(const RigidSystem<Plane>&, const BodyLanes<Plane>&, const LaneArray&, double);
template std::vector<TieRow<Space>> tieRows(const RigidSystem<Space>&, const BodyLanes<Space>&, const LaneArray&, double);
template class TieSolve<Plane>;
template class TieSolve<Space>;

} // namespace masonry::wall

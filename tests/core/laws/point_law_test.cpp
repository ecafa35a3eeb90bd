// The law of a point against a search over what it allows, against its own conditions, and against differences.
#include "laws/point_law.hpp"
#include <catch.hpp>
#include <random>

using namespace masonry;

namespace {

class Numbers {
public:
	explicit Numbers(int seed) : engine(seed) {}
	double operator()(double from, double to) { return std::uniform_real_distribution<double>(from, to)(engine); }
	template <class Rows>
	Rows rows()
	{
		Rows result;
		for (auto& x : result)
			x = (*this)(-1, 1);
		return result;
	}

private:
	std::mt19937 engine;
};

using Rows2 = Eigen::Vector2d;
using Rows3 = Eigen::Vector3d;

double size(const Rows2& y) { return std::abs(y[1]); }
double size(const Rows3& y) { return std::hypot(y[1], y[2]); }

// Tangential parts of a length, on all sides.
std::vector<Rows2> around(double length, int, const Rows2&) { return {{0, length}, {0, -length}}; }
std::vector<Rows3> around(double length, int directions, const Rows3&)
{
	std::vector<Rows3> result;
	for (int k = 0; k < directions; ++k)
		result.push_back({0, length * std::cos(2 * M_PI * k / directions), length * std::sin(2 * M_PI * k / directions)});
	return result;
}

constexpr int steps = 400;

// The allowed tangential part nearest to that of y, by a search over a grid of the disc; that of the normal part by one of the half line.
template <class Rows>
Rows nearest(const Rows& y, double friction)
{
	Rows best = Rows::Zero();
	for (int k = 0; k <= steps; ++k)
		if (const double pn = double(k) / steps; std::abs(pn - y[0]) < std::abs(best[0] - y[0]))
			best[0] = pn;
	const auto distance = [&](const Rows& p) { return Rows(p - y).template tail<Rows::RowsAtCompileTime - 1>().norm(); };
	Rows tangential = Rows::Zero();
	for (int k = 1; k <= steps; ++k)
		for (const Rows& p : around(friction * best[0] * k / steps, steps, y))
			if (distance(p) < distance(tangential))
				tangential = p;
	return best + tangential;
}

template <class Rows>
void checkProjections(int seed)
{
	Numbers number(seed);
	for (int k = 0; k < 50; ++k) {
		const double friction = number(0, 1.5);
		const Rows y = number.rows<Rows>();
		// Cells of the grid: 1/steps along the normal, friction/steps along and 2 pi friction/steps around the disc.
		CHECK((project<Rows>(friction, y) - nearest(y, friction)).norm() < (1 + 8 * friction) / steps);
	}
}

// Returns a random pair of impulse and velocity that obeys the law.
template <class Rows>
void checkResiduals(const PointLaw& law, int seed)
{
	constexpr int tangents = Rows::RowsAtCompileTime - 1;
	Numbers number(seed);
	for (int k = 0; k < 200; ++k) {
		Rows p = Rows::Zero(), u = Rows::Zero();
		const double stiffness = number(0.1, 10);
		const bool presses = k % 2, slips = k % 4 == 1;
		if (law.kind == PointLaw::Bilateral) {
			p[0] = number(-1, 1);
			u = number.rows<Rows>();
			u[0] = 0;
		} else if (law.kind == PointLaw::Tied) {
			p = number.rows<Rows>();
			p[0] = presses ? number(0.1, 1) : 0;
			u[0] = presses ? 0 : number(0.1, 1);
		} else if (!presses) {
			u = number.rows<Rows>();
			u[0] = number(0.1, 1);
		} else {
			p = number.rows<Rows>();
			p[0] = number(0.1, 1);
			if (law.kind == PointLaw::Coulomb) {
				p.template tail<tangents>() *= law.friction * p[0] / size(p) * (slips ? 1 : 0.9);
				if (slips)
					u.template tail<tangents>() = -number(0.1, 1) * p.template tail<tangents>();
			}
		}
		CHECK(residual(law, p, u, stiffness) < 1e-14);
		Rows approaching = u, slipping = u;
		approaching[0] -= 0.1;
		CHECK(residual(law, p, approaching, stiffness) > (presses || law.kind == PointLaw::Bilateral ? 0.05 : -1.));
		if (presses && !slips && law.kind != PointLaw::Bilateral) {
			slipping[1] += 10 * stiffness; // beyond the cone, which is 0.1 mu p_n away at least, 6e-3 N s
			CHECK(residual(law, p, slipping, stiffness) > 5e-3 * stiffness);
		}
	}
}

template <class Rows>
void checkRates(const PointLaw& law, int seed)
{
	constexpr double step = 1e-6;
	Numbers number(seed);
	for (int k = 0; k < 100; ++k) {
		const Rows y = number.rows<Rows>();
		if (std::abs(y[0]) < 0.01 || std::abs(size(y) - law.friction * y[0]) < 0.01) // there P has a kink
			continue;
		const auto rate = projectionRate<Rows>(law, y);
		for (int c = 0; c < rate.cols(); ++c) {
			const Rows d = step * Rows::Unit(c), difference = (project<Rows>(law, y + d) - project<Rows>(law, y - d)) / (2 * step);
			CHECK((rate.col(c) - difference).norm() < 1e-6); // of the third derivative, up to 1/0.01^2 times the square of the step
		}
	}
}

template <int rows>
void checkPointsAlone(int seed)
{
	using Rows = Eigen::Matrix<double, rows, 1>;
	Numbers number(seed);
	for (int k = 0; k < 200; ++k) {
		OnePoint<rows> point;
		point.G.setIdentity(); // with couplings too small to ask for a pull
		for (int i = 0; i < rows; ++i)
			for (int j = 0; j < i; ++j)
				point.G(i, j) = point.G(j, i) = number(-0.3, 0.3);
		const Rows u0 = number.template rows<Rows>();
		for (const PointLaw& law : {PointLaw(number(0, 1.)), PointLaw(PointLaw::NoSlip), PointLaw(PointLaw::Bilateral)}) {
			const Rows p = point.impulse(u0, law), u = u0 + point.G * p;
			CAPTURE(int(law.kind), law.friction, p.transpose(), u.transpose());
			if (law.kind == PointLaw::NoSlip && p[0] > 0 && std::abs(u[1]) > 1e-12)
				continue; // no impulse obeys the law: the point is held along the normal alone
			CHECK(residual(law, p, u, point.G.trace()) < 1e-12);
		}
	}
}

} // namespace

TEST_CASE("A projection is the nearest impulse that the law allows, normal part first")
{
	checkProjections<Rows2>(1);
	checkProjections<Rows3>(2);
}

TEST_CASE("The residual is zero where the law of a point holds, and not elsewhere")
{
	for (const PointLaw& law : {PointLaw(0.6), PointLaw(PointLaw::NoSlip), PointLaw(PointLaw::Bilateral), PointLaw(PointLaw::Tied)}) {
		CAPTURE(int(law.kind));
		checkResiduals<Rows2>(law, 3);
		checkResiduals<Rows3>(law, 4);
	}
}

TEST_CASE("The derivative of a projection is that of its differences")
{
	for (const PointLaw& law :
	     {PointLaw(0.6), PointLaw(0.), PointLaw(PointLaw::NoSlip), PointLaw(PointLaw::Bilateral), PointLaw(PointLaw::Tied)}) {
		CAPTURE(int(law.kind));
		checkRates<Rows2>(law, 5);
		checkRates<Rows3>(law, 6);
	}
}

TEST_CASE("The impulse of a point alone obeys its law")
{
	checkPointsAlone<2>(7);
	checkPointsAlone<3>(8);
}

TEST_CASE("An infinite friction coefficient is the law without slip")
{
	CHECK(PointLaw(noSlip).kind == PointLaw::NoSlip);
	CHECK(PointLaw(1e300).kind == PointLaw::Coulomb);
	const Rows3 y(1e-3, 1e9, -1e9);
	CHECK(project<Rows3>(noSlip, y) == y);
	CHECK(project<Rows3>(noSlip, -y).isZero(0));
	CHECK(project<Rows3>(noSlip, y, 1e-2).isZero(0)); // too small to count as pressing
}

#include "rocking/restoring.hpp"
#include <boost/math/constants/constants.hpp>
#include <boost/math/special_functions/ellint_rf.hpp>
#include <cmath>

namespace masonry {

namespace {
double square(double x) { return x * x; }

// long double would cost a factor of three and gain nothing: the arguments are doubles
using DoublePrecision = boost::math::policies::policy<boost::math::policies::promote_double<false>>;
} // namespace

RockingLaw::RockingLaw(const RockingBlock& block, Restoring restoring_)
    : restoring(restoring_), alpha(block.criticalAngle), sinAlpha(block.halfWidth / block.radius),
      cosAlpha(block.halfHeight / block.radius), p(block.frequencyParameter), gravity(block.gravity), sinHalf_(std::sin(alpha / 2)),
      cosHalf_(std::cos(alpha / 2))
{
	switch (restoring) {
	case Restoring::Constant:
		maximumEnergy_ = alpha * sinAlpha / 2;
		break;
	case Restoring::Linear:
		maximumEnergy_ = square(alpha / 2);
		break;
	case Restoring::Exact:
		maximumEnergy_ = square(sinHalf_);
		break;
	}
}

FreeEnergy RockingLaw::energy(double u, double velocity) const
{
	const double kinetic = square(velocity / (2 * p)), phi = alpha - u;
	if (u == 0)
		return {kinetic, maximumEnergy_ - kinetic};
	switch (restoring) {
	case Restoring::Constant:
		return {kinetic + u * sinAlpha / 2, phi * sinAlpha / 2 - kinetic};
	case Restoring::Linear:
		return {kinetic + u * (alpha + phi) / 4, square(phi / 2) - kinetic};
	case Restoring::Exact:
		break;
	}
	return {kinetic + std::sin(u / 2) * std::sin(alpha - u / 2), square(std::sin(phi / 2)) - kinetic};
}

FreeEnergy RockingLaw::afterImpact(const FreeEnergy& e, double restitution, const RockingLaw& next) const
{
	const double share = restitution * (p / next.p), kept = square(share);
	return {kept * e.energy, (next.maximumEnergy_ - maximumEnergy_) + (1 - share) * (1 + share) * maximumEnergy_ + kept * e.deficit};
}

double RockingLaw::impactVelocity(const FreeEnergy& e) const { return 2 * p * std::sqrt(e.energy); }

// Exact: the peak has sin(phi/2) = sqrt(K), hence u = 2 asin(h) - 2 asin(sqrt K) with h = sin(alpha/2). The difference of the
// two arcs, by the addition theorem and h^2 - K = D, is free of cancellation.
double RockingLaw::peakAngle(const FreeEnergy& e) const
{
	switch (restoring) {
	case Restoring::Constant:
		return 2 * e.energy / sinAlpha;
	case Restoring::Linear:
		return 2 * e.energy / (alpha / 2 + std::sqrt(e.deficit));
	case Restoring::Exact:
		break;
	}
	return 2 * std::asin(e.energy / (sinHalf_ * std::sqrt(1 - e.deficit) + std::sqrt(e.deficit) * cosHalf_));
}

// Exact: integral from sin(phi/2) = sqrt(K) of dphi/(2p sqrt(sin^2(phi/2) - K)). With x = sin(phi/2) of the state,
// x^2 - K = (u'/2p)^2 and S^2 = (x^2 - K)/(x^2 (1 - K)), it is S R_F(1 - S^2, 1 - (1 - K) S^2, 1)/p (Carlson), and
// 1 - S^2 = K (1 - x^2)/(x^2 (1 - K)), 1 - (1 - K) S^2 = K/x^2.
// Linear: atanh(y) = log1p(2y/(1 - y))/2 with y = |u'|/(p phi) and 1 - y = (1 - y^2)/(1 + y) = 4K/(phi^2 (1 + y)).
double RockingLaw::timeFromPeak(const FreeEnergy& e, double u, double velocity) const
{
	const double rate = std::abs(velocity) / p, phi = alpha - u, K = e.deficit;
	switch (restoring) {
	case Restoring::Constant:
		return rate / (p * sinAlpha);
	case Restoring::Linear:
		return std::log1p(rate * (phi + rate) / (2 * K)) / (2 * p);
	case Restoring::Exact:
		break;
	}
	const double x = u == 0 ? sinHalf_ : std::sin(phi / 2), ratio = K / square(x), S = rate / (2 * x * std::sqrt(1 - K));
	return S * boost::math::ellint_rf(ratio * (1 - square(x)) / (1 - K), ratio, 1.0, DoublePrecision()) / p;
}

double RockingLaw::impulseLever(double u) const
{
	return square(p) / gravity * (restoring == Restoring::Exact ? std::cos(alpha - u) : cosAlpha);
}

double RockingLaw::upliftAcceleration() const { return gravity * (restoring == Restoring::Linear ? alpha : sinAlpha / cosAlpha); }

double RockingLaw::lostAngle() const { return restoring == Restoring::Constant ? alpha : boost::math::double_constants::half_pi; }

} // namespace masonry

#include "rocking/taylor_step.hpp"
#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

namespace masonry {

namespace {
// 1/k, because divisions would take half the time of an expansion
template <size_t size>
std::array<double, size> reciprocals()
{
	std::array<double, size> result {};
	for (size_t k = 1; k < size; k++)
		result[k] = 1.0 / double(k);
	return result;
}
const auto inverse = reciprocals<32>();
using Pair = double __attribute__((vector_size(16)));
} // namespace

TaylorStep::Acceleration::Acceleration(const BaseMotion::Piece& piece, double t)
{
	terms = 0;
	const auto s = t - piece.start;
	if (piece.amplitude != 0) {
		a[0] = piece.amplitude * std::sin(piece.frequency * s);
		a[1] = piece.amplitude * piece.frequency * std::cos(piece.frequency * s);
		for (int k = 2; k <= highestOrder; k++)
			a[k] = -piece.frequency * piece.frequency * a[k - 2] / (k * (k - 1));
		terms = highestOrder + 1;
	} else if (!piece.isFree()) {
		a[0] = piece.constant + piece.slope * s;
		a[1] = piece.slope;
		terms = 2;
	}
}

TaylorStep::TaylorStep(const RockingLaw& law, const RockingState& state, const Shaking& shaking, double t, double longest)
{
	c_[0] = state.angle;
	c_[1] = state.velocity;
	expand(law, state.side, Acceleration(shaking.horizontal, t), Acceleration(shaking.vertical, t), longest);
	while (!turnsOnce(length_))
		length_ /= 2;
}

// With S = sin(phi), C = cos(phi), phi = alpha - u, r = u' and X_k the k-th Taylor coefficient of X, a and z the base's acceleration along
// x and upwards:
//   (k+1) r_{k+1} = -p^2 (S_k + s/g sum_j a_j C_{k-j} + 1/g sum_j z_j S_{k-j}),   (k+2) u_{k+2} = r_{k+1}
//   (k+1) S_{k+1} = -sum_j r_j C_{k-j},   (k+1) C_{k+1} = sum_j r_j S_{k-j}
// Sums end with the terms that are known last: the others are done while those are waited for.
void TaylorStep::expand(const RockingLaw& law, int side, const Acceleration& horizontal, const Acceleration& vertical, double longest)
{
	const auto& [a, terms] = horizontal;
	const auto& [z, verticalTerms] = vertical;
	const double p2 = law.p * law.p, push = side / law.gravity, phi = law.alpha - c_[0];
	const bool exact = law.restoring == Restoring::Exact;
	std::array<Pair, highestOrder> turned; // (-C, S)
	Series rate;
	if (law.restoring == Restoring::Linear)
		turned[0] = Pair {-1, phi};
	else if (law.restoring == Restoring::Constant || c_[0] == 0)
		turned[0] = Pair {-law.cosAlpha, law.sinAlpha};
	else
		turned[0] = Pair {-std::cos(phi), std::sin(phi)};
	rate[0] = c_[1];
	// a small hop needs no more than a few terms: its length is about -2 u'/u''
	const double weight = verticalTerms > 0 ? 1 + z[0] / law.gravity : 1;
	const double lift = -p2 * (weight * turned[0][1] - push * (terms > 0 ? a[0] : 0) * turned[0][0]);
	if (c_[0] == 0 && c_[1] > 0 && lift < 0)
		longest = std::min(longest, -2.5 * c_[1] / lift);
	length_ = longest;
	double power = longest; // longest^(k+1)
	for (int k = 0;; k++, power *= longest) {
		double force = 0;
		for (int j = std::min(k, terms - 1), last = exact ? 0 : k; j >= last; j--)
			force -= a[j] * turned[k - j][0];
		double weighed = turned[k][1];
		for (int j = std::min(k, verticalTerms - 1); j >= 0; j--)
			weighed += z[j] / law.gravity * turned[k - j][1];
		rate[k + 1] = -p2 * inverse[k + 1] * (weighed + push * force);
		c_[k + 2] = rate[k + 1] * inverse[k + 2];
		order_ = k + 2;
		if (order_ >= 5 && convergesAt(longest, power))
			return;
		if (order_ == highestOrder)
			break;
		if (exact) {
			Pair sum {}; // (S', C')
			for (int j = k; j >= 0; j--)
				sum += rate[j] * turned[k - j];
			sum *= inverse[k + 1];
			turned[k + 1] = Pair {-sum[1], sum[0]};
		} else {
			turned[k + 1][1] = law.restoring == Restoring::Constant ? 0 : -c_[k + 1];
		}
	}
	if (!std::isfinite(c_[highestOrder])) {
		std::ostringstream text;
		text << "the motion is too fast to be followed: the block turns at " << c_[1] << " rad/s and accelerates by " << 2 * c_[2]
		     << " rad/s^2; sizes must be in m, frequencies in Hz";
		throw std::invalid_argument(text.str());
	}
	while (!convergesAt(length_, std::pow(length_, order_ - 1)))
		length_ *= 0.8;
}

// Two terms in a row below a small share of the change of the angle, because every other term may vanish by symmetry.
bool TaylorStep::convergesAt(double s, double power) const
{
	const double change = s * (std::abs(c_[1]) + s * (std::abs(c_[2]) + s * std::abs(c_[3])));
	const double last = power * std::max(std::abs(c_[order_ - 1]), s * std::abs(c_[order_]));
	return last <= std::numeric_limits<double>::epsilon() * change && change < std::numeric_limits<double>::infinity();
}

// Certain where the first term of the velocity outweighs the others, or that of the acceleration. Else the roots of the velocity
// in (0, s) are at most as many as its Bernstein coefficients over [0, s] change their sign (Descartes' rule): of a polynomial
// sum_i a_i x^i of degree n they are b_j = sum_i binomial(j, i)/binomial(n, i) a_i s^i.
bool TaylorStep::turnsOnce(double s) const
{
	const int n = order_ - 1;
	Series b;
	b[0] = c_[1];
	double others = 0, bends = 0, power = s;
	for (int i = 1; i <= n; i++, power *= s) {
		b[i] = (i + 1) * c_[i + 1] * power;
		others += std::abs(b[i]);
		bends += i * std::abs(b[i]);
	}
	if (std::abs(b[0]) >= others || 2 * std::abs(b[1]) >= bends)
		return true;
	const double roundOff = std::numeric_limits<double>::epsilon() * (std::abs(b[0]) + others);
	double share = 1; // 1/binomial(n, i)
	for (int i = 1; i <= n; i++) {
		share *= i * inverse[n + 1 - i];
		b[i] *= share;
	}
	for (int i = 1; i <= n; i++)
		for (int j = n; j >= i; j--)
			b[j] += b[j - 1];
	int changes = 0;
	double last = 0;
	for (int j = 0; j <= n; j++)
		if (std::abs(b[j]) > roundOff) {
			changes += b[j] * last < 0;
			last = b[j];
		}
	return changes <= 1;
}

TaylorStep::Point TaylorStep::at(double s) const
{
	double angle = c_[order_], velocity = 0, half = 0;
	for (int k = order_ - 1; k >= 0; k--) {
		half = half * s + velocity;
		velocity = velocity * s + angle;
		angle = angle * s + c_[k];
	}
	return {angle, velocity, 2 * half};
}

double TaylorStep::firstChange() const { return c_[1] != 0 ? c_[1] : c_[2] != 0 ? c_[2] : c_[3]; }

} // namespace masonry

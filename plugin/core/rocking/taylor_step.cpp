#include "rocking/taylor_step.hpp"
#include <algorithm>
#include <cmath>
#include <limits>

namespace masonry {

TaylorStep::TaylorStep(const RockingLaw& law, const RockingState& state, const BaseMotion::Piece& piece, double t, double longest)
{
	Series a;
	int terms = 0;
	const auto s = t - piece.start;
	if (piece.amplitude != 0) {
		a[0] = piece.amplitude * std::sin(piece.frequency * s + piece.phase);
		a[1] = piece.amplitude * piece.frequency * std::cos(piece.frequency * s + piece.phase);
		for (int k = 2; k <= highestOrder; k++)
			a[k] = -piece.frequency * piece.frequency * a[k - 2] / (k * (k - 1));
		terms = highestOrder + 1;
	} else if (!piece.isFree()) {
		a[0] = piece.constant + piece.slope * s;
		a[1] = piece.slope;
		terms = 2;
	}
	c_[0] = state.angle;
	c_[1] = state.velocity;
	expand(law, state.side, a, terms, longest);
}

// With S = sin(phi), C = cos(phi), phi = alpha - u and X_k the k-th Taylor coefficient of X:
//   (k+2)(k+1) u_{k+2} = -p^2 (S_k + s/g sum_j a_j C_{k-j})
//   (k+1) S_{k+1} = -sum_j (j+1) u_{j+1} C_{k-j},   (k+1) C_{k+1} = sum_j (j+1) u_{j+1} S_{k-j}
void TaylorStep::expand(const RockingLaw& law, int side, const Series& a, int terms, double longest)
{
	const double p2 = law.p * law.p, push = side / law.gravity;
	const bool exact = law.restoring == Restoring::Exact;
	Series S, C, rate;
	S[0] = exact ? std::sin(law.alpha - c_[0]) : law.restoring == Restoring::Constant ? law.sinAlpha : law.alpha - c_[0];
	C[0] = exact ? std::cos(law.alpha - c_[0]) : law.restoring == Restoring::Constant ? law.cosAlpha : 1;
	rate[0] = c_[1];
	length_ = longest;
	for (int k = 0;; k++) {
		double force = 0;
		if (exact)
			for (int j = 0, last = std::min(k, terms - 1); j <= last; j++)
				force += a[j] * C[k - j];
		else if (k < terms)
			force = a[k] * C[0];
		c_[k + 2] = -p2 * (S[k] + push * force) / ((k + 2) * (k + 1));
		rate[k + 1] = (k + 2) * c_[k + 2];
		order_ = k + 2;
		if (order_ == highestOrder || (order_ >= 5 && convergesAt(order_, longest)))
			break;
		if (exact) {
			double sine = 0, cosine = 0;
			for (int j = 0; j <= k; j++) {
				sine -= rate[j] * C[k - j];
				cosine += rate[j] * S[k - j];
			}
			S[k + 1] = sine / (k + 1);
			C[k + 1] = cosine / (k + 1);
		} else {
			S[k + 1] = law.restoring == Restoring::Constant ? 0 : -c_[k + 1];
		}
	}
	while (!convergesAt(order_, length_))
		length_ *= 0.8;
}

// Two terms in a row below a small share of the change of the angle, because every other term may vanish by symmetry.
bool TaylorStep::convergesAt(int order, double s) const
{
	const double change = std::abs(c_[1]) * s + std::abs(c_[2]) * s * s + std::abs(c_[3]) * s * s * s;
	const double power = std::pow(s, order - 1);
	return std::max(std::abs(c_[order - 1]) * power, std::abs(c_[order]) * power * s) <=
	       std::numeric_limits<double>::epsilon() / 8 * change;
}

double TaylorStep::angle(double s) const
{
	double sum = c_[order_];
	for (int k = order_ - 1; k >= 0; k--)
		sum = sum * s + c_[k];
	return sum;
}

double TaylorStep::velocity(double s) const
{
	double sum = order_ * c_[order_];
	for (int k = order_ - 1; k >= 1; k--)
		sum = sum * s + k * c_[k];
	return sum;
}

double TaylorStep::firstChange() const { return c_[1] != 0 ? c_[1] : c_[2] != 0 ? c_[2] : c_[3]; }

} // namespace masonry

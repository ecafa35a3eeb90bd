// Which steps MoreauJeanIntegrator counts as failures, and what it says of them.

#include "MoreauJeanIntegrator.hpp"
#include "rigid_scene.hpp"
#include "sentence.hpp"
#include "tolerances.hpp"

#include <algorithm>
#include <core/Scene.hpp>
#include <sstream>

namespace yade {

/// Sums up what steps make and lose. Returns a sentence where either has come to matter, and again where it has grown tenfold.
string MoreauJeanIntegrator::addErrors()
{
	turnedOver = std::max(turnedOver, stepErrors.kinetic + frictDissip + impactDissip + crackDissip);
	madeEnergy += stepErrors.made;
	lostEnergy += stepErrors.lost;
	lift = std::max(lift, stepErrors.lift); // while gravity is switched off, errors are no larger than with it
	const Real most = masonry::maxUnexplained(turnedOver, lift);
	string text;
	const auto look = [&](Real energy, const char* what, Real& told) {
		if (!masonry::isWorthTelling(energy, most, told))
			return;
		const string share = turnedOver > 0 ? sentence(", ", 100 * energy / turnedOver, " % of what the scene has turned over") : "";
		text += sentence("the energy that has ", what, " since the start comes to ", energy, " J", share, ": do not trust what follows. ");
	};
	look(madeEnergy, "come from nothing", toldMade);
	look(lostEnergy, "vanished", toldLost);
	return text;
}

/// A sentence where no motion obeys the contact laws, else nothing.
string MoreauJeanIntegrator::jam(const masonry::StepReport& report) const
{
	if (report.jammed.empty())
		return "";
	const auto listed = [](const vector<int>& ids) {
		constexpr size_t maxNamed = 10;
		std::ostringstream text;
		for (size_t k = 0; k < std::min(maxNamed, ids.size()); ++k)
			text << (k ? ", " : "") << ids[k];
		text << (ids.size() > maxNamed ? ", ..." : "");
		return text.str();
	};
	const auto [blocks, prescribed] = sceneOf(memory).blocksAndPrescribed(report.jammed);
	return sentence(
	    "bodies with prescribed motion (", listed(prescribed), ") press blocks (", listed(blocks),
	    ") from two sides, or against others, so that no motion obeys the contact laws: they go into the blocks. Make room between "
	    "these bodies, or let one of them give way. ");
}

void MoreauJeanIntegrator::count(const masonry::StepReport& report)
{
	substeps += report.substeps;
	events += report.events;
	sweeps += report.sweeps;
	factorisations += report.factorisations;
	unlocalised += report.unlocalised;
	worstResidual = std::max(worstResidual, report.residual);
	if (report.diverged)
		throw std::runtime_error(
		    sentence("The simulation has diverged in the step from t = ", scene->time, " s: positions or velocities are no longer finite.",
		             method == "localised" ? " Structures of more than some twenty blocks are for method='wall'." : ""));
	const string sums = addErrors();
	const string jammed = jam(report);
	const bool crowded = report.unlocalised > 0;
	const bool unsettled = report.unsettled > 0;
	if (report.converged && jammed.empty() && !crowded && !unsettled && sums.empty() && report.created == 0 && !(report.deepest > 0) &&
	    !(report.turn > 0))
		return;

	const Real ofStep = gravity.norm() * scene->dt; // the speed that gravity gives
	// A residual this small moves nothing that anybody could measure: it is counted, without a word.
	const bool matters = !jammed.empty() || crowded || unsettled || !sums.empty() || report.created != 0 || report.deepest > 0 ||
	                     report.turn > 0 || !(report.residual <= masonry::tolerance::negligible * ofStep);
	std::ostringstream text;
	text << "In the step from t = " << scene->time << " s ";
	text << jammed;
	const bool missed = !report.converged && jammed.empty();
	if (missed)
		text << "the contact laws are missed: residual " << report.residual << " m/s (gravity gives " << ofStep << " m/s in a step). ";
	if (missed && sceneOf(memory).neverSlips())
		text << "Where nothing slips they may have no solution: a pivot that would have to pull, or an edge that lands while it moves "
		        "along the "
		        "face. Give the materials a frictionAngle instead of noSlip. ";
	if (unsettled)
		text << "the solver has not settled whether the mortar of " << report.unsettled << " joints gives way (residual " << report.residual
		     << " m/s), so that it holds: give dem.engines() a larger dt, 1e-3 s if this is a smaller one. ";
	if (crowded)
		text << report.unlocalised << " points closed after mostEvents = " << mostEvents << " events, plastically at its end. ";
	if (report.created > 0)
		text << report.created << " J of energy come from nowhere. ";
	if (report.created < 0)
		text << -report.created << " J of energy vanish. ";
	text << sums;
	if (report.deepest > 0)
		text << "blocks are " << report.deepest << " m deep in each other. ";
	if (report.turn > 0)
		text << "a block turns by " << report.turn
		     << " rad in the step, which method='wall' does not resolve; method='localised' divides such steps. ";
	constexpr size_t maxNamed = 30;
	const vector<int> touching = sceneOf(memory).touching();
	text << "Blocks in touch:";
	for (size_t k = 0; k < std::min(maxNamed, touching.size()); ++k)
		text << ' ' << touching[k];
	if (touching.size() > maxNamed)
		text << " and " << touching.size() - maxNamed << " more";
	text << '.';
	++failures;
	if (!matters)
		return;
	const bool first = firstFailure.empty();
	if (first)
		firstFailure = text.str();
	if (onTrouble == "stop")
		throw std::runtime_error(text.str() + (unsettled ? " Or" : " Give dem.engines() a smaller dt, or") +
		                         " set MoreauJeanIntegrator.onTrouble='continue'.");
	if ((first || !sums.empty()) && onTrouble != "count")
		LOG_WARN(text.str() << " The run goes on; MoreauJeanIntegrator.failures counts such steps."
		                    << (jammed.empty() && !unsettled
		                            ? " A smaller dt of dem.engines() may help; dem.compare() tells whether the answer depends on it."
		                            : ""));
}

} // namespace yade

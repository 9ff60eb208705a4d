#pragma once

#include "core/placement/layer.hpp"
#include "core/placement/place_explainer.hpp"
#include "core/rules/rule_factors.hpp"

#include <limits>
#include <span>
#include <string>
#include <vector>

namespace thicket {

/// How sentences call what a layer refers to.
struct RuleNames {
	std::vector<std::string> fields;    ///< As rule names, "noise" say; of each of Rules::fields.
	std::vector<std::string> neighbors; ///< Of the layer behind each of LayerSettings::neighbors.
	std::vector<std::string> shapes;    ///< Of each of Rules::shapes.
};

/// One factor as a designer reads it.
struct RuleSentence {
	std::string rule; ///< A short name that stays the same: "slope".
	double min = -std::numeric_limits<
			double>::infinity(); ///< What the rule asks its value to be in, infinite where it is open.
	double max = std::numeric_limits<double>::infinity();
	std::string sentence; ///< Value and what is asked for: "Slope is 42°, the layer asks for at most 30°."
};

/// `factor` is one of `layer`.
RuleSentence describe(const RuleFactor &factor, const LayerSettings &layer, const RuleNames &names);

/// Why something of the layer stands there or does not, by its rules alone.
struct RuleVerdict {
	bool yes = false;   ///< Something may stand at the place, and the point nearest to it stands.
	std::string rule;   ///< The rule that says no, "rank" where the density leaves the point out; empty for yes.
	std::string reason; ///< A sentence.
};

RuleVerdict judge(const PlaceExplanation &explanation, const LayerSettings &layer, const RuleNames &names);

/// A number for a sentence: two digits after the point, fewer for large ones, none that are 0; more where it would look like `other`
/// and is not.
std::string number_text(double number, double other = std::numeric_limits<double>::quiet_NaN());

/// "1.2 m away", or "here" for what is nearer than a centimeter.
std::string distance_text(double meters);

} // namespace thicket

#pragma once

#include "core/placement/layer.hpp"
#include "core/explain/place_explainer.hpp"
#include "core/rules/rule_factors.hpp"

#include <limits>
#include <span>
#include <string>
#include <vector>

namespace thicket {

/// The names that sentences use for the objects that a layer refers to.
struct RuleNames {
	std::vector<std::string> fields;    ///< Rule names of Rules::fields, such as "noise".
	std::vector<std::string> neighbors; ///< Names of the layers in LayerSettings::neighbors.
	std::vector<std::string> shapes;    ///< Names of Rules::shapes.
};

/// One factor, as text for a designer.
struct RuleSentence {
	std::string rule; ///< A short name that never changes, such as "slope".
	/// The range that the rule requires, infinite at an open end.
	double min = -std::numeric_limits<double>::infinity();
	double max = std::numeric_limits<double>::infinity();
	std::string sentence; ///< The value and the requirement: "Slope is 42°; the layer requires at most 30°."
};

/// `factor` is one of `layer`.
RuleSentence describe(const RuleFactor &factor, const LayerSettings &layer, const RuleNames &names);

/// Why an instance of the layer is placed at the position or not, judged by the layer's rules alone.
struct RuleVerdict {
	bool yes = false;   ///< An instance is allowed at the position, and the point nearest to it is kept.
	std::string rule;   ///< The rule that refuses it, or "rank" if the density excludes the point; empty for yes.
	std::string reason; ///< A sentence.
};

RuleVerdict judge(const PlaceExplanation &explanation, const LayerSettings &layer, const RuleNames &names);

/// A number for a sentence: two digits after the decimal point, fewer for large numbers, and no trailing zeros. Has
/// more digits if it would otherwise read the same as `other` although the numbers differ.
std::string number_text(double number, double other = std::numeric_limits<double>::quiet_NaN());

/// "1.2 m away", or "here" for anything nearer than a centimeter.
std::string distance_text(double meters);

} // namespace thicket

#pragma once

#include "core/placement/layer.hpp"
#include "core/explain/position_explainer.hpp"
#include "core/rules/rule_factors.hpp"

#include <limits>
#include <span>
#include <string>
#include <vector>

namespace thicket {

/// The names that sentences use for the fields, neighbors, shapes and density rules of a layer.
struct RuleNames {
	std::vector<std::string> fields;          ///< Rule names of Rules::fields, such as "noise".
	std::vector<std::string> neighbors;       ///< Names of the layers in LayerSettings::neighbors.
	std::vector<std::string> shapes;          ///< Names of Rules::shapes.
	std::vector<std::string> density_rules{}; ///< Names of Rules::density_rules.
};

/// A factor, described for the user of the editor.
struct RuleMessage {
	std::string rule; ///< A short, stable name, such as "slope".
	/// The range that the rule requires; infinite where it has no limit.
	double min = -std::numeric_limits<double>::infinity();
	double max = std::numeric_limits<double>::infinity();
	std::string message; ///< The value and the requirement: "Slope is 42°; the layer requires at most 30°."
};

/// Describes a factor. It must come from an evaluation of `layer`.
RuleMessage describe(const RuleFactor &factor, const LayerSettings &layer, const RuleNames &names);

/// Describes the share of a mesh in the choice for the instance at the explained point:
/// "Oak (this instance): weight 2 × 0.35 gives 41 % (biome("Forest") is 0.35)." `name` is the name of
/// the mesh.
std::string describe_mesh(const PositionExplanation &explanation, std::size_t mesh, const std::string &name);

/// The decision of the rules on whether to place an instance of the layer at a position, and the
/// reason. Ignores a game's changes.
struct RuleVerdict {
	bool yes = false; ///< True if an instance is allowed at the position and the nearest point is kept.
	/// The rule that prevents an instance, or "rank" if the density excludes the point. Empty if
	/// `yes`.
	std::string rule;
	std::string reason; ///< One or more sentences for the user.
};

RuleVerdict judge(const PositionExplanation &explanation, const LayerSettings &layer, const RuleNames &names);

/// Formats a number for a sentence with at most two decimal places, fewer for large numbers, and no
/// trailing zeros. Adds decimal places if the result would otherwise be the same as for a different
/// number `other`.
std::string number_text(double number, double other = std::numeric_limits<double>::quiet_NaN());

/// Returns, for example, "1.2 m away", or "here" if the distance is less than a centimeter.
std::string distance_text(double meters);

} // namespace thicket

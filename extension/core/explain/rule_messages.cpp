#include "core/explain/rule_messages.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace thicket {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

std::string fixed_text(double number, int digits) {
	std::array<char, 400> text{};
	std::snprintf(text.data(), text.size(), "%.*f", digits, number);
	std::string result = text.data();
	if (digits > 0) {
		result.erase(result.find_last_not_of('0') + 1);
		result.erase(result.find_last_not_of('.') + 1);
	}
	return result == "-0" ? "0" : result;
}

std::string percent(double fraction) {
	// A tiny fraction is not displayed as 0 %, and a fraction just below 1 not as 100 %.
	const double percentage = std::clamp(fraction * 100.0, fraction > 0.0 ? 0.1 : 0.0, fraction < 1.0 ? 99.9 : 100.0);
	return fixed_text(percentage, percentage < 1.0 || percentage > 99.0 ? 1 : 0) + " %";
}

std::string name_at(const std::vector<std::string> &names, std::size_t index, const char *fallback) {
	return index < names.size() && !names[index].empty() ? names[index] : std::string(fallback);
}

/// Returns the required range in words, with enough digits to distinguish its limits from `value`.
std::string range_text(const RuleMessage &range, double value, const char *unit) {
	const std::string low = number_text(range.min, value) + unit;
	const std::string high = number_text(range.max, value) + unit;
	if (std::isinf(range.min)) {
		return "at most " + high;
	}
	return std::isinf(range.max) ? "at least " + low : low + " to " + high;
}

/// Returns a sentence for a rule that keeps only some of the points, or an empty string for all
/// other rules.
std::string leaves(double density) {
	return density > 0.0 && density < 1.0 ? " The rule permits " + percent(density) + " of the instances." : "";
}

void describe_range(const char *quantity, const char *unit, const RuleFactor &factor, RuleMessage &r_message) {
	const double limit = factor.value < r_message.min ? r_message.min : r_message.max;
	r_message.message = std::string(quantity) + " is " + number_text(factor.value, limit) + unit +
			"; the layer requires " + range_text(r_message, factor.value, unit) + "." + leaves(factor.density);
}

void describe_height(const RuleFactor &factor, const Rules &rules, RuleMessage &r_message) {
	r_message.min = rules.min_height <= -unlimited_height ? -infinity : rules.min_height;
	r_message.max = rules.max_height >= unlimited_height ? infinity : rules.max_height;
	describe_range("Height", " m", factor, r_message);
}

void describe_water_depth(const RuleFactor &factor, const Rules &rules, RuleMessage &r_message) {
	r_message.min = rules.min_water_depth <= -unlimited_height ? -infinity : rules.min_water_depth;
	r_message.max = rules.max_water_depth >= unlimited_height ? infinity : rules.max_water_depth;
	if (std::isinf(factor.value)) {
		r_message.message =
				"There is no water here; the layer requires a depth of " + range_text(r_message, 0.0, " m") + ".";
		return;
	}
	describe_range("Water depth", " m", factor, r_message);
}

void describe_slope(const RuleFactor &factor, const Rules &rules, RuleMessage &r_message) {
	r_message.min = rules.min_slope_degrees;
	r_message.max = rules.max_slope_degrees;
	describe_range("Slope", "°", factor, r_message);
}

std::string curve_text(const char *curve, const RuleFactor &factor, const char *unit) {
	return std::string(curve) + " is " + number_text(factor.density) + " at " + number_text(factor.value) + unit + ".";
}

std::string expression_text(const RuleFactor &factor, const Rules &rules) {
	const std::string value =
			std::isnan(factor.value) ? "not a number here, which is treated as 0" : number_text(factor.value) + " here";
	return "The density expression " + rules.expression->text() + " is " + value + ".";
}

std::string textures_text(const RuleFactor &factor, const Rules &rules) {
	std::string list;
	for (const std::int32_t texture : rules.ground_textures) {
		list += (list.empty() ? "" : ", ") + std::to_string(texture);
	}
	const std::string fraction = factor.density > 0.0 ? percent(factor.density) : "None";
	return fraction + " of the ground has the layer's textures (" + list + ").";
}

std::string shapes_text(const RuleFactor &factor, const Rules &rules, const RuleNames &names) {
	if (factor.index == no_index) {
		return rules.shapes->includes() && factor.density <= 0.0 ? "Outside all regions that include the layer."
																 : "No region excludes anything here.";
	}
	const bool exclude = rules.shapes->shapes()[factor.index].exclude;
	const std::string region = "Region " + name_at(names.shapes, factor.index, "without a name");
	return region + (exclude ? " excludes the layer here." : " includes the layer here.") + leaves(factor.density);
}

void describe_neighbor(
		const RuleFactor &factor, const Neighbor &rule, const std::string &name, RuleMessage &r_message) {
	const bool far = factor.value >= rule.distance;
	const std::string distance = number_text(rule.distance, factor.value) + " m";
	if (rule.curve == nullptr) {
		r_message.rule = "spacing";
		r_message.min = rule.distance;
		r_message.message = far ? "No instance of " + name + " is nearer than the spacing of " + distance + "."
								: "The nearest instance of " + name + " is " +
						number_text(factor.value, rule.distance) + " m away; the spacing requires " + distance + ".";
		return;
	}
	r_message.rule = "proximity";
	r_message.message = far ? "No instance of " + name + " within " + distance + "."
							: "The nearest instance of " + name + " is " + number_text(factor.value) + " m away.";
	r_message.message += factor.density > 0.0 ? leaves(factor.density)
			: far                             ? " The layer is placed only near one."
											  : " The layer is not placed this close to one.";
}

std::string density_message(const RuleFactor &factor) {
	return factor.density > 0.0 ? "Density is " + number_text(factor.density) + "." : "The layer's density is 0.";
}

std::string field_message(const std::string &field, const RuleFactor &factor) {
	const std::string what = field == "noise" ? "The noise"
			: field == "mask_texture"         ? "The mask texture"
											  : "The field";
	return factor.density > 0.0 ? what + " permits " + percent(factor.density) + " of the instances here."
								: what + " permits no instances here.";
}

std::string density_rule_message(const RuleFactor &factor, const RuleNames &names) {
	const std::string rule = "The density rule " + name_at(names.density_rules, factor.index, "without a name");
	return factor.density > 0.0 ? rule + " permits " + percent(factor.density) + " of the instances here."
								: rule + " permits no instances here.";
}

std::string mask_message(const RuleFactor &factor) {
	return factor.density > 0.0 ? "The painted mask permits " + percent(factor.density) + " of the instances here."
								: "The painted mask permits no instances here.";
}

std::string biome_message(const RuleFactor &factor) {
	return factor.density > 0.0 ? "The weight of the layer's biomes is " + number_text(factor.density) + "."
								: "The position is in none of the layer's biomes.";
}

std::string clumps_message(const RuleFactor &factor) {
	return factor.density >= 1.0   ? "Inside a clump."
			: factor.density > 0.0 ? "On the edge of a clump." + leaves(factor.density)
								   : "Between the layer's clumps.";
}

std::string edge_message(const RuleFactor &factor, const Rules &rules) {
	return "The other rules permit the layer in " + percent(factor.value) + " of the area within " +
			number_text(rules.edge_feather) + " m" +
			(factor.density > 0.0 ? "." : "; edge_feather requires more than half.") + leaves(factor.density);
}

std::string rank_text(const PositionExplanation &explanation, const LayerSettings &layer, const RuleNames &names) {
	const double density = explanation.at_point.density;
	const double rank = explanation.point.rank * 0x1p-32;
	std::string text = "Excluded by the density: the nearest point of the set, " + distance_text(explanation.distance) +
			", has rank " + number_text(rank, density) + ", and the density there is " + number_text(density, rank) +
			".";
	if (const RuleFactor *strictest_factor = strictest(explanation.at_point.factors); strictest_factor != nullptr) {
		text += ' ';
		text += describe(*strictest_factor, layer, names).message;
	}
	return text;
}

} // namespace

std::string number_text(double number, double other) {
	if (std::isinf(number)) {
		return number > 0.0 ? "any" : "-any";
	}
	const double size = std::abs(number);
	int digits = size >= 1000.0 ? 0 : size >= 100.0 ? 1 : 2;
	constexpr int max_digits = 9;
	while (digits < max_digits && number != other && fixed_text(number, digits) == fixed_text(other, digits)) {
		++digits;
	}
	return fixed_text(number, digits);
}

std::string distance_text(double meters) {
	constexpr double min_distance = 0.01;
	return meters < min_distance ? "here" : number_text(meters) + " m away";
}

RuleMessage describe(const RuleFactor &factor, const LayerSettings &layer, const RuleNames &names) {
	const Rules &rules = layer.rules;
	RuleMessage result;
	switch (factor.rule) {
		case RuleKind::density: return {.rule = "density", .message = density_message(factor)};
		case RuleKind::field:
			result.rule = name_at(names.fields, factor.index, "field");
			result.message = field_message(result.rule, factor);
			return result;
		case RuleKind::mask: return {.rule = "mask", .message = mask_message(factor)};
		case RuleKind::biome: return {.rule = "biome", .message = biome_message(factor)};
		case RuleKind::clumping: return {.rule = "clumps", .message = clumps_message(factor)};
		case RuleKind::ground: return {.rule = "ground", .message = "There is no ground here."};
		case RuleKind::height:
			result.rule = "height";
			describe_height(factor, rules, result);
			return result;
		case RuleKind::height_curve:
			return {.rule = "density_over_height", .message = curve_text("Density over height", factor, " m")};
		case RuleKind::ground_textures: return {.rule = "ground_textures", .message = textures_text(factor, rules)};
		case RuleKind::water_depth:
			result.rule = "water_depth";
			describe_water_depth(factor, rules, result);
			return result;
		case RuleKind::slope:
			result.rule = "slope";
			describe_slope(factor, rules, result);
			return result;
		case RuleKind::slope_curve:
			return {.rule = "density_over_slope", .message = curve_text("Density over slope", factor, "°")};
		case RuleKind::expression: return {.rule = "density_expression", .message = expression_text(factor, rules)};
		case RuleKind::density_rule: return {.rule = "density_rules", .message = density_rule_message(factor, names)};
		case RuleKind::shapes: return {.rule = "regions", .message = shapes_text(factor, rules, names)};
		case RuleKind::neighbor:
			describe_neighbor(factor, layer.neighbors[factor.index],
					name_at(names.neighbors, factor.index, "another layer"), result);
			return result;
		case RuleKind::edge_feather:
			return {.rule = "edge_feather", .min = 0.5, .message = edge_message(factor, rules)};
	}
	return result;
}

namespace {

/// Returns, for example, " (biome("Forest") is 0.35)", or an empty text if there are no inputs.
std::string inputs_text(const std::vector<MeshShare::Input> &inputs) {
	std::string text;
	for (const MeshShare::Input &input : inputs) {
		const double value = input.value;
		const bool is_far = input.input.kind == WorldInputKind::distance && value >= input.input.max_distance;
		text += (text.empty() ? " (" : ", ") + text_of(input.input) + " is " + (is_far ? "at least " : "") +
				number_text(value);
	}
	return text.empty() ? text : text + ")";
}

} // namespace

std::string describe_mesh(const PositionExplanation &explanation, std::size_t mesh, const std::string &name) {
	const MeshShare &share = explanation.meshes[mesh];
	const bool falls_back = std::ranges::none_of(
			explanation.meshes, [](const MeshShare &other) { return other.weight * other.density > 0.0; });
	const bool is_this = explanation.mesh == mesh && explanation.is_placed();
	return name + (is_this ? " (this instance)" : "") + ": weight " + number_text(share.weight) + " × " +
			number_text(share.density) +
			(falls_back ? "; all weights are 0 here, so the plain weight gives " : " gives ") +
			percent(share.probability) + inputs_text(share.inputs) + ".";
}

RuleVerdict judge(const PositionExplanation &explanation, const LayerSettings &layer, const RuleNames &names) {
	const auto limiting_rule = [&](const RuleResult &result) {
		const RuleFactor *strictest_factor = strictest(result.factors);
		return strictest_factor != nullptr ? describe(*strictest_factor, layer, names)
										   : RuleMessage{.rule = "density", .message = ""};
	};
	if (!explanation.is_allowed()) {
		const RuleMessage limit = limiting_rule(explanation.at_position);
		return {false, limit.rule, limit.message};
	}
	if (explanation.is_placed()) {
		return {true, "", "Placed " + distance_text(explanation.distance) + "."};
	}
	if (!explanation.has_point && layer.set.in_rows) {
		return {false, "rows",
				"Allowed here, but no row of the layer has a point within " + number_text(layer.set.radius) + " m."};
	}
	if (explanation.at_point.density > 0.0) {
		return {false, "rank", rank_text(explanation, layer, names)};
	}
	const RuleMessage limit = limiting_rule(explanation.at_point);
	return {false, limit.rule,
			"Allowed here, but not at the nearest point of the set, " + distance_text(explanation.distance) + ": " +
					limit.message};
}

} // namespace thicket

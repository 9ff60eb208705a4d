// Tests the sentences that explain a rule to a designer: the value, the required range, and the rule that excludes a
// position.

#include "core/explain/rule_messages.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <string>

using namespace thicket;

namespace {

LayerSettings sloped() {
	LayerSettings layer;
	layer.rules.max_slope_degrees = 30.0;
	return layer;
}

std::string message_of(const RuleFactor &factor, const LayerSettings &layer, const RuleNames &names = {}) {
	return describe(factor, layer, names).message;
}

/// Returns an explanation of a position and of a point 1.5 m from it. The mask determines the
/// density of both.
PositionExplanation explained(double density_at_position, double at_point, double rank) {
	PositionExplanation explanation;
	explanation.at_position = {
			{}, density_at_position, {{RuleKind::mask, density_at_position, density_at_position, no_index}}};
	explanation.at_point = {{}, at_point, {{RuleKind::mask, at_point, at_point, no_index}}};
	explanation.point.rank = static_cast<std::uint32_t>(rank * 0x1p32);
	explanation.distance = 1.5;
	return explanation;
}

} // namespace

TEST_CASE("rule sentences: a range names the value, the required range, and the remaining fraction") {
	LayerSettings layer = sloped();
	const RuleMessage steep = describe({RuleKind::slope, 42.0, 0.0, no_index}, layer, {});
	CHECK(steep.rule == "slope");
	CHECK(steep.max == 30.0);
	CHECK(steep.message == "Slope is 42°; the layer requires 0° to 30°.");
	CHECK(message_of({RuleKind::slope, 25.5, 0.45, no_index}, layer) ==
			"Slope is 25.5°; the layer requires 0° to 30°. The rule permits 45 % of the instances.");
	layer.rules.min_height = -2.0;
	const RuleMessage low = describe({RuleKind::height, -12.3456, 0.0, no_index}, layer, {});
	CHECK(low.message == "Height is -12.35 m; the layer requires at least -2 m.");
	CHECK(std::isinf(low.max));
}

TEST_CASE("rule sentences: each mesh has a weight, a density and a percentage") {
	PositionExplanation explanation = explained(1.0, 1.0, 0.5);
	explanation.meshes = {{2.0, 0.35, 0.7 / 1.7}, {1.0, 1.0, 1.0 / 1.7}, {0.0, 1.0, 0.0}};
	explanation.mesh = 1;
	CHECK(describe_mesh(explanation, 0, "Oak") == "Oak: weight 2 × 0.35 gives 41 %.");
	CHECK(describe_mesh(explanation, 1, "Fir") == "Fir (this instance): weight 1 × 1 gives 59 %.");
	CHECK(describe_mesh(explanation, 2, "Elm") == "Elm: weight 0 × 1 gives 0 %.");
	explanation.meshes[0].inputs = {{{WorldInputKind::biome, "Forest", 0, 0.0}, 0.35f},
			{{WorldInputKind::distance, "Rocks", 0, 8.0}, 8.0f}, {{WorldInputKind::distance, "Rocks", 0, 9.0}, 8.0f}};
	CHECK(describe_mesh(explanation, 0, "Oak") ==
			"Oak: weight 2 × 0.35 gives 41 % (biome(\"Forest\") is 0.35, distance(\"Rocks\") is at least 8, "
			"distance(\"Rocks\") is 8).");
	explanation.point.rank = 0xffffffff;
	explanation.at_point.density = 0.5;
	CHECK(describe_mesh(explanation, 1, "Fir") == "Fir: weight 1 × 1 gives 59 %.");
	explanation.meshes = {{3.0, 0.0, 0.75}, {1.0, 0.0, 0.25}};
	CHECK(describe_mesh(explanation, 0, "Oak") ==
			"Oak: weight 3 × 0; all weights are 0 here, so the plain weight gives 75 %.");
}

TEST_CASE("rule sentences: a value just beyond a limit is not printed as the limit") {
	CHECK(message_of({RuleKind::slope, 30.0004, 0.0, no_index}, sloped()) ==
			"Slope is 30.0004°; the layer requires 0° to 30°.");
	CHECK(number_text(1234.5) == "1234");
	CHECK(number_text(-0.001) == "0");
	CHECK(number_text(0.5) == "0.5");
	CHECK(number_text(2.0, 2.0) == "2");
	CHECK(number_text(2.004, 2.0) == "2.004");
}

TEST_CASE("rule sentences: other layers, regions and fields are named") {
	LayerSettings layer;
	const auto other = std::make_shared<LayerSettings>();
	layer.neighbors = {{other, 3.0, nullptr}};
	const RuleNames names{{"noise"}, {"Oaks"}, {"Pond"}};
	CHECK(message_of({RuleKind::neighbor, 1.2, 0.0, 0}, layer, names) ==
			"The nearest instance of Oaks is 1.2 m away; the spacing requires 3 m.");
	CHECK(message_of({RuleKind::neighbor, 3.0, 1.0, 0}, layer, names) ==
			"No instance of Oaks is nearer than the spacing of 3 m.");
	CHECK(describe({RuleKind::field, 0.0, 0.0, 0}, layer, names).rule == "noise");
	CHECK(describe({RuleKind::field, 0.0, 0.0, 7}, layer, names).rule == "field");
	Shape pond;
	pond.kind = ShapeKind::sphere;
	pond.half_size = {5.0, 5.0, 5.0};
	pond.exclude = true;
	const auto shapes = std::make_shared<ShapeSet>();
	REQUIRE(shapes->set({pond}).ok());
	layer.rules.shapes = shapes;
	CHECK(message_of({RuleKind::shapes, 0.0, 0.0, 0}, layer, names) == "Region Pond excludes the layer here.");
	CHECK(message_of({RuleKind::shapes, 1.0, 1.0, no_index}, layer, names) == "No region excludes anything here.");
}

TEST_CASE("rule sentences: the reason is one rule, or the rank, or none") {
	const LayerSettings layer;
	const RuleVerdict rejected = judge(explained(0.0, 1.0, 0.0), layer, {});
	CHECK(!rejected.yes);
	CHECK(rejected.rule == "mask");
	CHECK(rejected.reason == "The painted mask permits no instances here.");
	const RuleVerdict unlikely = judge(explained(1.0, 0.0, 0.0), layer, {});
	CHECK(unlikely.rule == "mask");
	CHECK(unlikely.reason.starts_with(
			"Allowed here, but not at the nearest point of the set, 1.5 m away: The painted mask"));
	const RuleVerdict late_rule = judge(explained(0.5, 0.25, 0.75), layer, {});
	CHECK(late_rule.rule == "rank");
	CHECK(late_rule.reason ==
			"Excluded by the density: the nearest point of the set, 1.5 m away, has rank 0.75, and the density there "
			"is 0.25. The painted mask permits 25 % of the instances here.");
	const RuleVerdict accepted = judge(explained(0.5, 0.5, 0.25), layer, {});
	CHECK(accepted.yes);
	CHECK(accepted.rule.empty());
	CHECK(accepted.reason == "Placed 1.5 m away.");
}

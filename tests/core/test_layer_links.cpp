// Tests that references between layers make them neighbors, in list order, and that unchanged
// layers keep their pointers.

#include "core/placement/layer_links.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <set>
#include <string>
#include <vector>

using namespace thicket;

namespace {

struct NamedLayer : LayerLinks {
	LayerSettings settings;
};

NamedLayer layer_named(const std::string &name, double radius = 2.0) {
	NamedLayer layer;
	layer.name = name;
	layer.settings.set.radius = radius;
	return layer;
}

std::vector<UnlinkedLayer> unlinked(const std::vector<NamedLayer> &layers) {
	std::vector<UnlinkedLayer> result;
	for (const NamedLayer &layer : layers) {
		result.push_back({&layer.settings, &layer});
	}
	return result;
}

std::vector<SharedLayer> linked(const std::vector<NamedLayer> &layers, const std::vector<SharedLayer> &before = {}) {
	std::vector<SharedLayer> result;
	for (const LinkedLayer &layer : link_layers(unlinked(layers), before)) {
		CHECK(layer.status.ok());
		result.push_back(layer.settings);
	}
	return result;
}

std::size_t problems(const std::vector<NamedLayer> &layers, std::size_t index, const std::string &word) {
	std::vector<const LayerLinks *> links;
	for (const NamedLayer &layer : layers) {
		links.push_back(&layer);
	}
	const std::vector<std::string> found_problems = name_problems(links, index);
	CHECK(std::ranges::all_of(
			found_problems, [&](const std::string &text) { return text.find(word) != std::string::npos; }));
	return found_problems.size();
}

} // namespace

TEST_CASE("links: the later layer of a pair keeps the larger distance, whichever layer specifies it") {
	std::vector<NamedLayer> layers{layer_named("oak"), layer_named("birch"), layer_named("fern")};
	layers[0].spacing = {{"birch", 5.0}, {"fern", 1.0}};
	layers[1].spacing = {{"oak", 3.0}};
	layers[2].spacing = {{"oak", 2.0}};
	const std::vector<SharedLayer> result = linked(layers);
	CHECK(result[0]->neighbors.empty());
	REQUIRE(result[1]->neighbors.size() == 1);
	CHECK(result[1]->neighbors[0] == Neighbor{result[0], 5.0, nullptr});
	REQUIRE(result[2]->neighbors.size() == 1);
	CHECK(result[2]->neighbors[0] == Neighbor{result[0], 2.0, nullptr});

	std::swap(layers[0], layers[2]);
	const std::vector<SharedLayer> linked_layers = linked(layers);
	CHECK(linked_layers[0]->neighbors.empty());
	CHECK(linked_layers[1]->neighbors.empty());
	REQUIRE(linked_layers[2]->neighbors.size() == 2);
	CHECK(linked_layers[2]->neighbors[0] == Neighbor{linked_layers[0], 2.0, nullptr});
	CHECK(linked_layers[2]->neighbors[1] == Neighbor{linked_layers[1], 5.0, nullptr});
}

TEST_CASE("links: proximity applies to earlier layers only") {
	std::vector<NamedLayer> layers{layer_named("oak"), layer_named("fern")};
	const auto curve = std::make_shared<const CurveTable>();
	for (NamedLayer &layer : layers) {
		layer.proximity_layer = layer.name == "oak" ? "fern" : "oak";
		layer.proximity_distance = 6.0;
		layer.proximity_curve = curve;
	}
	layers[1].spacing = {{"oak", 1.5}};
	const std::vector<SharedLayer> result = linked(layers);
	CHECK(result[0]->neighbors.empty());
	REQUIRE(result[1]->neighbors.size() == 2);
	CHECK(result[1]->neighbors[0] == Neighbor{result[0], 1.5, nullptr});
	CHECK(result[1]->neighbors[1] == Neighbor{result[0], 6.0, curve});
	CHECK(problems(layers, 0, "before") == 1);
	CHECK(problems(layers, 1, "") == 0);
}

TEST_CASE("links: an unchanged layer keeps its pointer, also as a neighbor") {
	std::vector<NamedLayer> layers{layer_named("oak"), layer_named("birch"), layer_named("fern")};
	layers[1].spacing = {{"oak", 3.0}};
	layers[2].spacing = {{"birch", 1.0}};
	const std::vector<SharedLayer> first = linked(layers);
	CHECK(linked(layers, first) == first);

	layers[1].settings.rules.density = 0.5;
	const std::vector<SharedLayer> second = linked(layers, first);
	CHECK(second[0] == first[0]);
	CHECK(second[1] != first[1]);
	CHECK(second[1]->neighbors[0].layer == first[0]);
	CHECK(second[2] != first[2]);
	CHECK(second[2]->neighbors[0].layer == second[1]);
	layers[2].spacing.clear();
	CHECK(linked(layers, second)[2]->neighbors.empty());
}

TEST_CASE("links: names may refer to no layer, to two layers, or to the layer itself") {
	std::vector<NamedLayer> layers{layer_named("oak"), layer_named("oak"), layer_named("fern"), layer_named("")};
	layers[1].spacing = {{"fern", 2.0}};
	layers[2].spacing = {{"oak", 1.0}, {"elm", 4.0}, {"fern", 9.0}};
	layers[2].proximity_layer = "elm";
	layers[3].spacing = {{"fern", 1.0}};
	const std::vector<SharedLayer> result = linked(layers);
	REQUIRE(result[2]->neighbors.size() == 2);
	CHECK(result[2]->neighbors[0] == Neighbor{result[0], 1.0, nullptr});
	CHECK(result[2]->neighbors[1] == Neighbor{result[1], 2.0, nullptr}); // The second oak defines this spacing.
	CHECK(result[3]->neighbors.size() == 1);
	CHECK(problems(layers, 1, "so \"oak\" refers to that layer") == 1);
	CHECK(problems(layers, 2, "") == 3);
	layers[2].spacing.erase("fern"); // "fern" is the name of the layer itself.
	CHECK(problems(layers, 2, "\"elm\", and no layer") == 2);
	CHECK(problems(layers, 0, "") == 0);
	CHECK(problems(layers, 3, "") == 0);
}

TEST_CASE("links: layers are found by index and by identity, and the larger of two distances applies") {
	std::vector<NamedLayer> layers{layer_named(""), layer_named("oak"), layer_named("fern")};
	layers[0].identity = 70;
	layers[1].identity = 71;
	LayerReference first;
	first.identity = 70;
	LayerReference second;
	second.index = 1;
	layers[2].spacing = {{first, 3.0}, {second, 1.0}, {"oak", 2.0}};
	layers[2].proximity_layer = first;
	layers[2].proximity_distance = 6.0;
	layers[2].proximity_curve = std::make_shared<const CurveTable>();
	const std::vector<SharedLayer> result = linked(layers);
	REQUIRE(result[2]->neighbors.size() == 3);
	CHECK(result[2]->neighbors[0] == Neighbor{result[0], 3.0, nullptr});
	CHECK(result[2]->neighbors[1] == Neighbor{result[0], 6.0, layers[2].proximity_curve});
	CHECK(result[2]->neighbors[2] == Neighbor{result[1], 2.0, nullptr});
	CHECK(problems(layers, 2, "") == 0);

	first.identity = 72;
	second.index = 3;
	layers[2].spacing = {{first, 3.0}, {second, 1.0}};
	CHECK(linked(layers)[2]->neighbors.size() == 1); // Only the proximity is left.
	CHECK(problems(layers, 2, "which is not in the list") == 2);
	CHECK(problems(layers, 2, "Layers of different TerrainScatter3D nodes cannot refer to each other") == 2);
	second.index = 2;
	layers[2].spacing = {{second, 1.0}};
	CHECK(problems(layers, 2, "the layer itself") == 1);
}

TEST_CASE("links: the layers on which colors, variations and scales depend are earlier ones, and not neighbors") {
	std::vector<NamedLayer> layers{layer_named("oak"), layer_named("fern"), layer_named("moss")};
	layers[0].color_layer = "moss";
	layers[1].color_layer = "oak";
	layers[1].variation_layer = "fern";
	layers[2].variation_layer = "fern";
	layers[2].scale_layer = "oak";
	const std::vector<SharedLayer> result = linked(layers);
	CHECK(result[0]->instance_data.color.layer == nullptr);
	CHECK(result[1]->instance_data.color.layer == result[0]);
	CHECK(result[1]->instance_data.variation.layer == nullptr);
	CHECK(result[2]->instance_data.variation.layer == result[1]);
	CHECK(result[2]->instance_data.scale.layer == result[0]);
	CHECK(result[2]->neighbors.empty());
	CHECK(linked(layers, result) == result);
	CHECK(problems(layers, 0, "color_value.layer is \"moss\", which is not before") == 1);
	CHECK(problems(layers, 1, "variation_value.layer is \"fern\", which is not before") == 1);
	CHECK(problems(layers, 2, "") == 0);
	layers[2].color_layer = "elm";
	CHECK(problems(layers, 2, "color_value.layer is \"elm\", and no layer has that name") == 1);
	layers[0].settings.rules.density = 0.5;
	const std::vector<SharedLayer> later_layers = linked(layers, result);
	CHECK(later_layers[1] != result[1]);
	CHECK(later_layers[1]->instance_data.color.layer == later_layers[0]);
}

TEST_CASE("links: a missing layer is not a neighbor, and a rejected one keeps its settings") {
	std::vector<NamedLayer> layers{layer_named("oak"), layer_named("fern")};
	NamedLayer &fern = layers[1];
	fern.spacing = {{"oak", 2.0}};
	const std::vector<LinkedLayer> alone = link_layers(std::vector<UnlinkedLayer>{{}, {&fern.settings, &fern}}, {});
	CHECK(alone[0].settings == nullptr);
	CHECK(alone[1].settings->neighbors.empty());

	const std::vector<LinkedLayer> good = link_layers(unlinked(layers), {});
	const std::vector<SharedLayer> before{good[0].settings, good[1].settings};
	fern.spacing = {{"oak", 2.0 * max_neighbor_distance}};
	const std::vector<LinkedLayer> bad = link_layers(unlinked(layers), before);
	CHECK(bad[1].status.code == ErrorCode::out_of_range);
	CHECK(bad[1].settings == good[1].settings);
	CHECK(link_layers(unlinked(layers), {})[1].settings == nullptr);

	fern.spacing = {{"oak", 3.0}};
	const LayerCheck none_at_1 = [](const LayerSettings &layer, std::size_t index) {
		CHECK(layer.neighbors.size() == index);
		return index == 1 ? Status{ErrorCode::too_many_points, "spacing", 3.0} : Status{};
	};
	const std::vector<LinkedLayer> checked = link_layers(unlinked(layers), before, none_at_1);
	CHECK(checked[0].status.ok());
	CHECK(checked[1].status.code == ErrorCode::too_many_points);
	CHECK(checked[1].settings == good[1].settings);
}

TEST_CASE("layers: an unused name is kept, and a used one gets the lowest free number") {
	const std::vector<std::string> used_names{"Oak", "Oak 2", "Oak 4", "Fir 2", ""};
	CHECK(free_layer_name("Fir", used_names) == "Fir");
	CHECK(free_layer_name("Oak", used_names) == "Oak 3");
	CHECK(free_layer_name("Fir 2", used_names) == "Fir 2 2");
	CHECK(free_layer_name("", used_names) == " 2");
	CHECK(free_layer_name("Oak", {}) == "Oak");
}

TEST_CASE("links: a layer that cannot fill gaps is reported") {
	std::vector<NamedLayer> layers{layer_named("oak"), layer_named("ivy"), layer_named("fern")};
	layers[2].spacing_fills = true;
	CHECK(problems(layers, 2, "there is no spacing between this layer and an earlier one") == 1);
	layers[2].spacing = {{"oak", 3.0}};
	CHECK(problems(layers, 2, "spacing_fills") == 0);
	layers[1].on_surface = true;
	layers[1].spacing = {{"fern", 1.0}}; // Either layer of a pair can set the distance.
	CHECK(problems(layers, 2, "around \"ivy\", which is on_surfaces") == 1);
	layers[2].on_surface = true;
	CHECK(problems(layers, 2, "while on_surfaces is on") == 1);
}

TEST_CASE("links: hosts are the known layers that surface_layers of any layer contain") {
	std::vector<NamedLayer> layers{layer_named("stone"), layer_named("trunk"), layer_named("moss")};
	layers[2].surface_layers = {"trunk", "missing", "stone"};
	CHECK(hosts_in(std::vector<const LayerLinks *>{&layers[0], nullptr, &layers[2]}) == std::set<std::size_t>{0});
	CHECK(hosts_in(std::vector<const LayerLinks *>{&layers[0], &layers[1], &layers[2]}) == std::set<std::size_t>{0, 1});
}
